//! A simulated device, which the frame scheduler plans for: for its tests and for `verify`.

use super::frame::{FrameScheduler, TILE};
use super::work::{Extent, Needs, Stage, Work};
use std::collections::VecDeque;
use std::time::Duration;

/// True costs, and what becomes of measurements.
pub(crate) struct Device {
    pub(crate) extent: Extent,
    pub(crate) fixed_s: f64,
    pub(crate) rays_per_s: f64,
    /// Cost of tiles relative to each other; those of the second half.
    pub(crate) indoors: f64,
    pub(crate) noise: f64,
    /// Frames after which measurements arrive.
    pub(crate) late: usize,
    pub(crate) timestamps: bool,
    pub(crate) slowdown: f64,
    pub(crate) random: u64,
    pub(crate) pending: VecDeque<Vec<(Work, f64)>>,
}

/// What a frame was planned to be and was.
pub(crate) struct Frame {
    pub(crate) works: Vec<Work>,
    pub(crate) seconds: f64,
    /// The longest item in it, or the one that has been waited for.
    pub(crate) item_s: f64,
}

impl Device {
    pub(crate) fn new(extent: Extent, rays_per_s: f64) -> Self {
        let (pending, random) = (VecDeque::new(), 0x9e37_79b9_7f4a_7c15);
        let (fixed_s, indoors, noise, late) = (30e-6, 1.0, 0.1, 0);
        Self { extent, fixed_s, rays_per_s, indoors, noise, late, timestamps: true, slowdown: 1.0, random, pending }
    }

    /// About normal, of deviation 1.
    fn normal(&mut self) -> f64 {
        let mut uniform = || {
            self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.random >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    pub(crate) fn noisy(&mut self, seconds: f64) -> f64 {
        seconds * (1.0 + self.noise * self.normal()).max(0.3)
    }

    pub(crate) fn item_s(&self, work: &Work, item: u32) -> f64 {
        let texels = f64::from(TILE.min(self.extent.texels.saturating_sub(item * TILE)));
        let relative = if item >= self.extent.tiles() / 2 { self.indoors } else { 1.0 };
        let seconds = match work.stage {
            Stage::Direct => texels * f64::from(self.extent.lights.max(1)) * 0.5 / self.rays_per_s,
            Stage::Gather => texels * 16.0 * f64::from(work.quanta) * relative / self.rays_per_s,
            Stage::Importance => f64::from(self.extent.texels_per_importance_part) * 0.1 / self.rays_per_s,
            Stage::Publish => f64::from(self.extent.texels_per_block_row) * 0.1 / self.rays_per_s,
        };
        seconds * self.slowdown
    }

    /// Plans and carries out a frame; measurements arrive late.
    pub(crate) fn frame(&mut self, scheduler: &mut FrameScheduler, budget_s: f64, needs: Needs) -> Frame {
        let works = scheduler.plan(Duration::from_secs_f64(budget_s), needs, 0.0).to_vec();
        let mut frame = Frame { works: works.clone(), seconds: 0.0, item_s: 0.0 };
        let mut measured = Vec::new();
        for work in works {
            let longest_s = work.items.clone().map(|item| self.item_s(&work, item)).fold(0.0, f64::max);
            let exact_s = self.fixed_s + work.items.clone().map(|item| self.item_s(&work, item)).sum::<f64>();
            let seconds = self.noisy(exact_s);
            frame.seconds += seconds;
            frame.item_s = frame.item_s.max(longest_s + self.fixed_s);
            measured.push((work, self.noisy(seconds)));
        }
        self.pending.push_back(measured);
        while self.pending.len() > self.late {
            self.deliver(scheduler);
        }
        frame
    }

    fn deliver(&mut self, scheduler: &mut FrameScheduler) {
        let Some(measured) = self.pending.pop_front() else { return };
        if self.timestamps {
            for (work, seconds) in &measured {
                scheduler.measured(work, *seconds, false);
            }
        } else {
            let seconds = measured.iter().map(|(_, seconds)| seconds).sum();
            let works: Vec<_> = measured.into_iter().map(|(work, _)| work).collect();
            scheduler.measured_frame(&works, seconds);
        }
    }
}

/// Of a light map of so many tiles.
pub(crate) fn extent(tiles: u32) -> Extent {
    let texels = tiles * TILE - 100.min(tiles);
    Extent {
        texels,
        lights: 4,
        block_rows: tiles.div_ceil(32),
        texels_per_block_row: 32 * TILE,
        importance_parts: tiles.div_ceil(64),
        texels_per_importance_part: 64 * TILE,
        fixed_quanta: None,
    }
}
