//! The algorithm: a static bake, as a list of passes.

mod memory;
mod progress;
mod setup;

pub use crate::epochs::Bounces;
pub use crate::schedule::Slice;
pub use memory::{MemoryEstimate, estimate_memory};
pub use progress::{Outcome, Phase, Progress, Seconds, Statistics, Stop};

use crate::epochs::{Epoch, Epochs};
use crate::error::Result;
use crate::features::Features;
use crate::gpu::Commands;
use crate::gpu::layout::Push;
use crate::pass::{Bake, DeviceScene, Dilate, Direct, Maps, Resolve, ResolveSums, Source, SourceSums, TexelList};
use crate::scene::{Atlas, Resolution};
use crate::schedule::{Pace, Sweep, Unit};
use std::ops::ControlFlow;
use std::time::Instant;

/// How to bake.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeSettings {
    /// How large the light map is.
    pub resolution: Resolution,
    /// How many times light is reflected.
    pub bounces: Bounces,
    /// Another seed gives other noise.
    pub seed: u64,
    /// How long one submission to the device may take.
    pub slice: Slice,
}

impl Default for BakeSettings {
    /// 512 texels a side, all bounces, seed 0, slices of 50 ms.
    fn default() -> Self {
        Self { resolution: Resolution::Texels(512), bounces: Bounces::Auto, seed: 0, slice: Slice::default() }
    }
}

/// A baked light map.
#[derive(Debug, Clone, PartialEq)]
pub struct LightMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `[texel]`, row-major from the top (light-map coordinate v = 0). RGB: irradiance, linear Rec. 709, scene units;
    /// A: 1 where the texel lies on a surface, else 0.
    pub pixels: Vec<[f32; 4]>,
}

/// Bakes the light map of one scene on one device.
///
/// Dropping it waits for the device.
pub struct Baker {
    // Dropped first: waits for what is under way.
    commands: Commands,
    passes: Passes,
    texels: TexelList,
    maps: Maps,
    _scene: DeviceScene,
    atlas: Atlas,
    push: Push,
    bounces: Bounces,
    features: Features,
    pace: Pace,
    state: Option<State>,
    statistics: Statistics,
}

struct Passes {
    direct: Option<Direct>,
    source: Source,
    bake: Bake,
    resolve: Resolve,
    dilate: Dilate,
}

/// Where a bake stands, between two slices.
struct State {
    epochs: Epochs,
    epoch: Epoch,
    sweep: Sweep,
    /// Quanta of every texel that are kept.
    kept: u32,
    /// When the error is estimated next, in kept quanta.
    next_estimate: u32,
    mean_luminance: f64,
    /// Every texel has samples of some epoch.
    covered: bool,
}

/// Side of the grid of strata for kept samples: 64 rays a quantum. Lavapipe, a game level, Mrays/s: 16 rays 3.7, 64 rays
/// 4.0 to 4.9, for neighbouring texels' rays then are all but parallel.
const STRATA_SIDE: u32 = 8;
/// The same for bounce epochs, which only have to carry the mean.
const BOUNCE_STRATA_SIDE: u32 = 4;
/// Random numbers of bounce epochs start here, above those of kept samples.
const BOUNCE_SAMPLES: u32 = 1 << 31;

