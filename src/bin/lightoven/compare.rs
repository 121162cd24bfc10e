//! `lightoven compare`: how far a light map is from a reference.

use crate::arguments::Compare;
use crate::paths;
use crate::report::write_json;
use crate::{Ending, messages};
use lightoven::io::{exr, luminance};
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;

/// Texels of B with less of its mean luminance than this do not count: a relative difference says nothing there.
pub(crate) const DARK: f64 = 0.01;

/// Share of the mean luminance, squared, that relMSE adds to its denominator, so that dark texels do not decide it.
pub(crate) const RELATIVE_MSE_FLOOR: f64 = 0.01;

/// Where one range of brightness ends and the next begins, in means of B: decades, so that a few texels at a lamp's edge
/// can neither hide nor fake an agreement of all the others.
const BRIGHTNESS: [f64; 4] = [DARK, 0.1, 1.0, 10.0];

/// Reads both, compares, says how they differ.
pub(crate) fn run(arguments: &Compare) -> Result<Ending> {
    let inputs = [("the first light map", Some(&arguments.a)), ("the second one", Some(&arguments.b))];
    paths::check(&inputs, &[("--report", arguments.report.as_ref())])?;
    let (width, height, a) = exr::read_image(&arguments.a)?;
    let (b_width, b_height, b) = exr::read_image(&arguments.b)?;
    let (a_name, b_name) = (arguments.a.display(), arguments.b.display());
    if (width, height) != (b_width, b_height) {
        return Err(Error::new(
            ErrorKind::InvalidScene,
            format!("'{a_name}' is {width} x {height} and '{b_name}' is {b_width} x {b_height}; allowed is one size"),
        ));
    }
    let Some(difference) = Difference::new(&a, &b, arguments.scale_b, width) else {
        let why = "no texel has A > 0.5 in both and, in the second, more than 1 % of its mean luminance";
        return Err(Error::new(ErrorKind::InvalidScene, format!("cannot compare '{a_name}' with '{b_name}': {why}")));
    };
    messages::stdout(&difference.text())?;
    if let Some(path) = &arguments.report {
        let (a, b) = (arguments.a.to_string_lossy().into_owned(), arguments.b.to_string_lossy().into_owned());
        write_json(path, &Report { a, b, scale_b: arguments.scale_b, difference })?;
    }
    Ok(Ending::Done)
}

#[derive(Serialize)]
struct Report {
    a: String,
    b: String,
    scale_b: f64,
    #[serde(flatten)]
    difference: Difference,
}

/// How the luminance of A differs from that of B, over the texels that count.
#[derive(Debug, Serialize)]
struct Difference {
    /// Texels that count.
    texels: usize,
    /// Covered texels left out because one of the two is not a finite number.
    not_finite: usize,
    /// Sum of A over sum of B.
    energy_ratio: f64,
    /// Of |a - b| / b.
    median_relative_difference: f64,
    /// Of |a - b| / b: 95 % of the texels are below it.
    p95_relative_difference: f64,
    /// Square root of the mean of (a - b)^2.
    rmse: f64,
    /// Mean of (a - b)^2 / (b^2 + 0.01 mean^2), where mean is that of B over the covered texels.
    rel_mse: f64,
    /// Largest |a - b|.
    largest_difference: f64,
    /// Column and row of it.
    largest_at: [usize; 2],
    /// Mean of B over the covered texels.
    mean_b: f64,
    /// The texels that count, by how bright they are in B.
    by_brightness: Vec<Brightness>,
}

/// How A differs from B over texels of like brightness. A noisy B sorts its own outliers into the brightest.
#[derive(Debug, Serialize)]
struct Brightness {
    /// Least luminance of B, as a multiple of `mean_b`.
    from: f64,
    /// The luminance that it stays below, likewise; none for the brightest.
    to: Option<f64>,
    /// Texels in between.
    texels: usize,
    /// Sum of A over sum of B; none without texels.
    energy_ratio: Option<f64>,
    /// Median of a / b; none without texels.
    median_ratio: Option<f64>,
}

