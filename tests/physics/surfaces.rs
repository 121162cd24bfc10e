//! What a surface shows from either side, without a place in the light map, and with a texture.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, How, bake, mean};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use lightoven::scene::{Sidedness, Texture, TextureUse, Wrap};
use std::f64::consts::PI;

on_both_back_ends!(
    single_sided_from_behind,
    single_sided_blocks_the_sky,
    double_sided_from_both_sides,
    unmapped_emitter,
    textured_emitter,
    unmapped_textured_emitter,
);

/// Case 6 at h = 1.
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
fn received(gpu: &Gpu, stage: Stage, quads: &[Quad]) -> Estimate {
    let chart = Chart::new(RECEIVER);
    Estimate::direct(gpu, &stage.with(quads), How::new(32_768, Bounces::Auto), chart).times(PI.recip())
}

fn single_sided_from_behind(gpu: &Gpu) {
    let (stage, quads) = stage(Facing::Up);
    let (map, _) = bake(gpu, &stage.with(&quads), How::new(256, Bounces::Auto), 0);
    assert_eq!(mean(&map, Chart::new(RECEIVER)), 0.0);
}

fn single_sided_blocks_the_sky(gpu: &Gpu) {
    let (mut stage, quads) = stage(Facing::Up);
    stage.sky(1.0);
    let estimate = received(gpu, stage, &quads);
    estimate.assert_is("sky round a square seen from behind", gpu, 1.0 - FACTOR, 1e-6, 1e-3);
}

fn double_sided_from_both_sides(gpu: &Gpu) {
    for facing in [Facing::Up, Facing::Down] {
        let (mut stage, quads) = stage(facing);
        stage.desc.materials[1].sidedness = Sidedness::Double;
        let estimate = received(gpu, stage, &quads);
        estimate.assert_is(&format!("double-sided square, facing {facing:?}"), gpu, FACTOR, 1e-6, 1e-3);
    }
}

fn unmapped_emitter(gpu: &Gpu) {
    let (stage, [receiver, emitter]) = stage(Facing::Down);
    let estimate = received(gpu, stage, &[receiver, Quad { chart: None, ..emitter }]);
    estimate.assert_is("emitter outside the light map", gpu, FACTOR, 1e-6, 1e-3);
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

fn textured_emitter(gpu: &Gpu) {
    let (mut stage, quads) = stage(Facing::Down);
    chequered(&mut stage);
    let estimate = received(gpu, stage, &quads);
    estimate.assert_is("chequered emitter", gpu, 0.5 * FACTOR, CODE * 0.5 * FACTOR, 1e-3);
}

fn unmapped_textured_emitter(gpu: &Gpu) {
    let (mut stage, [receiver, emitter]) = stage(Facing::Down);
    chequered(&mut stage);
    let estimate = received(gpu, stage, &[receiver, Quad { chart: None, ..emitter }]);
    // The mean of each triangle is taken at some thousand points.
    estimate.assert_is("chequered emitter outside the light map", gpu, 0.5 * FACTOR, 1e-3 * 0.5 * FACTOR, 1e-3);
}
