//! Which texels go on taking rays, where a bake ends at an error. Pure: what groups of texels have shown goes in, which of
//! them go on comes out.
//!
//! The error is a mean over texels. To halve it, rays are best spent in proportion to the root of a texel's variance
//! (Neyman's allocation); so those stop first that have converged. Of a group of texels the two fields, whose rows take turns,
//! decide for each other: a texel that stopped because its own samples happened to be alike would be biased.

/// One field of a group of texels.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Field {
    pub(crate) texels: u32,
    /// Sum over its texels of the squared relative error, as the half buffers tell it.
    pub(crate) error: f64,
    /// Quanta that each of its texels has.
    pub(crate) quanta: u32,
}

impl Field {
    /// Of a quantum, mean over the field's texels.
    fn variance(&self) -> f64 {
        if self.texels == 0 { 0.0 } else { self.error / f64::from(self.texels) * f64::from(self.quanta) }
    }
}

/// A field has at least this share of the quanta of the one that has most: what a group has not yet found it may find.
const FLOOR: f64 = 0.125;
/// And no field counts as one of less than this share of the mean variance.
const LEAST_VARIANCE: f64 = 0.01;
/// Steps of a factor 4 up to enough quanta, and halvings of the last one: to a thousandth.
const STEPS: usize = 32;
const HALVINGS: usize = 12;

/// What decides about a field.
struct Need {
    /// Its texels times the variance of a quantum.
    variance: f64,
    /// Standard deviation that its quanta are in proportion to.
    deviation: f64,
    quanta: f64,
}

/// `[group][field]`: whether its texels go on, so that the root of the mean squared relative error comes to `target` with
/// the fewest rays.
pub(crate) fn allocate(groups: &[[Field; 2]], target: f64) -> Vec<[bool; 2]> {
    let fields = || groups.iter().flatten();
    let texels = fields().map(|field| f64::from(field.texels)).sum::<f64>().max(1.0);
    let mean = fields().map(|field| f64::from(field.texels) * field.variance()).sum::<f64>() / texels;
    if !mean.is_finite() {
        return vec![[true; 2]; groups.len()];
    }
    let most = fields().map(|field| field.quanta).max().unwrap_or(0);
    let floor = FLOOR * f64::from(most);
    let need = |field: &Field, other: &Field| Need {
        variance: f64::from(field.texels) * field.variance(),
        deviation: deciding_variance(field, other).max(LEAST_VARIANCE * mean).sqrt(),
        quanta: f64::from(field.quanta).max(1.0),
    };
    let needs: Vec<[Need; 2]> = groups.iter().map(|[one, other]| [need(one, other), need(other, one)]).collect();
    let allowed = target * target * texels;
    let is_enough = |scale: f64| {
        let error = |need: &Need| need.variance / (scale * need.deviation).max(floor).max(need.quanta);
        needs.iter().flatten().map(error).sum::<f64>() <= allowed
    };
    // Quanta for each unit of standard deviation.
    let (mut least, mut enough) = (0.0, 1.0);
    for _ in 0..STEPS {
        if is_enough(enough) {
            break;
        }
        (least, enough) = (enough, enough * 4.0);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (least + enough);
        if is_enough(middle) { enough = middle } else { least = middle }
    }
    let enough = if is_enough(0.0) { 0.0 } else { enough };
    let goes_on =
        |field: &Field, need: &Need| field.texels > 0 && f64::from(field.quanta) < (enough * need.deviation).max(floor);
    groups.iter().zip(&needs).map(|(fields, needs)| [0, 1].map(|of| goes_on(&fields[of], &needs[of]))).collect()
}

