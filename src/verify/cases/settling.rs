//! How old light leaves the light map of an engine's frames. Closed forms 17 and 19, extremes 3 and 4.

use super::{Case, Checks};
use crate::baker::FrameSettings;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Scene, Sky};
use crate::verify::live::{AMPLE, Live, SIDE};
use crate::verify::random::Random;
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square, room};
use glam::Vec3;
use std::f64::consts::PI;
use std::time::Duration;

pub(super) const CASES: [Case; 4] = [
    Case::closed_form(17, "step response within frames", step_response),
    Case::closed_form(19, "frames to settle in a furnace", frames_to_settle),
    Case::extreme(3, "frames at any rate and latency", any_rate_and_latency),
    Case::extreme(4, "a million still samples, then a change", long_still_history),
];

const LATENCY_S: f64 = 0.5;
const THRESHOLD: f64 = 0.1;
/// What a floor of half its height's side has from the lamp over it, roughly.
const UNDER_THE_LAMP: f64 = 3.25;

/// A black floor of one chart under a lamp that receives nothing; material 1 is the lamp's.
pub(super) fn lamp_over(chart: Chart) -> Result<Scene> {
    let mut stage = Stage::new();
    let (black, lamp) = (stage.material(0.0, 0.0), stage.material(0.0, 2.0));
    let light = Quad { chart: None, ..level_square(2.0, 1.0, Facing::Down, chart, lamp) };
    stage.with(&[level_square(1.0, 0.0, Facing::Up, chart, black), light])
}

/// Noise is no matter here.
fn one_quantum() -> FrameSettings {
    FrameSettings { quanta: Some(1), ..FrameSettings::default() }
}

fn texels(chart: Chart) -> Vec<usize> {
    chart.texels().map(|(texel, _)| texel).collect()
}

/// Times of frames that add up to the latency.
fn uneven(seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    let times: Vec<f64> = (0..40).map(|_| f64::from(random.unit()).powi(4) + 1e-3).collect();
    let sum: f64 = times.iter().sum();
    times.iter().map(|time| time * LATENCY_S / sum).collect()
}

/// Once the average is full, for four latencies frames of these times, and then the lamp goes out for one. Each texel's
/// share of the old light that is left: all new light is exactly 0, so that the noise of the old is no matter.
fn step_response(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = Chart::new(0).on(SIDE);
    let mut live = Live::new(gpu, &lamp_over(chart)?, one_quantum())?;
    live.warm_up()?;
    live.frames(40, 0.1)?;
    let alike = |rate: f64| vec![rate.recip(); (LATENCY_S * rate).round() as usize];
    let patterns =
        [("30 frames a second", alike(30.0)), ("144 frames a second", alike(144.0)), ("one frame", alike(2.0))];
    for (name, times) in patterns.into_iter().chain([("uneven frames", uneven(1)), ("other uneven frames", uneven(2))])
    {
        live.baker.set_emission(1, Vec3::ONE)?;
        for elapsed_s in times.iter().cycle().take(4 * times.len()) {
            live.frame(*elapsed_s, AMPLE)?;
        }
        let old = live.irradiance(&texels(chart))?;
        live.baker.set_emission(1, Vec3::ZERO)?;
        for elapsed_s in &times {
            live.frame(*elapsed_s, AMPLE)?;
        }
        let left = live.irradiance(&texels(chart))?;
        let shares = || left.iter().zip(&old).map(|(left, old)| left / old);
        checks.relative(format!("least left after {name}"), shares().fold(f64::INFINITY, f64::min), THRESHOLD, 1e-5);
        checks.relative(format!("most left after {name}"), shares().fold(0.0, f64::max), THRESHOLD, 1e-5);
    }
    Ok(())
}

/// Light that is reflected again and again leaves with the latency of one average and not of one a bounce.
fn frames_to_settle(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = |index| Chart::new(index).on(SIDE);
    for (albedo, expected) in [(0.8_f32, 35.0), (0.9, 44.0)] {
        let mut stage = Stage::new();
        let wall = stage.material(albedo, 1.0);
        let scene = stage.with(&room(Vec3::splat(-1.0), Vec3::ONE, chart, wall))?;
        let texels: Vec<usize> = (0..6).flat_map(|index| texels(chart(index))).collect();
        let mut live = Live::new(gpu, &scene, one_quantum())?;
        live.warm_up()?;
        live.frames(130, 0.1)?;
        let steady = live.mean(&texels)?;
        checks.relative(format!("furnace of albedo {albedo}"), steady, PI / (1.0 - f64::from(albedo)), 1e-3);
        live.baker.set_emission(0, Vec3::ZERO)?;
        let mut frames = 0;
        while frames < 400 && live.mean(&texels)? > THRESHOLD * steady {
            live.frame(1.0 / 60.0, AMPLE)?;
            frames += 1;
        }
        checks.within(format!("frames at albedo {albedo}"), f64::from(frames), expected, 1.0);
    }
    Ok(())
}

/// The average stays a number, and that of the light.
fn any_rate_and_latency(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = Chart::new(0).on(SIDE);
    for latency in [Duration::ZERO, Duration::from_millis(1), Duration::from_secs(60), Duration::MAX] {
        let frames = FrameSettings { tolerable_latency: latency, ..FrameSettings::default() };
        let mut live = Live::new(gpu, &lamp_over(chart)?, frames)?;
        live.warm_up()?;
        for elapsed_s in [0.0, 1e-4, 1.0, 1e6, 0.0] {
            live.frames(4, elapsed_s)?;
            let what = format!("light with a latency of {latency:?}, {elapsed_s} s a frame");
            checks.relative(what, live.mean(&texels(chart))?, UNDER_THE_LAMP, 0.2);
        }
        let old = live.mean(&texels(chart))?;
        live.baker.set_emission(1, Vec3::ZERO)?;
        live.frames(2, 1.0)?;
        let left = live.mean(&texels(chart))? / old;
        let what = format!("left with a latency of {latency:?} after two seconds");
        match latency {
            Duration::MAX => checks.at_least(what, left, 0.5),
            latency if latency < Duration::from_secs(1) => checks.at_most(what, left, 1e-6),
            latency => checks.relative(what, left, THRESHOLD.powf(2.0 / latency.as_secs_f64()), 0.01),
        }
    }
    Ok(())
}

/// A million rays of each of four texels, under a sky that goes out; without the cut of the history 99.6 % of its light would
/// be left.
fn long_still_history(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = Chart::at([1, 1], 2).on(SIDE);
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    stage.sky(1.0);
    let scene = stage.with(&[level_square(1.0, 0.0, Facing::Up, chart, black)])?;
    let frames = FrameSettings { quanta: Some(64), ..FrameSettings::default() };
    let mut live = Live::new(gpu, &scene, frames)?;
    live.warm_up()?;
    live.frames(1000, 0.1)?;
    checks.at_least("samples of a texel", live.baker.statistics().samples_per_texel, 1e6);
    checks.holds("the scene counts as still", !live.frame(0.1, AMPLE)?.decaying);
    let old = live.mean(&texels(chart))?;
    checks.relative("light", old, PI, 1e-4);
    live.baker.set_sky(Sky::Black)?;
    live.frames(15, LATENCY_S / 15.0)?;
    let left = live.mean(&texels(chart))? / old;
    checks.relative("left at the latency", left, THRESHOLD, 1e-5);
    Ok(())
}
