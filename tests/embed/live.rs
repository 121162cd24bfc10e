//! A baker that runs in an engine's frames by a clock of the test's.

use crate::engine::Engine;
use crate::stage::SIDE;
use lightoven::baker::{BakeSettings, Baker, Clock, FrameReport, FrameSettings, Mode, Sampling};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{Resolution, Scene};
use std::time::Duration;

/// More than any sweep here takes.
pub(crate) const AMPLE: Duration = Duration::from_secs(100);

pub(crate) struct Live {
    pub(crate) engine: Engine,
    pub(crate) baker: Baker,
    now_s: f64,
}

impl Live {
    /// By the test's own clock, whatever `frames` says.
    pub(crate) fn new(backend: BackendChoice, scene: &Scene, frames: FrameSettings) -> Option<Self> {
        Self::sampled(backend, scene, frames, Sampling::Auto)
    }

    pub(crate) fn sampled(
        backend: BackendChoice,
        scene: &Scene,
        frames: FrameSettings,
        sampling: Sampling,
    ) -> Option<Self> {
        let engine = Engine::new(backend)?;
        let frames = FrameSettings { clock: Clock::Engine, ..frames };
        let settings = BakeSettings {
            resolution: Resolution::Texels(SIDE),
            mode: Mode::Frames(frames),
            sampling,
            ..BakeSettings::default()
        };
        let baker = Baker::new(engine.gpu(), scene, &settings).unwrap();
        Some(Self { engine, baker, now_s: 0.0 })
    }

    /// A frame, `elapsed_s` after the one before.
    pub(crate) fn frame(&mut self, elapsed_s: f64, budget: Duration) -> FrameReport {
        self.now_s += elapsed_s;
        self.baker.set_time(Duration::from_secs_f64(self.now_s)).unwrap();
        self.engine.record_frame(&mut self.baker, budget, None).0
    }

    /// Frames of whole sweeps.
    pub(crate) fn frames(&mut self, count: usize, elapsed_s: f64) {
        for _ in 0..count {
            self.frame(elapsed_s, AMPLE);
        }
    }

    /// Frames until a frame has time for a sweep: the first ones find out how fast the device is.
    pub(crate) fn warm_up(&mut self) {
        for _ in 0..200 {
            let before = self.baker.light_map().generation;
            self.frame(0.0, AMPLE);
            if self.baker.light_map().generation > before {
                return;
            }
        }
        panic!("no light map in 200 frames");
    }

    /// Irradiance of some texels of the newest light map.
    pub(crate) fn irradiance(&mut self, texels: &[usize]) -> Vec<f64> {
        let map = self.baker.read_back().unwrap();
        texels.iter().map(|texel| f64::from(map.pixels[*texel][0])).collect()
    }

    pub(crate) fn mean(&mut self, texels: &[usize]) -> f64 {
        self.irradiance(texels).iter().sum::<f64>() / texels.len() as f64
    }

    pub(crate) fn finish(self) {
        drop(self.baker);
        self.engine.finish();
    }
}
