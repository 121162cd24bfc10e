//! How long a dispatch takes: a fixed part and a part in proportion to its work, learned from measurements.

/// Share of what is known that a new measurement leaves: about 20 dispatches are remembered.
const KEEP: f64 = 0.95;
/// The same for a measurement that is off by more than `SURPRISE`. What was known is then of another pace, and a line
/// through points of two paces is neither: simulated, its fixed part swallowed the rest.
const KEEP_SURPRISED: f64 = 0.7;
const SURPRISE: f64 = 1.6;
/// Seconds of a dispatch without work, until measurements tell: what an empty one costs on most drivers.
const FIXED_S: f64 = 50e-6;
/// How far the fixed part may be from that.
const FIXED_SPREAD_S: f64 = 200e-6;
/// Relative noise of a measurement.
const NOISE: f64 = 0.1;
/// A measurement this many times longer than predicted is a spike, against which the next frame is guarded at once.
const SPIKE: f64 = 1.25;
/// A spike counts this much at most: after a machine has slept through a dispatch, an hour's prediction would leave
/// nothing to be done, and so nothing to be measured, for minutes. What was learned counts as nothing where two
/// measurements running are as much shorter.
const MOST_SPIKE: f64 = 50.0;
/// By how much of what is left of a spike each later measurement lets it go. Simulated with 8 seeds, a device that
/// stays slow overshot a second time with 4 of them at .5, with none at .3.
const CALM: f64 = 0.3;
/// The fit takes a measurement for no longer than this many times the prediction: a single stall is not a trend.
const LIMIT: f64 = 3.0;
/// The part in proportion to the work is at least this share of the mean: a line through points of two paces must not
/// make more work look free. Simulated on the way back from a tenth of the pace, the longest frame: 1.6 budgets; 3.2
/// with a share of .05.
const LEAST_SHARE: f64 = 0.55;
/// Beyond these, work is no work and seconds are a broken clock's.
const LEAST_X: f64 = 1e-6;
const SECONDS: std::ops::Range<f64> = 1e-9..1e6;

/// A fit t = fixed + per_unit * x of one stage. Recursive least squares with forgetting, in the form that keeps sums:
/// with two unknowns the constrained solution is closed, and nothing winds up where all dispatches are alike.
#[derive(Debug, Clone)]
pub(crate) struct Cost {
    /// Work that counts as x = 1.
    unit: f64,
    sums: Sums,
    measurements: u32,
    /// Measurements running that were shorter than the fit by more than the most that a spike counts.
    far_shorter: u32,
    fixed_s: f64,
    per_unit_s: f64,
    /// By how much longer dispatches take at present than the fit says; at least 1.
    spike: f64,
}

/// Weighted sums over the measurements, of 1, x, x^2, t and x t.
#[derive(Debug, Clone, Default)]
struct Sums {
    one: f64,
    x: f64,
    xx: f64,
    t: f64,
    xt: f64,
}

impl Cost {
    /// `unit`: work of an item; `seconds`: a cautious guess of what one unit of work (not one item) takes.
    pub(crate) fn new(unit: f64, seconds: f64) -> Self {
        let unit = unit.max(1.0);
        let per_unit_s = seconds * unit;
        Self { unit, sums: Sums::default(), measurements: 0, far_shorter: 0, fixed_s: FIXED_S, per_unit_s, spike: 1.0 }
    }

    /// Forgets the present spike.
    pub(crate) fn calm(&mut self) {
        self.spike = 1.0;
    }

    /// Seconds of a dispatch of this much work.
    pub(crate) fn predicted(&self, work: f64) -> f64 {
        self.fit(work) * self.spike
    }

    /// Seconds of a dispatch that are there without any work.
    pub(crate) fn fixed_s(&self) -> f64 {
        self.fixed_s * self.spike
    }

    /// Seconds a piece of work, without the fixed part.
    pub(crate) fn per_work_s(&self) -> f64 {
        self.per_unit_s * self.spike / self.unit
    }

