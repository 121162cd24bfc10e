//! An object that moves in every frame, and a device that is lost. Extremes 21 and 22.

use super::slices::{baker, baker_of, differing, lit_room, to_samples};
use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, FrameSettings, Outcome, Ran, Slice};
use crate::error::{ErrorKind, Result};
use crate::gpu::Gpu;
use crate::scene::{Mobility, Resolution, Scene};
use crate::verify::estimate::broken;
use crate::verify::live::{AMPLE, Live, SIDE};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DVec3, Vec3};
use std::ops::ControlFlow;
use std::time::Duration;

pub(super) const CASES: [Case; 6] = [
    Case::extreme(21, "an object that moves in every frame", moves_in_every_frame),
    Case::extreme(21, "a shadow that moves on", shadow_moves_on),
    Case::extreme(22, "a device that is lost in a bake", lost_in_a_bake),
    Case::extreme(22, "what is kept from a device that is lost", kept_from_a_lost_device),
    Case::extreme(22, "a device that is lost while preparing", lost_while_preparing),
    Case::extreme(22, "a device that is lost within frames", lost_within_frames),
];

const THRESHOLD: f64 = 0.1;
/// Of a sixtieth of a second each: the latency.
const LATENCY_FRAMES: usize = 30;

/// Where the square shades nothing.
const ASIDE: f64 = 12.0;

fn chart() -> Chart {
    Chart::new(0).on(SIDE)
}

/// A black floor under a lamp, material 1, and a movable square between them. Neither of the two has a place in the light
/// map, which is as the floor has it.
fn floor(square: f32, x: f64) -> Result<Scene> {
    let mut stage = Stage::new();
    let (black, lamp) = (stage.material(0.0, 0.0), stage.material(0.0, 2.0));
    let light = Quad { chart: None, ..level_square(2.0, 2.0, Facing::Down, chart(), lamp) };
    stage.place(&[level_square(1.0, 0.0, Facing::Up, chart(), black), light], DAffine3::IDENTITY);
    let sides = [Facing::Up, Facing::Down];
    let sides = sides.map(|facing| Quad { chart: None, ..level_square(square, 0.0, facing, chart(), black) });
    stage.place(&sides, at(x));
    stage.desc.instances[1].mobility = Mobility::Movable;
    stage.build()
}

fn at(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 0.25))
}

/// Only the top level is built anew, what is direct light is not drawn again, and the lamp's light leaves with the latency.
fn moves_in_every_frame(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let mut live = Live::new(gpu, &floor(0.2, 0.0)?, frames)?;
    live.warm_up()?;
    let texels: Vec<usize> = chart().texels().map(|(texel, _)| texel).collect();
    let (bytes, mut old, mut rebuilt) = (live.gpu().allocated_bytes(), 0.0, 0);
    const FRAMES: usize = 200;
    for frame in 0..FRAMES + LATENCY_FRAMES {
        if frame == FRAMES {
            old = live.mean(&texels)?;
            live.baker.set_emission(1, Vec3::ZERO)?;
        }
        live.baker.set_transform(1, at((frame % 20 + 1) as f64 * 0.01))?;
        let report = live.frame(1.0 / 60.0, AMPLE)?;
        rebuilt += u64::from(report.ran.contains(Ran::UPDATE | Ran::TOP_LEVEL) && report.decaying);
    }
    checks.count("frames with a new top level", rebuilt, (FRAMES + LATENCY_FRAMES) as u64);
    checks.count("bytes that it takes of the device", live.gpu().allocated_bytes(), bytes);
    checks.at_least("light before", old, 0.5);
    checks.relative("light left at the latency", live.mean(&texels)? / old, THRESHOLD, 1e-5);
    Ok(())
}

/// The square comes from aside and shades the floor whole, and goes again: at the latency a tenth is left of the light, and
/// later of the shade.
fn shadow_moves_on(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let frames = FrameSettings { quanta: Some(4), ..FrameSettings::default() };
    let mut live = Live::new(gpu, &floor(8.0, ASIDE)?, frames)?;
    let texels: Vec<usize> = chart().texels().map(|(texel, _)| texel).collect();
    live.warm_up()?;
    live.frames(200, 0.1)?;
    let open = live.mean(&texels)?;
    checks.at_least("light in the open", open, 0.5);
    live.baker.set_transform(1, at(0.0))?;
    live.frames(LATENCY_FRAMES, 1.0 / 60.0)?;
    // All new light is exactly 0.
    checks.relative("light left at the latency", live.mean(&texels)? / open, THRESHOLD, 1e-5);
    live.frames(4 * LATENCY_FRAMES, 1.0 / 60.0)?;
    live.baker.set_transform(1, at(ASIDE))?;
    live.frames(LATENCY_FRAMES, 1.0 / 60.0)?;
    // 36 texels of 1,900 rays each, a quarter of which find the lamp: 4 standard errors are 3 %.
    let back = live.mean(&texels)? / open;
    checks.relative("light that is back at the latency", back, 1.0 - THRESHOLD, 0.03);
    Ok(())
}

