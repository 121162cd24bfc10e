//! What a case found, and what it should have found.

use super::estimate::Estimate;
use crate::error::{ErrorKind, Result};

/// The rows of a case, as it goes along.
#[derive(Debug, Default)]
pub struct Checks {
    pub(super) rows: Vec<Row>,
    pub(super) skipped: Option<String>,
}

/// A figure and what it should be.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Which figure.
    pub what: String,
    /// What it should be, or its limit.
    pub expected: f64,
    /// What it is.
    pub measured: f64,
    /// How the two are to lie.
    pub comparison: Comparison,
    /// Whether they do.
    pub passes: bool,
}

/// How a measured figure is to lie to the expected one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Comparison {
    /// Within four standard errors and `tolerance`; four standard errors must be at most `resolution`, for an estimate that
    /// tells nothing does not pass.
    Estimate {
        /// Of the measured figure.
        standard_error: f64,
        /// What the case allows beside noise.
        tolerance: f64,
        /// What four standard errors may be.
        resolution: f64,
    },
    /// At most this far apart.
    Within(f64),
    /// At most this share of the expected one apart.
    Relative(f64),
    /// Not above it.
    AtMost,
    /// Not below it.
    AtLeast,
    /// A statement: 1 is true.
    Holds,
}

impl Checks {
    /// The case has no meaning on this device.
    pub(super) fn skip(&mut self, reason: impl Into<String>) {
        self.skipped = Some(reason.into());
    }

    /// Within 4 standard errors and `tolerance`, which is what the case allows beside noise, and well enough known: 4 standard
    /// errors are at most `resolution`.
    pub(super) fn estimate(
        &mut self,
        what: impl Into<String>,
        estimate: Estimate,
        expected: f64,
        tolerance: f64,
        resolution: f64,
    ) {
        let Estimate { mean, standard_error } = estimate;
        self.push(what, mean, expected, Comparison::Estimate { standard_error, tolerance, resolution });
    }

    /// At most `bound` apart.
    pub(super) fn within(&mut self, what: impl Into<String>, measured: f64, expected: f64, bound: f64) {
        self.push(what, measured, expected, Comparison::Within(bound));
    }

    /// At most the share `bound` of `expected` apart.
    pub(super) fn relative(&mut self, what: impl Into<String>, measured: f64, expected: f64, bound: f64) {
        self.push(what, measured, expected, Comparison::Relative(bound));
    }

    pub(super) fn at_most(&mut self, what: impl Into<String>, measured: f64, limit: f64) {
        self.push(what, measured, limit, Comparison::AtMost);
    }

    pub(super) fn at_least(&mut self, what: impl Into<String>, measured: f64, limit: f64) {
        self.push(what, measured, limit, Comparison::AtLeast);
    }

    /// Exactly so many.
    pub(super) fn count(&mut self, what: impl Into<String>, measured: u64, expected: u64) {
        self.within(what, measured as f64, expected as f64, 0.0);
    }

    pub(super) fn holds(&mut self, what: impl Into<String>, is_so: bool) {
        self.push(what, f64::from(u8::from(is_so)), 1.0, Comparison::Holds);
    }

    /// It must be an error of this kind, whose message has all of `words`.
    pub(super) fn refused<T>(&mut self, what: impl Into<String>, result: &Result<T>, kind: ErrorKind, words: &[&str]) {
        let says = |text: &str| words.iter().all(|word| text.contains(word));
        let is_so = result.as_ref().is_err_and(|error| error.kind() == kind && says(&error.to_string()));
        let what = match result {
            Err(error) if !is_so => format!("{}: refused by name, but it is {:?}: {error}", what.into(), error.kind()),
            _ => format!("{}: refused by name", what.into()),
        };
        self.holds(what, is_so);
    }

    fn push(&mut self, what: impl Into<String>, measured: f64, expected: f64, comparison: Comparison) {
        let passes = comparison.admits(measured, expected);
        self.rows.push(Row { what: what.into(), expected, measured, comparison, passes });
    }
}

impl Comparison {
    /// What is not a number is never admitted.
    fn admits(self, measured: f64, expected: f64) -> bool {
        let apart = (measured - expected).abs();
        match self {
            Self::Estimate { standard_error, tolerance, resolution } => {
                4.0 * standard_error <= resolution && apart <= 4.0 * standard_error + tolerance
            }
            Self::Within(bound) => apart <= bound,
            Self::Relative(bound) => apart <= bound * expected.abs(),
            Self::AtMost => measured <= expected,
            Self::AtLeast => measured >= expected,
            Self::Holds => measured == 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_or_tells_nothing_fails() {
        let estimate = |standard_error| Comparison::Estimate { standard_error, tolerance: 0.1, resolution: 1.0 };
        assert!(estimate(0.1).admits(1.5, 1.0) && !estimate(0.1).admits(1.51, 1.0));
        assert!(!estimate(0.3).admits(1.0, 1.0) && !estimate(f64::NAN).admits(1.0, 1.0));
        assert!(Comparison::Within(0.5).admits(1.5, 1.0) && !Comparison::Within(0.5).admits(0.49, 1.0));
        assert!(Comparison::Relative(0.1).admits(-9.0, -10.0) && !Comparison::Relative(0.1).admits(-8.9, -10.0));
        assert!(Comparison::AtMost.admits(1.0, 1.0) && !Comparison::AtMost.admits(1.1, 1.0));
        assert!(Comparison::AtLeast.admits(1.0, 1.0) && !Comparison::AtLeast.admits(0.9, 1.0));
        let all = [Comparison::Within(9.0), Comparison::Relative(9.0), Comparison::AtMost, Comparison::AtLeast];
        assert!(all.into_iter().all(|comparison| !comparison.admits(f64::NAN, 1.0)));
    }
}
