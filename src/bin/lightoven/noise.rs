//! The noise of bakes that differ in their seeds alone, against a converged light map. Pure.

use crate::compare::{DARK, RELATIVE_MSE_FLOOR, quantile};
use lightoven::io::luminance;
use serde::Serialize;

/// The converged light map, as luminance (Rec. 709), where it counts.
pub(crate) struct Reference {
    /// Texel and luminance.
    counting: Vec<(usize, f64)>,
    /// Over all covered texels.
    mean: f64,
}

impl Reference {
    /// `pixels` is `[texel]`: irradiance, and coverage in A. `None` where no texel counts: covered, finite and of more
    /// than 1 % of the mean.
    pub(crate) fn new(pixels: &[[f32; 4]]) -> Option<Self> {
        let covered = pixels.iter().enumerate().filter(|(_, pixel)| pixel[3] > 0.5);
        let mut counting: Vec<(usize, f64)> =
            covered.map(|(texel, pixel)| (texel, luminance(*pixel))).filter(|(_, value)| value.is_finite()).collect();
        let mean = counting.iter().map(|(_, value)| value).sum::<f64>() / counting.len() as f64;
        counting.retain(|(_, value)| *value > DARK * mean);
        (!counting.is_empty()).then_some(Self { counting, mean })
    }

    /// Texels that count.
    pub(crate) fn texels(&self) -> usize {
        self.counting.len()
    }

    /// Texel and luminance of those that count.
    pub(crate) fn counting(&self) -> &[(usize, f64)] {
        &self.counting
    }

    /// What relMSE adds to a squared luminance.
    pub(crate) fn floor(&self) -> f64 {
        RELATIVE_MSE_FLOOR * self.mean.powi(2)
    }
}

/// What bakes of one kind sum up to, for each texel that counts.
pub(crate) struct Sums<'a> {
    reference: &'a Reference,
    bakes: u32,
    /// Luminance, and its squared difference from the reference.
    texels: Vec<(f64, f64)>,
}

/// How noisy one ray is: all figures are relative to the reference, and scaled by the samples of a bake.
#[derive(Debug, Serialize)]
pub(crate) struct Noise {
    /// Mean of the variance over r^2 + 0.01 mean^2, where r is the reference: relMSE a ray.
    pub(crate) mean_variance: f64,
    /// Median of the standard deviation over r.
    pub(crate) median_sd: f64,
    /// The same: 90 % of the texels are below it.
    pub(crate) p90_sd: f64,
    /// Mean of the bakes over the reference, as sums over the texels.
    pub(crate) energy_ratio: f64,
    /// Texels left out because some bake is not a finite number there.
    pub(crate) not_finite: usize,
}

impl<'a> Sums<'a> {
    pub(crate) fn new(reference: &'a Reference) -> Self {
        Self { reference, bakes: 0, texels: vec![(0.0, 0.0); reference.texels()] }
    }

    /// `pixels` is `[texel]`, as those of the reference.
    pub(crate) fn add(&mut self, pixels: &[[f32; 4]]) {
        for ((texel, expected), sums) in self.reference.counting.iter().zip(&mut self.texels) {
            let found = luminance(pixels[*texel]);
            sums.0 += found;
            sums.1 += (found - expected).powi(2);
        }
        self.bakes += 1;
    }