    /// Seconds that the work of a measured dispatch took, without the fixed part.
    pub(crate) fn work_s(&self, seconds: f64) -> f64 {
        (seconds - self.fixed_s).max(0.0)
    }

    /// Learns from a dispatch; times that are no times are ignored.
    pub(crate) fn measured(&mut self, work: f64, seconds: f64) {
        let x = work / self.unit;
        if !(SECONDS.contains(&seconds) && x >= LEAST_X && x.is_finite()) {
            return;
        }
        let longer = seconds / self.fit(work);
        let limit = if self.measurements < 2 { f64::INFINITY } else { LIMIT * self.fit(work) };
        self.measurements = self.measurements.saturating_add(1);
        let surprised = !(1.0 / SURPRISE..=SURPRISE).contains(&longer);
        self.far_shorter = if longer * MOST_SPIKE < 1.0 { self.far_shorter.saturating_add(1) } else { 0 };
        self.sums.forget(match (self.far_shorter, surprised) {
            (2.., _) => 0.0,
            (_, true) => KEEP_SURPRISED,
            (_, false) => KEEP,
        });
        self.sums.add(x, seconds.min(limit));
        self.solve();
        // Up at once, down step by step: later measurements have to agree that it is over.
        let target = if longer > SPIKE { (seconds / self.fit(work)).clamp(1.0, MOST_SPIKE) } else { 1.0 };
        self.spike = target.max(self.spike + CALM * (target - self.spike));
    }

    /// Work is from now on counted in units this many times as large.
    pub(crate) fn rescale(&mut self, factor: f64) {
        self.sums.x /= factor;
        self.sums.xt /= factor;
        self.sums.xx /= factor * factor;
        self.per_unit_s *= factor;
    }

    fn fit(&self, work: f64) -> f64 {
        self.fixed_s + self.per_unit_s * (work / self.unit)
    }

    fn solve(&mut self) {
        let sums = &self.sums;
        // What is known of the fixed part beforehand, weighed as the measurements are: against their noise.
        let known = (NOISE * self.per_unit_s / FIXED_SPREAD_S).powi(2).clamp(1e-6, 1e3);
        let (one, t) = (sums.one + known, sums.t + known * FIXED_S);
        let determinant = one * sums.xx - sums.x * sums.x;
        let fixed_s = (t * sums.xx - sums.x * sums.xt) / determinant;
        let least = LEAST_SHARE * sums.xt / sums.xx;
        (self.fixed_s, self.per_unit_s) = if fixed_s > 0.0 {
            let per_unit_s = (sums.xt - fixed_s * sums.x) / sums.xx;
            let fixed_for_least_s = ((sums.t - least * sums.x) / sums.one).max(0.0);
            if per_unit_s >= least { (fixed_s, per_unit_s) } else { (fixed_for_least_s, least) }
        } else {
            (0.0, sums.xt / sums.xx)
        };
    }
}

impl Sums {
    fn forget(&mut self, keep: f64) {
        for sum in [&mut self.one, &mut self.x, &mut self.xx, &mut self.t, &mut self.xt] {
            *sum *= keep;
        }
    }

