//! Case 3: a sphere within a sphere, which reflect each other's light and, the outer one, its own.

use super::shapes::{Places, Triangle, area, facets, icosphere};
use super::{Case, Checks};
use crate::baker::{Bounces, LightMap, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::verify::estimate::{Estimate, How, bake, broken};
use crate::verify::stage::Stage;
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 3] = [
    Case::closed_form(3, "spheres, a bright one within", bright_within),
    Case::closed_form(3, "spheres, a bright one around", bright_around),
    Case::closed_form(3, "spheres alike", alike),
];

/// One of the two.
#[derive(Debug, Clone, Copy)]
struct Sphere {
    radius: f64,
    albedo: f32,
    /// Radiosity that it emits, in units of pi.
    emitted: f32,
}

impl Sphere {
    fn albedo(self) -> f64 {
        f64::from(self.albedo)
    }

    fn emitted(self) -> f64 {
        f64::from(self.emitted)
    }
}

/// Radiosities of the inner and the outer one. Spheres of flat facets have the same form factors: whatever leaves a convex
/// body meets what surrounds it, and F21 is the ratio of their areas, which of bodies of one shape is that of the squared
/// radii. That each has one radiosity everywhere is so of round ones only: measured, of a mean less than a thousandth.
fn radiosities([inner, outer]: [Sphere; 2]) -> [f64; 2] {
    let (e1, e2, rho1, rho2) = (inner.emitted(), outer.emitted(), inner.albedo(), outer.albedo());
    let f21 = (inner.radius / outer.radius).powi(2);
    let f22 = 1.0 - f21;
    let b2 = (e2 + rho2 * f21 * e1) / (1.0 - rho2 * f22 - rho1 * rho2 * f21);
    [e1 + rho1 * b2, b2]
}

/// Pairs in one scene: each is a randomisation, for what is in a closed sphere knows of no other.
const PAIRS: usize = 8;
const APART: f64 = 4.0;
const PLACES: Places = Places { first_column: 1, side: 160 };

/// Fronts toward each other; each pair's facets follow the last one's, the inner one's first.
fn scene([inner, outer]: [Sphere; 2], unit: &[Triangle]) -> Result<Scene> {
    let mut stage = Stage::new();
    let [within, around] = [inner, outer].map(|sphere| stage.material(sphere.albedo, sphere.emitted));
    let outward: Vec<Triangle> = unit.iter().map(|corners| corners.map(|corner| corner * inner.radius)).collect();
    let inward: Vec<Triangle> = unit.iter().map(|[a, b, c]| [a, c, b].map(|corner| *corner * outer.radius)).collect();
    for pair in 0..PAIRS {
        let first = 2 * pair * unit.len();
        let parts = vec![facets(&outward, PLACES, first, within), facets(&inward, PLACES, first + unit.len(), around)];
        stage.place_parts(parts, DAffine3::from_translation(DVec3::X * APART * pair as f64));
    }
    stage.build()
}

/// The mean over a sphere's area, from this facet on, in units of pi.
fn radiosity(map: &LightMap, unit: &[Triangle], first: usize, sphere: Sphere) -> Result<f64> {
    let (mut irradiance, mut whole) = (0.0, 0.0);
    for (index, triangle) in unit.iter().enumerate() {
        let [red, _, _, alpha] = map.pixels[PLACES.texel(first + index)];
        if alpha != 1.0 {
            return Err(broken(format!("facet {index} is not baked")));
        }
        irradiance += f64::from(red) * area(triangle);
        whole += area(triangle);
    }
    Ok(sphere.emitted() + sphere.albedo() * irradiance / whole / PI)
}

/// `tolerance` beside noise, and `resolution`, are shares of the closed form.
fn check(
    gpu: &Gpu,
    checks: &mut Checks,
    spheres: [Sphere; 2],
    samples: u32,
    [tolerance, resolution]: [f64; 2],
) -> Result<()> {
    let unit = icosphere();
    let how = How::new(samples, Bounces::Auto).by(Sampling::Cosine).on(PLACES.side);
    let (map, _) = bake(gpu, &scene(spheres, &unit)?, how, 0)?;
    for (index, expected) in radiosities(spheres).into_iter().enumerate() {
        let of_pair = |pair| radiosity(&map, &unit, (2 * pair + index) * unit.len(), spheres[index]);
        let estimate = Estimate::over(&(0..PAIRS).map(of_pair).collect::<Result<Vec<_>>>()?);
        let what = ["inner radiosity", "outer radiosity"][index];
        checks.estimate(what, estimate, expected, tolerance * expected, resolution * expected);
    }
    Ok(())
}

/// Half a percent, noise and all.
const HALF_A_PERCENT: [f64; 2] = [3e-3, 2e-3];

fn bright_within(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let inner = Sphere { radius: 0.5, albedo: 0.5, emitted: 1.0 };
    check(gpu, checks, [inner, Sphere { radius: 1.0, albedo: 0.6, emitted: 0.4 }], 256, HALF_A_PERCENT)
}

fn bright_around(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let inner = Sphere { radius: 0.6, albedo: 0.3, emitted: 0.2 };
    check(gpu, checks, [inner, Sphere { radius: 0.8, albedo: 0.9, emitted: 0.7 }], 256, HALF_A_PERCENT)
}

/// Of one radiance everywhere, so that there is no noise: what passed between facets would show. A ten-thousandth may be
/// missing of the bounces.
fn alike(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let [inner, outer] = [0.6, 0.8].map(|radius| Sphere { radius, albedo: 0.5, emitted: 0.5 });
    check(gpu, checks, [inner, outer], 64, [1.1e-4, 1e-6])
}
