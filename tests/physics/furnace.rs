//! Cases 1 and 2: a closed room whose walls all shine and reflect alike has the same radiance everywhere.

use crate::device::on_both_back_ends;
use crate::estimate::{How, bake};
use crate::stage::{Chart, Quad, Stage, room};
use glam::Vec3;
use lightoven::baker::{Bounces, LightMap, Sampling};
use lightoven::gpu::Gpu;
use lightoven::scene::{Sidedness, Sky};
use std::f64::consts::PI;

on_both_back_ends!(
    open_to_the_sky,
    half,
    nine_tenths,
    all_but_a_hundredth,
    automatic_bounces,
    charts_that_end_within_a_texel
);

/// How the charts lie: whole texels, nothing beside them.
const WHOLE: f32 = 0.01;

/// Bakes the furnace; the light map, and the irradiance of the closed form.
fn furnace(gpu: &Gpu, albedo: f32, bounces: Bounces, inset: f32) -> (LightMap, f64) {
    let mut stage = Stage::new();
    let white = stage.material(albedo, 1.0);
    let walls = room(Vec3::ZERO, Vec3::ONE, |index| Chart::new(index).inset(inset), white);
    let (map, statistics) = bake(gpu, &stage.with(&walls), How::new(256, bounces), 0);
    println!("{} epochs, {} texels", statistics.epochs, statistics.texels);
    assert_eq!(statistics.invalid_texels, 0);
    (map, PI / (1.0 - f64::from(albedo)))
}

/// Every texel's irradiance against the closed form. All rays see the same radiance: there is no noise to allow for.
fn assert_uniform(gpu: &Gpu, what: &str, (map, expected): &(LightMap, f64), tolerance: f64) {
    let (mut count, mut lowest, mut highest) = (0, f64::INFINITY, 0.0_f64);
    for pixel in map.pixels.iter().filter(|pixel| pixel[3] == 1.0) {
        for channel in &pixel[..3] {
            let ratio = f64::from(*channel) / expected;
            (count, lowest, highest) = (count + 1, lowest.min(ratio), highest.max(ratio));
        }
    }
    println!("{what}, {}: {lowest:.7} to {highest:.7} times the closed form", gpu.backend().name());
    assert!(count >= 6 * 36 * 3, "only {count} values are baked");
    assert!(lowest >= 1.0 - tolerance && highest <= 1.0 + tolerance, "{what}: {lowest} to {highest}");
}

/// Bounces after which a millionth is missing.
fn enough(albedo: f64) -> Bounces {
    Bounces::Limit((1e-6_f64.ln() / albedo.ln()).ceil() as u32)
}

/// A box whose ceiling hangs above it, under a sky of radiance 1, with an unmapped square of radiance 1 in it; its walls
/// shine with what their albedo takes, so that all that anyone sees has radiance 1. Seven bounces are all there are: no later
/// source map mends what they leave out.
fn open_to_the_sky(gpu: &Gpu) {
    let mut stage = Stage::new();
    stage.desc.sky = Sky::Constant(Vec3::ONE);
    let (wall, lamp) = (stage.material(0.5, 0.5), stage.material(0.0, 1.0));
    stage.desc.materials.iter_mut().for_each(|material| material.sidedness = Sidedness::Double);
    let mut quads = room(Vec3::ZERO, Vec3::ONE, |index| Chart::new(index).inset(WHOLE), wall).to_vec();
    quads[1].corner += Vec3::Z * 0.5;
    quads.push(Quad { corner: Vec3::splat(0.4), u: Vec3::X * 0.2, v: Vec3::Y * 0.2, chart: None, material: lamp });
    let scene = stage.with(&quads);
    let missing = 0.5_f64.powi(8);
    for sampling in [Sampling::Cosine, Sampling::Auto] {
        let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Limit(7)).by(sampling), 0);
        assert_uniform(gpu, "furnace under a sky", &(map, PI), missing + 1e-5);
    }
}

fn half(gpu: &Gpu) {
    assert_uniform(gpu, "furnace .5", &furnace(gpu, 0.5, enough(0.5), WHOLE), 1e-4);
}

fn nine_tenths(gpu: &Gpu) {
    assert_uniform(gpu, "furnace .9", &furnace(gpu, 0.9, enough(0.9), WHOLE), 1e-4);
}

fn all_but_a_hundredth(gpu: &Gpu) {
    assert_uniform(gpu, "furnace .99", &furnace(gpu, 0.99, Bounces::Auto, WHOLE), 1e-2);
}

/// What the automatic number of bounces promises: a ten-thousandth may be missing, and what 32-bit floats round.
fn automatic_bounces(gpu: &Gpu) {
    let furnace = furnace(gpu, 0.9, Bounces::Auto, WHOLE);
    assert_uniform(gpu, "furnace .9, automatic bounces", &furnace, 1.1e-4);
}

/// Texels that a chart covers in part, just touches, or covers all but a sliver of see the same as all others.
fn charts_that_end_within_a_texel(gpu: &Gpu) {
    for inset in [-0.5, -0.02, 0.0, 0.4, 0.97] {
        let furnace = furnace(gpu, 0.875, enough(0.875), inset);
        assert_uniform(gpu, &format!("furnace .875, charts that end {inset} texels inside"), &furnace, 1e-4);
    }
}
