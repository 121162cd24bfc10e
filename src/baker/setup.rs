//! What happens once before a bake: hierarchy, maps, g-buffer, the list of texels, and every pipeline's first use.

use super::dark::{Dark, is_dark, nothing_to_bake};
use super::frames::Frames;
use super::memory::MemoryEstimate;
use super::still::Still;
use super::{BakeSettings, Baker, Core, Mode, Running, Sampling, Statistics};
use crate::bvh::{Bvh, InstanceRecord, Motion};
use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::{NO_FOOTPRINT, Push};
use crate::gpu::{Commands, Constants, Gpu};
use crate::pass::{
    Context, DeviceScene, Gbuffer, Links, Maps, Nothing, Pieces, Settle, Sources, TexelKind, TexelList, activity,
};
use crate::scene::{Atlas, Scene, Sky};
use glam::Vec3;
use std::ops::Range;
use std::time::Instant;

/// Rays start this far off the surface, as a share of the scene's largest extent from its middle: 64 ulps of its largest
/// coordinate. Waechter and Binder (Ray Tracing Gems, 6) use 256 ulps of the point's own coordinates, and a constant
/// below 1/32, which a scene of a millionth of a unit does not survive; relative to the scene it has no scale.
const ORIGIN_OFFSET: f64 = 1.0 / (1 << 17) as f64;

/// For a scene that reaches this far from its middle.
pub(super) fn origin_offset(reach: f64) -> f32 {
    (reach * ORIGIN_OFFSET) as f32
}

impl Baker {
    /// Prepares a bake: lays out the light map, builds the hierarchy, draws the g-buffer. Waits for the device. With
    /// [`Mode::Still`] nothing of this is done where the light map can only be black; a warning says why.
    ///
    /// # Errors
    /// `InvalidSettings` for a setting outside its range; `InvalidScene` where the scene is smaller than 1e-12 units, and
    /// with [`Mode::Frames`] where there is nothing to bake; `OutOfMemory`,
    /// saying what was asked for; `DeviceLost` or `Driver` from the device.
    pub fn new(gpu: &Gpu, scene: &Scene, settings: &BakeSettings) -> Result<Self> {
        check(gpu, settings)?;
        check_size(scene)?;
        let started = Instant::now();
        let atlas = Atlas::new(scene, settings.resolution)?;
        let estimate = MemoryEstimate::of_bake(scene, &atlas, settings);
        estimate.check(atlas.size.to_array(), gpu.info())?;
        if is_dark(scene, &atlas, settings) {
            return Ok(Self(Running::Dark(Box::new(Dark::new(gpu, scene, atlas, settings.error)?))));
        }
        if atlas.touched_texels == 0 {
            return Err(Error::scene(nothing_to_bake(scene)));
        }
        let features = estimate.features;
        let mut statistics = Statistics::default();
        statistics.seconds.gbuffer = started.elapsed().as_secs_f64();
        let started = Instant::now();
        let motion = match settings.mode {
            Mode::Still if settings.unneeded.contains(Features::INSTANCES) => Motion::NoneUnderTop,
            Mode::Still => Motion::None,
            Mode::Frames(_) => Motion::OfMovables,
        };
        if settings.sampling == Sampling::Importance {
            warn_of_what_is_missed(scene, features, &mut statistics);
        }
        let mut bvh = Bvh::build_for(scene, &atlas, motion)?;
        statistics.seconds.bvh = started.elapsed().as_secs_f64();
        let mut core = Core::new(gpu, scene, settings, &mut bvh, atlas, features, statistics, None)?;

        let started = Instant::now();
        Ok(Self(match settings.mode {
            Mode::Still => {
                let still = Still::new(&mut core, settings)?;
                core.statistics.seconds.compile += started.elapsed().as_secs_f64();
                Running::Still(Box::new((core, still)))
            }
            Mode::Frames(frames) => {
                let frames = Frames::new(&mut core, scene, bvh, frames, settings.sampling)?;
                core.statistics.seconds.compile += started.elapsed().as_secs_f64();
                Running::Frames(Box::new((core, frames)))
            }
        }))
    }
}

/// Aimed rays alone do not find everything.
fn warn_of_what_is_missed(scene: &Scene, features: Features, statistics: &mut Statistics) {
    if matches!(scene.sky(), Sky::Constant(radiance) if *radiance != Vec3::ZERO) {
        statistics
            .warn("sampling by importance alone leaves out the sky, which has one radiance; mixtures see it".into());
    }
    let emits = scene.materials().iter().any(crate::scene::Material::is_emissive);
    if features.contains(Features::UNMAPPED) && emits {
        statistics.warn(
            "sampling by importance alone leaves out what emits without light-map coordinates; mixtures see it".into(),
        );
    }
}

/// Units. A scene of 1e-16 baked black: areas of its texels, and what is made of them, are no 32-bit numbers. This leaves
/// room for fine light maps.
const LEAST_REACH: f64 = 1e-12;

pub(super) fn check_size(scene: &Scene) -> Result<()> {
    let reach = reach(scene);
    if reach == 0.0 || reach >= LEAST_REACH {
        return Ok(());
    }
    let name = scene.name();
    Err(Error::scene(format!(
        "scene '{name}' reaches {reach:e} units from its middle; allowed is at least {LEAST_REACH:e}"
    )))
}

/// From the scene's middle along any axis; 0 of an empty scene.
fn reach(scene: &Scene) -> f64 {
    scene.bounds().map_or(0.0, |(lo, hi)| ((hi - lo) * 0.5).max_element())
}

