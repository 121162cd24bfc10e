//! What a frame tells.

use crate::sampling::SamplingStatistics;
use std::time::Duration;

/// A frame of a baker's: numbered from 1, one for each `Baker::record` or `Baker::submit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct FrameId(pub u64);

bitflags::bitflags! {
    /// The passes of a frame.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub struct Ran: u32 {
        /// Transforms, lights, emission or sky were written.
        const UPDATE = 1;
        /// The top level of the hierarchy was built anew.
        const TOP_LEVEL = 1 << 1;
        /// Light from analytic lights.
        const DIRECT = 1 << 2;
        /// Rays.
        const BAKE = 1 << 3;
        /// Outgoing radiance of texels.
        const SOURCE = 1 << 4;
        /// A light map was written, or a part of one.
        const PUBLISH = 1 << 5;
        /// What rays are aimed by was made anew, or a part of it.
        const IMPORTANCE = 1 << 6;
    }
}

impl Ran {
    /// The passes' names.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let names = ["update", "top level", "direct", "bake", "source", "publish", "importance"];
        names.into_iter().enumerate().filter(move |(bit, _)| self.bits() & (1 << bit) != 0).map(|(_, name)| name)
    }
}

/// What a frame was given to do.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameReport {
    /// The frame, to be reported complete.
    pub frame: FrameId,
    /// The passes that were recorded.
    pub ran: Ran,
    /// Rays of gathering.
    pub rays: u64,
    /// Rays a texel, over all texels that take rays: a fraction where tiles take turns.
    pub samples_per_texel: f64,
    /// Dispatches of direct light, rays, outgoing radiance and light maps.
    pub dispatches: u32,
    /// How long the cost model expects it to take.
    pub predicted: Duration,
    /// How long one unit of gathering, the least that is dispatched, is expected to take.
    pub one_unit: Duration,
    /// Sweeps over all texels finished so far.
    pub sweeps: u64,
    /// How rays were sent up to this frame.
    pub sampling: SamplingStatistics,
    /// Whether old light leaves the running average, because something has changed lately.
    pub decaying: bool,
    /// Nothing was recorded, since as many frames as may be in flight had not been reported complete.
    pub held_up: bool,
}

/// What told how long a frame took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasuredBy {
    /// Timestamps of the device.
    Timestamps,
    /// The host's clock, from recording to the report of completion.
    Host,
}

/// How long a frame took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameTiming {
    /// The frame.
    pub frame: FrameId,
    /// Time of the baker's work on the device.
    pub bake: Duration,
    /// What told it.
    pub measured_by: MeasuredBy,
    /// A pipeline ran for the first time, and the driver may have compiled it within the frame: the cost model leaves such
    /// a frame out.
    pub first_use: bool,
}
