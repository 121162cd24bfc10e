//! A baker: of a scene that stays as it is, until its light map is good enough (`still.rs`), or of one that changes, within
//! an engine's frames (`frames`).

mod aiming;
mod dark;
mod frames;
mod gather_bench;
mod keeping;
mod memory;
mod needs;
mod progress;
mod renewal;
mod settings;
mod setup;
mod still;

pub use crate::epochs::Bounces;
pub use crate::sampling::{AimedBy, Sampling, SamplingStatistics};
pub use crate::schedule::Slice;
pub use frames::{Clock, FrameId, FrameReport, FrameSettings, FrameTiming, Learning, MeasuredBy, Ran, Timing};
pub use gather_bench::{GatherBench, SentRays};
pub use memory::{MemoryEstimate, estimate_memory};
use progress::Stretch;
pub use progress::{Outcome, Phase, Progress, Seconds, Statistics, Stop};
pub use settings::{BakeSettings, ErrorEstimate, Mode};

use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::Push;
use crate::gpu::{Commands, Constants, FrameCommands, Gpu, TimelinePoint};
use crate::pass::{DeviceScene, Maps, TexelList};
use crate::scene::{Atlas, Light, Sky};
use ash::vk;
use dark::Dark;
use frames::{Frames, Shown};
use glam::{DAffine3, Vec3};
use std::ops::ControlFlow;
use std::time::Duration;
use still::Still;

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

/// The newest finished light map on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeviceLightMap {
    /// The image.
    pub image: vk::Image,
    /// A view of all of it; one of three, and the same for the same image.
    pub view: vk::ImageView,
    /// The layout that the image is in, now and always.
    pub layout: vk::ImageLayout,
    /// RGB: irradiance, linear Rec. 709, scene units; A: 1 where the texel lies on a surface, else 0. Gutters are filled.
    pub format: vk::Format,
    /// Width and height in texels. Row 0 is light-map coordinate v = 0.
    pub size: [u32; 2],
    /// Grows by 1 with every finished map; 0: none is finished yet, and this one is black. Always 0 with [`Mode::Still`].
    pub generation: u64,
    /// Sweeps over all texels that it holds. Always 0 with [`Mode::Still`].
    pub sweeps: u64,
}

/// Bakes the light map of one scene on one device.
///
/// # Dropping
/// Dropping a baker does not wait. It may be dropped once every frame that it recorded or submitted, and every frame that
/// uses one of its light maps, has finished on the device; the device itself goes later. Methods that wait
/// ([`Baker::new`], [`Baker::bake`], [`Baker::read_back`]) leave nothing behind.
///
/// # Within an engine's frames
/// A baker made with [`Mode::Frames`] works in one of two ways, from its first frame on: [`Baker::record`] into the
/// engine's command buffer, or [`Baker::submit`] to a queue for compute. Each call is a frame, with an id. The engine
/// reports with [`Baker::complete`] when a frame has finished on the device, and uses [`Baker::light_map`] in between. The
/// baker never waits within a frame. What has changed in the scene is told before the frame, and a change that is refused
/// leaves everything as it was.
pub struct Baker(Running);

/// What both ways of baking work on.
struct Core {
    gpu: Gpu,
    settings: BakeSettings,
    commands: Commands,
    constants: Constants,
    texels: TexelList,
    maps: Maps,
    scene: DeviceScene,
    atlas: Atlas,
    push: Push,
    features: Features,
    /// Of what surfaces look like; 0 where the scene does not change.
    looks: u64,
    statistics: Statistics,
}

enum Running {
    Dark(Box<Dark>),
    Still(Box<(Core, Still)>),
    Frames(Box<(Core, Frames)>),
}

