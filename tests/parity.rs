//! Both back ends against the host's traversal: NUMERICS case 21.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;
#[path = "common/shared_scenes.rs"]
mod shared_scenes;

use device::on_both_back_ends;
use glam::{DAffine3, DVec3, Vec2, Vec3};
use lightoven::Tracer;
use lightoven::bvh::{Bvh, Hit, Ray};
use lightoven::gpu::Gpu;
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{Atlas, Instance, Material, MeshDesc, MeshPart, Mobility, Resolution, Scene, SceneDesc};
use shared_scenes::shared_scene;
use std::path::Path;

const RAYS: usize = 1_000_000;

/// Numbers in [0, 1), the same every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}

/// Rays from anywhere within the scene's bounds, into all directions, some along an axis.
fn random_rays(scene: &Scene) -> Vec<Ray> {
    let (lo, hi) = scene.bounds().unwrap();
    let half = ((hi - lo) * 0.5).as_vec3();
    let mut random = Random(1);
    let ray = |i: usize| {
        let origin = random.vector() * half;
        let direction =
            if i.is_multiple_of(64) { Vec3::AXES[i / 64 % 3] } else { random.vector().normalize_or(Vec3::X) };
        Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY.min(1e30) }
    };
    (0..RAYS).map(ray).collect()
}

/// The same hit or miss, the same distance; the triangle may differ where two meet.
fn agree(a: &Option<Hit>, b: &Option<Hit>, scale: f32) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => (a.t - b.t).abs() <= 1e-5 * (a.t + scale),
        _ => false,
    }
}

fn compare(path: &Path, gpu: &Gpu) {
    compare_scene(&gltf::read(path, &ReadSettings::default()).unwrap(), gpu);
}

fn compare_scene(scene: &Scene, gpu: &Gpu) {
    let atlas = Atlas::new(scene, Resolution::Texels(64)).unwrap();
    let bvh = Bvh::build(scene, &atlas).unwrap();
    let rays = random_rays(scene);
    let skip = vec![None; rays.len()];
    let hits = Tracer::new(gpu, scene, &bvh).unwrap().trace(&rays, &skip).unwrap();
    let (lo, hi) = scene.bounds().unwrap();
    let scale = (hi - lo).length() as f32;
    let (mut differ, mut facing, mut any) = (0, 0, 0);
    for (ray, hit) in rays.iter().zip(&hits) {
        let expected = bvh.trace_closest(ray, None);
        any += usize::from(hit.is_some_and(|hit| hit.primitive == u32::MAX));
        differ += usize::from(!agree(hit, &expected, scale));
        let same = |(a, b): (Hit, Hit)| a.primitive == b.primitive && a.front_face != b.front_face;
        facing += usize::from((*hit).zip(expected).is_some_and(same));
    }
    let found = hits.iter().flatten().count();
    println!(
        "{}, {}: {found} of {RAYS} rays hit; {differ} differ from the host, {facing} in facing, {any} any-hit queries \
         differ",
        scene.name(),
        gpu.backend().name()
    );
    assert!(found > RAYS / 10, "too few rays hit anything");
    assert!(differ <= RAYS / 100_000, "{differ} rays differ");
    assert_eq!((facing, any > RAYS / 100_000), (0, false));
}

on_both_back_ends!(instances, level, meshes_without_triangles);

fn instances(gpu: &Gpu) {
    compare(&Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/courtyard.gltf"), gpu);
}

fn level(gpu: &Gpu) {
    if let Some(path) = shared_scene("wrackdm17.glb") {
        compare(&path, gpu);
    }
}

/// In first and in last place: their instances must not show another mesh.
fn meshes_without_triangles(gpu: &Gpu) {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let square = MeshPart {
        positions: corners.map(|c| (c * 2.0 - 1.0).extend(0.0)).to_vec(),
        light_map_uvs: Some(corners.to_vec()),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..MeshPart::default()
    };
    let mesh = |name: &str, parts| MeshDesc { name: name.into(), parts };
    let place = |mesh: usize, z| Instance {
        name: format!("{mesh}"),
        mesh,
        transform: DAffine3::from_translation(DVec3::new(0.0, 0.0, z)),
        mobility: Mobility::Static,
    };
    let scene = Scene::new(SceneDesc {
        name: "meshes without triangles".into(),
        meshes: vec![mesh("none", vec![]), mesh("square", vec![square]), mesh("none either", vec![])],
        instances: vec![place(0, 3.0), place(1, 0.0), place(2, -3.0), place(1, 1.0)],
        materials: vec![Material::default()],
        ..SceneDesc::default()
    });
    compare_scene(&scene.unwrap(), gpu);
}