impl Difference {
    /// `None` where no texel counts. Both are `[texel]`, row-major, of the same length; B is multiplied by `scale_b`.
    fn new(a: &[[f32; 4]], b: &[[f32; 4]], scale_b: f64, width: u32) -> Option<Self> {
        let covered = a.iter().zip(b).enumerate().filter(|(_, (a, b))| a[3] > 0.5 && b[3] > 0.5);
        let pairs: Vec<(usize, f64, f64)> =
            covered.map(|(texel, (a, b))| (texel, luminance(*a), luminance(*b) * scale_b)).collect();
        let (mut counting, broken): (Vec<_>, Vec<_>) =
            pairs.into_iter().partition(|(_, a, b)| a.is_finite() && b.is_finite());
        let mean = counting.iter().map(|(_, _, b)| b).sum::<f64>() / counting.len() as f64;
        counting.retain(|(_, _, b)| *b > DARK * mean);
        let count = counting.len() as f64;
        let floor = RELATIVE_MSE_FLOOR * mean * mean;
        let mean_of =
            |value: &dyn Fn(f64, f64) -> f64| counting.iter().map(|(_, a, b)| value(*a, *b)).sum::<f64>() / count;
        let mut relative: Vec<f64> = counting.iter().map(|(_, a, b)| (a - b).abs() / b).collect();
        relative.sort_unstable_by(f64::total_cmp);
        let (texel, largest) = counting
            .iter()
            .map(|(texel, a, b)| (*texel, (a - b).abs()))
            .max_by(|one, other| one.1.total_cmp(&other.1))?;
        Some(Self {
            texels: counting.len(),
            not_finite: broken.len(),
            energy_ratio: mean_of(&|a, _| a) / mean_of(&|_, b| b),
            median_relative_difference: quantile(&relative, 0.5),
            p95_relative_difference: quantile(&relative, 0.95),
            rmse: mean_of(&|a, b| (a - b).powi(2)).sqrt(),
            rel_mse: mean_of(&|a, b| (a - b).powi(2) / (b * b + floor)),
            largest_difference: largest,
            largest_at: [texel % width as usize, texel / width as usize],
            mean_b: mean,
            by_brightness: Brightness::table(&counting, mean),
        })
    }

    fn text(&self) -> String {
        let percent = |value: f64| 100.0 * value;
        let [x, y] = self.largest_at;
        let mut lines = vec![
            format!("texels                      {}", self.texels),
            format!("energy ratio                {:.5}", self.energy_ratio),
            format!("median relative difference  {:.3} %", percent(self.median_relative_difference)),
            format!("95th percentile             {:.3} %", percent(self.p95_relative_difference)),
            format!("RMSE                        {:.6e}", self.rmse),
            format!("relMSE                      {:.6e}", self.rel_mse),
            format!("largest difference          {:.6e} at column {x}, row {y}", self.largest_difference),
        ];
        if self.not_finite > 0 {
            lines.push(format!("not finite, left out        {}", self.not_finite));
        }
        lines.push(format!("by brightness of B, in means of {:.6e}", self.mean_b));
        lines.push("    from       to   texels  energy ratio  median ratio".into());
        lines.extend(self.by_brightness.iter().map(Brightness::line));
        lines.push(String::new());
        lines.join("\n")
    }
}

impl Brightness {
    /// The texels that count, as position, a and b; `mean` is that of B.
    fn table(counting: &[(usize, f64, f64)], mean: f64) -> Vec<Self> {
        let ends = BRIGHTNESS.iter().skip(1).copied().map(Some).chain([None]);
        BRIGHTNESS.into_iter().zip(ends).map(|(from, to)| Self::new(counting, mean, from, to)).collect()
    }

    fn new(counting: &[(usize, f64, f64)], mean: f64, from: f64, to: Option<f64>) -> Self {
        let within = |b: f64| b >= from * mean && to.is_none_or(|to| b < to * mean);
        let pairs = || counting.iter().filter(|(_, _, b)| within(*b)).map(|(_, a, b)| (*a, *b));
        let (sum_a, sum_b) = pairs().fold((0.0, 0.0), |sum, (a, b)| (sum.0 + a, sum.1 + b));
        let mut ratios: Vec<f64> = pairs().map(|(a, b)| a / b).collect();
        ratios.sort_unstable_by(f64::total_cmp);
        let texels = ratios.len();
        Self {
            from,
            to,
            texels,
            energy_ratio: (texels > 0).then(|| sum_a / sum_b),
            median_ratio: (texels > 0).then(|| quantile(&ratios, 0.5)),
        }
    }

