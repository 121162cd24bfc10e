//! Light from analytic lights, slice by slice, before any ray looks for light.

use super::{State, Still};
use crate::baker::Core;
use crate::baker::progress::{Clock, Outcome, Phase, Progress, Stop};
use crate::epochs::Epoch;
use crate::error::Result;
use crate::schedule::{Pace, Sweep, Unit};
use std::ops::ControlFlow;
use std::time::Instant;

/// How far it has come.
pub(super) struct Lighting {
    sweep: Sweep,
    pace: Pace,
    /// Texels that have theirs.
    reached: u32,
}

impl Lighting {
    pub(super) fn new(core: &Core, pace: &Pace) -> Self {
        Self { sweep: Sweep::new(core.texels.count, 0..1), pace: pace.clone(), reached: 0 }
    }

    pub(super) fn is_done(&self, core: &Core) -> bool {
        self.reached == core.texels.count
    }
}

impl Still {
    /// Goes on with it. `Some`: the callback broke off, or the time is up. Where rays are sent all texels are gone through
    /// even then: there is no light map before their first.
    pub(super) fn light_directly(
        &self,
        core: &mut Core,
        lighting: &mut Lighting,
        stop: &Stop,
        clock: Clock,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Option<Outcome>> {
        let Some(pass) = &self.passes.direct else {
            lighting.reached = core.texels.count;
            return Ok(None);
        };
        let (alone, mut ended) = (self.passes.gathering.is_none(), None);
        // Up to 40 shadow rays a light; four of five lights do not reach a texel's few.
        let rays = 8 * core.push.light_count.max(1);
        while let Some(Unit { texels, .. }) = lighting.sweep.next(&lighting.pace, rays, 1) {
            let (started, end, push) = (Instant::now(), texels.end, &core.push);
            let count = u64::from(texels.end - texels.start) * u64::from(rays);
            let took = core.commands.run(|recorder| {
                pass.record(recorder, push, texels);
                Ok(())
            })?;
            lighting.pace.measured(count, took);
            lighting.reached = end;
            core.statistics.seconds.direct += started.elapsed().as_secs_f64();
            let report = core.statistics.progress(Epoch::Keep { quanta: 0 }, stop, clock.elapsed());
            let fraction = if alone { end as f32 / core.texels.count.max(1) as f32 } else { report.fraction };
            let report = Progress { phase: Phase::Preparing, fraction, time_left: None, ..report };
            if progress(&report).is_break() {
                ended = Some(Outcome::Interrupted);
            }
            if alone && ended.is_none() && stop.time.is_some_and(|time| clock.elapsed() >= time) {
                ended = Some(Outcome::Finished);
            }
            if alone && ended.is_some() && !lighting.is_done(core) {
                return Ok(ended);
            }
        }
        Ok(ended)
    }

    /// The end of a bake without rays: all its light comes from analytic lights. `ended`: before all texels had theirs.
    pub(super) fn end_without_rays(
        &self,
        core: &mut Core,
        state: &State,
        ended: Option<Outcome>,
        report: impl FnOnce(&mut Core),
    ) -> Outcome {
        let (reached, texels) = (state.lighting.reached, core.texels.count);
        if state.lighting.is_done(core) {
            core.statistics.estimated_error = self.exact_error(core, state);
            report(core);
            return Outcome::Finished;
        }
        core.statistics.warn(format!(
            "{} of {texels} texels have not been reached, and are filled from their neighbours",
            texels - reached
        ));
        ended.unwrap_or(Outcome::Finished)
    }
}
