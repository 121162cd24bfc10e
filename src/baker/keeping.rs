//! Looks at the light map on the way, for a device that is lost takes its memory along.

use super::{Baker, LightMap, Outcome, Progress, Running, Statistics, Stop};
use crate::error::{ErrorKind, Result};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A look takes at most one part in so many of the time in between, but for the first.
const LOOK_SHARE: u32 = 20;

impl Baker {
    /// [`Baker::bake`] that hands out the light map, and what is known of it, about once in `every`: at the end of a slice,
    /// once all texels have samples, and less often where reading it back takes more than a twentieth of that time. It costs
    /// a host copy of the light map, and keeps what was baked from a device that is lost. `stop.time` is what all calls take
    /// together, as with [`Baker::bake_until`], without the looks. A look for which there is no memory is left out.
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
            match self.read_back() {
                Ok(light_map) => keep(light_map, self.statistics()),
                Err(error) if error.kind() == ErrorKind::OutOfMemory => {}
                Err(error) => return Err(error),
            }
            wait = every.max(looking.elapsed() * LOOK_SHARE);
        }
    }
}
