//! The list of cases, a file for what belongs together.

mod adaptive;
mod albedo;
mod bare_scenes;
mod charts;
mod choice;
mod closed_meshes;
mod extremes;
mod form_factors;
mod furnace;
mod instances;
mod limits;
mod not_finite;
mod placing;
mod sizes;
mod triangles;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 15] = [
    &furnace::CASES,
    &form_factors::CASES,
    &albedo::CASES,
    &extremes::CASES,
    &not_finite::CASES,
    &triangles::CASES,
    &placing::CASES,
    &instances::CASES,
    &closed_meshes::CASES,
    &charts::CASES,
    &bare_scenes::CASES,
    &limits::CASES,
    &sizes::CASES,
    &choice::CASES,
    &adaptive::CASES,
];
