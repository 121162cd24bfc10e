//! Cuts work into slices of a wanted length. Pure: timings come in, units of work go out.
//!
//! A unit is a range of texels times a range of quanta. Which units there are never changes a bit of the result: random
//! numbers are keyed by texel and sample, and a texel's quanta are merged in order.

use std::ops::Range;
use std::time::Duration;

/// How long one submission to the device may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slice {
    /// About this long, measured as it goes.
    Time(Duration),
    /// This many texels, one quantum of rays each.
    Texels(u32),
}

impl Default for Slice {
    /// 50 ms: soon enough for an interruption and a progress bar, and 250 times what a submission costs on lavapipe.
    fn default() -> Self {
        Self::Time(Duration::from_millis(50))
    }
}

/// What one submission does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unit {
    pub(crate) texels: Range<u32>,
    pub(crate) quanta: Range<u32>,
}

/// Goes through the texels again and again, until all their quanta are done.
#[derive(Debug, Clone)]
pub(crate) struct Sweep {
    texels: u32,
    quanta: Range<u32>,
    next_texel: u32,
    /// Quanta of the pass through the texels that is under way.
    pass: Range<u32>,
}

impl Sweep {
    pub(crate) fn new(texels: u32, quanta: Range<u32>) -> Self {
        let pass = quanta.start..quanta.start;
        Self { texels, quanta, next_texel: texels, pass }
    }

    /// The next unit; no pass through the texels goes beyond quantum `stop`. `None`: all is done.
    pub(crate) fn next(&mut self, pace: &Pace, samples: u32, stop: u32) -> Option<Unit> {
        if self.next_texel == self.texels {
            let end = self.quanta.end.min(stop.max(self.pass.end + 1));
            if self.pass.end >= self.quanta.end || self.texels == 0 {
                return None;
            }
            let quanta = pace.quanta(self.texels, samples).min(end - self.pass.end);
            self.pass = self.pass.end..self.pass.end + quanta;
            self.next_texel = 0;
        }
        let count = pace.texels(samples * self.pass.len() as u32).min(self.texels - self.next_texel);
        let texels = self.next_texel..self.next_texel + count;
        self.next_texel = texels.end;
        Some(Unit { texels, quanta: self.pass.clone() })
    }

    /// The quantum up to which every texel is done, at the end of a pass through the texels; `None` within one.
    pub(crate) fn finished_pass(&self) -> Option<u32> {
        (self.next_texel == self.texels).then_some(self.pass.end)
    }
}

/// How many rays make up a slice.
#[derive(Debug, Clone)]
pub(crate) struct Pace {
    slice: Slice,
    rays: f64,
}

/// Texels of a work group, which is never cut: `local_size_x` of the shaders that go through the list of texels.
pub(crate) const GROUP: u32 = 64;

impl Pace {
    pub(crate) fn new(slice: Slice) -> Self {
        // One group of a full quantum each, until something has been measured.
        Self { slice, rays: 64.0 * 64.0 * 16.0 }
    }

    fn texels(&self, rays_per_texel: u32) -> u32 {
        let texels = match self.slice {
            Slice::Time(_) => (self.rays / f64::from(rays_per_texel.max(1))).min(f64::from(u32::MAX / 2)) as u32,
            Slice::Texels(texels) => texels,
        };
        texels.clamp(1, u32::MAX / 2).next_multiple_of(GROUP)
    }

    /// Quanta for which all texels fit into one slice; at least 1, and at most 16: 1,024 rays for an invocation, far below
    /// the 65,535 iterations at which older drivers cut loops.
    fn quanta(&self, texels: u32, samples: u32) -> u32 {
        match self.slice {
            Slice::Time(_) => (self.rays / (f64::from(texels) * f64::from(samples))).clamp(1.0, 16.0) as u32,
            Slice::Texels(_) => 1,
        }
    }

