//! The algorithm of a static bake, as a list of passes: bounces first, then samples that are kept.

mod adapting;
mod lighting;
mod passes;
mod showing;

use super::aiming::{Aiming, Occasion};
use super::progress::{Clock, Outcome, Progress, Stop, Stretch};
use super::{BakeSettings, Core, ErrorEstimate};
use crate::epochs::{Bounces, Epoch, Epochs, Stage, too_bright};
use crate::error::Result;
use crate::gpu::layout::Push;
use crate::pass::SourceSums;
use crate::schedule::{Pace, Sweep, Unit};
use adapting::Adapting;
use lighting::Lighting;
use passes::{Gathering, Passes};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A static bake.
pub(super) struct Still {
    passes: Passes,
    aiming: Aiming,
    bounces: Bounces,
    pace: Pace,
    state: Option<State>,
    /// What all calls took so far, but for the light maps at their ends.
    baked: Duration,
}

/// Where a bake stands, between two slices.
struct State {
    lighting: Lighting,
    adapting: Option<Adapting>,
    epochs: Epochs,
    epoch: Epoch,
    sweep: Sweep,
    /// Quanta of every texel that are kept.
    kept: u32,
    /// When the error is estimated next, in kept quanta.
    next_estimate: u32,
    mean_luminance: f64,
    /// As it was estimated last when that was due: a look on the way decides nothing.
    error: Option<f32>,
    /// Every texel has samples of some epoch.
    covered: bool,
    /// The epoch's last quantum, which tells how well rays were aimed.
    evidence_quantum: u32,
}

/// Rays of a quantum that is kept, each of a stratum of its own. Lavapipe, a game level, Mrays/s: 16 rays 3.7, 64 rays
/// 4.0 to 4.9, for neighbouring texels' rays then are all but parallel.
const RAYS: u32 = 64;
/// The same for bounce epochs, which only have to carry the mean.
const BOUNCE_RAYS: u32 = 8;
/// Texels whose links light goes along at once: some 4 million links, well under a slice.
const LINKED_AT_ONCE: u32 = 1 << 18;
/// Random numbers of bounce epochs start here, above those of kept samples.
const BOUNCE_SAMPLES: u32 = 1 << 31;

impl Still {
    pub(super) fn new(core: &mut Core, settings: &BakeSettings) -> Result<Self> {
        Ok(Self {
            passes: Passes::new(core)?,
            aiming: Aiming::new(core, settings.sampling)?,
            bounces: settings.bounces,
            pace: Pace::new(settings.slice),
            state: None,
            baked: Duration::ZERO,
        })
    }