    /// `None` where no texel is left; each bake had `samples` rays a texel.
    pub(crate) fn noise(&self, samples: f64) -> Option<Noise> {
        let (bakes, floor) = (f64::from(self.bakes), self.reference.floor());
        let values = self.reference.counting.iter().map(|(_, expected)| *expected);
        let finite: Vec<(f64, f64, f64)> = values
            .zip(&self.texels)
            .map(|(expected, (sum, squares))| (expected, sum / bakes, samples * squares / bakes))
            .filter(|(_, mean, variance)| mean.is_finite() && variance.is_finite())
            .collect();
        let mut deviations: Vec<f64> = finite.iter().map(|(r, _, variance)| variance.sqrt() / r).collect();
        deviations.sort_unstable_by(f64::total_cmp);
        let sum = |value: &dyn Fn(&(f64, f64, f64)) -> f64| finite.iter().map(value).sum::<f64>();
        (!finite.is_empty()).then(|| Noise {
            mean_variance: sum(&|(r, _, variance)| variance / (r * r + floor)) / finite.len() as f64,
            median_sd: quantile(&deviations, 0.5),
            p90_sd: quantile(&deviations, 0.9),
            energy_ratio: sum(&|(_, mean, _)| *mean) / sum(&|(r, _, _)| *r),
            not_finite: self.texels.len() - finite.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: f32, alpha: f32) -> [f32; 4] {
        [value, value, value, alpha]
    }

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
    }

    /// A texel that is off by a share of its light, upward and downward in turn, has that deviation.
    #[test]
    fn a_known_noise_has_its_known_variance() {
        let light = [1.0, 2.0, 4.0, 5.0];
        let share = [0.1, 0.2, 0.3, 0.4];
        let reference = Reference::new(&light.map(|value| grey(value, 1.0))).expect("texels count");
        let mut sums = Sums::new(&reference);
        for sign in [1.0, -1.0, -1.0, 1.0] {
            let pixels: Vec<_> = light.iter().zip(share).map(|(r, s)| grey(r * (1.0 + sign * s), 1.0)).collect();
            sums.add(&pixels);
        }
        let noise = sums.noise(100.0).expect("texels count");
        // The mean is 3, the floor 0.09.
        let relative = |r: f64, s: f64| 100.0 * (r * s).powi(2) / (r * r + 0.09);
        let expected = light.iter().zip(share).map(|(r, s)| relative(f64::from(*r), f64::from(s))).sum::<f64>() / 4.0;
        assert!((noise.mean_variance / expected - 1.0).abs() < 1e-5, "{noise:?} for {expected}");
        let deviation = |share: f64| 10.0 * share;
        assert!((noise.median_sd / deviation(0.25) - 1.0).abs() < 1e-5, "{noise:?}");
        assert!((noise.p90_sd / deviation(0.37) - 1.0).abs() < 1e-5, "{noise:?}");
        close(noise.energy_ratio, 1.0);
    }

    /// What is off in all bakes alike is a bias, and shows in the energy.
    #[test]
    fn a_bias_shows_in_the_energy() {
        let reference = Reference::new(&[grey(1.0, 1.0), grey(3.0, 1.0)]).expect("texels count");
        let mut sums = Sums::new(&reference);
        (0..3).for_each(|_| sums.add(&[grey(1.5, 1.0), grey(3.0, 1.0)]));
        let noise = sums.noise(64.0).expect("texels count");
        close(noise.energy_ratio, 4.5 / 4.0);
        close(noise.median_sd, 0.5 * 8.0 * 0.5);
    }

    #[test]
    fn only_covered_lit_and_finite_texels_count() {
        let pixels = [grey(1.0, 1.0), grey(0.001, 1.0), grey(9.0, 0.0), grey(f32::NAN, 1.0), grey(2.0, 1.0)];
        let reference = Reference::new(&pixels).expect("texels count");
        assert_eq!(reference.texels(), 2);
        let mut sums = Sums::new(&reference);
        sums.add(&[grey(1.5, 1.0), grey(7.0, 1.0), grey(7.0, 1.0), grey(7.0, 1.0), grey(f32::INFINITY, 1.0)]);
        let noise = sums.noise(1.0).expect("a texel is left");
        assert_eq!(noise.not_finite, 1);
        close(noise.median_sd, 0.5);
        close(noise.energy_ratio, 1.5);
        sums.add(&[grey(f32::NAN, 1.0); 5]);
        assert!(sums.noise(1.0).is_none());
        assert!(Reference::new(&[grey(0.0, 1.0), grey(1.0, 0.0)]).is_none() && Reference::new(&[]).is_none());
    }
}
