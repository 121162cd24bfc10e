//! The scene as it changes between frames: checked when it is told, written to the device with the next frame.

use super::report::{FrameId, Ran};
use super::sky_map::SkyUpload;
use crate::baker::Core;
use crate::baker::setup::origin_offset;
use crate::bvh::Bvh;
use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::{self, Push};
use crate::gpu::{Gpu, Recorder};
use crate::pass::{DeviceScene, encode_light};
use crate::scene::{Light, Mobility, Scene, Sky, check_light_quantity};
use glam::{DAffine3, Vec3};
use std::ops::Range;

bitflags::bitflags! {
    /// What the device does not know yet.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub(super) struct Changes: u32 {
        const PLACING = 1;
        const LIGHTS = 1 << 1;
        const EMISSION = 1 << 2;
        const SKY = 1 << 3;
    }
}

/// The host's side of a scene that changes.
pub(in crate::baker) struct World {
    bvh: Bvh,
    instances: Vec<InstanceState>,
    lights: Vec<layout::Light>,
    materials: usize,
    sky_map: Option<SkyUpload>,
    changes: Changes,
    /// Instances whose records have changed.
    touched: Range<usize>,
}

struct InstanceState {
    name: String,
    mobility: Mobility,
    present: bool,
}

impl World {
    pub(super) fn new(gpu: &Gpu, scene: &Scene, bvh: Bvh, features: Features) -> Result<Self> {
        let state = |instance: &crate::scene::Instance| InstanceState {
            name: instance.name.clone(),
            mobility: instance.mobility,
            present: true,
        };
        let sky_map = match scene.sky() {
            Sky::Map(map) if features.contains(Features::SKY_MAP) => Some(SkyUpload::new(gpu, map)?),
            _ => None,
        };
        Ok(Self {
            instances: scene.instances().iter().map(state).collect(),
            lights: scene.lights().iter().map(|light| encode_light(light, bvh.centre)).collect(),
            materials: scene.materials().len(),
            sky_map,
            bvh,
            changes: Changes::empty(),
            touched: 0..0,
        })
    }

    /// Goes on from `old`: what was taken out stays out, and what differs has changed.
    pub(super) fn follow(&mut self, old: &Self, before: &Core, after: &Core) {
        let mut reappears = false;
        for (index, state) in old.instances.iter().enumerate() {
            if !state.present && self.instances[index].mobility == Mobility::Movable {
                self.instances[index].present = false;
                self.bvh.set_present(index, false);
            }
            reappears |= !state.present && self.instances[index].present;
        }
        let sky = |world: &Self, core: &Core| (core.push.sky, world.sky_map.as_ref().map(|map| map.pixels().to_vec()));
        let placed = |world: &Self| world.bvh.instances.iter().map(|record| record.object_to_world).collect::<Vec<_>>();
        self.touched = 0..self.instances.len();
        // What was told and never came to be in a frame.
        let mut changes = old.changes;
        changes.set(Changes::PLACING, changes.contains(Changes::PLACING) || reappears || placed(old) != placed(self));
        changes.set(Changes::LIGHTS, changes.contains(Changes::LIGHTS) || old.lights != self.lights);
        let emits_otherwise = before.scene.radiators.materials != after.scene.radiators.materials;
        let looks_otherwise = emits_otherwise || before.looks != after.looks;
        changes.set(Changes::EMISSION, changes.contains(Changes::EMISSION) || looks_otherwise);
        changes.set(Changes::SKY, changes.contains(Changes::SKY) || sky(old, before) != sky(self, after));
        // A hierarchy that was made with all of them knows nothing of those that are out.
        let any_is_out = self.instances.iter().any(|state| !state.present);
        self.changes = changes | if any_is_out { Changes::PLACING } else { Changes::empty() };
    }

    pub(in crate::baker) fn set_transform(&mut self, instance: usize, transform: &DAffine3) -> Result<()> {
        let state = self.movable(instance)?;
        let name = &state.name;
        let matrix = transform.matrix3;
        let scale = matrix.x_axis.length() * matrix.y_axis.length() * matrix.z_axis.length();
        // As `Instance::check` has it.
        if !transform.is_finite() || matrix.determinant().abs() <= 1e-12 * scale || !matrix.inverse().is_finite() {
            return Err(Error::settings(format!(
                "the transform of instance {instance} '{name}' is {matrix}, {}; allowed are finite, invertible ones",
                transform.translation
            )));
        }
        if self.bvh.place(instance, transform)? {
            self.touch(instance);
            // What is absent moves unseen.
            self.changes
                .set(Changes::PLACING, self.changes.contains(Changes::PLACING) || self.instances[instance].present);
        }
        Ok(())
    }

