//! The scene that is baked and drawn: a file's, with a box and a lamp that move, and a sun where it has none.

use crate::brightness::mean_irradiance;
use crate::engine::Look;
use crate::motion::{Motion, Pose, world_to_sun};
use crate::place::Place;
use glam::{DAffine3, DVec3, Vec2, Vec3};
use lightoven::bvh::Bvh;
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{
    Atlas, Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Resolution, Scene, SceneDesc, Sidedness,
    Sky,
};
use lightoven::{Error, ErrorKind, Result};
use std::path::Path;

/// Side of the moving box, of the scene's longest side.
const BOX_SIDE: f64 = 0.05;
/// Where a sun's light goes that the benchmark adds: down and into rooms that are open toward +z, as glTF's front is.
const SUN_DIRECTION: Vec3 = Vec3::new(-0.35, -0.55, -0.76);

/// The scene and what moves in it.
pub(crate) struct World {
    pub(crate) scene: Scene,
    /// Position of the box's instance.
    pub(crate) mover: usize,
    /// Position of the lamp among the lights.
    pub(crate) lamp: usize,
    pub(crate) motion: Motion,
    sun: Sun,
    exposure: f32,
    radius: f32,
}

#[derive(Debug, Clone, Copy)]
struct Sun {
    direction: Vec3,
    irradiance: Vec3,
}

impl World {
    /// Reads a file and adds to it. `resolution` is the light map's, in which all that is added has to find room.
    ///
    /// # Errors
    /// As [`gltf::read`]; `InvalidScene` without triangles, or where nothing has light-map coordinates.
    pub(crate) fn read(path: &Path, resolution: Resolution) -> Result<Self> {
        let (mut desc, warnings) = gltf::read_desc(path, &ReadSettings::default())?;
        let plain = Scene::new(desc.clone())?;
        let nothing = || Error::new(ErrorKind::InvalidScene, format!("'{}' has no triangles", path.display()));
        let (lo, hi) = plain.bounds().ok_or_else(nothing)?;
        let (half, longest) = (0.5 * (hi - lo), (hi - lo).max_element());
        let place = Place::find(&Bvh::build(&plain, &Atlas::new(&plain, resolution)?)?, half);
        let irradiance = mean_irradiance(&plain, half.length());
        let motion = Motion { place, box_half_side: (0.5 * BOX_SIDE * longest).min(0.3 * place.room), longest };
        let first = motion.at(0);

        let mover = plain.instances().len();
        let lamp = desc.lights.len();
        add_box(&mut desc, motion.box_half_side, translated(&first.mover, plain.centre()));
        // At the edge of its room the lamp alone is as bright as all else is on average.
        let intensity = Vec3::new(1.0, 0.8, 0.5) * (irradiance * place.room * place.room) as f32;
        let kind = LightKind::Point { position: first.lamp + plain.centre(), range: None };
        desc.lights.push(Light { name: "moving lamp".into(), intensity, kind });
        let sun = sun_of(&mut desc, irradiance as f32);
        let mut scene = Scene::new(desc)?;
        warnings.into_iter().for_each(|warning| scene.warn(warning));
        // Grey of albedo 0.5 in mean light is shown at 0.4 linear: 1 - exp(-0.5).
        let exposure = 0.5 / (0.5 * irradiance as f32 / std::f32::consts::PI);
        Ok(Self { scene, mover, lamp, motion, sun, exposure, radius: half.length() as f32 })
    }

    /// Object to world of the box, as the library takes it.
    pub(crate) fn mover_transform(&self, pose: &Pose) -> DAffine3 {
        translated(&pose.mover, self.scene.centre())
    }

    /// The lamp, as the library takes it.
    pub(crate) fn lamp_light(&self, pose: &Pose) -> Light {
        let kind = LightKind::Point { position: pose.lamp + self.scene.centre(), range: None };
        Light { kind, ..self.scene.lights()[self.lamp].clone() }
    }

    /// How the camera sees a frame.
    pub(crate) fn look(&self, pose: &Pose, aspect_ratio: f32) -> Look {
        Look {
            world_to_clip: pose.world_to_clip(aspect_ratio, self.motion.longest),
            world_to_sun: world_to_sun(self.sun.direction, 1.05 * self.radius),
            eye: pose.eye.as_vec3(),
            exposure: self.exposure,
            sun_direction: self.sun.direction,
            sun_irradiance: self.sun.irradiance,
            background: self.background(),
        }
    }

