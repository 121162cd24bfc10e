//! Budgets of any size, work that suddenly takes ten times as long, no timestamps. Extreme 18.

use super::settling::lamp_over;
use super::{Case, Checks};
use crate::baker::{FrameSettings, MeasuredBy, Ran, Timing};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::schedule::simulated::{Device, extent};
use crate::schedule::{FrameScheduler, Needs, Stage, Work};
use crate::verify::live::{AMPLE, Live, SIDE};
use crate::verify::stage::Chart;
use std::time::Duration;

pub(super) const CASES: [Case; 5] = [
    Case::extreme(18, "no budget, a nanosecond, centuries", budgets),
    Case::extreme(18, "frames without timestamps", without_timestamps),
    Case::extreme(18, "overshoot of a frame, simulated", overshoot),
    Case::extreme(18, "a spike of ten times the cost, simulated", spike),
    Case::extreme(18, "progress whatever the budget, simulated", progress),
];

const ALL: Needs = Needs { direct: true, importance: true, importance_after: true, publish: true };
const GATHER_ONLY: Needs = Needs { direct: false, importance: false, importance_after: false, publish: false };

/// 28 x 28 texels, of which one work group is a part.
fn chart() -> Chart {
    Chart::at([2, 2], 28).on(SIDE)
}

fn budgets(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let mut live = Live::new(gpu, &lamp_over(chart())?, frames)?;
    let mut idle = 0;
    for _ in 0..100 {
        let report = live.frame(0.01, Duration::ZERO)?;
        idle += u64::from(report.ran == Ran::empty() && report.rays == 0 && report.dispatches == 0);
    }
    checks.count("frames of no budget that do nothing", idle, 100);
    // At least a unit of work in 64 frames, and never more than one: rays, and the radiance that follows from them.
    let (mut most, mut count, mut waited, mut longest) = (0, 0, 0, 0);
    while live.baker.light_map().generation == 0 && count < 64 * 64 {
        let dispatches = live.frame(0.01, Duration::from_nanos(1))?.dispatches;
        waited = if dispatches == 0 { waited + 1 } else { 0 };
        (most, longest, count) = (most.max(dispatches), longest.max(waited), count + 1);
    }
    checks.at_least("light maps in frames of a nanosecond", live.baker.light_map().generation as f64, 1.0);
    checks.count("most dispatches of such a frame", most.into(), 2);
    checks.at_most("such frames in a row that do nothing", f64::from(longest), 63.0);
    // However large the budget, a frame goes round once.
    live.warm_up()?;
    let texels = live.baker.statistics().texels;
    let (mut most, mut least) = (0, u64::MAX);
    for budget in [AMPLE, Duration::from_secs(1 << 40), Duration::MAX] {
        for _ in 0..5 {
            let rays = live.frame(0.01, budget)?.rays;
            (most, least) = (most.max(rays), least.min(rays));
        }
    }
    checks.count("most rays of a frame of any budget", most, 16 * texels);
    checks.count("least rays of such a frame", least, 16 * texels);
    Ok(())
}

/// The host's clock takes their place.
fn without_timestamps(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const BUDGET: Duration = Duration::from_millis(8);
    let frames = FrameSettings { timing: Timing::Host, quanta: Some(1), ..FrameSettings::default() };
    let mut live = Live::new(gpu, &lamp_over(chart())?, frames)?;
    let (mut by_host, mut timed, mut beyond_s) = (0, 0, 0.0_f64);
    for frame in 0..150 {
        let (report, timing) = live.timed_frame(0.01, BUDGET)?;
        if let Some(timing) = timing.filter(|_| report.dispatches > 0) {
            timed += 1;
            by_host += u64::from(timing.measured_by == MeasuredBy::Host);
        }
        if frame >= 50 {
            // The longest dispatch that is planned, or one of what cannot be cut.
            let slice_s = (2.0 * report.one_unit.as_secs_f64()).max(4e-3);
            beyond_s = beyond_s.max((report.predicted.as_secs_f64() - BUDGET.as_secs_f64()) / slice_s);
        }
    }
    checks.at_least("frames that were timed", timed as f64, 10.0);
    checks.count("frames timed by the host", by_host, timed);
    checks.at_least("light maps", live.baker.light_map().generation as f64, 2.0);
    checks.at_most("slices that a frame is given beyond its budget", beyond_s, 1.0);
    Ok(())
}

