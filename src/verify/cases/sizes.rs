//! Extreme cases 8 and 20: light maps of any size.

use super::extremes::{FACTOR, POINT};
use super::{Case, Checks};
use crate::baker::{Bounces, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::verify::estimate::{Estimate, How, MIXTURES, bake, irradiance, mean};
use crate::verify::stage::{Chart, Facing, Stage, level_square, room};
use glam::Vec3;
use std::f64::consts::PI;

pub(super) const CASES: [Case; 3] = [
    Case::extreme(8, "one bright texel of 1024 x 1024", one_of_many),
    Case::extreme(20, "map of one texel", one_texel),
    Case::extreme(20, "maps of odd sides", odd_sides),
];

/// A point in the first texels of the map, and a shining unit square above it in the last.
fn scene(side: u32, [point, lamp]: [u32; 2]) -> Result<(Scene, Chart)> {
    let chart = |first: u32, size| Chart::at([first; 2], size).on(side).inset(0.01);
    let mut stage = Stage::new();
    let (black, shining) = (stage.material(0.0, 0.0), stage.material(0.0, 1.0));
    let receiver = chart(0, point);
    let quads = [
        level_square(POINT, 0.0, Facing::Up, receiver, black),
        level_square(1.0, 1.0, Facing::Down, chart(side - lamp, lamp), shining),
    ];
    Ok((stage.with(&quads)?, receiver))
}

fn odd_sides(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for (side, sizes, samples) in [(3, [1, 1], 8192), (5, [2, 2], 8192), (37, [6, 17], 1024), (100, [6, 37], 1024)] {
        let (scene, receiver) = scene(side, sizes)?;
        for sampling in [MIXTURES[0], Sampling::Importance] {
            let how = How::new(samples, Bounces::Auto).by(sampling).on(side);
            let estimate = Estimate::direct(gpu, &scene, how, receiver)?.times(PI.recip());
            let what = format!("square in the last {} of {side} texels a side, by {sampling}", sizes[1]);
            checks.estimate(what, estimate, FACTOR, 1e-6, 5e-3);
        }
    }
    Ok(())
}

/// All six walls of a closed room in the only texel. Rays by the cosine make it exact.
fn one_texel(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = Chart::at([0; 2], 1).on(1).inset(0.01);
    let furnace = |albedo| {
        let mut stage = Stage::new();
        let walls = stage.material(albedo, 1.0);
        stage.with(&room(Vec3::ZERO, Vec3::ONE, |_| chart, walls))
    };
    let how = How::new(64, Bounces::Auto).on(1);
    let found = mean(&bake(gpu, &furnace(0.5)?, how, 0)?.0, chart)?;
    checks.relative("furnace of albedo .5", found, PI / 0.5, 1.1e-4);
    for sampling in MIXTURES {
        let how = How::new(1 << 17, Bounces::Auto).by(sampling).on(1);
        let estimate = Estimate::direct(gpu, &furnace(0.0)?, how, chart)?;
        checks.estimate(format!("shining room by {sampling}"), estimate, PI, 1e-6, 0.05 * PI);
    }
    Ok(())
}

/// One texel shines, all others are black. A few others take rays, for which time is in short supply. The texels of the
/// point are the randomisations.
fn one_of_many(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const SIDE: u32 = 1024;
    let (scene, receiver) = scene(SIDE, [6, 1])?;
    let (map, _) = bake(gpu, &scene, How::new(256, Bounces::Auto).by(MIXTURES[0]).on(SIDE), 0)?;
    let estimate = Estimate::over(&irradiance(&map, receiver)?).times(PI.recip());
    checks.estimate("form factor", estimate, FACTOR, 1e-6, 5e-3);
    Ok(())
}
