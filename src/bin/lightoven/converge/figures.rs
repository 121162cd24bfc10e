//! How far bakes are from a reference, from time to time, and how that falls. Pure.

use crate::compare::quantile;
use crate::noise::Reference;
use lightoven::io::luminance;
use serde::Serialize;
use std::time::Duration;

/// The first time of a bake that is looked at; each further one is twice as long.
const FIRST_TIME: Duration = Duration::from_millis(125);

/// An error this many times what does not fall any more (a bias, or the reference's own noise) shows a slope: the
/// straight line's -1 is then -0.75 or steeper.
pub(super) const ABOVE_FLOOR: f64 = 4.0;

/// An eighth of a second and its doublings below `end`, then `end` itself.
pub(super) fn times(end: Duration) -> Vec<Duration> {
    let doublings = std::iter::successors(Some(FIRST_TIME), |time| time.checked_mul(2));
    doublings.take_while(|time| *time < end).chain([end]).collect()
}

/// Where a bake stands when it is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct At {
    /// Of baking.
    pub(super) seconds: f64,
    pub(super) rays: u64,
    /// Kept.
    pub(super) samples_per_texel: f64,
}

/// What bakes that differ in their seeds alone sum up to at one time.
#[derive(Debug, Default)]
pub(super) struct Sums {
    bakes: u32,
    seconds: f64,
    rays: u64,
    samples_per_texel: f64,
    median: f64,
    p95: f64,
    /// For each texel that counts: the difference from the reference, and its square.
    texels: Vec<(f64, f64)>,
}

/// The errors at one time: luminance, over the texels that count, as means over the bakes.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    /// Time of baking, as `bake --time` counts: the bounces, rays, source maps, what rays are aimed by, analytic lights and the estimates
    /// of the error on the way, without loading, the hierarchy, the g-buffer, compilation and what it takes to look.
    pub(super) seconds: f64,
    /// Those of bounces included.
    pub(super) rays: u64,
    /// Kept samples; 0 while the bounces are found out.
    pub(super) samples_per_texel: f64,
    /// Bakes that have been looked at at this time.
    pub(super) seeds: u32,
    /// Root of the mean squared difference.
    pub(super) rmse: f64,
    /// Mean of (x - r)^2 / (r^2 + 0.01 mean^2).
    pub(super) relmse: f64,
    /// Of |x - r| / r.
    pub(super) median: f64,
    /// Of |x - r| / r: 95 % of the texels are below it.
    pub(super) p95: f64,
    /// Root of the bias's part of relMSE: `relmse` = bias^2 + seeds * bias_noise^2. What the mean of the bakes is off by,
    /// less what noise makes of that; 0 where noise explains it all, `null` with one bake.
    pub(super) bias: Option<f64>,
    /// What noise puts the mean of the bakes off by: a bias below it is not told from none.
    pub(super) bias_noise: Option<f64>,
    /// 1 / (relMSE * seconds); `null` without an error.
    pub(super) efficiency: Option<f64>,
    /// Texels left out because some bake is not a finite number there.
    pub(super) not_finite: usize,
}

impl Sums {
    /// `pixels` is `[texel]`, as those of the reference.
    pub(super) fn add(&mut self, reference: &Reference, at: At, pixels: &[[f32; 4]]) {
        self.texels.resize(reference.texels(), (0.0, 0.0));
        let mut relative = Vec::with_capacity(self.texels.len());
        for ((texel, expected), sums) in reference.counting().iter().zip(&mut self.texels) {
            let difference = luminance(pixels[*texel]) - expected;
            sums.0 += difference;
            sums.1 += difference.powi(2);
            relative.extend(Some(difference.abs() / expected).filter(|value| value.is_finite()));
        }
        relative.sort_unstable_by(f64::total_cmp);
        if !relative.is_empty() {
            self.median += quantile(&relative, 0.5);
            self.p95 += quantile(&relative, 0.95);
        }
        self.seconds += at.seconds;
        self.rays += at.rays;
        self.samples_per_texel += at.samples_per_texel;
        self.bakes += 1;
    }