    fn line(&self) -> String {
        let ratio = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.5}"));
        let to = self.to.map_or("-".into(), |to| to.to_string());
        let (energy, median) = (ratio(self.energy_ratio), ratio(self.median_ratio));
        format!("{:>8} {to:>8} {:>8} {energy:>13} {median:>13}", self.from, self.texels)
    }
}

/// Of sorted values, linear between them; at least one.
pub(crate) fn quantile(sorted: &[f64], share: f64) -> f64 {
    let position = share * (sorted.len() - 1) as f64;
    let (below, above) = (position.floor() as usize, position.ceil() as usize);
    sorted[below] + (sorted[above] - sorted[below]) * position.fract()
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

    #[test]
    fn figures_are_those_of_the_texels_that_count() {
        // Counts: the first three. Then dark, uncovered in either, not finite.
        let b = [
            grey(1.0, 1.0),
            grey(2.0, 1.0),
            grey(1.0, 1.0),
            grey(0.001, 1.0),
            grey(9.0, 0.0),
            grey(9.0, 1.0),
            grey(1.0, 1.0),
        ];
        let a = [
            grey(2.2, 1.0),
            grey(4.0, 1.0),
            grey(1.0, 1.0),
            grey(5.0, 1.0),
            grey(9.0, 1.0),
            grey(9.0, 0.0),
            grey(f32::NAN, 1.0),
        ];
        let found = Difference::new(&a, &b, 2.0, 4).expect("texels count");
        assert_eq!((found.texels, found.not_finite, found.largest_at), (3, 1, [2, 0]));
        close(found.energy_ratio, 7.2 / 8.0);
        close(found.median_relative_difference, 0.1);
        close(found.p95_relative_difference, 0.1 + 0.9 * 0.4);
        close(found.rmse, ((0.04_f64 + 1.0) / 3.0).sqrt());
        let mean = (2.0 + 4.0 + 2.0 + 0.002) / 4.0;
        let floor = 0.01 * mean * mean;
        close(found.rel_mse, (0.04 / (4.0 + floor) + 1.0 / (4.0 + floor)) / 3.0);
        close(found.largest_difference, 1.0);
    }

    #[test]
    fn texels_are_told_apart_by_brightness() {
        // The mean is 5; the first and the last three do not count.
        let b = [0.02, 0.1, 0.45, 0.6, 0.6, 1.0, 55.0, 0.0, 0.0, -7.77].map(|b| grey(b, 1.0));
        let a = [9.0, 0.2, 0.45, 1.2, 1.8, 1.0, 44.0, 1.0, 1.0, 1.0].map(|a| grey(a, 1.0));
        let found = Difference::new(&a, &b, 1.0, 5).expect("texels count");
        close(found.mean_b, 5.0);
        let ranges: Vec<_> = found.by_brightness.iter().map(|range| (range.from, range.to, range.texels)).collect();
        assert_eq!(ranges, [(0.01, Some(0.1), 2), (0.1, Some(1.0), 3), (1.0, Some(10.0), 0), (10.0, None, 1)]);
        let ratios = |range: usize| {
            let Brightness { energy_ratio, median_ratio, .. } = found.by_brightness[range];
            energy_ratio.zip(median_ratio)
        };
        for (range, energy, median) in [(0, 0.65 / 0.55, 1.5), (1, 4.0 / 2.2, 2.0), (3, 0.8, 0.8)] {
            let (found_energy, found_median) = ratios(range).expect("has texels");
            close(found_energy, energy);
            close(found_median, median);
        }
        assert_eq!(ratios(2), None);
        assert_eq!(found.by_brightness.iter().map(|range| range.texels).sum::<usize>(), found.texels);
    }

    #[test]
    fn nothing_that_counts_is_no_comparison() {
        assert!(Difference::new(&[grey(1.0, 1.0)], &[grey(0.0, 1.0)], 1.0, 1).is_none());
        assert!(Difference::new(&[], &[], 1.0, 1).is_none());
    }
}
