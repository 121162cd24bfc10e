//! Texels that stop when they have converged: the light stays the same, and the rays are fewer.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, How, irradiance, mean, mean_of};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::Vec3;
use lightoven::baker::{BakeSettings, Baker, Bounces, LightMap, Sampling, Slice, Statistics, Stop};
use lightoven::gpu::Gpu;
use lightoven::scene::{Resolution, Scene};
use std::ops::ControlFlow;

on_both_back_ends!(the_same_light_with_fewer_rays, however_the_work_is_cut, another_target);

/// A floor under an even ceiling, and one under a small lamp in a corner, which rays by the cosine find seldom: its texels
/// are those that need rays.
fn scene() -> Scene {
    let mut stage = Stage::new();
    let [black, even, bright] = [0.0, 1.0, 400.0].map(|emission| stage.material(0.0, emission));
    let away = |quad: Quad| Quad { corner: quad.corner + Vec3::X * 50.0, ..quad };
    let lamp = level_square(0.1, 0.5, Facing::Down, Chart::new(3), bright);
    stage.with(&[
        level_square(1.0, 0.0, Facing::Up, Chart::new(0), black),
        level_square(8.0, 0.5, Facing::Down, Chart::new(1), even),
        away(level_square(1.0, 0.0, Facing::Up, Chart::new(2), black)),
        away(Quad { corner: lamp.corner + Vec3::new(0.3, 0.3, 0.0), ..lamp }),
    ])
}

const FLOORS: [u32; 2] = [0, 2];

fn bake(gpu: &Gpu, adaptive: bool, slice: Slice, errors: &[f32], seed: u64) -> (LightMap, Statistics) {
    let settings = BakeSettings {
        resolution: Resolution::Texels(crate::stage::SIDE),
        bounces: Bounces::Limit(0),
        sampling: Sampling::Cosine,
        adaptive,
        slice,
        seed,
        ..BakeSettings::default()
    };
    let mut baker = Baker::new(gpu, &scene(), &settings).unwrap();
    for error in errors {
        let stop = Stop { error: Some(*error), ..Stop::default() };
        baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
        assert!(baker.statistics().estimated_error.unwrap() <= *error);
    }
    (baker.read_back().unwrap(), baker.statistics().clone())
}

fn the_same_light_with_fewer_rays(gpu: &Gpu) {
    let wanted = Estimate::each_direct(
        gpu,
        &scene(),
        How::new(1 << 12, Bounces::Limit(0)).by(Sampling::Mixture { cosine: 0.5 }),
        &FLOORS.map(Chart::new),
    );
    let bakes = |adaptive: bool| -> Vec<_> {
        (0..16).map(|seed| bake(gpu, adaptive, Slice::default(), &[0.1], seed)).collect()
    };
    let (adaptive, even) = (bakes(true), bakes(false));
    let rays =
        |bakes: &[(LightMap, Statistics)]| bakes.iter().map(|(_, statistics)| statistics.rays).sum::<u64>() as f64;
    let share = rays(&adaptive) / rays(&even);
    println!("{}: {share:.3} of the rays", gpu.backend().name());
    assert!(share < 0.8);
    for ((_, told), (_, all)) in adaptive.iter().zip(&even) {
        assert!(told.samples_per_texel < told.most_samples && all.samples_per_texel == all.most_samples);
    }
    let [told, all] = [&adaptive, &even].map(|bakes| true_error(gpu, bakes));
    println!("{}: error {told:.4}, of the same rays for all {all:.4}; .1 was asked for", gpu.backend().name());
    assert!(told <= 0.1 && told <= 1.1 * all);
    // Texels that stop because they were lucky would be too dark.
    for (chart, wanted) in FLOORS.map(Chart::new).into_iter().zip(wanted) {
        let found = Estimate::over(&adaptive.iter().map(|(map, _)| mean(map, chart)).collect::<Vec<_>>());
        let error = found.standard_error.hypot(wanted.standard_error);
        let sigma = (found.mean - wanted.mean) / error;
        println!("{}: {found:?}, {wanted:?} wanted, {sigma:.2} sigma", gpu.backend().name());
        assert!(sigma.abs() <= 4.0 && 4.0 * error <= 0.03 * wanted.mean);
    }
}

/// Root of relMSE over all texels, as `--error` has it, mean over bakes.
fn true_error(gpu: &Gpu, bakes: &[(LightMap, Statistics)]) -> f64 {
    let how = How::new(1 << 12, Bounces::Limit(0)).by(Sampling::Mixture { cosine: 0.5 });
    let (reference, _) = crate::estimate::bake(gpu, &scene(), how, 99);
    let texels = |map: &LightMap| (0..4).map(Chart::new).flat_map(|chart| irradiance(map, chart)).collect::<Vec<_>>();
    let wanted = texels(&reference);
    let least = 0.01 * mean_of(&wanted).powi(2);
    let of_bake = |(map, _): &(LightMap, Statistics)| {
        let squares = texels(map)
            .into_iter()
            .zip(&wanted)
            .map(|(found, wanted)| (found - wanted).powi(2) / (wanted * wanted + least));
        mean_of(&squares.collect::<Vec<_>>())
    };
    mean_of(&bakes.iter().map(of_bake).collect::<Vec<_>>()).sqrt()
}

fn however_the_work_is_cut(gpu: &Gpu) {
    let bits = |slice| {
        let (map, statistics) = bake(gpu, true, slice, &[0.2], 5);
        (map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>(), statistics.rays)
    };
    let whole = bits(Slice::Texels(u32::MAX));
    assert!(bits(Slice::default()) == whole && bits(Slice::Texels(64)) == whole);
}

/// Those that had stopped go on for a smaller error.
fn another_target(gpu: &Gpu) {
    let (_, first) = bake(gpu, true, Slice::default(), &[0.2], 1);
    let (_, both) = bake(gpu, true, Slice::default(), &[0.2, 0.1], 1);
    println!("{}: {} and {} rays", gpu.backend().name(), first.rays, both.rays);
    assert!(both.rays > 2 * first.rays && both.samples_per_texel > first.samples_per_texel);
}
