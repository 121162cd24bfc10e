//! Cases 1 and 2: a closed room whose walls all shine and reflect alike has the same radiance everywhere.

use super::{Case, Checks};
use crate::baker::{Bounces, LightMap, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Sidedness, Sky};
use crate::verify::estimate::{How, bake, broken};
use crate::verify::stage::{Chart, Quad, Stage, room};
use glam::Vec3;
use std::f64::consts::PI;

pub(super) const CASES: [Case; 6] = [
    Case::closed_form(1, "furnace under a sky", open_to_the_sky),
    Case::closed_form(1, "furnace of albedo .5", half),
    Case::closed_form(1, "furnace of albedo .9", nine_tenths),
    Case::closed_form(1, "furnace of albedo .9, automatic bounces", automatic_bounces),
    Case::closed_form(1, "furnace of albedo .875, charts that end within a texel", charts_that_end_within_a_texel),
    Case::closed_form(2, "furnace of albedo .99", all_but_a_hundredth),
];

/// How the charts lie: whole texels, nothing beside them.
const WHOLE: f32 = 0.01;

/// Bakes the furnace; the light map, and the irradiance of the closed form.
fn furnace(gpu: &Gpu, albedo: f32, bounces: Bounces, inset: f32) -> Result<(LightMap, f64)> {
    let mut stage = Stage::new();
    let white = stage.material(albedo, 1.0);
    let walls = room(Vec3::ZERO, Vec3::ONE, |index| Chart::new(index).inset(inset), white);
    let (map, statistics) = bake(gpu, &stage.with(&walls)?, How::new(256, bounces), 0)?;
    if statistics.invalid_texels > 0 {
        return Err(broken(format!("{} texels of a room are inside something", statistics.invalid_texels)));
    }
    Ok((map, PI / (1.0 - f64::from(albedo))))
}

/// Every texel's irradiance against the closed form. All rays see the same radiance: there is no noise to allow for.
fn check_uniform(checks: &mut Checks, (map, expected): &(LightMap, f64), tolerance: f64) {
    let (mut count, mut lowest, mut highest) = (0, f64::INFINITY, 0.0_f64);
    for pixel in map.pixels.iter().filter(|pixel| pixel[3] == 1.0) {
        for channel in &pixel[..3] {
            let ratio = f64::from(*channel) / expected;
            (count, lowest, highest) = (count + 1, lowest.min(ratio), highest.max(ratio));
        }
    }
    checks.at_least("values that are baked", f64::from(count), 6.0 * 36.0 * 3.0);
    checks.relative("lowest irradiance", lowest * expected, *expected, tolerance);
    checks.relative("highest irradiance", highest * expected, *expected, tolerance);
}

/// Bounces after which a millionth is missing.
fn enough(albedo: f64) -> Bounces {
    Bounces::Limit((1e-6_f64.ln() / albedo.ln()).ceil() as u32)
}

/// A box whose ceiling hangs above it, under a sky of radiance 1, with an unmapped square of radiance 1 in it; its walls
/// shine with what their albedo takes, so that all that anyone sees has radiance 1. Seven bounces are all there are: no later
/// source map mends what they leave out.
fn open_to_the_sky(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    stage.desc.sky = Sky::Constant(Vec3::ONE);
    let (wall, lamp) = (stage.material(0.5, 0.5), stage.material(0.0, 1.0));
    stage.desc.materials.iter_mut().for_each(|material| material.sidedness = Sidedness::Double);
    let mut quads = room(Vec3::ZERO, Vec3::ONE, |index| Chart::new(index).inset(WHOLE), wall).to_vec();
    quads[1].corner += Vec3::Z * 0.5;
    quads.push(Quad { corner: Vec3::splat(0.4), u: Vec3::X * 0.2, v: Vec3::Y * 0.2, chart: None, material: lamp });
    let scene = stage.with(&quads)?;
    let missing = 0.5_f64.powi(8);
    for sampling in [Sampling::Cosine, Sampling::Auto] {
        let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Limit(7)).by(sampling), 0)?;
        check_uniform(checks, &(map, PI), missing + 1e-5);
    }
    Ok(())
}

fn half(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_uniform(checks, &furnace(gpu, 0.5, enough(0.5), WHOLE)?, 1e-4);
    Ok(())
}

fn nine_tenths(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_uniform(checks, &furnace(gpu, 0.9, enough(0.9), WHOLE)?, 1e-4);
    Ok(())
}

fn all_but_a_hundredth(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_uniform(checks, &furnace(gpu, 0.99, Bounces::Auto, WHOLE)?, 1e-2);
    Ok(())
}

/// What the automatic number of bounces promises: a ten-thousandth may be missing, and what 32-bit floats round.
fn automatic_bounces(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_uniform(checks, &furnace(gpu, 0.9, Bounces::Auto, WHOLE)?, 1.1e-4);
    Ok(())
}

/// Texels that a chart covers in part, just touches, or covers all but a sliver of see the same as all others.
fn charts_that_end_within_a_texel(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for inset in [-0.5, -0.02, 0.0, 0.4, 0.97] {
        check_uniform(checks, &furnace(gpu, 0.875, enough(0.875), inset)?, 1e-4);
    }
    Ok(())
}
