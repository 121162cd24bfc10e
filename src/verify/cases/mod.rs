//! The list of cases, a file for what belongs together.

mod adaptive;
mod albedo;
mod area;
mod bare_scenes;
mod charts;
mod choice;
mod closed_meshes;
mod colours;
mod energy;
mod extremes;
mod form_factors;
mod frame_noise;
mod furnace;
mod instances;
mod lambert;
mod lights;
mod limits;
mod long_runs;
mod means;
mod not_finite;
mod placing;
mod radiosity;
mod runtime;
mod schedule;
mod settling;
mod shapes;
mod sizes;
mod sky;
mod slices;
mod spheres;
mod surfaces;
mod temporal;
mod traversal;
mod triangles;

use super::{Case, Checks};

/// In the order of the table.
pub(super) const GROUPS: [&[Case]; 34] = [
    &furnace::CASES,
    &colours::CASES,
    &spheres::CASES,
    &form_factors::CASES,
    &surfaces::CASES,
    &lambert::CASES,
    &shapes::CASES,
    &lights::CASES,
    &sky::CASES,
    &radiosity::CASES,
    &temporal::CASES,
    &frame_noise::CASES,
    &settling::CASES,
    &area::CASES,
    &traversal::CASES,
    &slices::CASES,
    &means::CASES,
    &energy::CASES,
    &albedo::CASES,
    &long_runs::CASES,
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
    &schedule::CASES,
    &runtime::CASES,
    &choice::CASES,
    &adaptive::CASES,
];
