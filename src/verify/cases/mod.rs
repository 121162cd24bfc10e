//! The list of cases, a file for what belongs together.

mod area;
mod energy;
mod form_factors;
mod furnace;
mod lambert;
mod lights;
mod means;
mod radiosity;
mod shapes;
mod sky;
mod spheres;
mod surfaces;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 12] = [
    &furnace::CASES,
    &spheres::CASES,
    &form_factors::CASES,
    &surfaces::CASES,
    &lambert::CASES,
    &shapes::CASES,
    &lights::CASES,
    &sky::CASES,
    &radiosity::CASES,
    &area::CASES,
    &means::CASES,
    &energy::CASES,
];
