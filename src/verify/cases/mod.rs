//! The list of cases, a file for what belongs together.

mod adaptive;
mod albedo;
mod area;
mod bare_scenes;
mod charts;
mod choice;
mod closed_meshes;
mod energy;
mod extremes;
mod form_factors;
mod furnace;
mod instances;
mod lambert;
mod lights;
mod limits;
mod means;
mod not_finite;
mod placing;
mod radiosity;
mod shapes;
mod sizes;
mod sky;
mod spheres;
mod surfaces;
mod triangles;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 25] = [
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
