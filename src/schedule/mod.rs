//! Cuts work into pieces of a wanted length. Pure: timings come in, pieces of work go out.
//!
//! - [`sweep`]: submissions of a static bake;
//! - [`frame`]: dispatches within the budget of a frame, [`work`], by the predictions of [`cost`] and [`tile_cost`];
//! - [`simulated`]: a device to plan for.

mod cost;
mod frame;
pub(crate) mod simulated;
#[cfg(test)]
mod simulation;
mod sweep;
mod tile_cost;
mod work;

pub(crate) use frame::{FrameScheduler, TILE, samples_per_texel};
pub use sweep::Slice;
pub(crate) use sweep::{GROUP, Pace, Sweep, Unit};
pub(crate) use work::{Extent, Needs, STAGES, Stage, Work};
