//! How rays are aimed in a static bake: at what the source map has, and what rays have shown decides how
//! many are aimed.

use super::{Core, Sampling};
use crate::epochs::Epoch;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::Push;
use crate::pass::{Aim, Context};
use crate::sampling::Chooser;
use std::time::Instant;

/// Without the feature nothing is aimed and nothing is made.
pub(super) struct Aiming {
    pass: Option<Aim>,
    chooser: Chooser,
    sky_made: bool,
    aims_all: bool,
    /// Aimed rays made light grow from bounce to bounce.
    bounces_by_cosine: bool,
    /// About that of the irradiance: what shines, spread evenly.
    mean_luminance: f32,
}

/// What the aim is made anew for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Occasion {
    /// What shines has changed.
    NewSource,
    /// Rays have been aimed by the last one, and tell how well.
    Epoch,
}

impl Aiming {
    pub(super) fn new(core: &mut Core, sampling: Sampling) -> Result<Self> {
        let context = Context { gpu: &core.gpu, constants: core.constants, scene: &core.scene, maps: &core.maps };
        let pass = Aim::new(context)?;
        let chooser = Chooser::new(sampling, core.features.contains(Features::SKY_MAP));
        if let Some(pass) = &pass {
            let nothing = Push { map_size: [0, 0], ..core.push };
            core.commands.run(|recorder| {
                pass.record_first_use(recorder, &nothing);
                Ok(())
            })?;
        }
        Ok(Self {
            pass,
            chooser,
            sky_made: false,
            aims_all: sampling == Sampling::Importance,
            bounces_by_cosine: false,
            mean_luminance: 0.0,
        })
    }

    /// Whether no ray goes by the cosine: what nothing has been aimed at yet is then not found either.
    pub(super) fn aims_all(&self) -> bool {
        self.aims_all
    }

    /// Whether rays may be aimed.
    pub(super) fn may_aim(&self) -> bool {
        self.pass.is_some()
    }

    /// From now on no rays of bounce epochs are aimed. False: none were.
    pub(super) fn leave_bounces_to_cosine(&mut self) -> bool {
        let aimed = !self.bounces_by_cosine && self.chooser.shares().any_aimed();
        self.bounces_by_cosine = true;
        aimed
    }

    /// A quantum of `rays`, some of them aimed. `refreshes`: whether what they see is looked at after the epoch.
    pub(super) fn push(&self, push: Push, rays: u32, epoch: Epoch, refreshes: bool) -> Push {
        let by_cosine = self.bounces_by_cosine && matches!(epoch, Epoch::Bounce(_));
        let [source_rays, sky_rays] = if by_cosine { [0, 0] } else { self.chooser.shares().aimed_rays(rays) };
        let step_texels = self.pass.as_ref().filter(|_| refreshes).map_or(0, Aim::tells_every);
        Push { rays, source_rays, sky_rays, step_texels, mean_luminance: self.mean_luminance, ..push }
    }

    /// Makes the aim from the source map, and chooses how many rays are aimed. Where none are and none may be, nothing
    /// is done.
    pub(super) fn refresh(&mut self, core: &mut Core, occasion: Occasion) -> Result<()> {
        let Some(pass) = &self.pass else { return Ok(()) };
        if occasion == Occasion::Epoch && !self.chooser.shares().any_aimed() {
            return Ok(());
        }
        let started = Instant::now();
        let push = &core.push;
        let make_sky = !std::mem::replace(&mut self.sky_made, true);
        core.commands.run(|recorder| {
            pass.record(recorder, push, 0, 0..pass.parts(), true);
            if make_sky {
                pass.record_sky(recorder, push);
            }
            Ok(())
        })?;
        let sums = pass.read_sums(core.texels.count);
        let statistics = &mut core.statistics;
        statistics.seconds.importance += started.elapsed().as_secs_f64();
        if sums.invalid > 0 {
            let invalid = sums.invalid;
            statistics.warn(format!("{invalid} texels shine beyond what 32-bit floats hold; no ray is aimed at them"));
        }
        self.mean_luminance = sums.evidence.mean_luminance();
        statistics.sampling.invalid_texels = sums.invalid;
        statistics.sampling.evenness = Some(sums.evidence.evenness() as f32);
        statistics.sampling.power = Some(sums.evidence.power);
        statistics.sampling.pyramids += 1;
        match occasion {
            Occasion::NewSource => self.chooser.begin(&sums.evidence, core.scene.sky_shines),
            Occasion::Epoch => {
                statistics.sampling.saw(self.chooser.shares().aimed_rays(64), sums.seen);
                self.chooser.learn(&sums.evidence);
            }
        }
        Ok(())
    }
}
