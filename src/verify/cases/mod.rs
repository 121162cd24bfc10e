//! The list of cases, a file for what belongs together.

mod form_factors;
mod furnace;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 2] = [&furnace::CASES, &form_factors::CASES];
