//! Which texels go on taking rays, where a bake ends at an error. Pure: what groups of texels have shown goes in, which of
//! them go on comes out.
//!
//! The error is a mean over texels. To halve it, rays are best spent in proportion to the root of a texel's variance
//! (Neyman's allocation); so those stop first that have converged. Of a group of texels the two fields of a chequerboard
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
/// Bisections of the number of quanta: to a thousandth.
const STEPS: usize = 60;

/// `[group][field]`: whether its texels go on, so that the root of the mean squared relative error comes to `target` with
/// the fewest rays.
pub(crate) fn allocate(groups: &[[Field; 2]], target: f64) -> Vec<[bool; 2]> {
    let fields = || groups.iter().flat_map(|[one, other]| [(one, other), (other, one)]);
    let texels: f64 = fields().map(|(field, _)| f64::from(field.texels)).sum();
    let most = fields().map(|(field, _)| field.quanta).max().unwrap_or(0);
    let floor = FLOOR * f64::from(most);
    let error_at = |scale: f64| {
        let of_field = |(field, other): (&Field, &Field)| {
            let quanta = (scale * deviation(field, other)).max(floor).max(f64::from(field.quanta)).max(1.0);
            f64::from(field.texels) * field.variance() / quanta
        };
        fields().map(of_field).sum::<f64>() / texels.max(1.0)
    };
    // Quanta for each unit of standard deviation.
    let (mut least, mut enough) = (0.0, 1.0);
    for _ in 0..STEPS {
        if error_at(enough) <= target * target {
            break;
        }
        (least, enough) = (enough, enough * 4.0);
    }
    for _ in 0..STEPS {
        let middle = 0.5 * (least + enough);
        if error_at(middle) <= target * target { enough = middle } else { least = middle }
    }
    let goes_on = |field: &Field, other: &Field| {
        field.texels > 0 && f64::from(field.quanta) < (enough * deviation(field, other)).max(floor)
    };
    let decided: Vec<_> = groups.iter().map(|[one, other]| [goes_on(one, other), goes_on(other, one)]).collect();
    if error_at(0.0) <= target * target || decided.iter().any(|fields| fields.contains(&true)) {
        return decided;
    }
    // Neighbours that know of no error leave it to those that do.
    let is_far = |field: &Field| field.error > f64::from(field.texels) * target * target;
    groups.iter().map(|fields| [0, 1].map(|field| is_far(&fields[field]))).collect()
}

/// The standard deviation of a quantum that a field goes by: its neighbour's, or its own where it has none.
fn deviation(field: &Field, other: &Field) -> f64 {
    let decides = if other.texels > 0 { other } else { field };
    decides.variance().max(0.0).sqrt()
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
        let groups = [[field(0.0, 8), field(9.0, 8)], [field(1.0, 8), field(1.0, 8)]];
        assert_eq!(allocate(&groups, 0.4), [[true, false], [true, true]]);
        let alone = [[field(9.0, 8), Field::default()]];
        assert_eq!(allocate(&alone, 0.4), [[true, false]]);
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
