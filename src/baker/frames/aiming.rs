//! How rays are aimed within frames: the aim is made anew while what shines changes, and what it sums up decides some
//! sweeps later, when the host is sure to have it.

use crate::baker::Core;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::Recorder;
use crate::gpu::layout::Push;
use crate::pass::{Aim, Context};
use crate::sampling::{Chooser, Sampling};
use crate::schedule::Work;

/// Share of the light of a change that its last bounce may leave out when the aim is no longer made.
const LEFT: f64 = 0.01;
/// After a change: by what shines, then by what aimed rays have shown, and once more.
const DECISIONS: u64 = 3;
/// Bounces that the aim follows, at most.
const MOST_SWEEPS: f64 = 100.0;
/// Makings of the aim for which cosine alone, once chosen by what rays have shown, is kept while the scene goes on changing.
const REST: u32 = 64;

/// Without the feature nothing is aimed and nothing is made.
pub(super) struct Aiming {
    pass: Option<Aim>,
    chooser: Chooser,
    /// Sweeps for which a change is followed: its bounces, and the decisions about it.
    sweeps: u64,
    /// Sweeps from an aim until the frame that made it has been reported complete, whatever the budgets: a frame ends one
    /// sweep at most. Decisions by the count of sweeps alone make the light map the same however the work is cut.
    delay: u64,
    due_until: u64,
    due: bool,
    sky_due: bool,
    /// Sums are under way: the sweep from which on they are read, and whether rays were aimed before them.
    awaited: Option<(u64, bool)>,
    rest: u32,
    /// Rays of a quantum that are aimed in the sweep under way.
    rays: [u32; 2],
    /// Whether what the sweep under way sees is looked at after it.
    tells: bool,
    mean_luminance: f32,
}

impl Aiming {
    pub(super) fn new(core: &mut Core, sampling: Sampling, max_albedo: f64, frames_in_flight: u32) -> Result<Self> {
        let context = Context { gpu: &core.gpu, constants: core.constants, scene: &core.scene, maps: &core.maps };
        let pass = Aim::new(context)?;
        if let Some(pass) = &pass {
            let nothing = Push { map_size: [0, 0], ..core.push };
            core.commands.run(|recorder| {
                pass.record_first_use(recorder, &nothing);
                Ok(())
            })?;
        }
        let sweeps = if max_albedo > 0.0 { (LEFT.ln() / max_albedo.ln()).clamp(1.0, MOST_SWEEPS) } else { 1.0 };
        let sky = core.features.contains(Features::SKY_MAP);
        let delay = u64::from(frames_in_flight) + 1;
        Ok(Self {
            due: pass.is_some(),
            pass,
            chooser: Chooser::new(sampling, sky),
            sweeps: (sweeps.ceil() as u64).max(DECISIONS * delay),
            delay,
            due_until: 0,
            sky_due: sky,
            awaited: None,
            rest: 0,
            rays: [0, 0],
            tells: false,
            mean_luminance: 0.0,
        })
    }

    /// Parts that [`Aiming::record`] may be cut into.
    pub(super) fn parts(&self) -> u32 {
        self.pass.as_ref().map_or(0, Aim::parts)
    }

    /// What shines has changed, or what is seen of it.
    pub(super) fn changed(&mut self, sweeps: u64, sky: bool) {
        self.due = self.pass.is_some();
        self.sky_due |= sky;
        // After a rest anything may have become another scene; one that never comes to rest is looked at now and then.
        if sweeps > self.due_until {
            self.rest = 0;
        }
        self.due_until = sweeps + self.sweeps;
    }

    /// Whether the aim is out of date.
    pub(super) fn is_due(&self) -> bool {
        self.due
    }

    /// Whether it will be after so many sweeps.
    pub(super) fn is_due_after(&self, sweeps: u64) -> bool {
        self.pass.is_some() && sweeps <= self.due_until
    }

    /// Part of the aim, from a source map.
    pub(super) fn record(
        &mut self,
        core: &mut Core,
        recorder: &mut Recorder<'_>,
        work: &Work,
        source: usize,
        sweeps: u64,
    ) {
        let Some(pass) = &self.pass else { return };
        if work.items.start == 0 {
            self.due = false;
        }
        let wanted = self.awaited.is_none();
        pass.record(recorder, &core.push, source, work.items.clone(), wanted);
        if !work.ends_stage {
            return;
        }
        if std::mem::take(&mut self.sky_due) {
            pass.record_sky(recorder, &core.push);
        }
        if wanted {
            recorder.show_host();
            self.awaited = Some((sweeps + self.delay, self.chooser.shares().any_aimed()));
        }
        core.statistics.sampling.pyramids += 1;
        self.rest = self.rest.saturating_sub(1);
    }

    /// A sweep begins: how many of its rays are aimed.
    pub(super) fn begin_sweep(&mut self, core: &mut Core, sweeps: u64, rays: u32) {
        if let (Some(pass), Some((_, aimed))) = (&self.pass, self.awaited.filter(|(from, _)| *from <= sweeps)) {
            self.awaited = None;
            let sums = pass.read_sums(core.texels.count);
            core.statistics.sampling.evenness = Some(sums.evidence.evenness() as f32);
            core.statistics.sampling.power = Some(sums.evidence.power);
            self.mean_luminance = sums.evidence.mean_luminance();
            core.statistics.sampling.invalid_texels = sums.invalid;
            if aimed {
                core.statistics.sampling.saw(self.rays, sums.seen);
                self.chooser.learn(&sums.evidence);
                self.rest = if self.chooser.shares().any_aimed() { 0 } else { REST };
            } else if self.rest == 0 {
                self.chooser.begin(&sums.evidence, core.scene.sky_shines);
            }
        }
        self.rays = self.chooser.shares().aimed_rays(rays);
        self.tells = self.is_due_after(sweeps + 1);
    }

    /// A sweep has ended: its source map is another one.
    pub(super) fn end_sweep(&mut self, sweeps: u64) {
        self.due |= self.is_due_after(sweeps);
    }

    /// A quantum of `rays`, some of them aimed.
    pub(super) fn push(&self, push: Push, rays: u32) -> Push {
        let [source_rays, sky_rays] = self.rays;
        let step_texels = self.pass.as_ref().filter(|_| self.tells).map_or(0, Aim::tells_every);
        Push { rays, source_rays, sky_rays, step_texels, mean_luminance: self.mean_luminance, ..push }
    }
}