fn check(gpu: &Gpu, settings: &BakeSettings) -> Result<()> {
    settings.check()?;
    if matches!(settings.mode, Mode::Frames(_)) && gpu.is_owned() {
        return Err(Error::settings("a bake within frames works on an engine's device; this one is lightoven's own"));
    }
    Ok(())
}

impl Core {
    /// What passes are made from.
    pub(super) fn context(&self) -> Context<'_> {
        Context { gpu: &self.gpu, constants: self.constants, scene: &self.scene, maps: &self.maps }
    }

    /// `kept`: what the maps of the same layout were made for whose light is taken over.
    #[expect(clippy::too_many_arguments, reason = "all that a bake is made from, in one place")]
    pub(super) fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &BakeSettings,
        bvh: &mut Bvh,
        atlas: Atlas,
        mut features: Features,
        mut statistics: Statistics,
        kept: Option<&Self>,
    ) -> Result<Self> {
        let started = Instant::now();
        let size = atlas.size.to_array();
        let moves = |index: &usize| bvh.instances[*index].flags & InstanceRecord::MOVABLE != 0;
        let movable: Vec<usize> = (0..bvh.instances.len()).filter(moves).collect();
        // What may leave does not decide which texels are inside something.
        set_present(bvh, &movable, false);
        let mut commands = Commands::new(gpu)?;
        let nothing = Nothing::new(&mut commands)?;
        let mut device_scene = DeviceScene::new(gpu, &mut commands, scene, bvh, features, &nothing)?;
        let kept = kept.map(|kept| (&kept.maps, kept.features));
        let mut maps = Maps::new(gpu, &mut commands, size, device_scene.sky_size(), features, &nothing, kept)?;
        let constants = Constants::new(features, bvh);
        let context = Context { gpu, constants, scene: &device_scene, maps: &maps };
        let push = push_of(scene, settings, bvh, &device_scene, size);
        let compile = draw_surfaces(context, &mut commands, scene, bvh, &push)?;
        let surfaces: Vec<[u32; 4]> = commands.read_image(&maps.surface)?;
        let texels = list_texels(gpu, &mut commands, &maps, &surfaces, &mut statistics)?;
        let before_aiming = Instant::now();
        if features.contains(Features::IMPORTANCE) {
            let pieces = Pieces::new(&mut commands, scene, bvh, &device_scene, size, &surfaces)?;
            if let Some(Pieces { codes, list }) = pieces {
                features |= Features::SHARED_TEXELS;
                (maps.pieces, device_scene.pieces) = (codes, list);
            } else if features.contains(Features::SHARED_TEXELS) {
                maps.pieces = Pieces::codes_of_none(&mut commands, size)?;
            }
            if features.contains(Features::CLUSTERS) {
                let blind = (!features.contains(Features::VISIBILITY)).then_some(&nothing);
                maps.sources = Sources::new(&mut commands, blind, bvh, &device_scene, size, &surfaces)?;
            }
            device_scene.host_primitives = Vec::new();
        }
        statistics.seconds.aiming = before_aiming.elapsed().as_secs_f64();
        let linked_rays = Links::rays(u64::from(texels.count)).filter(|_| features.contains(Features::LINKS));
        features.set(Features::LINKS, linked_rays.is_some());
        if let Some(rays) = linked_rays {
            maps.links = Links::new(gpu, texels.count, rays)?;
        }
        if features.contains(Features::GATHERING) && !features.contains(Features::DYNAMIC) {
            maps.activity = activity(&mut commands, texels.fields.len())?;
        }
        let constants = Constants::new(features, bvh);
        if !movable.is_empty() {
            set_present(bvh, &movable, true);
            commands.run(|recorder| device_scene.record_placing(recorder, bvh, 0..bvh.instances.len()))?;
        }
        statistics.seconds.compile = compile;
        statistics.seconds.gbuffer += started.elapsed().as_secs_f64() - compile - statistics.seconds.aiming;
        let (gpu, settings) = (gpu.clone(), settings.clone());
        Ok(Self {
            gpu,
            settings,
            commands,
            constants,
            texels,
            maps,
            scene: device_scene,
            atlas,
            push,
            features,
            looks: if features.contains(Features::DYNAMIC) { scene.looks() } else { 0 },
            statistics,
        })
    }
}

fn set_present(bvh: &mut Bvh, instances: &[usize], present: bool) {
    if !instances.is_empty() {
        instances.iter().for_each(|instance| bvh.set_present(*instance, present));
        bvh.rebuild_top_level();
    }
}

fn push_of(scene: &Scene, settings: &BakeSettings, bvh: &Bvh, device_scene: &DeviceScene, size: [u32; 2]) -> Push {
    let sky = if let Sky::Constant(radiance) = scene.sky() { *radiance } else { Vec3::ZERO };
    Push {
        map_size: size,
        light_count: device_scene.light_count,
        root: bvh.root(),
        sky: sky.into(),
        origin_offset: origin_offset(reach(scene)),
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

fn list_texels(
    gpu: &Gpu,
    commands: &mut Commands,
    maps: &Maps,
    surfaces: &[[u32; 4]],
    statistics: &mut Statistics,
) -> Result<TexelList> {
    let footprints: Vec<u32> = commands.read_image(&maps.footprint)?;
    let texels = TexelList::new(gpu, commands, maps.size, |texel| match (surfaces[texel][0], footprints[texel]) {
        (0, _) => TexelKind::Empty,
        (_, NO_FOOTPRINT) => TexelKind::GivenUp,
        _ => TexelKind::Baked,
    })?;
    statistics.texels = u64::from(texels.count);
    statistics.invalid_texels = u64::from(texels.given_up);
    let covered = statistics.texels + statistics.invalid_texels;
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