/// At several places in a bake: the error says what has happened, nothing hangs, what was read back before stays, and the
/// same baker goes on failing by name. On a device that works a new one bakes as if nothing had been.
fn lost_in_a_bake(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let mut whole = baker(gpu, &scene)?;
    whole.bake(&to_samples(128), &mut |_| ControlFlow::Continue(()))?;
    let expected = whole.read_back()?;
    for more in [0, 7] {
        let lost = gpu.as_lost_after(u32::MAX)?;
        let mut baker = baker(&lost, &scene)?;
        baker.bake(&to_samples(128), &mut |_| ControlFlow::Continue(()))?;
        let kept = baker.read_back()?;
        let samples = baker.statistics().samples_per_texel;
        lost.lose_after(more);
        let outcome = baker.bake(&to_samples(1 << 20), &mut |_| ControlFlow::Continue(()));
        let by_name = |kind: Option<ErrorKind>| kind == Some(ErrorKind::DeviceLost);
        checks.holds(format!("the bake ends with DeviceLost, {more} submissions later"), by_name(kind(outcome)));
        checks.holds("so does a look at the light map", by_name(kind(baker.read_back())));
        let again = baker.bake(&to_samples(1 << 20), &mut |_| ControlFlow::Continue(()));
        checks.holds("and the next call", by_name(kind(again)));
        checks.count("texels that differ in what was read before", differing(&kept, &expected), 0);
        checks.at_least("samples in it", samples, 128.0);
    }
    let mut anew = baker(gpu, &scene)?;
    let outcome = anew.bake(&to_samples(128), &mut |_| ControlFlow::Continue(()))?;
    checks.holds("a new bake finishes", outcome == Outcome::Finished);
    checks.count("texels that differ in a new bake", differing(&anew.read_back()?, &expected), 0);
    Ok(())
}

/// A bake that hands out its light map on the way, on a device that is lost: what it handed out is a bake of fewer samples.
fn kept_from_a_lost_device(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let lost = gpu.as_lost_after(u32::MAX)?;
    // At the end of each slice then all texels have as many samples.
    let whole = Slice::Texels(u32::MAX);
    let mut baker = baker_of(&lost, &scene, whole)?;
    let (mut kept, mut is_told) = (Vec::new(), false);
    let outcome = baker.bake_keeping(
        &to_samples(1 << 20),
        Duration::ZERO,
        &mut |_| ControlFlow::Continue(()),
        &mut |map, statistics| {
            kept.push((map, statistics.samples_per_texel));
            // Past the bounces.
            if statistics.samples_per_texel >= 128.0 && !is_told {
                is_told = true;
                lost.lose_after(10);
            }
        },
    );
    checks.holds("the bake ends with DeviceLost", kind(outcome) == Some(ErrorKind::DeviceLost));
    checks.at_least("light maps that were handed out", kept.len() as f64, 1.0);
    let (map, samples) = kept.pop().ok_or_else(|| broken("no light map was handed out".into()))?;
    checks.at_least("samples of the last one", samples, 128.0);
    let mut shorter = baker_of(gpu, &scene, whole)?;
    shorter.bake(&to_samples(samples as u32), &mut |_| ControlFlow::Continue(()))?;
    checks.count("texels that differ from a bake of as many samples", differing(&map, &shorter.read_back()?), 0);
    Ok(())
}

fn kind<T>(result: Result<T>) -> Option<ErrorKind> {
    result.err().map(|error| error.kind())
}

/// After so many of the submissions that a baker takes to be made: an error, and nothing of the device's memory stays.
fn lost_while_preparing(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let (mut submissions, mut tried, mut other_errors, mut bytes_left) = (0, 0, 0, 0);
    while submissions < 200 {
        let lost = gpu.as_lost_after(submissions)?;
        let made = Baker::new(&lost, &scene, &settings).map(drop);
        bytes_left += lost.allocated_bytes();
        match kind(made) {
            None => break,
            Some(kind) => other_errors += u64::from(kind != ErrorKind::DeviceLost),
        }
        submissions += 3;
        tried += 1;
    }
    checks.at_least("times that the device was lost", f64::from(tried), 5.0);
    checks.at_most("submissions to make a baker", f64::from(submissions), 199.0);
    checks.count("errors of another name", other_errors, 0);
    checks.count("bytes left on the device", bytes_left, 0);
    Ok(())
}

/// Frames that the baker submits itself.
fn lost_within_frames(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let lost = gpu.as_lost_after(u32::MAX)?;
    let mut live = Live::new(&lost, &floor(0.2, 0.0)?, FrameSettings::default())?;
    let mut rays = 0;
    for _ in 0..10 {
        rays += live.submitted_frame(AMPLE)?.rays;
    }
    checks.at_least("rays before", rays as f64, 1000.0);
    checks.at_least("light maps before", live.baker.light_map().generation as f64, 1.0);
    lost.lose_after(0);
    let by_name = |kind: Option<ErrorKind>| kind == Some(ErrorKind::DeviceLost);
    checks.holds("the frame ends with DeviceLost", by_name(kind(live.submitted_frame(AMPLE))));
    checks.holds("so does a look at the light map", by_name(kind(live.baker.read_back())));
    Ok(())
}
