//! Texels that stop when they have converged: the light stays the same, and the rays are fewer.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Bounces, ErrorEstimate, LightMap, Sampling, Slice, Statistics, Stop};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Resolution, Scene};
use crate::verify::estimate::{self, Estimate, How, broken, irradiance, mean, mean_of};
use crate::verify::stage::{Chart, Facing, Quad, SIDE, Stage, level_square};
use glam::Vec3;
use std::ops::ControlFlow;

pub(super) const CASES: [Case; 3] = [
    Case::conduct("adaptive, the same light with fewer rays", the_same_light_with_fewer_rays),
    Case::conduct("adaptive, however the work is cut", however_the_work_is_cut),
    Case::conduct("adaptive, another target", another_target),
];

/// A floor under an even ceiling, and one under a small lamp in a corner, which rays by the cosine find seldom: its texels
/// are those that need rays.
fn scene() -> Result<Scene> {
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

type Baked = (LightMap, Statistics);

fn bake(gpu: &Gpu, error: ErrorEstimate, slice: Slice, errors: &[f32], seed: u64) -> Result<Baked> {
    let settings = BakeSettings {
        resolution: Resolution::Texels(SIDE),
        bounces: Bounces::Limit(0),
        sampling: Sampling::Cosine,
        error,
        slice,
        seed,
        ..BakeSettings::default()
    };
    let mut baker = Baker::new(gpu, &scene()?, &settings)?;
    for target in errors {
        let stop = Stop { error: Some(*target), ..Stop::default() };
        baker.bake(&stop, &mut |_| ControlFlow::Continue(()))?;
        match baker.statistics().estimated_error {
            Some(reached) if reached <= *target => {}
            reached => return Err(broken(format!("an error of {target} was asked for, and {reached:?} is reached"))),
        }
    }
    Ok((baker.read_back()?, baker.statistics().clone()))
}

fn the_same_light_with_fewer_rays(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let how = How::new(1 << 12, Bounces::Limit(0)).by(Sampling::Mixture { cosine: 0.5 });
    let wanted = Estimate::each_direct(gpu, &scene()?, how, &FLOORS.map(Chart::new))?;
    let bakes = |error: ErrorEstimate, seeds| -> Result<Vec<Baked>> {
        (0..seeds).map(|seed| bake(gpu, error, Slice::default(), &[0.1], seed)).collect()
    };
    let (adaptive, even) = (bakes(ErrorEstimate::Adaptive, 16)?, bakes(ErrorEstimate::Told, 8)?);
    let rays =
        |bakes: &[Baked]| bakes.iter().map(|(_, statistics)| statistics.rays).sum::<u64>() as f64 / bakes.len() as f64;
    checks.at_most("share of the rays", rays(&adaptive) / rays(&even), 0.8);
    let stops = adaptive.iter().filter(|(_, told)| told.samples_per_texel < told.most_samples).count();
    let all = even.iter().filter(|(_, all)| all.samples_per_texel == all.most_samples).count();
    checks.count("bakes in which texels stop", stops as u64, 16);
    checks.count("others in which none does", all as u64, 8);
    let how = How::new(1 << 12, Bounces::Limit(0)).by(Sampling::Mixture { cosine: 0.5 });
    let (reference, _) = estimate::bake(gpu, &scene()?, how, 99)?;
    let [told, all] = [true_error(&reference, &adaptive)?, true_error(&reference, &even)?];
    checks.at_most("true error", told, 0.1);
    checks.at_most("true error, against that of the same rays for all", told, 1.1 * all);
    // Texels that stop because they were lucky would be too dark.
    for (floor, wanted) in FLOORS.into_iter().zip(wanted) {
        let means: Result<Vec<f64>> = adaptive.iter().map(|(map, _)| mean(map, Chart::new(floor))).collect();
        let found = Estimate::over(&means?);
        let both = Estimate { standard_error: found.standard_error.hypot(wanted.standard_error), ..found };
        checks.estimate(format!("irradiance of floor {floor}"), both, wanted.mean, 0.0, 0.03 * wanted.mean);
    }
    Ok(())
}

/// Root of relMSE over all texels, as `--error` has it, mean over bakes.
fn true_error(reference: &LightMap, bakes: &[Baked]) -> Result<f64> {
    let texels = |map: &LightMap| -> Result<Vec<f64>> {
        let charts: Result<Vec<Vec<f64>>> = (0..4).map(|chart| irradiance(map, Chart::new(chart))).collect();
        Ok(charts?.concat())
    };
    let wanted = texels(reference)?;
    let least = 0.01 * mean_of(&wanted).powi(2);
    let of_bake = |(map, _): &Baked| {
        let squares = texels(map)?
            .into_iter()
            .zip(&wanted)
            .map(|(found, wanted)| (found - wanted).powi(2) / (wanted * wanted + least));
        Ok(mean_of(&squares.collect::<Vec<_>>()))
    };
    let errors: Result<Vec<f64>> = bakes.iter().map(of_bake).collect();
    Ok(mean_of(&errors?).sqrt())
}

fn however_the_work_is_cut(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let bits = |slice| -> Result<_> {
        let (map, statistics) = bake(gpu, ErrorEstimate::Adaptive, slice, &[0.2], 5)?;
        Ok((map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>(), statistics.rays))
    };
    let whole = bits(Slice::Texels(u32::MAX))?;
    checks.holds("slices by time give the same bits", bits(Slice::default())? == whole);
    checks.holds("slices of 64 texels give the same bits", bits(Slice::Texels(64))? == whole);
    Ok(())
}

/// Those that had stopped go on for a smaller error.
fn another_target(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (_, first) = bake(gpu, ErrorEstimate::Adaptive, Slice::default(), &[0.2], 1)?;
    let (_, both) = bake(gpu, ErrorEstimate::Adaptive, Slice::default(), &[0.2, 0.1], 1)?;
    checks.at_least("rays", both.rays as f64, 2.0 * first.rays as f64 + 1.0);
    checks.holds("texels have more samples", both.samples_per_texel > first.samples_per_texel);
    Ok(())
}
