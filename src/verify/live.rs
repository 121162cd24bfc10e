//! Plays the engine: a baker's frames, by a clock of the case's.

use super::estimate::broken;
use crate::baker::{BakeSettings, Baker, Clock, FrameReport, FrameSettings, FrameTiming, Mode};
use crate::error::Result;
use crate::gpu::{Commands, Gpu};
use crate::scene::{Resolution, Scene};
use std::time::Duration;

/// Side of the light map, texels: room for the first charts of a row, for a frame publishes all of it.
pub(super) const SIDE: u32 = 32;
/// More than any sweep here takes.
pub(super) const AMPLE: Duration = Duration::from_secs(100);

/// A baker whose frames are recorded, submitted and waited for.
pub(super) struct Live {
    // Dropped before what it was made from.
    pub(super) baker: Baker,
    commands: Commands,
    gpu: Gpu,
    now_s: f64,
}

impl Live {
    /// By the case's own clock, whatever `frames` says.
    pub(super) fn new(gpu: &Gpu, scene: &Scene, frames: FrameSettings) -> Result<Self> {
        let gpu = gpu.as_of_an_engine()?;
        let mode = Mode::Frames(FrameSettings { clock: Clock::Engine, ..frames });
        let settings = BakeSettings { resolution: Resolution::Texels(SIDE), mode, ..BakeSettings::default() };
        Ok(Self { baker: Baker::new(&gpu, scene, &settings)?, commands: Commands::new(&gpu)?, gpu, now_s: 0.0 })
    }

    /// The device that its memory is of.
    pub(super) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// A frame, `elapsed_s` after the one before.
    pub(super) fn frame(&mut self, elapsed_s: f64, budget: Duration) -> Result<FrameReport> {
        Ok(self.timed_frame(elapsed_s, budget)?.0)
    }

    /// The same, and how long it took.
    pub(super) fn timed_frame(
        &mut self,
        elapsed_s: f64,
        budget: Duration,
    ) -> Result<(FrameReport, Option<FrameTiming>)> {
        self.now_s += elapsed_s;
        self.baker.set_time(Duration::from_secs_f64(self.now_s))?;
        let mut report = FrameReport::default();
        self.commands.run(|recorder| {
            report = self.baker.record(recorder.frame_commands(), budget)?;
            Ok(())
        })?;
        Ok((report, self.baker.complete(report.frame)?))
    }

    /// A frame that the baker submits itself; a baker's frames are all of one kind.
    pub(super) fn submitted_frame(&mut self, budget: Duration) -> Result<FrameReport> {
        let report = self.baker.submit(budget, &[], &[])?;
        // What is submitted later to the same queue is done later.
        self.commands.run(|_| Ok(()))?;
        self.baker.complete(report.frame)?;
        Ok(report)
    }

    /// Frames of whole sweeps.
    pub(super) fn frames(&mut self, count: usize, elapsed_s: f64) -> Result<()> {
        (0..count).try_for_each(|_| self.frame(elapsed_s, AMPLE).map(|_| ()))
    }

    /// Frames until a frame has time for a sweep: the first ones find out how fast the device is.
    pub(super) fn warm_up(&mut self) -> Result<()> {
        for _ in 0..200 {
            let before = self.baker.light_map().generation;
            self.frame(0.0, AMPLE)?;
            if self.baker.light_map().generation > before {
                return Ok(());
            }
        }
        Err(broken("there is no light map in 200 frames".into()))
    }

    /// Irradiance of some texels of the newest light map.
    pub(super) fn irradiance(&mut self, texels: &[usize]) -> Result<Vec<f64>> {
        let map = self.baker.read_back()?;
        Ok(texels.iter().map(|texel| f64::from(map.pixels[*texel][0])).collect())
    }

    /// Their mean.
    pub(super) fn mean(&mut self, texels: &[usize]) -> Result<f64> {
        Ok(super::estimate::mean_of(&self.irradiance(texels)?))
    }
}
