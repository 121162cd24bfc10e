//! How one figure grows with another. Pure.

/// Least-squares slope of ln y over ln x; `None` without two different x. All are more than 0.
pub(crate) fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(x, y), log| (x + log.0 / count, y + log.1 / count));
    let moment = |other: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(|log| (log.0 - x) * other(log)).sum::<f64>();
    let slope = moment(&|log| log.1 - y) / moment(&|log| log.0 - x);
    slope.is_finite().then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_powers() {
        let points = |power: i32| -> Vec<(f64, f64)> {
            [0.125_f64, 0.25, 1.0, 7.0].iter().map(|x| (*x, 3.0 * x.powi(power))).collect()
        };
        for power in [-2, -1, 0, 1] {
            let found = slope(&points(power)).expect("has four");
            assert!((found - f64::from(power)).abs() < 1e-6, "{found} for {power}");
        }
        assert_eq!((slope(&[]), slope(&[(1.0, 2.0)]), slope(&[(1.0, 2.0), (1.0, 3.0)])), (None, None, None));
    }
}
