//! Case 16: two unit squares of a texel each reflect each other's light.

use super::{Case, Checks};
use crate::baker::Bounces;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::verify::estimate::{Estimate, How, SAMPLINGS, bake, mean};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::Vec3;
use std::f64::consts::PI;

pub(super) const CASES: [Case; 1] = [Case::closed_form(16, "radiosity of two patches", two_patches)];

const ALBEDO: f32 = 0.5;
/// Pairs in one scene, so far apart that they do not know of each other, in rows of four: each is a randomisation.
const PAIRS: u32 = 16;
const APART: f32 = 30.0;

/// A patch of a pair; `row`: of the light map.
fn patch(pair: u32, height: f32, facing: Facing, row: u32, material: usize) -> Quad {
    let chart = Chart::at([40 + 4 * pair, row], 1).inset(0.01);
    let quad = level_square(1.0, height, facing, chart, material);
    let place = Vec3::new((pair % 4) as f32, (pair / 4) as f32, 0.0) * APART;
    Quad { corner: quad.corner + place, ..quad }
}

/// The lower patches shine. Radiosity is in parts of what they emit, pi.
fn two_patches(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let (lamp, grey) = (stage.material(ALBEDO, 1.0), stage.material(ALBEDO, 0.0));
    let lower: Vec<Quad> = (0..PAIRS).map(|pair| patch(pair, 0.0, Facing::Up, 2, lamp)).collect();
    let upper: Vec<Quad> = (0..PAIRS).map(|pair| patch(pair, 1.0, Facing::Down, 6, grey)).collect();
    let scene = stage.with(&[&lower[..], &upper[..]].concat())?;
    for sampling in SAMPLINGS {
        let (map, _) = bake(gpu, &scene, How::new(1 << 15, Bounces::Auto).by(sampling), 0)?;
        let radiosity = |quad: &Quad, emitted: f64| Ok(emitted + f64::from(ALBEDO) * mean(&map, quad.mapped()?)? / PI);
        let of = |quads: &[Quad], emitted| -> Result<Estimate> {
            let radiosities: Result<Vec<f64>> = quads.iter().map(|quad| radiosity(quad, emitted)).collect();
            Ok(Estimate::over(&radiosities?))
        };
        checks.estimate(format!("lamp, by {sampling}"), of(&lower, 1.0)?, 1.010_083, 1e-3, 2e-3);
        checks.estimate(format!("its reflector, by {sampling}"), of(&upper, 0.0)?, 0.100_920, 1e-3, 2e-3);
    }
    Ok(())
}
