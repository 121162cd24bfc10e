//! The light map of a static bake, as far as it is.

use super::{State, Still};
use crate::baker::{Core, ErrorEstimate, LightMap};
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::Push;
use crate::pass::ResolveSums;
use std::time::Instant;

impl Still {
    /// Without rays there is no noise, where somebody asks for the error.
    pub(super) fn exact_error(&self, core: &Core, state: &State) -> Option<f32> {
        let has_no_noise = self.passes.gathering.is_none() && state.lighting.is_done(core);
        let is_exact = has_no_noise && core.settings.error != ErrorEstimate::None;
        is_exact.then_some(0.0)
    }

    /// The light map as far as it is, and its estimated error.
    pub(super) fn resolve(&self, core: &mut Core, state: &State, mean_luminance: f64) -> Result<ResolveSums> {
        let started = Instant::now();
        let mut sums = ResolveSums { mean: mean_luminance, ..ResolveSums::default() };
        // The error is relative to the mean, which the first time is not known yet.
        let times = if mean_luminance == 0.0 && self.passes.gathering.is_some() { 2 } else { 1 };
        for _ in 0..times {
            let push = Push { mean_luminance: sums.mean as f32, ..core.push };
            let (pass, texels) = (&self.passes.resolve, &core.texels);
            core.commands.run(|recorder| {
                pass.record(recorder, &push, 0..texels.count);
                Ok(())
            })?;
            sums = ResolveSums::read(texels);
        }
        // Sums of light near the largest 32-bit number are infinite, and tell nothing.
        let is_told = state.kept >= 2
            && core.features.contains(Features::HALVES)
            && sums.mean.is_finite()
            && sums.relative_mse.is_finite();
        let by_halves = is_told.then_some(sums.relative_mse.sqrt() as f32);
        core.statistics.estimated_error = self.exact_error(core, state).or(by_halves);
        core.statistics.seconds.resolve += started.elapsed().as_secs_f64();
        Ok(sums)
    }

    pub(in crate::baker) fn read_back(&mut self, core: &mut Core) -> Result<LightMap> {
        let maps = &core.maps;
        core.commands.run(|recorder| {
            // What an earlier call filled is no light of its own.
            recorder.clear(&[&maps.light_map[0]]);
            Ok(())
        })?;
        if let Some(state) = &self.state {
            self.resolve(core, state, state.mean_luminance)?;
        }
        let started = Instant::now();
        let (dilate, push) = (&self.passes.dilate, &core.push);
        core.commands.run(|recorder| {
            dilate.record(recorder, push);
            Ok(())
        })?;
        let pixels = core.commands.read_image(&core.maps.light_map[0])?;
        core.statistics.seconds.resolve += started.elapsed().as_secs_f64();
        let [width, height] = core.maps.size;
        Ok(LightMap { width, height, pixels })
    }
}
