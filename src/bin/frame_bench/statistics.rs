//! Percentiles, and how sure the overlap is.

use crate::random::Random;
use serde::Serialize;

/// Resamples of the bootstrap.
const RESAMPLES: usize = 1000;

/// Percentiles of some times, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Percentiles {
    pub(crate) p50: f64,
    pub(crate) p95: f64,
    pub(crate) p99: f64,
}

impl Percentiles {
    /// `None` without values.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |share| percentile(&sorted, share);
        Some(Self { p50: at(0.5)?, p95: at(0.95)?, p99: at(0.99)? })
    }
}

/// Mean; `None` without values.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Median; `None` without values.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    percentile(&sorted, 0.5)
}

/// Between the two nearest ranks, linearly; `None` without values.
fn percentile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * (sorted.len().checked_sub(1)?) as f64;
    let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(low + (high - low) * place.fract())
}

/// Frame times of the three cases, in milliseconds.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Cases {
    pub(crate) raster: Vec<f64>,
    pub(crate) bake: Vec<f64>,
    pub(crate) both: Vec<f64>,
}

/// Overlap efficiency with the interval from 2.5 to 97.5 % of its bootstrap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Efficiency {
    pub(crate) efficiency: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Cases {
    /// (T_raster + T_bake - T_both) / min(T_raster, T_bake) of medians: 1 where the shorter one is hidden, 0 where they
    /// follow each other, less where they are in each other's way. `None` where a case has no frames.
    pub(crate) fn efficiency(&self, seed: u64) -> Option<Efficiency> {
        let of = |raster: &[f64], bake: &[f64], both: &[f64]| {
            let (raster, bake, both) = (median(raster)?, median(bake)?, median(both)?);
            Some((raster + bake - both) / raster.min(bake))
        };
        let efficiency = of(&self.raster, &self.bake, &self.both)?;
        let mut random = Random::new(seed);
        let mut resample =
            |values: &[f64]| -> Vec<f64> { values.iter().map(|_| values[random.below(values.len())]).collect() };
        let mut found: Vec<f64> = (0..RESAMPLES)
            .filter_map(|_| of(&resample(&self.raster), &resample(&self.bake), &resample(&self.both)))
            .collect();
        found.sort_unstable_by(f64::total_cmp);
        Some(Efficiency { efficiency, low: percentile(&found, 0.025)?, high: percentile(&found, 0.975)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_lie_between_ranks() {
        let values: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        assert_eq!(Percentiles::of(&values), Some(Percentiles { p50: 50.0, p95: 95.0, p99: 99.0 }));
        assert_eq!(Percentiles::of(&[3.0]), Some(Percentiles { p50: 3.0, p95: 3.0, p99: 3.0 }));
        assert_eq!((median(&[4.0, 1.0]), mean(&[4.0, 1.0])), (Some(2.5), Some(2.5)));
        assert_eq!((Percentiles::of(&[]), median(&[]), mean(&[])), (None, None, None));
    }

    /// Values around a centre with a spread of a tenth.
    fn noisy(random: &mut Random, centre: f64) -> Vec<f64> {
        (0..300).map(|_| centre * (0.95 + 0.1 * random.unit())).collect()
    }

    #[test]
    fn efficiency_is_1_when_hidden_and_0_in_series() {
        let random = &mut Random::new(1);
        for (both, expected) in [(8.0, 1.0), (12.0, 0.0), (14.0, -0.5)] {
            let cases = Cases { raster: noisy(random, 4.0), bake: noisy(random, 8.0), both: noisy(random, both) };
            let found = cases.efficiency(0).expect("there are frames");
            assert!((found.efficiency - expected).abs() < 0.1, "{found:?}, expected {expected}");
            assert!(found.low <= found.efficiency && found.efficiency <= found.high, "{found:?}");
            assert!(found.low < found.high && found.high - found.low < 0.2, "{found:?}");
            assert_eq!(cases.efficiency(0), Some(found), "a seed repeats its resamples");
        }
    }

    #[test]
    fn the_interval_holds_the_truth_about_as_often_as_it_says() {
        // Of 200 intervals of 95 %, 190 +- 4 sigma = 12 should hold it; the bootstrap of a median errs to the wide side.
        let random = &mut Random::new(2);
        let holds = |_: &i32| {
            let cases = Cases { raster: noisy(random, 4.0), bake: noisy(random, 4.0), both: noisy(random, 6.0) };
            let found = cases.efficiency(3).expect("there are frames");
            found.low <= 0.5 && 0.5 <= found.high
        };
        let count = (0..200).filter(holds).count();
        assert!(count >= 178, "{count} of 200");
    }

    #[test]
    fn a_case_without_frames_has_no_efficiency() {
        assert_eq!(Cases { raster: vec![1.0], bake: vec![1.0], both: Vec::new() }.efficiency(0), None);
    }
}
