//! Cuts work into pieces of a wanted length. Pure: timings come in, pieces of work go out.
//!
//! - [`sweep`]: submissions of a static bake;
//! - [`frame`]: dispatches within the budget of a frame, by the predictions of [`cost`] and [`tile_cost`].

mod cost;
mod frame;
#[cfg(test)]
mod simulation;
mod sweep;
mod tile_cost;

pub(crate) use frame::{Extent, FrameScheduler, Needs, Stage, TILE, Work, samples_per_texel};
pub use sweep::Slice;
pub(crate) use sweep::{GROUP, Pace, Sweep, Unit};
