//! The same by the Rust interface: the scene of scene.h, baked at a stretch and within frames.

use crate::engine::Engine;
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{BakeSettings, Baker, Clock, FrameSettings, Learning, LightMap, Mode, Stop};
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{
    Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Resolution, Scene, SceneDesc, Sidedness, Sky,
    SkyMap, Texture, TextureUse, Wrap,
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

const ONCE: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const TWICE: [[f32; 2]; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]];

fn list<const N: usize, T: From<[f32; N]>>(values: [[f32; N]; 4]) -> Vec<T> {
    values.map(T::from).into()
}

/// Four corners, with a chart between these coordinates.
fn quad(corners: [[f32; 3]; 4], [left, top, right, bottom]: [f32; 4], material: usize) -> MeshPart {
    MeshPart {
        positions: list(corners),
        light_map_uvs: Some(list([[left, top], [right, top], [right, bottom], [left, bottom]])),
        indices: vec![0, 1, 2, 0, 2, 3],
        material,
        ..MeshPart::default()
    }
}

fn placed(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 1.0))
}

fn meshes() -> Vec<MeshDesc> {
    let square = |half: f32| [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]];
    let lamp = [[-1.0, -1.0, 3.0], [-1.0, 1.0, 3.0], [1.0, 1.0, 3.0], [1.0, -1.0, 3.0]];
    let floor = MeshPart {
        normals: Some(list([[0.0, 0.1, 2.0], [0.0, 0.1, 2.0], [0.0, -0.1, 2.0], [0.0, -0.1, 2.0]])),
        albedo_uvs: Some(list(TWICE)),
        emission_uvs: Some(list(ONCE)),
        ..quad(square(2.0), [0.02, 0.02, 0.48, 0.48], 0)
    };
    let lamp = MeshPart {
        albedo_uvs: Some(list(ONCE)),
        emission_uvs: Some(list(TWICE)),
        ..quad(lamp, [0.52, 0.02, 0.98, 0.48], 1)
    };
    let parts = [("floor", floor), ("lamp", lamp), ("square", quad(square(0.6), [0.02, 0.52, 0.48, 0.98], 2))];
    parts.map(|(name, part)| MeshDesc { name: name.into(), parts: vec![part] }).into()
}

fn materials() -> Vec<Material> {
    let material = |name: &str, albedo: [f32; 3], emission: [f32; 3]| Material {
        name: name.into(),
        albedo: albedo.into(),
        emission: emission.into(),
        ..Material::default()
    };
    let textured = |wrap| Some(TextureUse { texture: 0, wrap });
    vec![
        Material {
            albedo_texture: textured([Wrap::Repeat, Wrap::MirroredRepeat]),
            ..material("floor", [0.5, 0.6, 0.7], [0.0; 3])
        },
        Material {
            emission_texture: textured([Wrap::ClampToEdge, Wrap::Repeat]),
            ..material("lamp", [0.1; 3], [4.0, 5.0, 6.0])
        },
        Material { sidedness: Sidedness::Double, ..material("square", [0.8, 0.4, 0.2], [0.0; 3]) },
    ]
}

fn lantern(intensity: [f32; 3], inner_angle: f32, outer_angle: f32) -> Light {
    let (position, direction) = (DVec3::new(-1.5, -1.0, 2.0), Vec3::new(0.5, 0.25, -2.0));
    let kind = LightKind::Spot { position, direction, inner_angle, outer_angle, range: None };
    Light { name: "lantern".into(), intensity: intensity.into(), kind }
}

fn lights() -> Vec<Light> {
    let bulb = LightKind::Point { position: DVec3::new(1.0, 1.0, 2.0), range: Some(9.0) };
    let sun = LightKind::Directional { direction: Vec3::new(1.0, 2.0, -4.0) };
    vec![
        Light { name: "bulb".into(), intensity: Vec3::new(3.0, 2.0, 1.0), kind: bulb },
        lantern([5.0, 6.0, 7.0], 0.25, 0.75),
        Light { name: "sun".into(), intensity: Vec3::new(0.5, 0.4, 0.3), kind: sun },
    ]
}

fn sky(pixels: [[f32; 3]; 8]) -> Sky {
    Sky::Map(SkyMap { width: 4, height: 2, pixels: pixels.map(Vec3::from_array).to_vec() })
}

fn day() -> Sky {
    sky([
        [0.1, 0.2, 0.3],
        [0.2, 0.3, 0.4],
        [0.3, 0.4, 0.5],
        [0.4, 0.5, 0.6],
        [0.5, 0.4, 0.3],
        [0.4, 0.3, 0.2],
        [0.3, 0.2, 0.1],
        [0.2, 0.1, 0.0],
    ])
}

fn night() -> Sky {
    sky([0.1, 0.2, 0.3, 0.2, 0.1, 0.1, 0.1, 0.1].map(|blue| [0.0, 0.0, blue]))
}

pub(crate) fn scene() -> Scene {
    let instance = |name: &str, mesh, transform, mobility| Instance { name: name.into(), mesh, transform, mobility };
    let pixels = vec![[255, 200, 150, 255], [90, 60, 30, 255], [10, 240, 120, 255], [200, 100, 220, 255]];
    Scene::new(SceneDesc {
        name: "room".into(),
        meshes: meshes(),
        instances: vec![
            instance("floor", 0, DAffine3::IDENTITY, Mobility::Static),
            instance("lamp", 1, DAffine3::IDENTITY, Mobility::Static),
            instance("square", 2, placed(-0.5), Mobility::Movable),
        ],
        materials: materials(),
        textures: vec![Texture { name: "tiles".into(), width: 2, height: 2, pixels }],
        lights: lights(),
        sky: day(),
    })
    .unwrap()
}

/// What changes before a frame.
fn change(baker: &mut Baker, frame: u32) {
    baker.set_transform(2, placed(-0.5 + f64::from(frame) / 32.0)).unwrap();
    match frame {
        6 => baker.set_light(1, lantern([9.0, 6.0, 3.0], 0.125, 0.5)).unwrap(),
        9 => baker.set_emission(1, Vec3::new(8.0, 2.0, 1.0)).unwrap(),
        12 => baker.set_sky(night()).unwrap(),
        18 => baker.remove_instance(2).unwrap(),
        24 => baker.add_instance(2).unwrap(),
        _ => {}
    }
    baker.set_time(Duration::from_millis(16) * frame).unwrap();
}

fn baker(engine: &Engine, scene: &Scene, seed: u64) -> Baker {
    let settings = BakeSettings { resolution: Resolution::Texels(64), seed, ..BakeSettings::default() };
    Baker::new(engine.gpu(), scene, &settings).unwrap()
}

/// What the baker does without, a line each.
pub(crate) fn left_out(engine: &Engine, scene: &Scene, seed: u64) -> String {
    let baker = baker(engine, scene, seed);
    let left_out = baker.memory_estimate(scene).left_out(scene, baker.atlas());
    left_out.into_iter().map(|(words, bytes)| format!("{words}: {bytes}\n")).collect()
}

pub(crate) fn still(engine: &Engine, scene: &Scene, seed: u64, samples: u32) -> LightMap {
    let mut baker = baker(engine, scene, seed);
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
        change(&mut baker, frame);
        if way == Way::Submit && frame == 15 {
            baker.set_scene(&scene()).unwrap();
        }
        match way {
            Way::Record => engine.record_frame(&mut baker, ONE_SECOND, None),
            Way::Submit => engine.submit_frame(&mut baker, ONE_SECOND, None),
        };
    }
    baker.read_back().unwrap()
}
