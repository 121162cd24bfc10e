//! How the noise of an engine's frames falls, and where it stays. Closed form 18.

use super::{Case, Checks};
use crate::baker::FrameSettings;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::verify::estimate::{Estimate, mean_of};
use crate::verify::live::{AMPLE, Live, SIDE};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::Vec3;
use std::time::Duration;

pub(super) const CASES: [Case; 2] = [
    Case::closed_form(18, "noise of frames in which nothing changes", still),
    Case::closed_form(18, "steady noise of frames that change", changing),
];

const THRESHOLD: f64 = 0.1;
const RATE: f64 = 30.0;

/// Texels that all lie in one place: they differ by their noise alone.
fn chart() -> Chart {
    Chart::at([2, 2], 28).on(SIDE)
}

/// A black point under a lamp, and far below both what may change unseen: material 2.
fn live(gpu: &Gpu, latency_s: f64) -> Result<Live> {
    let mut stage = Stage::new();
    let (black, lamp, other) = (stage.material(0.0, 0.0), stage.material(0.0, 2.0), stage.material(0.0, 1.0));
    let unmapped = |quad: Quad| Quad { chart: None, ..quad };
    let scene = stage.with(&[
        level_square(1e-4, 0.0, Facing::Up, chart(), black),
        unmapped(level_square(1.0, 1.0, Facing::Down, chart(), lamp)),
        unmapped(level_square(1.0, -9.0, Facing::Down, chart(), other)),
    ])?;
    let tolerable_latency = Duration::from_secs_f64(latency_s);
    let frames =
        FrameSettings { quanta: Some(1), tolerable_latency, decay_threshold: THRESHOLD, ..FrameSettings::default() };
    let mut live = Live::new(gpu, &scene, frames)?;
    live.warm_up()?;
    Ok(live)
}

/// Over the texels.
fn variance(live: &mut Live) -> Result<f64> {
    let texels: Vec<usize> = chart().texels().map(|(texel, _)| texel).collect();
    let values = live.irradiance(&texels)?;
    let mean = mean_of(&values);
    Ok(values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64)
}

/// A sweep, in a world that is another each time.
fn changed_frame(live: &mut Live, index: u32) -> Result<()> {
    live.baker.set_emission(2, Vec3::splat(1.0 + (index % 2) as f32))?;
    live.frame(RATE.recip(), AMPLE).map(|_| ())
}

/// Estimates of the variance over texels, as many frames apart as make them independent.
fn variances(live: &mut Live, apart: u32, each: &mut dyn FnMut(&mut Live, u32) -> Result<()>) -> Result<Vec<f64>> {
    (0..16)
        .map(|_| {
            (0..apart).try_for_each(|index| each(live, index))?;
            variance(live)
        })
        .collect()
}

/// As one over the samples: time stands still, and nothing is forgotten.
fn still(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut live = live(gpu, 0.5)?;
    let at = |live: &mut Live, sweeps: u64| {
        for _ in 0..10_000 {
            if live.baker.light_map().sweeps >= sweeps {
                break;
            }
            live.frame(0.0, AMPLE)?;
        }
        variance(live)
    };
    let first = live.baker.light_map().sweeps;
    let few = at(&mut live, first + 8)?;
    let sweeps = live.baker.light_map().sweeps as f64;
    let many = at(&mut live, 16 * sweeps as u64)?;
    let grown = live.baker.light_map().sweeps as f64 / sweeps;
    // 784 texels tell a variance to 5 %; four standard errors of a ratio of two are 29 %.
    checks.relative("variance of few frames over that of many", few / many, grown, 0.3);
    Ok(())
}

/// The variance of a single sweep times w / (2 - w).
fn changing(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (latency_s, mut single) = (0.1, live(gpu, 0.0)?);
    let one = Estimate::over(&variances(&mut single, 2, &mut changed_frame)?);
    let mut averaged = live(gpu, latency_s)?;
    let steady = Estimate::over(&variances(&mut averaged, 12, &mut changed_frame)?);
    let weight = 1.0 - THRESHOLD.powf(1.0 / (RATE * latency_s));
    let factor = weight / (2.0 - weight);
    let noise = (steady.standard_error / steady.mean).hypot(one.standard_error / one.mean);
    let ratio = steady.mean / one.mean;
    let estimate = Estimate { mean: ratio, standard_error: ratio * noise };
    checks.at_least("variance of a single sweep", one.mean, 1e-4);
    checks.estimate("variance over a single sweep's", estimate, factor, 0.0, 0.2 * factor);
    Ok(())
}