impl Baker {
    /// Bakes until `stop`, or until `progress` breaks; a later call goes on from there. In between,
    /// [`Baker::read_back`] gives the light map as far as it is.
    ///
    /// # Errors
    /// `InvalidSettings` for a stop outside its range, or with [`Mode::Frames`]; `InvalidScene` where light grows without
    /// end; `DeviceLost`, `OutOfMemory` or `Driver` from the device.
    pub fn bake(&mut self, stop: &Stop, progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Outcome> {
        self.bake_stretch(stop, Stretch::Whole, progress)
    }

    /// [`Baker::bake`] for one that looks at the light map on the way: `stop.time` is what all calls take together, so that
    /// the bake's clock stands still between them, and nothing is said of bounces that are missing, for the bake goes on.
    /// The samples are those of a bake at a stretch.
    ///
    /// # Errors
    /// As [`Baker::bake`].
    pub fn bake_until(
        &mut self,
        stop: &Stop,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome> {
        self.bake_stretch(stop, Stretch::Part, progress)
    }

    fn bake_stretch(
        &mut self,
        stop: &Stop,
        stretch: Stretch,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome> {
        match &mut self.0 {
            Running::Dark(dark) => dark.bake(stop, progress),
            Running::Still(still) => still.1.bake(&mut still.0, stop, stretch, progress),
            Running::Frames(_) => Err(Error::settings(
                "a bake within frames is not baked at a stretch; one that is made without frames is",
            )),
        }
    }

    /// The light map as far as it has been baked, gutters filled: waits for the device. With [`Mode::Frames`] the newest
    /// finished one, for tools and tests; no frame is then under way.
    ///
    /// # Errors
    /// `DeviceLost`, `OutOfMemory` or `Driver` from the device.
    pub fn read_back(&mut self) -> Result<LightMap> {
        match &mut self.0 {
            Running::Dark(dark) => Ok(dark.read_back()),
            Running::Still(still) => still.1.read_back(&mut still.0),
            Running::Frames(running) => {
                let (core, frames) = &mut **running;
                let pixels = core.commands.read_image(&core.maps.light_map[frames.light_map().map])?;
                let [width, height] = core.maps.size;
                Ok(LightMap { width, height, pixels })
            }
        }
    }

    /// Records a frame's work into the engine's command buffer: about as much as the device does in `budget`, and nothing
    /// for 0. What the engine records afterwards sees the map that [`Baker::light_map`] then gives.
    ///
    /// # Errors
    /// `InvalidSettings` without [`Mode::Frames`], or after [`Baker::submit`]; `Unsupported` or `Driver` from the device,
    /// after which the baker can only be dropped.
    pub fn record(&mut self, commands: FrameCommands, budget: Duration) -> Result<FrameReport> {
        let (frames, core) = self.frames()?;
        frames.record(core, commands, budget)
    }

    /// Submits a frame's work to the queue for compute (the same queue where the device has one): about as much as the
    /// device does in `budget`, and nothing for 0. It begins when all of `wait` are reached; all of `signal` follow it, even
    /// where there was nothing to do. A map that it finishes is given by [`Baker::light_map`] once the frame has been
    /// reported complete; a submission that uses the map waits for the frame's `signal`, which is reached by then.
    ///
    /// # Errors
    /// `InvalidSettings` without [`Mode::Frames`], or after [`Baker::record`]; `DeviceLost`, `OutOfMemory` or `Driver` from
    /// the device, after which the baker can only be dropped.
    pub fn submit(
        &mut self,
        budget: Duration,
        wait: &[TimelinePoint],
        signal: &[TimelinePoint],
    ) -> Result<FrameReport> {
        let (frames, core) = self.frames()?;
        frames.submit(core, budget, wait, signal)
    }

    /// The engine reports: this frame and all before it have finished on the device, with all that used a light map in
    /// them. Returns how long the frame took; `None` where it had nothing to do or was reported before.
    ///
    /// # Errors
    /// `InvalidSettings` for a frame that was not begun, or without [`Mode::Frames`].
    pub fn complete(&mut self, frame: FrameId) -> Result<Option<FrameTiming>> {
        self.frames()?.0.complete(frame)
    }

    /// The newest finished light map. It is not written again before the frame after the one that replaced it has been
    /// reported complete: use it in the next frame that is recorded, and ask again for the one after. With [`Mode::Still`]
    /// the only one, which [`Baker::read_back`] finishes.
    pub fn light_map(&self) -> DeviceLightMap {
        let Shown { map, generation, sweeps } = match &self.0 {
            Running::Dark(_) | Running::Still(_) => Shown::default(),
            Running::Frames(frames) => frames.1.light_map(),
        };
        let image = match &self.0 {
            Running::Dark(dark) => &dark.image,
            Running::Still(still) => &still.0.maps.light_map[map],
            Running::Frames(frames) => &frames.0.maps.light_map[map],
        };
        let (size, (image, view)) = (image.size(), image.handles());
        let (layout, format) = (vk::ImageLayout::GENERAL, vk::Format::R32G32B32A32_SFLOAT);
        DeviceLightMap { image, view, layout, format, size, generation, sweeps }
    }

    /// Moves an instance, counted as in [`crate::scene::Scene::instances`]. The g-buffer, in object space, stays as it is.
    ///
    /// # Errors
    /// `InvalidSettings`: an instance that does not exist or was not declared [`crate::scene::Mobility::Movable`], a
    /// transform that is singular or not finite. `Unsupported`: it moved so far away, or shrank so far beside the scene,
    /// that the hierarchy is no longer precise enough: by some 16 times the scene's half extent.
    pub fn set_transform(&mut self, instance: usize, object_to_world: DAffine3) -> Result<()> {
        self.frames()?.0.world.set_transform(instance, &object_to_world)
    }

    /// Takes an instance out of the scene; its texels take no rays.
    ///
    /// # Errors
    /// `InvalidSettings`: an instance that does not exist or was not declared movable.
    pub fn remove_instance(&mut self, instance: usize) -> Result<()> {
        self.frames()?.0.world.set_present(instance, false)
    }

    /// Puts an instance back that was taken out.
    ///
    /// # Errors
    /// As [`Baker::remove_instance`].
    pub fn add_instance(&mut self, instance: usize) -> Result<()> {
        self.frames()?.0.world.set_present(instance, true)
    }

    /// Replaces an analytic light, counted as in [`crate::scene::Scene::lights`]; an intensity of 0 switches it off.
    ///
    /// # Errors
    /// `InvalidSettings`: a light that does not exist. `InvalidScene`: a value that [`crate::scene::Scene::new`] would
    /// refuse too.
    pub fn set_light(&mut self, light: usize, value: Light) -> Result<()> {
        self.frames()?.0.world.set_light(light, value)
    }

    /// Changes what a material emits, before its texture: radiance, linear Rec. 709. Counted as in
    /// [`crate::scene::Scene::materials`].
    ///
    /// # Errors
    /// `InvalidSettings`: a material that does not exist. `InvalidScene`: a radiance that is negative or not finite.
    pub fn set_emission(&mut self, material: usize, emission: Vec3) -> Result<()> {
        let (frames, core) = self.frames()?;
        frames.world.set_emission(&mut core.scene, material, emission)
    }

    /// Replaces the sky. A scene that was declared with a map takes maps of its size; one without takes none.
    ///
    /// # Errors
    /// `InvalidSettings`: a map that does not fit. `InvalidScene`: a radiance that is negative or not finite.
    pub fn set_sky(&mut self, sky: Sky) -> Result<()> {
        let (frames, core) = self.frames()?;
        let shines = sky.shines();
        frames.world.set_sky(&mut core.push, sky)?;
        core.scene.sky_shines = shines;
        Ok(())
    }

    /// The time of the next frame, with [`Clock::Engine`]; from any beginning. Time that runs backwards stands still.
    ///
    /// # Errors
    /// `InvalidSettings` without [`Mode::Frames`].
    pub fn set_time(&mut self, now: Duration) -> Result<()> {
        self.frames()?.0.set_time(now);
        Ok(())
    }

    /// Whether the cost model goes on learning.
    ///
    /// # Errors
    /// `InvalidSettings` without [`Mode::Frames`].
    pub fn set_learning(&mut self, learning: Learning) -> Result<()> {
        self.frames()?.0.set_learning(learning);
        Ok(())
    }

    /// Rays that a frame of this budget has for each texel, as far as is known: rays a second * budget / texels. 0 with
    /// [`Mode::Still`].
    pub fn samples_per_texel(&self, budget: Duration) -> f64 {
        match &self.0 {
            Running::Dark(_) | Running::Still(_) => 0.0,
            Running::Frames(frames) => frames.1.samples_per_texel(&frames.0, budget),
        }
    }

    fn frames(&mut self) -> Result<(&mut Frames, &mut Core)> {
        match &mut self.0 {
            Running::Frames(running) => {
                let (core, frames) = &mut **running;
                Ok((frames, core))
            }
            Running::Dark(_) | Running::Still(_) => {
                Err(Error::settings("a bake at a stretch knows no frames and no changes; one within frames does"))
            }
        }
    }

    /// The layout of the light map.
    pub fn atlas(&self) -> &Atlas {
        self.core().map_or_else(|dark| &dark.atlas, |core| &core.atlas)
    }

    /// What the scene needs; all else was left out. Nothing, where the light map can only be black.
    pub fn features(&self) -> Features {
        self.core().map_or(Features::empty(), |core| core.features)
    }

    /// What has been done so far.
    pub fn statistics(&self) -> &Statistics {
        self.core().map_or_else(|dark| &dark.statistics, |core| &core.statistics)
    }

    fn core(&self) -> std::result::Result<&Core, &Dark> {
        match &self.0 {
            Running::Dark(dark) => Err(dark),
            Running::Still(still) => Ok(&still.0),
            Running::Frames(frames) => Ok(&frames.0),
        }
    }
}