    /// A sky of one colour as `view.frag` shows radiance; black where it is another.
    fn background(&self) -> [f32; 4] {
        let Sky::Constant(radiance) = self.scene.sky() else { return [0.0, 0.0, 0.0, 1.0] };
        let shown = |c: f32| {
            let linear = 1.0 - (-c * self.exposure).exp();
            if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
        };
        [shown(radiance.x), shown(radiance.y), shown(radiance.z), 1.0]
    }
}

fn translated(transform: &DAffine3, by: DVec3) -> DAffine3 {
    DAffine3 { translation: transform.translation + by, ..*transform }
}

/// The scene's first directional light; one is added where there is none.
fn sun_of(desc: &mut SceneDesc, irradiance: f32) -> Sun {
    for light in &desc.lights {
        if let LightKind::Directional { direction } = light.kind
            && let Some(direction) = direction.try_normalize()
        {
            return Sun { direction, irradiance: light.intensity };
        }
    }
    let direction = SUN_DIRECTION.normalize();
    let sun = Sun { direction, irradiance: Vec3::new(1.0, 0.95, 0.85) * irradiance };
    let kind = LightKind::Directional { direction };
    desc.lights.push(Light { name: "sun".into(), intensity: sun.irradiance, kind });
    sun
}

/// A box around the origin, its six sides apart from each other in the light map.
fn add_box(desc: &mut SceneDesc, half_side: f64, transform: DAffine3) {
    let mut part = MeshPart { material: desc.materials.len(), ..MeshPart::default() };
    let mut uvs = Vec::new();
    for (side, normal) in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].into_iter().enumerate() {
        let across = normal.any_orthonormal_vector();
        let along = normal.cross(across);
        let chart = Vec2::new((side % 3) as f32, (side / 3) as f32);
        let first = part.positions.len() as u32;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            part.positions.push((normal + x * across + y * along) * half_side as f32);
            // 0.8 of a third by a half each: the rest keeps the charts apart.
            uvs.push((chart + 0.5 + 0.4 * Vec2::new(x, y)) / Vec2::new(3.0, 2.0));
        }
        part.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
    part.light_map_uvs = Some(uvs);
    desc.materials.push(Material {
        name: "moving box".into(),
        albedo: Vec3::splat(0.7),
        sidedness: Sidedness::Single,
        ..Material::default()
    });
    let mesh = desc.meshes.len();
    desc.meshes.push(MeshDesc { name: "moving box".into(), parts: vec![part] });
    desc.instances.push(Instance { name: "moving box".into(), mesh, transform, mobility: Mobility::Movable });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asset(name: &str) -> World {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name);
        World::read(&path, Resolution::Texels(128)).expect("is a scene")
    }

    #[test]
    fn a_box_a_lamp_and_a_sun_are_added() {
        let world = asset("cornell.gltf");
        let instance = &world.scene.instances()[world.mover];
        assert_eq!((instance.name.as_str(), instance.mobility), ("moving box", Mobility::Movable));
        assert_eq!(world.scene.meshes()[instance.mesh].len(), 12);
        assert_eq!(world.scene.lights()[world.lamp].name, "moving lamp");
        assert_eq!(world.scene.lights().len(), 2);
        let side = 2.0 * world.motion.box_half_side;
        assert!((side - 0.05 * 2.013).abs() < 0.01, "{side}");
        assert!(world.scene.warnings().is_empty(), "{:?}", world.scene.warnings());
    }

    #[test]
    fn the_box_faces_outward() {
        let world = asset("cornell.gltf");
        for corners in world.scene.meshes()[world.scene.instances()[world.mover].mesh].positions() {
            let [a, b, c] = *corners;
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }

    #[test]
    fn a_scene_with_a_sun_keeps_it() {
        let world = asset("courtyard.gltf");
        let suns = world.scene.lights().iter().filter(|l| matches!(l.kind, LightKind::Directional { .. }));
        assert_eq!(suns.count(), 1);
        assert_eq!(world.lamp, 3);
    }

    #[test]
    fn paths_stay_clear_of_the_scene() {
        for name in ["cornell.gltf", "courtyard.gltf", "furnace.gltf"] {
            let world = asset(name);
            let place = world.motion.place;
            assert!(place.room > 0.05 * world.motion.longest, "{name}: {place:?}");
            assert!(place.back > 0.0, "{name}: {place:?}");
        }
    }
}