impl Baker {
    /// Bakes until `stop`, or until `progress` breaks; a later call goes on from there. In between,
    /// [`Baker::read_back`] gives the light map as far as it is.
    ///
    /// # Errors
    /// `InvalidSettings` for a stop outside its range; `InvalidScene` where light grows without end; `DeviceLost`,
    /// `OutOfMemory` or `Driver` from the device.
    pub fn bake(&mut self, stop: &Stop, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Outcome> {
        stop.check()?;
        let clock = Instant::now();
        let mut state = match self.state.take() {
            Some(state) => state,
            None => self.start()?,
        };
        // After an error the device is in no state to go on.
        let outcome = self.run(&mut state, stop, clock, progress)?;
        self.resolve(&mut state)?;
        self.statistics.bounces_missing = state.epochs.missing() as f32;
        if state.epoch == Epoch::Bounce && self.texels.count > 0 {
            let missing = state.epochs.missing();
            let share =
                if missing.is_finite() { format!("{:.2} %", 100.0 * missing) } else { "an unknown part".into() };
            self.statistics.warn(format!("the bounces have not converged: {share} of the light is missing"));
        }
        self.state = Some(state);
        Ok(outcome)
    }

    /// The first source map, which emits and does not reflect, and light from analytic lights.
    fn start(&mut self) -> Result<State> {
        let started = Instant::now();
        let maps = &self.maps;
        self.commands.run(|recorder| {
            // Texels that take no rays emit all the same.
            recorder.copy_image(&maps.emission, &maps.source);
            Ok(())
        })?;
        let emitted = self.update_source()?;
        self.light_directly()?;
        self.statistics.seconds.direct += started.elapsed().as_secs_f64();
        let epochs = Epochs::new(self.bounces, emitted.max_albedo, emitted.mean_radiance);
        let mut state = State {
            epochs,
            epoch: Epoch::Bounce,
            sweep: Sweep::new(0, 0..0),
            kept: 0,
            next_estimate: 2,
            mean_luminance: 0.0,
            covered: false,
        };
        self.begin_epoch(&mut state);
        Ok(state)
    }

    fn light_directly(&mut self) -> Result<()> {
        let (Some(pass), push) = (&self.passes.direct, &self.push) else { return Ok(()) };
        let mut sweep = Sweep::new(self.texels.count, 0..1);
        let mut pace = self.pace.clone();
        // Up to 40 shadow rays a light; four of five lights do not reach a texel's few.
        let rays = 8 * push.light_count;
        while let Some(Unit { texels, .. }) = sweep.next(&pace, rays, 1) {
            let count = u64::from(texels.end - texels.start) * u64::from(rays);
            let took = self.commands.run(|recorder| {
                pass.record(recorder, push, texels);
                Ok(())
            })?;
            pace.measured(count, took);
        }
        Ok(())
    }

    fn run(
        &mut self,
        state: &mut State,
        stop: &Stop,
        clock: Instant,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome> {
        if state.covered && stop.reached(&self.statistics, clock.elapsed()) {
            return Ok(Outcome::Finished);
        }
        // The first pass of few rays is gone through even then: there is no light map before it.
        let mut interrupted = false;
        loop {
            let (started, resolved_before) = (Instant::now(), self.statistics.seconds.resolve);
            let side = match state.epoch {
                Epoch::Bounce => BOUNCE_STRATA_SIDE,
                Epoch::Keep { .. } => STRATA_SIDE,
            };
            let limit = stop.quanta(side * side).min(state.next_estimate);
            match state.sweep.next(&self.pace, side * side, limit) {
                Some(unit) => self.gather(state, side, unit)?,
                None if self.texels.count == 0 => return Ok(Outcome::Finished),
                None => self.end_epoch(state)?,
            }
            state.covered |= state.sweep.finished_pass().is_some();
            if let (Epoch::Keep { .. }, Some(kept)) = (state.epoch, state.sweep.finished_pass()) {
                state.kept = kept;
                if kept >= state.next_estimate {
                    self.resolve(state)?;
                    state.next_estimate = kept + (kept / 16).max(2);
                }
            }
            let resolving = self.statistics.seconds.resolve - resolved_before;
            self.statistics.seconds.bake += started.elapsed().as_secs_f64() - resolving;
            self.statistics.samples_per_texel = f64::from(state.kept) * f64::from(STRATA_SIDE * STRATA_SIDE);
            let report = self.statistics.progress(state.epoch, stop, clock.elapsed());
            interrupted |= progress(&report).is_break();
            if !state.covered {
                continue;
            }
            if interrupted {
                return Ok(Outcome::Interrupted);
            }
            if stop.reached(&self.statistics, clock.elapsed()) {
                return Ok(Outcome::Finished);
            }
        }
    }

    /// One slice of rays.
    fn gather(&mut self, state: &State, strata_side: u32, unit: Unit) -> Result<()> {
        let first_sample = if state.epoch == Epoch::Bounce { BOUNCE_SAMPLES } else { 0 };
        let push = Push { strata_side, first_sample, ..self.push };
        let quanta = u64::from(unit.quanta.end - unit.quanta.start);
        let rays = u64::from(unit.texels.end - unit.texels.start) * quanta * u64::from(strata_side * strata_side);
        let pass = &self.passes.bake;
        let took = self.commands.run(|recorder| {
            pass.record(recorder, &push, unit.texels, unit.quanta);
            Ok(())
        })?;
        self.pace.measured(rays, took);
        self.statistics.rays += rays;
        Ok(())
    }

    /// What was gathered becomes the source of the next epoch.
    fn end_epoch(&mut self, state: &mut State) -> Result<()> {
        if state.epoch == Epoch::Bounce {
            let radiance = self.update_source()?.mean_radiance;
            state.epochs.bounced(radiance)?;
        } else if state.epochs.updates_source() {
            self.update_source()?;
        }
        self.statistics.epochs += 1;
        self.begin_epoch(state);
        Ok(())
    }

    fn begin_epoch(&self, state: &mut State) {
        state.epoch = state.epochs.next();
        state.sweep = match state.epoch {
            Epoch::Bounce => Sweep::new(self.texels.count, 0..1),
            Epoch::Keep { quanta } => Sweep::new(self.texels.count, state.kept..state.kept + quanta),
        };
    }

    fn update_source(&mut self) -> Result<SourceSums> {
        let (pass, push, texels) = (&self.passes.source, &self.push, &self.texels);
        self.commands.run(|recorder| {
            pass.record(recorder, push, 0..texels.count);
            Ok(())
        })?;
        let sums = SourceSums::read(texels);
        self.statistics.area = sums.area;
        if sums.invalid > 0 {
            self.statistics.warn(format!("{} texels have a radiance that is not finite; it counts as 0", sums.invalid));
        }
        Ok(sums)
    }

    /// The light map as far as it is, and its estimated error.
    fn resolve(&mut self, state: &mut State) -> Result<()> {
        let started = Instant::now();
        // The error is relative to the mean, which the first time is not known yet.
        let times = if state.mean_luminance == 0.0 { 2 } else { 1 };
        for _ in 0..times {
            let push = Push { mean_luminance: state.mean_luminance as f32, ..self.push };
            let (pass, texels) = (&self.passes.resolve, &self.texels);
            self.commands.run(|recorder| {
                pass.record(recorder, &push, 0..texels.count);
                Ok(())
            })?;
            let sums = ResolveSums::read(texels);
            state.mean_luminance = sums.mean;
            self.statistics.estimated_error = (state.kept >= 2).then_some(sums.relative_mse.sqrt() as f32);
        }
        self.statistics.seconds.resolve += started.elapsed().as_secs_f64();
        Ok(())
    }

    /// The light map as far as it has been baked, gutters filled.
    ///
    /// # Errors
    /// `DeviceLost`, `OutOfMemory` or `Driver` from the device.
    pub fn read_back(&mut self) -> Result<LightMap> {
        let maps = &self.maps;
        self.commands.run(|recorder| {
            // What an earlier call filled is no light of its own.
            recorder.clear(&[&maps.light_map]);
            Ok(())
        })?;
        if let Some(mut state) = self.state.take() {
            let resolved = self.resolve(&mut state);
            self.state = Some(state);
            resolved?;
        }
        let started = Instant::now();
        let (dilate, push) = (&self.passes.dilate, &self.push);
        self.commands.run(|recorder| {
            dilate.record(recorder, push);
            Ok(())
        })?;
        let pixels = self.commands.read_image(&self.maps.light_map)?;
        self.statistics.seconds.resolve += started.elapsed().as_secs_f64();
        let [width, height] = self.maps.size;
        Ok(LightMap { width, height, pixels })
    }

    /// The layout of the light map.
    pub fn atlas(&self) -> &Atlas {
        &self.atlas
    }

    /// What the scene needs; all else was left out.
    pub fn features(&self) -> Features {
        self.features
    }

    /// What has been done so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }
}