    pub(super) fn bake(
        &mut self,
        core: &mut Core,
        stop: &Stop,
        stretch: Stretch,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome> {
        stop.check_for(core.settings.error != ErrorEstimate::None)?;
        let before = if stretch == Stretch::Part { self.baked } else { Duration::ZERO };
        let clock = Clock::starting_at(before);
        let mut state = match self.state.take() {
            Some(state) => state,
            None => self.start(core)?,
        };
        core.statistics.estimated_error = state.error;
        if state.adapting.as_mut().is_some_and(|adapting| adapting.aim_for(stop.error)) {
            // At the end of the pass that is under way, for texels have quanta by whole passes.
            state.next_estimate = state.next_estimate.min(state.kept + 1);
        }
        // After an error the device is in no state to go on.
        let outcome = self.run(core, &mut state, stop, clock, progress)?;
        self.baked += clock.elapsed() - before;
        self.resolve(core, &state, state.mean_luminance)?;
        core.statistics.bounces_missing = state.epochs.missing() as f32;
        self.state = Some(state);
        if stretch == Stretch::Whole {
            self.tell_missing(core);
        }
        Ok(outcome)
    }

    /// Warns where the bake ends before light has been reflected as often as it should.
    pub(super) fn tell_missing(&self, core: &mut Core) {
        let Some(State { epoch: Epoch::Bounce(_), epochs, .. }) = &self.state else { return };
        if core.texels.count == 0 {
            return;
        }
        // Of all the light that there will be, not of what is there.
        let missing = epochs.missing() / (1.0 + epochs.missing());
        let share = if missing.is_finite() { format!("{:.2} %", 100.0 * missing) } else { "an unknown part".into() };
        core.statistics.warn(format!("the bounces have not converged: {share} of the light is missing"));
    }

    /// The first source map, which emits and does not reflect.
    fn start(&mut self, core: &mut Core) -> Result<State> {
        let started = Instant::now();
        if let Some(Gathering { source, .. }) = &self.passes.gathering {
            let (push, texels) = (&core.push, &core.texels);
            core.commands.run(|recorder| {
                // Texels that take no rays emit all the same.
                source.record(recorder, push, 0, texels.rest());
                Ok(())
            })?;
        }
        let emitted = self.update_source(core)?;
        self.aiming.refresh(core, Occasion::NewSource)?;
        core.statistics.seconds.direct += started.elapsed().as_secs_f64() - core.statistics.seconds.importance;
        let first = if self.aiming.may_aim() { Stage::Pilot } else { Stage::Last };
        let epochs = Epochs::new(self.bounces, first, emitted.max_albedo, emitted.mean_radiance);
        let mut state = State {
            lighting: Lighting::new(core, &self.pace),
            adapting: Adapting::new(core)?,
            epochs,
            epoch: Epoch::Bounce(first),
            sweep: Sweep::new(0, 0..0),
            kept: 0,
            next_estimate: 2,
            mean_luminance: 0.0,
            error: None,
            covered: false,
            evidence_quantum: 0,
        };
        self.begin_epoch(core, &mut state);
        Ok(state)
    }

    fn run(
        &mut self,
        core: &mut Core,
        state: &mut State,
        stop: &Stop,
        clock: Clock,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome> {
        if state.covered && stop.reached(&core.statistics, clock.elapsed()) {
            return Ok(Outcome::Finished);
        }
        let ended = self.light_directly(core, &mut state.lighting, stop, clock, progress)?;
        if self.passes.gathering.is_none() {
            return Ok(self.end_without_rays(core, state, ended, |core| {
                // Nothing is left that could be broken off.
                let _ = progress(&core.statistics.progress_at_end(stop, clock.elapsed()));
            }));
        }
        // The first pass of few rays is gone through even then: there is no light map before it.
        let mut interrupted = ended == Some(Outcome::Interrupted);
        loop {
            let (started, apart_before) = (Instant::now(), core.statistics.seconds.beside_bake());
            let rays = self.rays(core, state.epoch);
            let limit = stop.quanta(rays).min(state.next_estimate);
            match state.sweep.next(&self.pace, rays, limit) {
                Some(unit) => self.gather(core, state, rays, unit)?,
                None if core.texels.count == 0 => return Ok(Outcome::Finished),
                None => self.end_epoch(core, state)?,
            }
            state.covered |= state.sweep.finished_pass().is_some();
            if let (Epoch::Keep { .. }, Some(kept)) = (state.epoch, state.sweep.finished_pass()) {
                Self::keep(core, state, kept);
                if kept >= state.next_estimate {
                    let sums = self.resolve(core, state, state.mean_luminance)?;
                    if stop.error.is_some() && !(sums.mean.is_finite() && sums.relative_mse.is_finite()) {
                        // Its error would never be known.
                        return Err(too_bright());
                    }
                    // Whoever looks in between changes nothing of what is decided.
                    (state.mean_luminance, state.error) = (sums.mean, core.statistics.estimated_error);
                    if let Some(adapting) = &mut state.adapting {
                        adapting.decide(core, &sums)?;
                    }
                    state.next_estimate = kept + (kept / 16).max(2);
                }
            }
            let apart = core.statistics.seconds.beside_bake() - apart_before;
            core.statistics.seconds.bake += started.elapsed().as_secs_f64() - apart;
            let report = core.statistics.progress(state.epoch, stop, clock.elapsed());
            interrupted |= progress(&report).is_break();
            if !state.covered {
                continue;
            }
            if interrupted {
                return Ok(Outcome::Interrupted);
            }
            if stop.reached(&core.statistics, clock.elapsed()) {
                return Ok(Outcome::Finished);
            }
        }
    }

    /// Every texel that takes rays has got quanta up to this one.
    fn keep(core: &mut Core, state: &mut State, kept: u32) {
        let quanta = kept - std::mem::replace(&mut state.kept, kept);
        let (mean, most) = match &mut state.adapting {
            Some(adapting) => adapting.add(quanta),
            None => (f64::from(kept), kept),
        };
        core.statistics.samples_per_texel = mean * f64::from(RAYS);
        core.statistics.most_samples = f64::from(most) * f64::from(RAYS);
    }

    /// Of a quantum.
    fn rays(&self, core: &Core, epoch: Epoch) -> u32 {
        match epoch {
            Epoch::Keep { .. } => RAYS,
            Epoch::Bounce(_) if self.passes.bounce().is_none() => BOUNCE_RAYS,
            Epoch::Bounce(Stage::Pilot) => core.maps.links.rays.min(BOUNCE_RAYS),
            Epoch::Bounce(Stage::Last) => core.maps.links.rays,
        }
    }

    /// One slice of rays.
    fn gather(&mut self, core: &mut Core, state: &State, rays: u32, unit: Unit) -> Result<()> {
        let bounces = matches!(state.epoch, Epoch::Bounce(_));
        // Those that show how to aim are not those that are aimed so.
        let first_sample = match state.epoch {
            Epoch::Bounce(Stage::Pilot) => BOUNCE_SAMPLES,
            Epoch::Bounce(Stage::Last) => BOUNCE_SAMPLES + RAYS,
            Epoch::Keep { .. } => 0,
        };
        let link_stride = if bounces && self.passes.bounce().is_some() { core.maps.links.stride() } else { 0 };
        let push = Push { first_sample, link_stride, evidence_quantum: state.evidence_quantum, ..core.push };
        let refreshes = !bounces || self.traces(state);
        let push = self.aiming.push(push, rays, state.epoch, refreshes);
        let quanta = u64::from(unit.texels.end - unit.texels.start) * u64::from(unit.quanta.end - unit.quanta.start);
        // A unit is sized as if all its texels took rays: it never takes longer than a slice.
        let quanta = state.adapting.as_ref().map_or(quanta, |adapting| adapting.quanta_of(&unit));
        if quanta == 0 {
            return Ok(());
        }
        core.statistics.sampling.count(rays, [push.source_rays, push.sky_rays], quanta);
        let rays = quanta * u64::from(rays);
        let Some(Gathering { bake, .. }) = &self.passes.gathering else { return Ok(()) };
        let took = core.commands.run(|recorder| {
            bake.record(recorder, &push, 0, unit.texels, unit.quanta);
            Ok(())
        })?;
        self.pace.measured(rays, took);
        core.statistics.rays += rays;
        Ok(())
    }

    /// What was gathered becomes the source of the next epoch.
    fn end_epoch(&mut self, core: &mut Core, state: &mut State) -> Result<()> {
        if let Epoch::Bounce(_) = state.epoch {
            self.go_along_links(core, state)?;
            let radiance = self.update_source(core)?.mean_radiance;
            state.epochs.bounced(radiance)?;
            // Beside a surface the weights of a texel's few aimed rays may add up to more than the surface gives back; those
            // of rays by the cosine never do.
            if state.epochs.grows() && self.aiming.leave_bounces_to_cosine() {
                state.epochs.start_over();
            }
        } else if state.epochs.updates_source() {
            self.update_source(core)?;
        }
        core.statistics.epochs += 1;
        let before = state.epoch;
        self.begin_epoch(core, state);
        match state.epoch {
            Epoch::Keep { .. } => self.aiming.refresh(core, Occasion::Epoch),
            Epoch::Bounce(Stage::Pilot) if self.aiming.aims_all() => self.aiming.refresh(core, Occasion::NewSource),
            // Within a stage the bounces follow one operator, which aimed rays are a part of.
            Epoch::Bounce(_) if state.epoch != before => {
                self.aiming.refresh(core, Occasion::NewSource)?;
                if state.epochs.restarts() { self.forget_bounces(core) } else { Ok(()) }
            }
            Epoch::Bounce(_) => Ok(()),
        }
    }

    /// The source map is again what emits and does not reflect.
    fn forget_bounces(&self, core: &mut Core) -> Result<()> {
        let maps = &core.maps;
        core.commands.run(|recorder| {
            recorder.clear(&[&maps.mean_even, &maps.mean_odd]);
            Ok(())
        })?;
        self.update_source(core)?;
        Ok(())
    }

    /// Whether a bounce's rays are other ones than the last bounce's: the first of a stage, and those of a pilot whose rays
    /// are all aimed, each at what the one before has lit.
    fn traces(&self, state: &State) -> bool {
        state.epochs.rays_are_new() || state.epoch == Epoch::Bounce(Stage::Pilot) && self.aiming.aims_all()
    }

    /// A bounce whose rays have been traced before.
    fn go_along_links(&self, core: &mut Core, state: &State) -> Result<()> {
        let Some(pass) = self.passes.bounce().filter(|_| !self.traces(state)) else { return Ok(()) };
        let (rays, link_stride) = (self.rays(core, state.epoch), core.maps.links.stride());
        let (push, count) = (Push { rays, link_stride, ..core.push }, core.texels.count);
        for first in (0..count).step_by(LINKED_AT_ONCE as usize) {
            core.commands.run(|recorder| {
                pass.record(recorder, &push, first..(first + LINKED_AT_ONCE).min(count));
                Ok(())
            })?;
        }
        Ok(())
    }

    fn begin_epoch(&self, core: &Core, state: &mut State) {
        state.epoch = state.epochs.next();
        let quanta = match state.epoch {
            Epoch::Bounce(_) if self.passes.bounce().is_some() && !self.traces(state) => 0..0,
            Epoch::Bounce(_) => 0..1,
            Epoch::Keep { quanta } => state.kept..state.kept + quanta,
        };
        if !quanta.is_empty() {
            state.evidence_quantum = quanta.end - 1;
        }
        state.sweep = Sweep::new(core.texels.count, quanta);
    }

    fn update_source(&self, core: &mut Core) -> Result<SourceSums> {
        let Some(Gathering { source, .. }) = &self.passes.gathering else { return Ok(SourceSums::NOTHING) };
        let (push, texels) = (&core.push, &core.texels);
        core.commands.run(|recorder| {
            source.record(recorder, push, 0, 0..texels.count);
            Ok(())
        })?;
        let sums = SourceSums::read(texels);
        core.statistics.area = sums.area;
        if sums.invalid > 0 {
            core.statistics.warn(format!("{} texels have a radiance that is not finite; it counts as 0", sums.invalid));
        }
        Ok(sums)
    }
}
