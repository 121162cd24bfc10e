//! The frame scheduler against a simulated device.

mod rules;

use super::frame::{FrameScheduler, samples_per_texel};
use super::simulated::{Device, extent};
use super::work::{Extent, Needs, Stage, Work};

const ALL: Needs = Needs { direct: true, importance: true, importance_after: true, publish: true };
const GATHER_ONLY: Needs = Needs { direct: false, importance: false, importance_after: false, publish: false };

/// 95th percentile of the frames' times, less an item, and mean use, both in budgets.
fn adherence(device: &mut Device, budget_s: f64, needs: Needs) -> (f64, f64) {
    let mut scheduler = FrameScheduler::new(device.extent);
    for _ in 0..400 {
        device.frame(&mut scheduler, budget_s, needs);
    }
    let frames: Vec<_> = (0..1000).map(|_| device.frame(&mut scheduler, budget_s, needs)).collect();
    let mut over: Vec<_> = frames.iter().map(|frame| (frame.seconds - frame.item_s) / budget_s).collect();
    over.sort_by(f64::total_cmp);
    (over[950], frames.iter().map(|frame| frame.seconds).sum::<f64>() / 1000.0 / budget_s)
}

/// Tiles that fill a frame even at the most quanta.
fn can_fill(device: &Device, budget_s: f64) -> bool {
    let work = Work { stage: Stage::Gather, items: 0..1, quanta: 64, ends_stage: false };
    let tile_s = device.item_s(&work, 0).min(0.7 * 4e-3_f64.min((budget_s + 1e-9) / 2.0));
    tile_s * f64::from(device.extent.tiles()) > 1.1 * budget_s
}

#[test]
fn the_budget_is_kept_and_used() {
    let (mut most_over, mut least_use) = (0.0_f64, f64::INFINITY);
    for (budget_ms, rays_per_s, tiles) in cases() {
        for (needs, indoors, late, timestamps) in [
            (ALL, 1.0, 2, true),
            (ALL, 4.0, 2, true),
            (GATHER_ONLY, 1.0, 0, true),
            (GATHER_ONLY, 4.0, 2, true),
            (ALL, 1.0, 2, false),
        ] {
            let mut device = Device { indoors, late, timestamps, ..Device::new(extent(tiles), rays_per_s) };
            let budget_s = budget_ms * 1e-3;
            let (over, used) = adherence(&mut device, budget_s, needs);
            let case =
                format!("{budget_ms} ms, {rays_per_s:e} rays/s, {tiles} tiles, {needs:?}, {indoors}, {late} late");
            assert!(over <= 1.15, "{case}, times {timestamps}: {over}");
            most_over = most_over.max(over);
            if budget_ms >= 4.0 && can_fill(&device, budget_s) {
                assert!(used >= 0.75, "{case}, times {timestamps}: {used}");
                least_use = least_use.min(used);
            }
        }
    }
    println!("95th percentile less an item {most_over:.3}, mean use {least_use:.3} of the budget");
}

/// Budgets in milliseconds, rays a second and numbers of tiles.
fn cases() -> Vec<(f64, f64, u32)> {
    let mut cases = Vec::new();
    for budget_ms in [2.0, 4.0, 8.0, 16.0] {
        for rays_per_s in [0.5e6, 3e6, 20e6, 100e6, 500e6] {
            cases.extend([3, 17, 150, 4096].map(|tiles| (budget_ms, rays_per_s, tiles)));
        }
    }
    cases
}

/// Slow frames: only those in flight are too long; soon after the last, all is as before.
#[test]
fn a_spike_is_answered_at_once_and_forgotten() {
    let mut longest = 0.0_f64;
    for (budget_ms, rays_per_s, tiles) in cases().into_iter().filter(|(_, rate, tiles)| *rate > 10e6 && *tiles > 100) {
        for (late, slow_frames, seed) in (0..32).map(|k| ([0, 2][k % 2], [1, 40][k / 2 % 2], k as u64 / 4 + 1)) {
            let budget_s = 1e-3 * budget_ms;
            let random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mut device = Device { late, random, ..Device::new(extent(tiles), rays_per_s) };
            let mut scheduler = FrameScheduler::new(device.extent);
            let mut frames = |device: &mut Device, slowdown, count| -> Vec<_> {
                device.slowdown = slowdown;
                let frame = |_| device.frame(&mut scheduler, budget_s, GATHER_ONLY).seconds / budget_s;
                (0..count).map(frame).collect()
            };
            let usual = frames(&mut device, 1.0, 200)[100..].iter().sum::<f64>() / 100.0;
            let slow = frames(&mut device, 10.0, slow_frames);
            let after = frames(&mut device, 1.0, 60);
            let case = format!("{budget_ms} ms, {rays_per_s:e} rays/s, {tiles} tiles, {late} late, {slow_frames} slow");
            let over = slow.iter().filter(|used| **used > 2.0).count();
            assert!(over <= late + 1, "{case}: {slow:?}");
            longest = after.iter().copied().fold(longest, f64::max);
            assert!(after.iter().all(|used| *used < 1.75), "{case}: {after:?}");
            assert!(after[30..].iter().sum::<f64>() / 30.0 > 0.85 * usual, "{case}: {after:?}");
        }
    }
    println!("longest frame after a spike {longest:.3} budgets");
}

