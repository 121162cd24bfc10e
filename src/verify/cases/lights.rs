//! Cases 11, 12 and 13: analytic lights, taken at a texel's centre.

use super::{Case, Checks};
use crate::baker::Bounces;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::LightKind;
use crate::verify::estimate::{How, bake};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DVec3, Vec3};

pub(super) const CASES: [Case; 6] = [
    Case::closed_form(11, "point light", point_light),
    Case::closed_form(11, "point light with a range", point_light_with_range),
    Case::closed_form(12, "spot light", spot_light),
    Case::closed_form(13, "sun on a level plane", sun_on_a_level_plane),
    Case::closed_form(13, "sun on a tilted plane", sun_on_a_tilted_plane),
    Case::closed_form(13, "sun behind a plane", sun_behind_a_plane),
];

/// Bakes one light over one black rectangle. The texel, and channel, whose centre's irradiance is farthest from `expected`:
/// at most the share `bound` of the largest expected one.
fn check_worst(
    gpu: &Gpu,
    checks: &mut Checks,
    quad: Quad,
    light: LightKind,
    expected: impl Fn(DVec3) -> f64,
    bound: f64,
) -> Result<()> {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(light);
    let (map, _) = bake(gpu, &stage.with(&[quad])?, How::new(64, Bounces::Auto), 0)?;
    let (mut worst, mut largest) = ((0.0, 0.0), 0.0_f64);
    for (texel, at) in quad.mapped()?.texels() {
        let wanted = expected(quad.point(at));
        largest = largest.max(wanted);
        for measured in map.pixels[texel][..3].iter().map(|channel| f64::from(*channel)) {
            if (measured - wanted).abs() >= f64::abs(worst.0 - worst.1) {
                worst = (measured, wanted);
            }
        }
    }
    checks.holds("some texel is lit", largest > 0.0);
    checks.within("irradiance of the worst texel", worst.0, worst.1, bound * largest);
    Ok(())
}

fn plane() -> Quad {
    level_square(4.0, 0.0, Facing::Up, Chart::new(0), 0)
}

const POSITION: DVec3 = DVec3::new(0.3, -0.2, 1.25);

fn point_light(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let expected = |point: DVec3| POSITION.z / POSITION.distance(point).powi(3);
    check_worst(gpu, checks, plane(), LightKind::Point { position: POSITION, range: None }, expected, 1e-5)
}

/// KHR_lights_punctual, "Range Property".
fn point_light_with_range(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const RANGE: f32 = 2.0;
    let expected = |point: DVec3| {
        let distance = POSITION.distance(point);
        let fade = (1.0 - (distance / f64::from(RANGE)).powi(4)).clamp(0.0, 1.0);
        fade * POSITION.z / distance.powi(3)
    };
    let light = LightKind::Point { position: POSITION, range: Some(RANGE) };
    check_worst(gpu, checks, plane(), light, expected, 1e-5)
}

/// KHR_lights_punctual, "Inner and Outer Cone Angles".
fn spot_light(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (inner_angle, outer_angle) = (0.4_f32, 0.9_f32);
    let direction = Vec3::new(0.2, 0.1, -1.0);
    let expected = |point: DVec3| {
        let toward = (POSITION - point).normalize();
        let (inner, outer) = (f64::from(inner_angle).cos(), f64::from(outer_angle).cos());
        let scale = 1.0 / (inner - outer);
        let along = direction.as_dvec3().normalize().dot(-toward);
        let cone = (along * scale - outer * scale).clamp(0.0, 1.0);
        cone * cone * toward.z / POSITION.distance_squared(point)
    };
    let light = LightKind::Spot { position: POSITION, direction, inner_angle, outer_angle, range: None };
    check_worst(gpu, checks, plane(), light, expected, 1e-5)
}

const SUN: Vec3 = Vec3::new(-0.3, 0.5, -0.8);

fn sun_on(gpu: &Gpu, checks: &mut Checks, quad: Quad) -> Result<()> {
    let normal = quad.u.as_dvec3().cross(quad.v.as_dvec3()).normalize();
    let share = normal.dot(-SUN.as_dvec3().normalize()).max(0.0);
    check_worst(gpu, checks, quad, LightKind::Directional { direction: SUN }, |_| share, 1e-6)
}

fn sun_on_a_level_plane(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    sun_on(gpu, checks, plane())
}

fn tilted() -> Quad {
    Quad { u: Vec3::new(1.0, 0.2, 0.3), v: Vec3::new(-0.1, 0.9, 0.55), ..plane() }
}

fn sun_on_a_tilted_plane(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    sun_on(gpu, checks, tilted())
}

fn sun_behind_a_plane(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let Quad { u, v, .. } = tilted();
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: SUN });
    let (map, _) = bake(gpu, &stage.with(&[Quad { u: v, v: u, ..plane() }])?, How::new(64, Bounces::Auto), 0)?;
    checks.at_least("baked texels", map.pixels.iter().filter(|pixel| pixel[3] == 1.0).count() as f64, 36.0);
    checks.count("lit texels", map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count() as u64, 0);
    Ok(())
}