    /// Learns from a slice: at once where it took too long, by at most a factor of 2 where it was short.
    pub(crate) fn measured(&mut self, rays: u64, took: Duration) {
        if let Slice::Time(target) = self.slice {
            let rate = rays as f64 / took.as_secs_f64().max(1e-6);
            self.rays = (rate * target.as_secs_f64()).clamp(1.0, 2.0 * self.rays.max(rays as f64));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// What a clock may say: nothing, little, spikes, and all that fits.
    fn nanoseconds() -> Vec<u64> {
        vec![0, 1, 1_000, 50_000_000, 500_000_000, 3_600_000_000_000, u64::MAX]
    }

    fn units(texels: u32, quanta: Range<u32>, pace: &mut Pace, seconds: f64) -> Vec<Unit> {
        let mut sweep = Sweep::new(texels, quanta);
        let mut units = Vec::new();
        while let Some(unit) = sweep.next(pace, 64, u32::MAX) {
            pace.measured(unit.texels.len() as u64 * 64, Duration::from_secs_f64(seconds));
            units.push(unit);
        }
        units
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            failure_persistence: None, rng_seed: RngSeed::Fixed(3), ..ProptestConfig::default()
        })]

        /// Any clock: a slice always has something in it, and after a spike the next one is as much shorter.
        #[test]
        fn any_times_make_progress(
            texels in 1_u32..2000, count in 1_u32..9,
            times in prop::collection::vec((any::<u64>(), prop::sample::select(nanoseconds())), 1..40), slice in 0_u64..100_000,
        ) {
            let target = Duration::from_micros(slice);
            let mut pace = Pace::new(Slice::Time(target));
            let mut sweep = Sweep::new(texels, 0..count);
            let (mut done, mut units) = (0, 0);
            for (rays, nanoseconds) in times.into_iter().cycle() {
                let Some(unit) = sweep.next(&pace, 64, u32::MAX) else { break };
                prop_assert!(!unit.texels.is_empty() && !unit.quanta.is_empty() && unit.texels.end <= texels);
                done += unit.texels.len() as u64 * unit.quanta.len() as u64;
                units += 1;
                let (rays, took) = (rays >> (units % 64), Duration::from_nanos(nanoseconds));
                pace.measured(rays, took);
                let next_s = pace.rays / rays.max(1) as f64 * took.as_secs_f64();
                prop_assert!(pace.rays == 1.0 || next_s <= 1.000_001 * target.as_secs_f64().max(1e-6), "{next_s} s");
            }
            prop_assert_eq!(done, u64::from(texels) * u64::from(count));
            prop_assert!(units <= u64::from(texels.div_ceil(GROUP) * count));
        }

        #[test]
        fn every_texel_gets_every_quantum_once_and_in_order(
            texels in 0_u32..3000, count in 0_u32..9, size in 1_u32..2000, timed in any::<bool>(), seconds in 1e-6..10.0,
        ) {
            let slice = if timed { Slice::Time(Duration::from_millis(50)) } else { Slice::Texels(size) };
            let mut done = vec![3_u32; texels as usize];
            for unit in units(texels, 3..3 + count, &mut Pace::new(slice), seconds) {
                for texel in unit.texels {
                    prop_assert_eq!(done[texel as usize], unit.quanta.start);
                    done[texel as usize] = unit.quanta.end;
                }
            }
            prop_assert!(done.iter().all(|quantum| *quantum == 3 + count));
        }
    }

    #[test]
    fn a_pass_ends_at_the_stop() {
        let mut sweep = Sweep::new(64, 0..100);
        let pace = Pace { slice: Slice::Time(Duration::from_millis(50)), rays: 1e9 };
        assert_eq!(sweep.next(&pace, 64, 6).map(|unit| unit.quanta), Some(0..6));
        assert_eq!(sweep.finished_pass(), Some(6));
        assert_eq!(sweep.next(&pace, 64, 6).map(|unit| unit.quanta), Some(6..7));
    }

    #[test]
    fn a_spike_shrinks_the_next_slice_at_once() {
        let mut pace = Pace::new(Slice::default());
        pace.measured(1_000_000, Duration::from_secs(10));
        assert_eq!(pace.texels(1), 5000_u32.next_multiple_of(GROUP));
    }
}