    /// `None` before the first bake, and where no texel is left.
    pub(super) fn row(&self, reference: &Reference) -> Option<Row> {
        let (bakes, floor) = (f64::from(self.bakes), reference.floor());
        let values = reference.counting().iter().map(|(_, expected)| *expected);
        let sums = values.zip(&self.texels).map(|(expected, (sum, squares))| (expected, *sum, *squares));
        let finite: Vec<_> = sums.filter(|(_, sum, squares)| sum.is_finite() && squares.is_finite()).collect();
        if finite.is_empty() {
            return None;
        }
        let mean =
            |value: &dyn Fn(&(f64, f64, f64)) -> f64| finite.iter().map(value).sum::<f64>() / finite.len() as f64;
        let relmse = mean(&|(r, _, squares)| squares / bakes / (r * r + floor));
        let of_mean = mean(&|(r, sum, _)| (sum / bakes).powi(2) / (r * r + floor));
        // MSE = bias^2 + variance, and the mean over the bakes has bias^2 + variance / bakes of it.
        let noise = (self.bakes > 1).then(|| (relmse - of_mean).max(0.0) / (bakes - 1.0));
        let seconds = self.seconds / bakes;
        Some(Row {
            seconds,
            rays: (self.rays as f64 / bakes).round() as u64,
            samples_per_texel: self.samples_per_texel / bakes,
            seeds: self.bakes,
            rmse: mean(&|(_, _, squares)| squares / bakes).sqrt(),
            relmse,
            median: self.median / bakes,
            p95: self.p95 / bakes,
            bias: noise.map(|noise| (of_mean - noise).max(0.0).sqrt()),
            bias_noise: noise.map(f64::sqrt),
            efficiency: Some(1.0 / (relmse * seconds)).filter(|value| value.is_finite()),
            not_finite: self.texels.len() - finite.len(),
        })
    }
}

