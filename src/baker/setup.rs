//! What happens once before a bake: hierarchy, maps, g-buffer, the list of texels, and every pipeline's first use.

use super::memory::MemoryEstimate;
use super::{BakeSettings, Baker, Passes, Statistics};
use crate::bvh::Bvh;
use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::{NO_FOOTPRINT, Push};
use crate::gpu::{Commands, Constants, Gpu};
use crate::pass::{Bake, Context, DeviceScene, Dilate, Direct, Gbuffer, Maps, Resolve, Settle, Source, TexelList};
use crate::scene::{Atlas, Scene, Sky};
use crate::schedule::Pace;
use glam::Vec3;
use std::ops::Range;
use std::time::Instant;

/// Rays start this far off the surface, as a share of the scene's largest extent from its middle: 64 ulps of its largest
/// coordinate. Waechter and Binder (Ray Tracing Gems, 6) use 256 ulps of the point's own coordinates, and a constant
/// below 1/32, which a scene of a millionth of a unit does not survive; relative to the scene it has no scale.
const ORIGIN_OFFSET: f64 = 1.0 / (1 << 17) as f64;

impl Baker {
    /// Prepares a bake: lays out the light map, builds the hierarchy, draws the g-buffer. Waits for the device.
    ///
    /// # Errors
    /// `InvalidSettings` for a resolution outside its range; `InvalidScene` where there is nothing to bake;
    /// `OutOfMemory`, saying what was asked for; `DeviceLost` or `Driver` from the device.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &BakeSettings) -> Result<Self> {
        let atlas = Atlas::new(scene, settings.resolution)?;
        let size = atlas.size.to_array();
        MemoryEstimate::of(scene, size).check(size, gpu.info())?;
        let mut statistics = Statistics::default();
        let started = Instant::now();
        let bvh = Bvh::build(scene, &atlas)?;
        statistics.seconds.bvh = started.elapsed().as_secs_f64();

        let started = Instant::now();
        let features = Features::required(scene);
        let mut commands = Commands::new(gpu)?;
        let device_scene = DeviceScene::new(gpu, &mut commands, scene, &bvh)?;
        let maps = Maps::new(gpu, &mut commands, size, features)?;
        let constants = Constants::new(features, &bvh);
        let context = Context { gpu, constants, scene: &device_scene, maps: &maps };
        let push = push_of(scene, settings, &bvh, &device_scene, size);
        let compile = draw_surfaces(context, &mut commands, scene, &bvh, &push)?;
        let texels = list_texels(gpu, &mut commands, &maps, &mut statistics)?;
        statistics.seconds.gbuffer = started.elapsed().as_secs_f64() - compile;

        let started = Instant::now();
        let passes = Passes::new(context, &mut commands, &texels, features)?;
        passes.first_use(&mut commands, &push)?;
        statistics.seconds.compile = compile + started.elapsed().as_secs_f64();
        Ok(Self {
            commands,
            passes,
            texels,
            maps,
            _scene: device_scene,
            atlas,
            push,
            bounces: settings.bounces,
            features,
            pace: Pace::new(settings.slice),
            state: None,
            statistics,
        })
    }
}

fn push_of(scene: &Scene, settings: &BakeSettings, bvh: &Bvh, device_scene: &DeviceScene, size: [u32; 2]) -> Push {
    let extent = scene.bounds().map_or(0.0, |(lo, hi)| ((hi - lo) * 0.5).max_element());
    let sky = if let Sky::Constant(radiance) = scene.sky() { *radiance } else { Vec3::ZERO };
    Push {
        map_size: size,
        light_count: device_scene.light_count,
        root: bvh.root(),
        sky: sky.into(),
        origin_offset: (extent * ORIGIN_OFFSET) as f32,
        seed: [settings.seed as u32, (settings.seed >> 32) as u32],
        ..Push::default()
    }
}

/// Draws the g-buffer and settles where in its texels rays may start; returns the seconds that went into compiling.
fn draw_surfaces(context: Context<'_>, commands: &mut Commands, scene: &Scene, bvh: &Bvh, push: &Push) -> Result<f64> {
    let started = Instant::now();
    let gbuffer = Gbuffer::new(context, commands, scene, bvh)?;
    let settle = Settle::new(context)?;
    let height = push.map_size[1];
    commands.run(|recorder| {
        gbuffer.record_first_use(recorder, context.maps, push);
        settle.record(recorder, push, height..height + 1);
        Ok(())
    })?;
    let compile = started.elapsed().as_secs_f64();
    commands.run(|recorder| {
        gbuffer.record(recorder, context.maps, push);
        Ok(())
    })?;
    for rows in row_slices(push.map_size) {
        commands.run(|recorder| {
            settle.record(recorder, push, rows);
            Ok(())
        })?;
    }
    Ok(compile)
}

/// Rows that make up about this many texels are settled at once: some ten short rays each, well under a second.
const SETTLED_AT_ONCE: u32 = 1 << 17;

fn row_slices([width, height]: [u32; 2]) -> impl Iterator<Item = Range<u32>> {
    let rows = (SETTLED_AT_ONCE / width).max(1).next_multiple_of(8);
    (0..height).step_by(rows as usize).map(move |first| first..(first + rows).min(height))
}

fn list_texels(gpu: &Gpu, commands: &mut Commands, maps: &Maps, statistics: &mut Statistics) -> Result<TexelList> {
    let footprints: Vec<u32> = commands.read_image(&maps.footprint)?;
    let texels = TexelList::new(gpu, commands, maps.size, |texel| footprints[texel] != NO_FOOTPRINT)?;
    let surfaces: Vec<[u32; 4]> = commands.read_image(&maps.surface)?;
    let covered = surfaces.iter().filter(|surface| surface[0] != 0).count() as u64;
    statistics.texels = u64::from(texels.count);
    statistics.invalid_texels = covered - statistics.texels;
    if statistics.texels == 0 && covered > 0 {
        return Err(Error::scene(format!(
            "all {covered} texels see the back of a surface: is the winding the wrong way round? Double-sided, they could be baked"
        )));
    }
    if statistics.invalid_texels > 0 {
        let given_up = statistics.invalid_texels;
        statistics
            .warn(format!("{given_up} of {covered} texels lie inside something and are filled from their neighbours"));
    }
    Ok(texels)
}

impl Passes {
    fn new(context: Context<'_>, commands: &mut Commands, texels: &TexelList, features: Features) -> Result<Self> {
        let direct = features.contains(Features::LIGHTS).then(|| Direct::new(context, texels)).transpose()?;
        Ok(Self {
            direct,
            source: Source::new(context, texels)?,
            bake: Bake::new(context, texels)?,
            resolve: Resolve::new(context, texels)?,
            dilate: Dilate::new(context, commands)?,
        })
    }

    /// Runs every pass on no texel: drivers that compile at the first use do so here, and not in a slice.
    fn first_use(&self, commands: &mut Commands, push: &Push) -> Result<()> {
        let nothing = Push { map_size: [0, 0], strata_side: 1, ..*push };
        commands.run(|recorder| {
            if let Some(direct) = &self.direct {
                direct.record(recorder, &nothing, 0..0);
            }
            self.source.record(recorder, &nothing, 0..0);
            self.bake.record(recorder, &nothing, 0..0, 0..0);
            self.resolve.record(recorder, &nothing, 0..0);
            self.dilate.record(recorder, &nothing);
            Ok(())
        })?;
        Ok(())
    }
}
