//! Closed-form answers through the whole bake, on both back ends: NUMERICS section 8.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../common/device.rs"]
mod device;

mod adaptive;
mod area;
mod choice;
mod energy;
mod estimate;
mod extremes;
mod form_factors;
mod furnace;
mod instances;
mod lights;
mod means;
mod placing;
mod radiosity;
mod shapes;
mod sizes;
mod sky;
#[path = "../common/stage.rs"]
mod stage;
mod surfaces;