/// Rows that a slope is fitted to: with kept samples, and an error well above `floor`, a relMSE.
pub(super) fn falling(rows: &[Row], floor: f64) -> Vec<&Row> {
    let above = |row: &&Row| row.samples_per_texel > 0.0 && row.relmse > 0.0 && row.relmse >= ABOVE_FLOOR * floor;
    rows.iter().filter(above).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: f64) -> [f32; 4] {
        [value as f32, value as f32, value as f32, 1.0]
    }

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6 * expected.abs().max(1.0), "{found} for {expected}");
    }

    fn at(seconds: f64) -> At {
        At { seconds, rays: 100, samples_per_texel: 64.0 }
    }

    /// Of luminance 1, 2, 4 and 5: the mean is 3, relMSE's floor 0.09.
    const LIGHT: [f64; 4] = [1.0, 2.0, 4.0, 5.0];

    fn reference() -> Reference {
        Reference::new(&LIGHT.map(grey)).expect("texels count")
    }

    /// Each bake is the reference times 1 + share.
    fn row(shares: &[f64]) -> Row {
        let mut sums = Sums::default();
        for share in shares {
            sums.add(&reference(), at(0.5), &LIGHT.map(|light| grey(light * (1.0 + share))));
        }
        sums.row(&reference()).expect("texels count")
    }

    /// Mean of r^2 / (r^2 + floor).
    fn relative() -> f64 {
        LIGHT.iter().map(|light| light * light / (light * light + 0.09)).sum::<f64>() / 4.0
    }

    #[test]
    fn times_double_up_to_the_end() {
        let seconds =
            |end| -> Vec<f64> { times(Duration::from_secs_f64(end)).iter().map(Duration::as_secs_f64).collect() };
        assert_eq!(seconds(1.0), [0.125, 0.25, 0.5, 1.0]);
        assert_eq!(seconds(1.5), [0.125, 0.25, 0.5, 1.0, 1.5]);
        assert_eq!((seconds(0.125), seconds(0.01)), (vec![0.125], vec![0.01]));
        assert_eq!(times(Duration::from_secs(8760 * 3600)).len(), 29);
    }

    #[test]
    fn noise_alone_is_no_bias() {
        let found = row(&[0.1, -0.1]);
        close(found.relmse, 0.01 * relative());
        close(found.rmse, (0.01 * (1.0 + 4.0 + 16.0 + 25.0) / 4.0_f64).sqrt());
        close(found.median, 0.1);
        close(found.p95, 0.1);
        // The mean of the two happens to be right; the variance of one is twice the squared deviation.
        assert_eq!(found.bias, Some(0.0));
        close(found.bias_noise.expect("two bakes"), (0.01 * relative()).sqrt());
        close(found.efficiency.expect("has an error"), 1.0 / (0.5 * found.relmse));
        assert_eq!((found.seconds, found.rays, found.seeds, found.not_finite), (0.5, 100, 2, 0));
    }

    #[test]
    fn what_all_bakes_are_off_by_is_a_bias() {
        let found = row(&[0.25, 0.25, 0.25]);
        close(found.bias.expect("three bakes"), 0.25 * relative().sqrt());
        close(found.bias_noise.expect("three bakes"), 0.0);
        let both = row(&[0.3, 0.2, 0.45, 0.05]);
        let [bias, noise] = [both.bias, both.bias_noise].map(|value| value.expect("four bakes"));
        // Unbiased: sum of squares 0.085 about the mean of 0.25, over 4 * 3.
        close(noise.powi(2), 0.085 / 12.0 * relative());
        close(bias.powi(2), (0.25_f64.powi(2) - 0.085 / 12.0) * relative());
        close(both.relmse, bias.powi(2) + 4.0 * noise.powi(2));
        let alone = row(&[0.25]);
        assert_eq!((alone.bias, alone.bias_noise), (None, None));
    }

    #[test]
    fn quantiles_are_means_over_the_bakes() {
        let mut sums = Sums::default();
        let shares = [[0.0, 0.1, 0.2, 0.3], [0.4, 0.4, 0.4, 0.4]];
        for shares in shares {
            let pixels: Vec<_> = LIGHT.iter().zip(shares).map(|(light, share)| grey(light * (1.0 - share))).collect();
            sums.add(&reference(), at(1.0), &pixels);
        }
        let found = sums.row(&reference()).expect("texels count");
        close(found.median, (0.15 + 0.4) / 2.0);
        close(found.p95, (0.285 + 0.4) / 2.0);
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let mut sums = Sums::default();
        assert!(sums.row(&reference()).is_none());
        let mut pixels = LIGHT.map(|light| grey(light * 1.5));
        pixels[3] = grey(f64::NAN);
        sums.add(&reference(), at(1.0), &pixels);
        let found = sums.row(&reference()).expect("three are left");
        assert_eq!(found.not_finite, 1);
        close(found.median, 0.5);
        close(found.rmse, (0.25 * (1.0 + 4.0 + 16.0) / 3.0_f64).sqrt());
        sums.add(&reference(), at(1.0), &[grey(f64::INFINITY); 4]);
        assert!(sums.row(&reference()).is_none());
        assert_eq!(row(&[0.0, 0.0]).efficiency, None);
    }

    #[test]
    fn a_slope_ends_above_the_floor_and_begins_with_the_samples() {
        let mut rows: Vec<Row> = [0.8, 0.4, 0.2, 0.1].iter().map(|share| row(&[*share, *share])).collect();
        rows[0].samples_per_texel = 0.0;
        let floor = rows[2].relmse / ABOVE_FLOOR;
        let found: Vec<f64> = falling(&rows, floor).iter().map(|row| row.relmse).collect();
        assert_eq!(found, [rows[1].relmse, rows[2].relmse]);
    }
}