    /// Errors are relative for large x; the fixed part shows in small ones, which must not count beyond measure.
    fn add(&mut self, x: f64, seconds: f64) {
        let weight = (1.0 + x).powi(-2);
        for (sum, new) in [
            (&mut self.one, 1.0),
            (&mut self.x, x),
            (&mut self.xx, x * x),
            (&mut self.t, seconds),
            (&mut self.xt, x * seconds),
        ] {
            *sum += weight * new;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn learned(fixed_s: f64, per_work_s: f64, count: u32) -> Cost {
        let mut cost = Cost::new(4096.0, 1e-6);
        for k in 0..count {
            let work = 4096.0 * f64::from(k % 7 + 1);
            cost.measured(work, fixed_s + per_work_s * work);
        }
        cost
    }

    #[test]
    fn the_first_measurement_replaces_the_guess() {
        for seconds in [1e-5, 1e-4, 1e-2, 1.0] {
            let mut cost = Cost::new(4096.0, 1e-6);
            cost.measured(4096.0, seconds);
            assert!((cost.predicted(4096.0) / seconds - 1.0).abs() < 1e-6, "{} for {seconds}", cost.predicted(4096.0));
        }
    }

    #[test]
    fn a_line_is_found() {
        for (fixed_s, per_work_s) in [(0.0, 1e-6), (5e-5, 4e-9), (2e-4, 1e-7), (1e-5, 2e-6)] {
            let cost = learned(fixed_s, per_work_s, 100);
            for items in [1.0, 3.0, 20.0] {
                let wanted = fixed_s + per_work_s * 4096.0 * items;
                assert!(
                    (cost.predicted(4096.0 * items) / wanted - 1.0).abs() < 0.05,
                    "{fixed_s} {per_work_s} {cost:?}"
                );
            }
        }
    }

    #[test]
    fn a_spike_counts_at_once_and_is_soon_forgotten() {
        let mut cost = learned(5e-5, 1e-7, 100);
        let usual = cost.predicted(8192.0);
        cost.measured(8192.0, 10.0 * usual);
        assert!(cost.predicted(8192.0) >= 9.999 * usual);
        for _ in 0..16 {
            cost.measured(8192.0, usual);
        }
        assert!(cost.predicted(8192.0) < 1.15 * usual);
    }

    /// A machine slept through a dispatch: among the first, or later.
    #[test]
    fn an_hour_is_soon_forgotten() {
        for before in [0, 1, 2, 100] {
            let mut cost = learned(5e-5, 1e-7, before);
            let usual = 5e-5 + 1e-7 * 8192.0;
            cost.measured(8192.0, 3600.0);
            for _ in 0..16 {
                cost.measured(8192.0, usual);
            }
            assert!(cost.predicted(8192.0) < 1.3 * usual, "{before} before: {cost:?}");
        }
    }

    #[test]
    fn a_slower_device_is_learned() {
        let mut cost = learned(5e-5, 1e-7, 100);
        for _ in 0..200 {
            let seconds = 5e-4 + 1e-6 * 8192.0;
            cost.measured(8192.0, seconds);
            assert!(cost.predicted(8192.0) >= 0.75 * seconds, "the guard is held until the fit has followed");
        }
        assert!(cost.spike < 1.001, "{cost:?}");
    }

    #[test]
    fn another_unit_changes_no_prediction() {
        let mut cost = learned(5e-5, 1e-7, 50);
        let before = cost.predicted(8192.0);
        cost.rescale(2.0);
        assert!((cost.predicted(4096.0) / before - 1.0).abs() < 1e-12);
        cost.solve();
        assert!((cost.predicted(4096.0) / before - 1.0).abs() < 1e-2);
    }

    /// Any, and those of everyday size.
    fn number() -> impl Strategy<Value = f64> {
        let broken = [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-9, 1e6];
        prop_oneof![
            2 => any::<u64>().prop_map(f64::from_bits),
            2 => (-9.0_f64..12.0).prop_map(|exponent| 10_f64.powf(exponent)),
            1 => prop::sample::select(broken.to_vec()),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            failure_persistence: None, rng_seed: RngSeed::Fixed(5), ..ProptestConfig::default()
        })]

        #[test]
        fn nothing_makes_it_unusable(measured in prop::collection::vec((number(), number(), number()), 0..60)) {
            let mut cost = Cost::new(4096.0, 1e-6);
            for (work, seconds, factor) in measured {
                // Far more than all texels' quanta.
                cost.measured(work % 1e18, seconds);
                cost.rescale((factor.abs() % 8.0).max(0.125));
                prop_assert!(cost.fixed_s >= 0.0 && cost.per_unit_s > 0.0 && cost.spike >= 1.0, "{:?}", cost);
                prop_assert!(cost.predicted(1.0).is_finite() && cost.predicted(1e12).is_finite(), "{:?}", cost);
            }
        }
    }
}
