//! Light maps of any size: NUMERICS section 9, cases 8 and 20.

use crate::device::{on, on_both_back_ends};
use crate::estimate::{Estimate, How, MIXTURES, bake, irradiance, mean};
use crate::stage::{Chart, Facing, Stage, level_square, room};
use glam::Vec3;
use lightoven::baker::{Bounces, Sampling};
use lightoven::gpu::{BackendChoice, Gpu};
use lightoven::scene::Scene;
use std::f64::consts::PI;

on_both_back_ends!(one_texel, odd_sides, large);

/// Case 6 at h = 1.
const FACTOR: f64 = 0.239_456;

/// A point in the first texels of the map, and a shining unit square above it in the last.
fn scene(side: u32, [point, lamp]: [u32; 2]) -> (Scene, Chart) {
    let chart = |first: u32, size| Chart::at([first; 2], size).on(side).inset(0.01);
    let mut stage = Stage::new();
    let (black, shining) = (stage.material(0.0, 0.0), stage.material(0.0, 1.0));
    let receiver = chart(0, point);
    let quads = [
        level_square(1e-4, 0.0, Facing::Up, receiver, black),
        level_square(1.0, 1.0, Facing::Down, chart(side - lamp, lamp), shining),
    ];
    (stage.with(&quads), receiver)
}

fn odd_sides(gpu: &Gpu) {
    for (side, sizes, samples) in [(3, [1, 1], 8192), (5, [2, 2], 8192), (37, [6, 17], 1024), (100, [6, 37], 1024)] {
        let (scene, receiver) = scene(side, sizes);
        for sampling in [MIXTURES[0], Sampling::Importance] {
            let how = How::new(samples, Bounces::Auto).by(sampling).on(side);
            let estimate = Estimate::direct(gpu, &scene, how, receiver).times(PI.recip());
            let what = format!("square in the last {} of {side} texels a side, {sampling:?}", sizes[1]);
            estimate.assert_is(&what, gpu, FACTOR, 1e-6, 5e-3);
        }
    }
}

/// All six walls of a closed room in the only texel. Rays by the cosine make it exact.
fn one_texel(gpu: &Gpu) {
    let chart = Chart::at([0; 2], 1).on(1).inset(0.01);
    let furnace = |albedo| {
        let mut stage = Stage::new();
        let walls = stage.material(albedo, 1.0);
        stage.with(&room(Vec3::ZERO, Vec3::ONE, |_| chart, walls))
    };
    let how = How::new(64, Bounces::Auto).on(1);
    let (found, expected) = (mean(&bake(gpu, &furnace(0.5), how, 0).0, chart), PI / 0.5);
    println!("furnace in one texel, {}: {found}, closed form {expected}", gpu.backend().name());
    assert!((found / expected - 1.0).abs() <= 1.1e-4);
    for sampling in MIXTURES {
        let how = How::new(1 << 17, Bounces::Auto).by(sampling).on(1);
        let what = format!("dark room in one texel, {sampling:?}");
        Estimate::direct(gpu, &furnace(0.0), how, chart).assert_is(&what, gpu, PI, 1e-6, 0.05 * PI);
    }
}

/// Case 8: one texel of `side` squared shines, all others are black. A few others take rays, for which time is in short
/// supply: the map alone takes seconds. The texels of the point are the randomisations.
fn one_of_many(gpu: &Gpu, side: u32) {
    let (scene, receiver) = scene(side, [6, 1]);
    let (map, _) = bake(gpu, &scene, How::new(256, Bounces::Auto).by(MIXTURES[0]).on(side), 0);
    let estimate = Estimate::over(&irradiance(&map, receiver)).times(PI.recip());
    let what = format!("one bright texel of {side} x {side}");
    estimate.assert_is(&what, gpu, FACTOR, 1e-6, 5e-3);
}

fn large(gpu: &Gpu) {
    one_of_many(gpu, 1024);
}

#[test]
#[ignore = "half a minute and 4 GB"]
fn very_large() {
    on(BackendChoice::Software, |gpu| one_of_many(gpu, 4096));
}

#[test]
#[ignore = "two minutes and 12 GB"]
fn huge() {
    on(BackendChoice::Software, |gpu| one_of_many(gpu, 8192));
}
