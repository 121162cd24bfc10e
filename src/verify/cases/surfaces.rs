//! Case 6 again, for what a surface shows from either side, without a place in the light map, and with a texture.

use super::{Case, Checks};
use crate::baker::Bounces;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Sidedness, Texture, TextureUse, Wrap};
use crate::verify::estimate::{Estimate, How, bake, mean};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 6] = [
    Case::closed_form(6, "surface seen from behind", single_sided_from_behind),
    Case::closed_form(6, "surface seen from behind before a sky", single_sided_blocks_the_sky),
    Case::closed_form(6, "surface of two sides", double_sided_from_both_sides),
    Case::closed_form(6, "surface outside the light map", unmapped_emitter),
    Case::closed_form(6, "surface with a texture", textured_emitter),
    Case::closed_form(6, "surface with a texture, outside the light map", unmapped_textured_emitter),
];

/// At h = 1.
const FACTOR: f64 = 0.239_456;
const POINT: f32 = 1e-4;
const RECEIVER: u32 = 0;

/// A point-like receiver on the ground, black; then a shining unit square at height 1.
fn stage(facing: Facing) -> (Stage, [Quad; 2]) {
    let mut stage = Stage::new();
    let (black, lamp) = (stage.material(0.0, 0.0), stage.material(0.0, 1.0));
    let receiver = level_square(POINT, 0.0, Facing::Up, Chart::new(RECEIVER), black);
    (stage, [receiver, level_square(1.0, 1.0, facing, Chart::new(1), lamp)])
}

/// The receiver's irradiance over pi.
fn received(gpu: &Gpu, stage: Stage, quads: &[Quad]) -> Result<Estimate> {
    let (how, chart) = (How::new(32_768, Bounces::Auto), Chart::new(RECEIVER));
    Ok(Estimate::direct(gpu, &stage.with(quads)?, how, chart)?.times(PI.recip()))
}

fn single_sided_from_behind(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (stage, quads) = stage(Facing::Up);
    let (map, _) = bake(gpu, &stage.with(&quads)?, How::new(256, Bounces::Auto), 0)?;
    checks.within("irradiance", mean(&map, Chart::new(RECEIVER))?, 0.0, 0.0);
    Ok(())
}

fn single_sided_blocks_the_sky(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (mut stage, quads) = stage(Facing::Up);
    stage.sky(1.0);
    checks.estimate("sky round the square", received(gpu, stage, &quads)?, 1.0 - FACTOR, 1e-6, 1e-3);
    Ok(())
}

fn double_sided_from_both_sides(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for (what, facing) in [("from behind", Facing::Up), ("from in front", Facing::Down)] {
        let (mut stage, quads) = stage(facing);
        stage.desc.materials[1].sidedness = Sidedness::Double;
        checks.estimate(what, received(gpu, stage, &quads)?, FACTOR, 1e-6, 1e-3);
    }
    Ok(())
}

fn unmapped_emitter(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (stage, [receiver, emitter]) = stage(Facing::Down);
    let estimate = received(gpu, stage, &[receiver, Quad { chart: None, ..emitter }])?;
    checks.estimate("form factor", estimate, FACTOR, 1e-6, 1e-3);
    Ok(())
}

/// Squares of the chequerboard along a side, two to a texel of the light map. Turned by a quarter it is its own opposite,
/// so that a receiver under its middle sees its mean exactly.
const SQUARES: u32 = 12;
const PIXELS: u32 = 96;

/// The lamp shines in the white squares of a chequerboard. The mean is taken of light, not of sRGB codes.
fn chequered(stage: &mut Stage) {
    let pixel = |i: u32| {
        let (x, y) = (i % PIXELS * SQUARES / PIXELS, i / PIXELS * SQUARES / PIXELS);
        if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] }
    };
    let pixels = (0..PIXELS * PIXELS).map(pixel).collect();
    stage.desc.textures.push(Texture { name: "chequers".into(), width: PIXELS, height: PIXELS, pixels });
    stage.desc.materials[1].emission_texture = Some(TextureUse { texture: 0, wrap: [Wrap::ClampToEdge; 2] });
}

/// The mean of a mip level is an 8-bit sRGB code: at a half, a code is 1.2 %.
const CODE: f64 = 0.012;

fn textured_emitter(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (mut stage, quads) = stage(Facing::Down);
    chequered(&mut stage);
    let estimate = received(gpu, stage, &quads)?;
    checks.estimate("half the form factor", estimate, 0.5 * FACTOR, CODE * 0.5 * FACTOR, 1e-3);
    Ok(())
}

fn unmapped_textured_emitter(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (mut stage, [receiver, emitter]) = stage(Facing::Down);
    chequered(&mut stage);
    let estimate = received(gpu, stage, &[receiver, Quad { chart: None, ..emitter }])?;
    // The mean of each triangle is taken at some thousand points.
    checks.estimate("half the form factor", estimate, 0.5 * FACTOR, 1e-3 * 0.5 * FACTOR, 1e-3);
    Ok(())
}
