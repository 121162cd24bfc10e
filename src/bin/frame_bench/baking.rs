//! The library as the engine embeds it.

use crate::arguments::Arguments;
use crate::engine::{Commands, Device, Hosted, LightMapView, Timeline, frame_commands, timeline_point};
use crate::motion::Pose;
use crate::report::Setting;
use crate::row::Phase;
use crate::world::World;
use lightoven::Result;
use lightoven::baker::{BakeSettings, FrameReport, FrameSettings, Learning, MeasuredBy, Mode};
use lightoven::scene::{Atlas, Resolution};
use std::rc::Rc;
use std::time::Duration;

/// The baker of a scene, on the engine's device.
pub(crate) struct Baking {
    hosted: Hosted,
    scene: String,
    bake_queue: &'static str,
    /// What told the last bake's time.
    measured_by: Option<MeasuredBy>,
}

/// What a frame's bake took.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Taken {
    pub(crate) bake: Duration,
    pub(crate) first_use: bool,
}

impl Baking {
    pub(crate) fn new(device: &Rc<Device>, world: &World, arguments: &Arguments) -> Result<Self> {
        let settings = BakeSettings {
            resolution: Resolution::Texels(arguments.resolution),
            seed: arguments.seed,
            mode: Mode::Frames(FrameSettings::default()),
            ..BakeSettings::default()
        };
        let hosted = Hosted::new(device, &world.scene, &settings)?;
        let submits = arguments.mode == crate::arguments::Mode::Submit;
        let bake_queue = if submits && device.has_compute_queue() { "another" } else { "the engine's" };
        Ok(Self { hosted, scene: world.scene.name().into(), bake_queue, measured_by: None })
    }

    pub(crate) fn atlas(&self) -> &Atlas {
        self.hosted.baker.atlas()
    }

    /// What the frames run on, as far as it is known by now.
    pub(crate) fn setting(&self) -> Setting {
        let Hosted { baker, info, backend, .. } = &self.hosted;
        Setting {
            scene: self.scene.clone(),
            device: info.name.clone(),
            driver: info.driver.clone(),
            backend,
            bake_queue: self.bake_queue,
            bake_clock: match self.measured_by {
                Some(MeasuredBy::Timestamps) => "device",
                _ => "host",
            },
            resolution: baker.atlas().size.to_array(),
            texels: baker.statistics().texels,
        }
    }

    /// The overlap is measured with work that does not depend on what it takes.
    pub(crate) fn set_phase(&mut self, phase: Phase) -> Result<()> {
        let learning = if phase == Phase::Overlap { Learning::Held } else { Learning::On };
        self.hosted.baker.set_learning(learning)
    }

    /// Tells the library what has moved.
    pub(crate) fn place(&mut self, world: &World, pose: &Pose) -> Result<()> {
        let baker = &mut self.hosted.baker;
        baker.set_transform(world.mover, world.mover_transform(pose))?;
        baker.set_light(world.lamp, world.lamp_light(pose))
    }

    /// Records this frame's share into the engine's commands.
    pub(crate) fn record(&mut self, commands: &Commands, budget: Duration) -> Result<FrameReport> {
        self.hosted.baker.record(frame_commands(commands), budget)
    }

    /// Submits this frame's share; the timeline's next value tells when it has finished.
    pub(crate) fn submit(&mut self, timeline: &mut Timeline, budget: Duration) -> Result<FrameReport> {
        self.hosted.baker.submit(budget, &[], &[timeline_point(timeline)])
    }

    /// Tells the library that the frame has finished. One that had nothing to do took no time.
    pub(crate) fn complete(&mut self, report: &FrameReport) -> Result<Taken> {
        let Some(timing) = self.hosted.baker.complete(report.frame)? else { return Ok(Taken::default()) };
        self.measured_by = Some(timing.measured_by);
        Ok(Taken { bake: timing.bake, first_use: timing.first_use })
    }

    /// The newest finished light map.
    pub(crate) fn light_map(&self) -> LightMapView {
        let map = self.hosted.baker.light_map();
        LightMapView { view: map.view, layout: map.layout }
    }
}