    fn touch(&mut self, instance: usize) {
        let Range { start, end } = self.touched;
        self.touched = if start == end { instance..instance + 1 } else { start.min(instance)..end.max(instance + 1) };
    }

    pub(in crate::baker) fn set_present(&mut self, instance: usize, present: bool) -> Result<()> {
        self.movable(instance)?;
        let state = &mut self.instances[instance];
        if state.present != present {
            state.present = present;
            self.bvh.set_present(instance, present);
            self.touch(instance);
            self.changes |= Changes::PLACING;
        }
        Ok(())
    }

    pub(in crate::baker) fn set_light(&mut self, light: usize, value: Light) -> Result<()> {
        let count = self.lights.len();
        let value = value.checked()?;
        let known = self.lights.get_mut(light).ok_or_else(|| unknown("light", light, count))?;
        let value = encode_light(&value, self.bvh.centre);
        if *known != value {
            *known = value;
            self.changes |= Changes::LIGHTS;
        }
        Ok(())
    }

    pub(in crate::baker) fn set_emission(
        &mut self,
        scene: &mut DeviceScene,
        material: usize,
        emission: Vec3,
    ) -> Result<()> {
        if material >= self.materials {
            return Err(unknown("material", material, self.materials));
        }
        check_light_quantity(|| format!("the emission of material {material}"), emission)?;
        if scene.radiators.set_emission(material, emission) {
            self.changes |= Changes::EMISSION;
        }
        Ok(())
    }

    pub(in crate::baker) fn set_sky(&mut self, push: &mut Push, sky: Sky) -> Result<()> {
        sky.check()?;
        let constant = match &sky {
            Sky::Black => Vec3::ZERO,
            Sky::Constant(radiance) => *radiance,
            Sky::Map(_) if self.sky_map.is_none() => {
                return Err(Error::settings(
                    "the sky is a map, but the scene was declared without one; allowed are black and constant skies",
                ));
            }
            Sky::Map(_) => Vec3::ZERO,
        };
        let changed = match &mut self.sky_map {
            Some(upload) => upload.set(sky)?,
            None => std::mem::replace(&mut push.sky, constant.into()) != constant.to_array(),
        };
        if changed {
            self.changes |= Changes::SKY;
        }
        Ok(())
    }

    /// Writes what has changed. Returns what that was, and the passes that it took.
    pub(super) fn record(
        &mut self,
        recorder: &mut Recorder<'_>,
        scene: &mut DeviceScene,
        push: &mut Push,
        [frame, completed]: [FrameId; 2],
    ) -> Result<(Changes, Ran)> {
        let changes = std::mem::take(&mut self.changes);
        let mut ran = Ran::empty();
        ran.set(Ran::UPDATE, !changes.is_empty());
        if changes.contains(Changes::PLACING) {
            self.bvh.rebuild_top_level();
            scene.record_placing(recorder, &self.bvh, std::mem::take(&mut self.touched))?;
            push.origin_offset = push.origin_offset.max(origin_offset(self.bvh.world_reach()));
            ran |= Ran::TOP_LEVEL;
        }
        if changes.contains(Changes::LIGHTS) {
            scene.record_lights(recorder, &self.lights);
        }
        if changes.contains(Changes::EMISSION) {
            scene.record_radiators(recorder);
        }
        if let Some(upload) = self.sky_map.as_mut().filter(|_| changes.contains(Changes::SKY))
            && !upload.record(recorder, &scene.sky, frame, completed)
        {
            // The last one is still being copied: the next frame tries again.
            self.changes |= Changes::SKY;
        }
        Ok((changes, ran))
    }

    /// Whether anything waits to be written.
    pub(super) fn has_changed(&self) -> bool {
        !self.changes.is_empty()
    }

    fn movable(&self, instance: usize) -> Result<&InstanceState> {
        let count = self.instances.len();
        let state = self.instances.get(instance).ok_or_else(|| unknown("instance", instance, count))?;
        match state.mobility {
            Mobility::Movable => Ok(state),
            Mobility::Static => Err(Error::settings(format!(
                "instance {instance} '{}' was declared static; allowed to move, to go and to come are movable ones",
                state.name
            ))),
        }
    }
}

fn unknown(what: &str, index: usize, count: usize) -> Error {
    Error::settings(format!("there is no {what} {index}; the scene has {count}, counted from 0"))
}