#[test]
fn quanta_fill_a_frame() {
    for (tiles, budget_s, least, most) in
        [(4096, 2e-3, 1, 1), (64, 8e-3, 20, 30), (64, 2e-3, 5, 8), (16, 16e-3, 64, 64)]
    {
        let mut device = Device { noise: 0.0, ..Device::new(extent(tiles), 1e9 * 256.0 / 250.0) };
        (device.rays_per_s, device.fixed_s) = (1e9, 10e-6);
        let mut scheduler = FrameScheduler::new(device.extent);
        let mut quanta = 0;
        for _ in 0..200 {
            let frame = device.frame(&mut scheduler, budget_s, GATHER_ONLY);
            quanta = frame.works.last().map_or(quanta, |work| work.quanta);
        }
        assert!((least..=most).contains(&quanta), "{tiles} tiles, {budget_s} s: {quanta}");
    }
}

#[test]
fn no_budget_no_work_and_no_credit() {
    let mut device = Device::new(extent(64), 1e6);
    let mut scheduler = FrameScheduler::new(device.extent);
    for _ in 0..1000 {
        assert!(device.frame(&mut scheduler, 0.0, ALL).works.is_empty());
    }
    assert!(device.frame(&mut scheduler, 1e-3, ALL).works.is_empty(), "a frame's credit is less than the first item");
}

#[test]
fn a_huge_budget_gives_one_round() {
    let mut device = Device::new(extent(64), 100e6);
    let mut scheduler = FrameScheduler::new(device.extent);
    for _ in 0..200 {
        device.frame(&mut scheduler, 10.0, ALL);
    }
    let works = device.frame(&mut scheduler, 10.0, ALL).works;
    for (stage, items) in [(Stage::Direct, 64), (Stage::Gather, 64), (Stage::Publish, 2)] {
        let done: usize = works.iter().filter(|work| work.stage == stage).map(|work| work.items.len()).sum();
        assert_eq!(done, items, "{stage:?}: {works:?}");
    }
}

#[test]
fn a_map_without_texels_is_published_once() {
    let mut device = Device::new(Extent { texels: 0, ..extent(64) }, 100e6);
    let mut scheduler = FrameScheduler::new(device.extent);
    let works: Vec<_> = (0..50).flat_map(|_| device.frame(&mut scheduler, 0.1, ALL).works).collect();
    assert!(works.iter().all(|work| work.stage == Stage::Publish));
    assert_eq!(works.iter().filter(|work| work.ends_stage).count(), 1);
    assert_eq!(works.iter().map(|work| work.items.len()).sum::<usize>(), 2);
}

#[test]
fn broken_times_leave_the_predictions_alone() {
    let mut device = Device::new(extent(64), 100e6);
    let mut scheduler = FrameScheduler::new(device.extent);
    let works: Vec<_> = (0..20).flat_map(|_| device.frame(&mut scheduler, 8e-3, ALL).works).collect();
    let before: Vec<_> = works.iter().map(|work| scheduler.predicted(work)).collect();
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        scheduler.measured_frame(&works[..3], seconds);
        scheduler.measured(&works[0], seconds, false);
    }
    scheduler.measured(&works[0], 0.5, true);
    scheduler.measured_frame(&[], 1.0);
    let after: Vec<_> = works.iter().map(|work| scheduler.predicted(work)).collect();
    assert_eq!(before, after);
}

#[test]
fn rays_are_those_of_the_device() {
    let mut device = Device { noise: 0.03, ..Device::new(extent(512), 100e6) };
    let mut scheduler = FrameScheduler::new(device.extent);
    for _ in 0..200 {
        device.frame(&mut scheduler, 8e-3, GATHER_ONLY);
    }
    assert!((scheduler.rays_per_second() / 100e6 - 1.0).abs() < 0.15, "{}", scheduler.rays_per_second());
    assert!((samples_per_texel(262.144e6, 0.032, 512 * 512) - 32.0).abs() < 1e-9);
    assert_eq!(samples_per_texel(1e6, 1.0, 0), 0.0);
}
