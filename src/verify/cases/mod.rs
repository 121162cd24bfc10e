//! The list of cases, a file for what belongs together.

mod adaptive;
mod choice;
mod extremes;
mod form_factors;
mod furnace;
mod instances;
mod placing;
mod sizes;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 8] = [
    &furnace::CASES,
    &form_factors::CASES,
    &extremes::CASES,
    &placing::CASES,
    &instances::CASES,
    &sizes::CASES,
    &choice::CASES,
    &adaptive::CASES,
];