/// Simulated devices with measurements of every precision: how much longer than its budget a frame is, once costs are known.
fn overshoot(_: &Gpu, checks: &mut Checks) -> Result<()> {
    for (name, noise, timestamps, late) in [
        ("exact times", 0.0, true, 0),
        ("late times", 0.0, true, 2),
        ("noisy times", 0.1, true, 2),
        ("no timestamps", 0.1, false, 2),
    ] {
        let (mut most_slices, mut over_95) = (0.0_f64, 0.0_f64);
        for rays_per_s in [0.5e6, 3e6, 20e6, 100e6, 500e6] {
            for (tiles, budget_s) in [(17, 2e-3), (150, 4e-3), (4096, 8e-3), (150, 16e-3)] {
                let mut device = Device { noise, timestamps, late, ..Device::new(extent(tiles), rays_per_s) };
                let mut scheduler = FrameScheduler::new(device.extent);
                learn(&mut device, &mut scheduler, budget_s);
                let mut over: Vec<f64> = Vec::new();
                for _ in 0..400 {
                    let frame = device.frame(&mut scheduler, budget_s, ALL);
                    let dispatch_s = |work: &Work| {
                        device.fixed_s + work.items.clone().map(|item| device.item_s(work, item)).sum::<f64>()
                    };
                    let slice_s = frame.works.iter().map(dispatch_s).fold(1e-9, f64::max);
                    most_slices = most_slices.max((frame.seconds - budget_s) / slice_s);
                    over.push((frame.seconds - frame.item_s) / budget_s);
                }
                over.sort_by(f64::total_cmp);
                over_95 = over_95.max(over[380]);
            }
        }
        if noise == 0.0 {
            checks.at_most(format!("slices beyond the budget, {name}"), most_slices, 1.0);
        }
        checks.at_most(format!("95th percentile less an item, budgets, {name}"), over_95, 1.15);
    }
    Ok(())
}

/// Frames until every stage has been gone through, and some more.
fn learn(device: &mut Device, scheduler: &mut FrameScheduler, budget_s: f64) {
    let ends = |work: &Work| work.stage == Stage::Publish && work.ends_stage;
    for _ in 0..100_000 {
        if device.frame(scheduler, budget_s, ALL).works.iter().any(ends) {
            break;
        }
    }
    (0..200).for_each(|_| drop(device.frame(scheduler, budget_s, ALL)));
}

/// One frame, or forty, of ten times the cost: no more of them are long than were planned before the first was measured.
fn spike(_: &Gpu, checks: &mut Checks) -> Result<()> {
    for (late, slow_frames, timestamps) in [(0, 1, true), (2, 1, true), (0, 40, true), (2, 40, true), (2, 40, false)] {
        let (mut most_long, mut longest, mut least_after) = (0, 0.0_f64, f64::INFINITY);
        for (seed, rays_per_s, budget_s) in (1..=8).flat_map(|seed| [(seed, 20e6, 4e-3), (seed, 500e6, 8e-3)]) {
            let random = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed);
            let mut device = Device { late, random, timestamps, ..Device::new(extent(4096), rays_per_s) };
            let mut scheduler = FrameScheduler::new(device.extent);
            let mut frames = |slowdown, count| -> Vec<f64> {
                device.slowdown = slowdown;
                (0..count).map(|_| device.frame(&mut scheduler, budget_s, GATHER_ONLY).seconds / budget_s).collect()
            };
            let mean = |used: &[f64]| used.iter().sum::<f64>() / used.len() as f64;
            let usual = mean(&frames(1.0, 200)[100..]);
            most_long = most_long.max(frames(10.0, slow_frames).iter().filter(|used| **used > 2.0).count());
            let after = frames(1.0, 60);
            longest = after.iter().copied().fold(longest, f64::max);
            least_after = least_after.min(mean(&after[30..]) / usual);
        }
        let times = if timestamps { "" } else { ", no timestamps" };
        let what = format!("{slow_frames} slow frames, measured {late} late{times}");
        checks.at_most(format!("long frames, {what}"), most_long as f64, late as f64 + 1.0);
        checks.at_most(format!("longest frame afterwards, budgets, {what}"), longest, 1.75);
        checks.at_least(format!("use of the budget when it is over, {what}"), least_after, 0.85);
    }
    Ok(())
}

/// Also where no budget is enough, and where direct light and the aim are always out of date.
fn progress(_: &Gpu, checks: &mut Checks) -> Result<()> {
    for budget_s in [1e-9, 1e-6, 1e-4, 1e-2, 10.0] {
        let (mut most_wait, mut least_sweeps) = (0, u64::MAX);
        for (tiles, rays_per_s) in [(1, 1e4), (5, 1e6), (40, 1e7), (40, 1e9)] {
            let mut device = Device::new(extent(tiles), rays_per_s);
            let mut scheduler = FrameScheduler::new(device.extent);
            let (mut waited, mut sweeps) = (0, 0);
            let parts = 2 * tiles + device.extent.importance_parts + device.extent.block_rows;
            for _ in 0..2 * 64 * parts {
                let frame = device.frame(&mut scheduler, budget_s, ALL);
                waited = if frame.works.is_empty() { waited + 1 } else { 0 };
                most_wait = most_wait.max(waited);
                let ends = |work: &&Work| work.stage == Stage::Gather && work.ends_stage;
                sweeps += frame.works.iter().filter(ends).count() as u64;
            }
            least_sweeps = least_sweeps.min(sweeps);
        }
        checks.at_most(format!("frames in a row without work, {budget_s} s"), f64::from(most_wait), 63.0);
        checks.at_least(format!("sweeps, {budget_s} s"), least_sweeps as f64, 2.0);
    }
    Ok(())
}
