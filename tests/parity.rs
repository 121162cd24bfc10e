//! Both back ends against the host's traversal: NUMERICS case 21.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;
#[path = "common/shared_scenes.rs"]
mod shared_scenes;

use device::on_both_back_ends;
use glam::Vec3;
use lightoven::Tracer;
use lightoven::bvh::{Bvh, Hit, Ray};
use lightoven::gpu::Gpu;
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{Atlas, Resolution, Scene};
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
    let scene = gltf::read(path, &ReadSettings::default()).unwrap();
    let atlas = Atlas::new(&scene, Resolution::Texels(64)).unwrap();
    let bvh = Bvh::build(&scene, &atlas).unwrap();
    let rays = random_rays(&scene);
    let skip = vec![None; rays.len()];
    let hits = Tracer::new(gpu, &scene, &bvh).unwrap().trace(&rays, &skip).unwrap();
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
        path.display(),
        gpu.backend().name()
    );
    assert!(found > RAYS / 10, "too few rays hit anything");
    assert!(differ <= RAYS / 100_000, "{differ} rays differ");
    assert_eq!((facing, any > RAYS / 100_000), (0, false));
}

on_both_back_ends!(instances, level);

fn instances(gpu: &Gpu) {
    compare(&Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/courtyard.gltf"), gpu);
}

fn level(gpu: &Gpu) {
    if let Some(path) = shared_scene("wrackdm17.glb") {
        compare(&path, gpu);
    }
}
