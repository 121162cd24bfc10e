//! Closed-form answers through the whole bake, on both back ends: NUMERICS section 8.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../common/device.rs"]
mod device;

mod area;
mod energy;
mod estimate;
mod form_factors;
mod furnace;
mod lights;
mod means;
mod radiosity;
mod shapes;
mod sky;
#[path = "../common/stage.rs"]
mod stage;
mod surfaces;
