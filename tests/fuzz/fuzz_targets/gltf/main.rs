//! Bytes as a `.gltf` or `.glb`: refused with a message, or a scene that can be laid out and traced. Anything else is a
//! fault: a panic, an overflow, a hang, an allocation that the file does not justify.
#![no_main]

mod container;

use libfuzzer_sys::{Corpus, fuzz_mutator, fuzz_target, fuzzer_mutate};
use lightoven::bvh::{Bvh, Ray};
use lightoven::io::gltf::{ReadSettings, read};
use lightoven::scene::{Atlas, Resolution, Scene};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::LazyLock;

/// What is laid out and traced at most: beyond, a scene is only slow.
const MOST_TRIANGLES: usize = 4000;
const MOST_INSTANCES: usize = 64;
const SIDE: u32 = 64;

/// The reader takes a path. The file lies in a folder of its own, in `TMPDIR`.
static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = tempfile::Builder::new().prefix("lightoven-fuzz").tempdir().expect("a temporary folder can be made");
    folder.keep().join("input.gltf")
});

fuzz_target!(|bytes: &[u8]| -> Corpus {
    if refers_to_files(container::json(bytes)) {
        return Corpus::Reject;
    }
    std::fs::write(&*FILE, bytes).expect("the temporary folder can be written");
    match read(&FILE, &ReadSettings::default()) {
        Ok(scene) => use_scene(&scene),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    Corpus::Keep
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    container::mutate(data, size, max_size, seed, fuzzer_mutate)
});

/// Whether a URI may lead to a file: such an input must not be read, for the path may be any.
fn refers_to_files(json: &[u8]) -> bool {
    match serde_json::from_slice(json) {
        Ok(value) => has_path(&value),
        // The reader may still find it good where it ignores what is nested too deep.
        Err(_) => json.windows(3).any(|word| word == b"uri") || json.contains(&b'\\'),
    }
}

/// Whether any `uri` in it is no `data:` URI.
fn has_path(value: &Value) -> bool {
    match value {
        Value::Object(map) => map.iter().any(|(key, value)| {
            has_path(value) || key == "uri" && value.as_str().is_some_and(|uri| !uri.starts_with("data:"))
        }),
        Value::Array(list) => list.iter().any(has_path),
        _ => false,
    }
}

fn use_scene(scene: &Scene) {
    if scene.triangle_count() > MOST_TRIANGLES || scene.instances().len() > MOST_INSTANCES {
        return;
    }
    let Ok(atlas) = Atlas::new(scene, Resolution::Texels(SIDE)) else { return };
    assert_eq!(atlas.rects.len(), scene.instances().len());
    let Ok(bvh) = Bvh::build(scene, &atlas) else { return };
    let Some((lo, hi)) = scene.bounds() else { return };
    let [lo, hi] = [lo, hi].map(|corner| (corner - bvh.centre).as_vec3());
    for (origin, target) in [(lo, hi), (hi, lo), ((lo + hi) * 0.5, hi), (lo.with_x(hi.x), hi.with_x(lo.x))] {
        let direction = (target - origin).normalize_or(glam::Vec3::Y);
        let ray = Ray { origin, t_min: 0.0, direction, t_max: 1e30 };
        let hit = bvh.trace_closest(&ray, None);
        assert!(hit.is_none_or(|hit| hit.t > 0.0 && hit.t.is_finite()), "{hit:?}");
        assert_eq!(hit.is_some(), bvh.trace_occluded(&ray, None));
    }
}
