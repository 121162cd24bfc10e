//! Times as figures: rays a second, ratios, and whether all found the same. Pure.

use crate::compare::quantile;
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;

/// Something of each that traces.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(crate) struct Each<T> {
    pub(crate) software: T,
    pub(crate) ray_query: T,
    pub(crate) cpu: T,
}

impl<T> Each<T> {
    pub(crate) fn map<U>(self, mut f: impl FnMut(T) -> U) -> Each<U> {
        Each { software: f(self.software), ray_query: f(self.ray_query), cpu: f(self.cpu) }
    }

    pub(crate) fn as_ref(&self) -> Each<&T> {
        Each { software: &self.software, ray_query: &self.ray_query, cpu: &self.cpu }
    }
}

/// Seconds that each took, in every round.
pub(crate) type Rounds = Vec<Each<Option<f64>>>;

/// What rounds gave.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Spread {
    pub(crate) least: f64,
    pub(crate) median: f64,
    pub(crate) most: f64,
}

impl Spread {
    /// `None` without values.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let (least, most) = (*sorted.first()?, *sorted.last()?);
        Some(Self { least, median: quantile(&sorted, 0.5), most })
    }
}

/// Million rays a second of each, and how many times the others' the software back end's are, round by round.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Speeds {
    #[serde(flatten)]
    pub(crate) mrays_per_s: Each<Option<Spread>>,
    pub(crate) software_to_cpu: Option<Spread>,
    pub(crate) software_to_ray_query: Option<Spread>,
}

impl Speeds {
    pub(crate) fn new(rays: usize, rounds: &Rounds) -> Self {
        let millions = rays as f64 * 1e-6;
        let speeds = |of: fn(&Each<Option<f64>>) -> Option<f64>| {
            Spread::of(rounds.iter().filter_map(of).map(|seconds| millions / seconds.max(1e-9)))
        };
        let ratio = |of: fn(&Each<Option<f64>>) -> Option<f64>| {
            Spread::of(rounds.iter().filter_map(|round| Some(of(round)? / round.software?.max(1e-9))))
        };
        Self {
            mrays_per_s: Each {
                software: speeds(|round| round.software),
                ray_query: speeds(|round| round.ray_query),
                cpu: speeds(|round| round.cpu),
            },
            software_to_cpu: ratio(|round| round.cpu),
            software_to_ray_query: ratio(|round| round.ray_query),
        }
    }

    pub(crate) fn medians(&self) -> Each<Option<f64>> {
        self.mrays_per_s.map(|spread| spread.map(|spread| spread.median))
    }
}

/// What one found, `[ray]`: how far to the closest hit, infinite for a miss, and whether there is any.
pub(crate) struct Found {
    pub(crate) closest: Vec<f32>,
    pub(crate) occluded: Vec<bool>,
}

/// Whether all found the same.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Agreement {
    /// Share of the rays that hit something.
    pub(crate) hits: Each<Option<f64>>,
    /// Mean over the hits, scene units.
    pub(crate) mean_distance: Each<Option<f64>>,
    /// Share of the rays whose answers to the two queries are not those of the first.
    pub(crate) differing: Each<Option<f64>>,
}

/// More than this share of rays with other answers, and it was not the same work.
const MOST_DIFFERING: f64 = 1e-4;
/// Distances may differ by this share of themselves and of the scene: obvhs's test of triangles is less exact.
const TOLERANCE: f64 = 1e-4;

