//! The same bits however the work is cut, paused or gone on with. Closed form 22, extreme 22.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, FrameSettings, LightMap, Outcome, Sampling, Slice, Stop};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{LightKind, Resolution, Scene, Sky, SkyMap};
use crate::verify::live::{AMPLE, Live, SIDE};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square, room};
use glam::{DVec3, Vec3};
use std::ops::ControlFlow;
use std::time::Duration;

pub(super) const CASES: [Case; 4] = [
    Case::closed_form(22, "one slice against many", slices),
    Case::closed_form(22, "one frame a sweep against many", frames),
    Case::extreme(22, "a bake that pauses", pauses),
    Case::extreme(22, "frames that pause", paused_frames),
];

/// Texels of the room's charts, most of which have light.
const LIT: f64 = 250.0;

/// A grey room with a lamp that shines, a square that shades, a point light, and a window to a sky map.
pub(super) fn lit_room() -> Result<Scene> {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.6, 0.0), stage.material(0.2, 4.0));
    let chart = |index| Chart::new(index).on(SIDE);
    let mut quads = room(Vec3::splat(-1.0), Vec3::ONE, chart, grey).to_vec();
    quads[2].corner += Vec3::Z;
    quads.push(level_square(0.8, 0.9, Facing::Down, chart(6), lamp));
    quads.push(Quad { chart: Some(chart(7)), ..level_square(0.8, 0.92, Facing::Up, chart(7), grey) });
    stage.light(LightKind::Point { position: DVec3::new(0.4, 0.3, -0.2), range: None });
    let pixel = |index: u32| Vec3::splat(if index == 11 { 50.0 } else { 0.1 });
    stage.desc.sky = Sky::Map(SkyMap { width: 7, height: 5, pixels: (0..35).map(pixel).collect() });
    stage.with(&quads)
}

fn settings(sampling: Sampling, slice: Slice) -> BakeSettings {
    BakeSettings { resolution: Resolution::Texels(SIDE), sampling, slice, seed: 7, ..BakeSettings::default() }
}

pub(super) fn baker(gpu: &Gpu, scene: &Scene) -> Result<Baker> {
    baker_of(gpu, scene, Slice::default())
}

pub(super) fn baker_of(gpu: &Gpu, scene: &Scene, slice: Slice) -> Result<Baker> {
    Baker::new(gpu, scene, &settings(Sampling::Auto, slice))
}

pub(super) fn to_samples(samples: u32) -> Stop {
    Stop { samples: Some(samples), ..Stop::default() }
}

/// Texels of which a bit differs.
pub(super) fn differing(one: &LightMap, other: &LightMap) -> u64 {
    let bits = |pixel: &[f32; 4]| pixel.map(f32::to_bits);
    let pairs = one.pixels.iter().zip(&other.pixels);
    pairs.filter(|(one, other)| bits(one) != bits(other)).count() as u64
        + one.pixels.len().abs_diff(other.pixels.len()) as u64
}

fn lit(map: &LightMap) -> f64 {
    map.pixels.iter().filter(|pixel| pixel[3] == 1.0 && pixel[0] > 0.0).count() as f64
}

/// All texels at once against a work group at a time.
fn slices(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let bake = |slice| {
        let mut baker = Baker::new(gpu, &scene, &settings(Sampling::Auto, slice))?;
        let mut slices = 0_u32;
        baker.bake(&to_samples(1024), &mut |_| {
            slices += 1;
            ControlFlow::Continue(())
        })?;
        Ok((baker.read_back()?, slices, baker.statistics().sampling.source_rays))
    };
    let ((whole, few, aimed), (cut, many, _)) = (bake(Slice::Texels(u32::MAX))?, bake(Slice::Texels(1))?);
    checks.at_least("lit texels", lit(&whole), LIT);
    checks.at_least("aimed rays", aimed as f64, 1.0);
    checks.at_least("slices", f64::from(many), 100.0);
    checks.at_least("slices for one", f64::from(many) / f64::from(few), 3.0);
    checks.count("texels that differ", differing(&cut, &whole), 0);
    Ok(())
}

/// Twelve sweeps of a scene in which time stands still: their plain mean. Of many frames each has time for about an item.
fn frames(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let bake = |budget| {
        let (mut live, mut count, mut one_unit) = (Live::new(gpu, &scene, frames)?, 0_u32, Duration::ZERO);
        while live.baker.light_map().sweeps < 12 && count < 10_000 {
            one_unit = live.frame(0.0, budget)?.one_unit;
            count += 1;
        }
        Ok((live.baker.read_back()?, live.baker.light_map().sweeps, count, one_unit))
    };
    let (whole, sweeps, few, one_unit) = bake(AMPLE)?;
    let (cut, cut_sweeps, many, _) = bake(one_unit)?;
    checks.at_least("lit texels", lit(&whole), LIT);
    checks.at_least("frames for one", f64::from(many) / f64::from(few), 2.0);
    checks.count("sweeps of many frames", cut_sweeps, sweeps);
    checks.count("texels that differ", differing(&cut, &whole), 0);
    Ok(())
}

/// Broken off after every few slices, looked at, and gone on with.
fn pauses(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let mut whole = baker(gpu, &scene)?;
    whole.bake(&to_samples(256), &mut |_| ControlFlow::Continue(()))?;
    let mut paused = Baker::new(gpu, &scene, &settings(Sampling::Auto, Slice::Time(Duration::from_millis(1))))?;
    let (mut count, mut outcome) = (0_u32, Outcome::Interrupted);
    while outcome == Outcome::Interrupted && count < 1000 {
        let mut slices = 0;
        outcome = paused.bake_until(&to_samples(256), &mut |_| {
            slices += 1;
            if slices > 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        paused.read_back()?;
        count += 1;
    }
    checks.at_least("pauses", f64::from(count), 5.0);
    checks.holds("the bake has ended", outcome == Outcome::Finished);
    checks.count("texels that differ", differing(&paused.read_back()?, &whole.read_back()?), 0);
    Ok(())
}

/// Frames without a budget, while the engine's clock stands: nothing is lost, and what follows is as without them.
fn paused_frames(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = lit_room()?;
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let mut bake = |pauses: usize| {
        let mut live = Live::new(gpu, &scene, frames)?;
        live.warm_up()?;
        live.frames(20, 1.0 / 60.0)?;
        let before = live.baker.read_back()?;
        for _ in 0..pauses {
            live.frame(0.0, Duration::ZERO)?;
        }
        let while_paused = differing(&live.baker.read_back()?, &before);
        checks.count(format!("texels that change in {pauses} frames without a budget"), while_paused, 0);
        live.frames(20, 1.0 / 60.0)?;
        live.baker.read_back()
    };
    let (through, paused) = (bake(0)?, bake(50)?);
    checks.at_least("lit texels", lit(&through), LIT);
    checks.count("texels that differ", differing(&paused, &through), 0);
    Ok(())
}
