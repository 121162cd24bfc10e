//! Both back ends against the host's traversal: NUMERICS case 21.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::Vec3;
use lightoven::bvh::{Bvh, Hit, Ray};
use lightoven::gpu::BackendChoice;
use lightoven::headless::{Headless, HeadlessSettings, Validation};
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{Atlas, Resolution, Scene};
use lightoven::{Error, ErrorKind, Tracer};
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
        let direction = if i.is_multiple_of(64) { Vec3::AXES[i / 64 % 3] } else { random.vector().normalize_or(Vec3::X) };
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

fn compare(path: &Path, backend: BackendChoice) {
    let settings = HeadlessSettings { backend, validation: Validation::On, ..HeadlessSettings::default() };
    let headless = match Headless::new(&settings) {
        Err(error) if backend == BackendChoice::RayQuery && error.kind() == ErrorKind::Unsupported => {
            skipped(&error);
            return;
        }
        headless => headless.unwrap(),
    };
    let scene = gltf::read(path, &ReadSettings::default()).unwrap();
    let atlas = Atlas::new(&scene, Resolution::Texels(64)).unwrap();
    let bvh = Bvh::build(&scene, &atlas).unwrap();
    let rays = random_rays(&scene);
    let skip = vec![None; rays.len()];
    let hits = Tracer::new(headless.gpu(), &scene, &bvh).unwrap().trace(&rays, &skip).unwrap();
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
        headless.gpu().backend().name()
    );
    assert_eq!(headless.validation_messages(), Vec::<String>::new());
    assert!(found > RAYS / 10, "too few rays hit anything");
    assert!(differ <= RAYS / 100_000, "{differ} rays differ");
    assert_eq!((facing, any > RAYS / 100_000), (0, false));
}

fn skipped(error: &Error) {
    assert!(
        !std::env::var("LIGHTOVEN_REQUIRE").is_ok_and(|r| r == "ray_query"),
        "ray query is required: {error}"
    );
    println!("skipped: {error}");
}

fn asset(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name)
}

fn shared(name: &str) -> Option<std::path::PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(name);
    if !path.exists() {
        println!("skipped: {} is absent", path.display());
    }
    path.exists().then_some(path)
}

#[test]
fn software_matches_the_host_on_instances() {
    compare(&asset("courtyard.gltf"), BackendChoice::Software);
}

#[test]
fn ray_query_matches_the_host_on_instances() {
    compare(&asset("courtyard.gltf"), BackendChoice::RayQuery);
}

#[test]
fn software_matches_the_host_on_a_level() {
    if let Some(path) = shared("wrackdm17.glb") {
        compare(&path, BackendChoice::Software);
    }
}

#[test]
fn ray_query_matches_the_host_on_a_level() {
    if let Some(path) = shared("wrackdm17.glb") {
        compare(&path, BackendChoice::RayQuery);
    }
}
