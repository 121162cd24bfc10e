//! Cuts work into pieces of a wanted length. Pure: timings come in, pieces of work go out.
//!
//! - [`sweep`]: submissions of a static bake;
//! - [`frame`]: dispatches within the budget of a frame, by the predictions of [`cost`] and [`tile_cost`].

mod cost;
#[cfg_attr(not(test), expect(dead_code, reason = "the baker of changing scenes comes next"))]
mod frame;
#[cfg(test)]
mod simulation;
mod sweep;
mod tile_cost;

#[expect(unused_imports, reason = "the baker of changing scenes comes next")]
pub(crate) use frame::{Extent, FrameScheduler, Needs, Stage, TILE, Work, samples_per_texel};
pub use sweep::Slice;
pub(crate) use sweep::{GROUP, Pace, Sweep, Unit};
