//! What tiles cost relative to each other: those in the open cost less than those indoors.

use super::frame::TILE;
use std::ops::Range;

/// Bounds of a relative cost.
const LEAST: f32 = 0.125;
const MOST: f32 = 8.0;
/// By how much of what a dispatch shows its tiles follow.
const GAIN: f64 = 0.3;

/// Relative costs of the tiles, whose mean over the texels is 1 after every sweep.
#[derive(Debug, Clone)]
pub(crate) struct TileCosts {
    texels: u32,
    relative: Vec<f32>,
    largest: f32,
    /// Seconds a relative texel and quantum in the last sweep. Taken over a sweep, for what the newest dispatches took
    /// tells how the device is doing just where they were.
    usual_s: Option<f64>,
    sweep_s: f64,
    sweep_work: f64,
}

impl TileCosts {
    pub(crate) fn new(texels: u32) -> Self {
        let relative = vec![1.0; texels.div_ceil(TILE) as usize];
        Self { texels, relative, largest: 1.0, usual_s: None, sweep_s: 0.0, sweep_work: 0.0 }
    }

    /// Texels of a tile, of which the last may have fewer.
    pub(crate) fn texels(&self, tile: u32) -> u32 {
        TILE.min(self.texels.saturating_sub(tile.saturating_mul(TILE)))
    }

    /// Texels of a tile times its relative cost.
    pub(crate) fn weighted(&self, tile: u32) -> f64 {
        let relative = self.relative.get(tile as usize).copied().unwrap_or(1.0);
        f64::from(self.texels(tile)) * f64::from(relative)
    }

    /// The most that a tile may cost relative to the mean.
    pub(crate) fn largest(&self) -> f64 {
        f64::from(self.largest)
    }

    /// Learns from a dispatch of these tiles, each `quanta` quanta, which took `seconds` without its fixed part.
    pub(crate) fn measured(&mut self, tiles: Range<u32>, quanta: u32, seconds: f64) {
        let work = f64::from(quanta) * tiles.clone().map(|tile| self.weighted(tile)).sum::<f64>();
        if !(seconds > 0.0 && seconds.is_finite() && work > 0.0) {
            return;
        }
        self.sweep_s += seconds;
        self.sweep_work += work;
        let Some(usual_s) = self.usual_s else { return };
        // Clamped, for a stall of the device is no property of the tiles.
        let ratio = (seconds / (usual_s * work)).clamp(0.5, 2.0);
        let factor = (1.0 + GAIN * (ratio - 1.0)) as f32;
        let end = (tiles.end as usize).min(self.relative.len());
        for relative in &mut self.relative[(tiles.start as usize).min(end)..end] {
            *relative = (*relative * factor).clamp(LEAST, MOST);
        }
    }

    /// At the end of a sweep: makes the mean 1 again. Returns what relative costs were divided by.
    pub(crate) fn end_sweep(&mut self) -> f64 {
        let sum: f64 = (0..self.relative.len() as u32).map(|tile| self.weighted(tile)).sum();
        let mean = if self.texels > 0 { sum / f64::from(self.texels) } else { 1.0 };
        self.largest = LEAST;
        for relative in &mut self.relative {
            *relative = (*relative / mean as f32).clamp(LEAST, MOST);
            self.largest = self.largest.max(*relative);
        }
        if self.sweep_work > 0.0 {
            self.usual_s = Some(self.sweep_s / self.sweep_work * mean);
        }
        (self.sweep_s, self.sweep_work) = (0.0, 0.0);
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_tile_may_be_shorter() {
        let tiles = TileCosts::new(TILE * 2 + 3);
        assert_eq!([0, 1, 2, 3].map(|tile| tiles.texels(tile)), [TILE, TILE, 3, 0]);
        assert_eq!(TileCosts::new(0).relative.len(), 0);
    }

    /// Tiles of two costs, dispatched four at a time, on a device that once stalls.
    #[test]
    fn relative_costs_are_learned() {
        let mut tiles = TileCosts::new(TILE * 16);
        for sweep in 0..40 {
            for start in (0..16).step_by(4) {
                let stall = if sweep == 5 && start == 0 { 50.0 } else { 1.0 };
                let cost = if start < 8 { 1.0 } else { 4.0 };
                tiles.measured(start..start + 4, 2, stall * cost * 8e-5);
            }
            tiles.end_sweep();
        }
        let ratio = tiles.weighted(12) / tiles.weighted(3);
        assert!((ratio - 4.0).abs() < 0.1, "{ratio}");
        assert!((tiles.weighted(3) + tiles.weighted(12) - 512.0).abs() < 0.1);
    }

    #[test]
    fn times_that_are_none_are_ignored() {
        let mut tiles = TileCosts::new(TILE * 2);
        for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            tiles.measured(0..2, 1, seconds);
        }
        tiles.measured(5..9, 1, 1.0);
        assert_eq!(tiles.end_sweep(), 1.0);
        assert_eq!(tiles.usual_s, None);
    }
}
