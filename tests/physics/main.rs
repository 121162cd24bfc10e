//! Closed-form answers through the whole bake, on both back ends: NUMERICS section 8.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../common/device.rs"]
mod device;

mod adaptive;
mod choice;
mod estimate;
mod extremes;
mod instances;
mod placing;
mod sizes;
#[path = "../common/stage.rs"]
mod stage;