impl Agreement {
    /// `extent`: of the scene.
    ///
    /// # Errors
    /// `Driver`, naming who differs, where more than a ten-thousandth of the rays has other answers.
    pub(crate) fn new(found: &Each<Option<Found>>, extent: f64) -> Result<Self> {
        let reference = found.software.as_ref().or(found.ray_query.as_ref());
        let each = |of: &dyn Fn(&Found) -> f64| found.as_ref().map(|found| found.as_ref().map(of));
        let agreement = Self {
            hits: each(&|found| distances(found).count() as f64 / found.closest.len().max(1) as f64),
            mean_distance: each(&|found| distances(found).sum::<f64>() / distances(found).count().max(1) as f64),
            differing: each(&|found| reference.map_or(0.0, |reference| differing(found, reference, extent))),
        };
        let Each { software, ray_query, cpu } = agreement.differing;
        for (who, share) in [("software", software), ("ray-query", ray_query), ("obvhs", cpu)] {
            if let Some(share) = share.filter(|share| *share > MOST_DIFFERING) {
                let percent = 100.0 * share;
                let context =
                    format!("{percent:.3} % of the rays have other answers by {who}: their speeds say nothing");
                return Err(Error::new(ErrorKind::Driver, context));
            }
        }
        Ok(agreement)
    }
}

fn distances(found: &Found) -> impl Iterator<Item = f64> {
    found.closest.iter().filter(|distance| distance.is_finite()).map(|distance| f64::from(*distance))
}

fn differing(found: &Found, reference: &Found, extent: f64) -> f64 {
    let far = |(a, b): (&f32, &f32)| {
        let (a, b) = (f64::from(*a), f64::from(*b));
        a != b && !((a - b).abs() <= TOLERANCE * (b + extent))
    };
    let closest = found.closest.iter().zip(&reference.closest).map(far);
    let occluded = found.occluded.iter().zip(&reference.occluded).map(|(a, b)| a != b);
    let count = closest.zip(occluded).filter(|(closest, occluded)| *closest || *occluded).count();
    count as f64 / found.closest.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round(software: f64, ray_query: f64, cpu: f64) -> Each<Option<f64>> {
        Each { software: Some(software), ray_query: Some(ray_query), cpu: Some(cpu) }
    }

    /// The machine may slow down for a while: a ratio is taken within each round.
    #[test]
    fn ratios_are_those_of_rounds() {
        let speeds = Speeds::new(2_000_000, &vec![round(1.0, 8.0, 0.5), round(4.0, 28.0, 2.4), round(1.0, 9.0, 0.7)]);
        let cpu = speeds.software_to_cpu.expect("is there");
        assert_eq!((cpu.least, cpu.median, cpu.most), (0.5, 0.6, 0.7));
        assert_eq!(speeds.software_to_ray_query.map(|ratio| ratio.median), Some(8.0));
        assert_eq!(speeds.medians().software, Some(2.0));
    }

    #[test]
    fn what_is_absent_has_no_figures() {
        let speeds = Speeds::new(1, &vec![Each { software: Some(1.0), ..Each::default() }]);
        assert_eq!((speeds.software_to_cpu, speeds.medians().cpu), (None, None));
        assert!(Speeds::new(1, &Vec::new()).medians().software.is_none());
    }

    fn found(closest: &[f32]) -> Option<Found> {
        let occluded = closest.iter().map(|distance| distance.is_finite()).collect();
        Some(Found { closest: closest.to_vec(), occluded })
    }

    #[test]
    fn other_answers_are_an_error() {
        let all =
            |cpu: [f32; 3]| Each { software: found(&[1.0, 3.0, f32::INFINITY]), ray_query: None, cpu: found(&cpu) };
        let same = Agreement::new(&all([1.0, 3.0001, f32::INFINITY]), 1.0).expect("agrees");
        assert_eq!(
            (same.hits.cpu, same.mean_distance.software, same.differing.cpu),
            (Some(2.0 / 3.0), Some(2.0), Some(0.0))
        );
        for other in [[1.0, 3.1, f32::INFINITY], [1.0, 3.0, 5.0], [f32::INFINITY, 3.0, f32::INFINITY]] {
            let error = Agreement::new(&all(other), 1.0).expect_err("differs");
            assert!(error.to_string().contains("obvhs"), "{error}");
        }
    }
}
