//! The same by the Rust interface: the scene of scene.h, baked at a stretch and within frames.

use crate::engine::Engine;
use glam::{DAffine3, DVec3, Vec2, Vec3};
use lightoven::baker::{BakeSettings, Baker, Clock, FrameSettings, Learning, LightMap, Mode, Stop};
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{
    Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Resolution, Scene, SceneDesc, Sidedness,
};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

const ONE_SECOND: Duration = Duration::from_secs(1);

/// Which of a frame's ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    Record,
    Submit,
}

/// A square by two opposite corners' coordinates, counter-clockwise, or clockwise where it looks down.
fn quad(name: &str, corners: [[f32; 3]; 4], [left, top, right, bottom]: [f32; 4], material: usize) -> MeshDesc {
    let uvs = [[left, top], [right, top], [right, bottom], [left, bottom]];
    let part = MeshPart {
        positions: corners.map(Vec3::from_array).to_vec(),
        light_map_uvs: Some(uvs.map(Vec2::from_array).to_vec()),
        indices: vec![0, 1, 2, 0, 2, 3],
        material,
        ..MeshPart::default()
    };
    MeshDesc { name: name.into(), parts: vec![part] }
}

fn placed(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 1.0))
}

pub(crate) fn scene() -> Scene {
    let square = |half: f32, z: f32| [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    let lamp = [[-1.0, -1.0, 3.0], [-1.0, 1.0, 3.0], [1.0, 1.0, 3.0], [1.0, -1.0, 3.0]];
    let instance = |name: &str, mesh, transform, mobility| Instance { name: name.into(), mesh, transform, mobility };
    let material = |name: &str, albedo: [f32; 3], emission: [f32; 3], sidedness| Material {
        name: name.into(),
        albedo: albedo.into(),
        emission: emission.into(),
        sidedness,
        ..Material::default()
    };
    Scene::new(SceneDesc {
        name: "room".into(),
        meshes: vec![
            quad("floor", square(2.0, 0.0), [0.02, 0.02, 0.48, 0.48], 0),
            quad("lamp", lamp, [0.52, 0.02, 0.98, 0.48], 1),
            quad("square", square(0.6, 0.0), [0.02, 0.52, 0.48, 0.98], 2),
        ],
        instances: vec![
            instance("floor", 0, DAffine3::IDENTITY, Mobility::Static),
            instance("lamp", 1, DAffine3::IDENTITY, Mobility::Static),
            instance("square", 2, placed(-0.5), Mobility::Movable),
        ],
        materials: vec![
            material("floor", [0.5, 0.6, 0.7], [0.0; 3], Sidedness::Single),
            material("lamp", [0.0; 3], [4.0, 5.0, 6.0], Sidedness::Single),
            material("square", [0.8, 0.4, 0.2], [0.0; 3], Sidedness::Double),
        ],
        lights: vec![Light {
            name: "bulb".into(),
            intensity: Vec3::splat(3.0),
            kind: LightKind::Point { position: DVec3::new(1.0, 1.0, 2.0), range: None },
        }],
        ..SceneDesc::default()
    })
    .unwrap()
}

pub(crate) fn still(engine: &Engine, scene: &Scene, seed: u64, samples: u32) -> LightMap {
    let settings = BakeSettings { resolution: Resolution::Texels(64), seed, ..BakeSettings::default() };
    let mut baker = Baker::new(engine.gpu(), scene, &settings).unwrap();
    let stop = Stop { samples: Some(samples), ..Stop::default() };
    baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    baker.read_back().unwrap()
}

pub(crate) fn gltf(engine: &Engine, path: &Path) -> LightMap {
    still(engine, &gltf::read(path, &ReadSettings::default()).unwrap(), 0, 64)
}

pub(crate) fn frames(engine: &mut Engine, way: Way) -> LightMap {
    let frames = FrameSettings { clock: Clock::Engine, quanta: Some(1), ..FrameSettings::default() };
    let settings =
        BakeSettings { resolution: Resolution::Texels(64), mode: Mode::Frames(frames), ..BakeSettings::default() };
    let mut baker = Baker::new(engine.gpu(), &scene(), &settings).unwrap();
    baker.set_learning(Learning::Held).unwrap();
    for frame in 0..30_u32 {
        baker.set_transform(2, placed(-0.5 + f64::from(frame) / 32.0)).unwrap();
        baker.set_time(Duration::from_millis(16) * frame).unwrap();
        match way {
            Way::Record => engine.record_frame(&mut baker, ONE_SECOND, None),
            Way::Submit => engine.submit_frame(&mut baker, ONE_SECOND, None),
        };
    }
    baker.read_back().unwrap()
}
