//! How a baker behaves that works within an engine's frames.

use crate::error::{Error, Result};
use crate::temporal::Average;
use std::time::Duration;

/// How a baker behaves that works within an engine's frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameSettings {
    /// After so long a change has all but arrived: of the old light [`FrameSettings::decay_threshold`] is left. Shorter is
    /// livelier and noisier. Zero: of the old light nothing is left by the next visit; `Duration::MAX`: it never leaves.
    /// Default .5 s.
    pub tolerable_latency: Duration,
    /// Share of the old light that is left after the latency; between 0 and 1, both excluded. Default .1.
    pub decay_threshold: f64,
    /// Frames that may be recorded before the oldest of them is reported complete; 1 to 8. Default 3.
    pub frames_in_flight: u32,
    /// Which time the running average goes by. Default: the wall clock.
    pub clock: Clock,
    /// What tells how long the device took. Default: timestamps.
    pub timing: Timing,
    /// Rays of a visit to a texel, in quanta of 16; `None`: 1, and more where a frame has time for more. 1 to 64. With a
    /// number, the light map after so many sweeps of a still scene has the same bits however the work was cut.
    pub quanta: Option<u32>,
}

/// Which time the running average goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Clock {
    /// Time as it passes.
    #[default]
    Wall,
    /// What `Baker::set_time` says: game time that is paused, or a film's frames.
    Engine,
}

/// What tells how long the device took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Timing {
    /// Timestamps of the device where it has them and they are valid, else the host's clock.
    #[default]
    Timestamps,
    /// The host's clock, from recording until the frame is reported complete: too long by what else the frame did.
    Host,
}

/// Whether the cost model learns from what frames take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Learning {
    /// It does: budgets are kept.
    #[default]
    On,
    /// It stays as it is: equal budgets get equal work, whatever that takes. For measurements.
    Held,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            tolerable_latency: Duration::from_millis(500),
            decay_threshold: 0.1,
            frames_in_flight: 3,
            clock: Clock::default(),
            timing: Timing::default(),
            quanta: None,
        }
    }
}

/// Frames in flight, at most: their timestamps and command buffers are made beforehand.
const MOST_IN_FLIGHT: u32 = 8;
/// Quanta of a visit, at most: 1,024 rays, far below the 65,535 iterations at which older drivers cut loops.
const MOST_QUANTA: u32 = 64;

impl FrameSettings {
    /// # Errors
    /// `InvalidSettings` for what is outside its range.
    pub(in crate::baker) fn check(&self) -> Result<()> {
        Average::new(self.tolerable_latency, self.decay_threshold)?;
        let in_flight = self.frames_in_flight;
        if !(1..=MOST_IN_FLIGHT).contains(&in_flight) {
            return Err(Error::settings(format!("frames in flight are {in_flight}; allowed is 1 to {MOST_IN_FLIGHT}")));
        }
        match self.quanta {
            Some(quanta) if !(1..=MOST_QUANTA).contains(&quanta) => {
                Err(Error::settings(format!("the quanta of a visit are {quanta}; allowed is 1 to {MOST_QUANTA}")))
            }
            _ => Ok(()),
        }
    }
}
