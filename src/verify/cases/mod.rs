//! The list of cases, a file for what belongs together.

mod form_factors;
mod furnace;
mod long_runs;
mod runtime;
mod schedule;
mod settling;
mod slices;
mod temporal;
mod traversal;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 9] = [
    &furnace::CASES,
    &form_factors::CASES,
    &temporal::CASES,
    &settling::CASES,
    &traversal::CASES,
    &slices::CASES,
    &long_runs::CASES,
    &schedule::CASES,
    &runtime::CASES,
];