/// The variance that a field goes by: its neighbour's, or its own where that has none to tell.
fn deciding_variance(field: &Field, other: &Field) -> f64 {
    let neighbours = other.variance();
    if neighbours > 0.0 { neighbours } else { field.variance() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn field(variance: f64, quanta: u32) -> Field {
        Field { texels: 32, error: 32.0 * variance / f64::from(quanta), quanta }
    }

    /// Goes on until nobody does; returns the quanta and the error that are then there.
    fn run(variances: &[f64], target: f64) -> (Vec<u32>, f64) {
        let mut quanta = vec![8; variances.len()];
        loop {
            let groups: Vec<_> =
                variances.iter().zip(&quanta).map(|(variance, quanta)| [field(*variance, *quanta); 2]).collect();
            let goes_on = allocate(&groups, target);
            if goes_on.iter().all(|fields| *fields == [false; 2]) {
                let errors = groups.iter().map(|[one, _]| one.error / 32.0).sum::<f64>();
                return (quanta, (errors / variances.len() as f64).sqrt());
            }
            quanta.iter_mut().zip(goes_on).for_each(|(quanta, [goes_on, _])| *quanta += u32::from(goes_on));
        }
    }

    #[test]
    fn the_target_is_reached_with_the_fewest_rays() {
        let variances = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 25.0];
        let (quanta, error) = run(&variances, 0.2);
        assert!(error <= 0.2 && error > 0.19, "{error}");
        // In proportion to 1 and 5: 12 / 8 / .04 = 37.5 and 187.5 would do, but quanta are whole; evenly it takes 32 / 8 /
        // .04 = 100 each.
        assert!(quanta[..7].iter().all(|quanta| (37..=39).contains(quanta)), "{quanta:?}");
        assert!((184..=190).contains(&quanta[7]), "{quanta:?}");
    }

    #[test]
    fn none_starves() {
        let (quanta, _) = run(&[0.0, 4.0], 0.1);
        assert!(f64::from(quanta[0]) >= FLOOR * f64::from(quanta[1]), "{quanta:?}");
    }

    #[test]
    fn a_field_goes_by_its_neighbour() {
        // The one that has converged goes on for its neighbour, which stops for it.
        let groups = [[field(0.25, 20), field(9.0, 20)], [field(1.0, 20), field(1.0, 20)]];
        assert_eq!(allocate(&groups, (0.55_f64 / 4.0).sqrt()), [[true, false], [true, true]]);
        let unknown = [[field(0.0, 8), field(9.0, 8)], [field(1.0, 8), field(1.0, 8)]];
        assert_eq!(allocate(&unknown, 0.4)[0], [true, true]);
        let alone = [[field(9.0, 8), Field::default()]];
        assert_eq!(allocate(&alone, 0.4), [[true, false]]);
    }

    #[test]
    fn what_is_no_number_stops_nobody() {
        for error in [f64::NAN, f64::INFINITY] {
            let groups = [[Field { texels: 1, error, quanta: 8 }, field(1.0, 8)]];
            assert_eq!(allocate(&groups, 0.1), [[true; 2]]);
        }
    }

    proptest! {
        /// As long as the error is too large somebody goes on, and nobody where nothing is known to be wrong.
        #[test]
        fn it_ends_at_the_target_and_not_before(
            errors in prop::collection::vec((0_u32..33, 0.0..1e6_f64, 1_u32..1000), 2..40), target in 1e-6..10.0,
        ) {
            let fields: Vec<Field> =
                errors.iter().map(|(texels, error, quanta)| Field { texels: *texels, error: *error, quanta: *quanta }).collect();
            let groups: Vec<[Field; 2]> = fields.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
            let goes_on = allocate(&groups, target);
            prop_assert_eq!(goes_on.len(), groups.len());
            let any = goes_on.iter().flatten().any(|goes_on| *goes_on);
            let seen: Vec<&Field> = groups.iter().flatten().filter(|field| field.texels > 0).collect();
            let texels: f64 = seen.iter().map(|field| f64::from(field.texels)).sum();
            let error = seen.iter().map(|field| field.error).sum::<f64>() / texels.max(1.0);
            prop_assert!(any || error <= target * target * 1.001, "{} is over {}", error.sqrt(), target);
        }
    }
}
