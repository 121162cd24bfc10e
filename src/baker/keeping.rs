//! Looks at the light map on the way, for a device that is lost takes its memory along.

use super::{Baker, LightMap, Outcome, Progress, Running, Statistics, Stop};
use crate::error::Result;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A look costs at most one part in so many of the time in between.
const LOOK_SHARE: u32 = 20;

impl Baker {
    /// [`Baker::bake`] that hands out the light map, and what is known of it, about once in `every`; less often where it takes
    /// more than a twentieth of that to read it back. It costs a host copy of the light map, and keeps what was baked from
    /// a device that is lost. `stop.time` does not count the looks.
    ///
    /// # Errors
    /// As [`Baker::bake`].
    pub fn bake_keeping(
        &mut self,
        stop: &Stop,
        every: Duration,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
        keep: &mut dyn FnMut(LightMap, &Statistics),
    ) -> Result<Outcome> {
        let mut wait = every;
        loop {
            let (since, mut is_broken_off) = (Instant::now(), false);
            let outcome = self.bake_until(stop, &mut |report| {
                is_broken_off |= progress(report).is_break();
                let is_due = since.elapsed() >= wait;
                if is_broken_off || is_due { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            if outcome == Outcome::Finished || is_broken_off {
                if let Running::Still(still) = &mut self.0 {
                    still.1.tell_missing(&mut still.0);
                }
                return Ok(outcome);
            }
            let looking = Instant::now();
            keep(self.read_back()?, self.statistics());
            wait = every.max(looking.elapsed() * LOOK_SHARE);
        }
    }
}
