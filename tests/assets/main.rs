//! The project's own scenes: made here, committed under `assets/`, and compared with what is made.
//!
//! `LIGHTOVEN_REGENERATE=1 cargo test --test assets` writes them anew.

mod cornell;
mod courtyard;
mod doorway;
mod faces;
mod furnace;
#[path = "../common/gltf_builder.rs"]
mod gltf_builder;
mod materials;
mod tiny_lamp;

use glam::{DVec3, Vec2, Vec3};
use lightoven::io::gltf::{ReadSettings, read};
use lightoven::scene::{Atlas, Instance, LightKind, Resolution, Scene};
use std::path::PathBuf;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets").join(name)
}

/// Compares a committed file with what is made, or writes it.
fn compare(name: &str, made: &[u8]) {
    let path = path(name);
    if std::env::var_os("LIGHTOVEN_REGENERATE").is_some_and(|value| value == "1") {
        std::fs::write(&path, made).expect("the assets can be written");
    }
    let committed = std::fs::read(&path).unwrap_or_default();
    assert!(
        committed == made,
        "assets/{name} ({} bytes) is not what its generator makes ({} bytes); LIGHTOVEN_REGENERATE=1 writes it anew",
        committed.len(),
        made.len()
    );
}

fn scene(name: &str) -> Scene {
    read(&path(name), &ReadSettings::default()).expect("is valid")
}

fn atlas(scene: &Scene, side: u32) -> Atlas {
    Atlas::new(scene, Resolution::Texels(side)).expect("fits")
}

/// World-space corners of instances' triangles, turned so that their front is counter-clockwise again after mirroring.
fn triangles(scene: &Scene, instances: &[Instance]) -> Vec<[DVec3; 3]> {
    let mut triangles = Vec::new();
    for instance in instances {
        let mirrored = instance.transform.matrix3.determinant() < 0.0;
        for corners in scene.meshes()[instance.mesh].positions() {
            let [a, b, c] = corners.map(|p| instance.transform.transform_point3(p.as_dvec3()));
            triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
        }
    }
    triangles
}

/// Volume that triangles enclose, seen as closed by the point `apex`; negative where fronts face inward.
fn enclosed_volume(triangles: &[[DVec3; 3]], apex: DVec3) -> f64 {
    triangles.iter().map(|t| t.map(|p| p - apex)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// From inside, a room shows fronts and has no gaps: its volume then is the same, and negative, from everywhere.
fn assert_closed_inward(triangles: &[[DVec3; 3]], volume: f64) {
    for apex in [DVec3::ZERO, DVec3::new(3.0, -5.0, 7.0)] {
        let found = enclosed_volume(triangles, apex);
        assert!((found + volume).abs() < 1e-5 * volume, "from {apex} the volume is {found} for -{volume}");
    }
}

/// The light map is shared, no texel is covered twice, and what shines is one instance's chart of whole texels: their
/// number, along each side.
fn lamp_texels(scene: &Scene, lamp: usize) -> Vec2 {
    assert_eq!(scene.warnings(), [""; 0]);
    for side in [128, 256, 512] {
        let atlas = atlas(scene, side);
        assert!(atlas.shared && atlas.overlapping_texels == 0, "{side}: {} overlap", atlas.overlapping_texels);
    }
    let shines = |instance: &Instance| {
        let materials = scene.meshes()[instance.mesh].materials();
        materials.iter().filter(|material| scene.materials()[**material as usize].is_emissive()).count()
    };
    let shining: Vec<_> = scene.instances().iter().map(shines).collect();
    assert!(shining.iter().enumerate().all(|(i, count)| *count == if i == lamp { 2 } else { 0 }), "{shining:?}");
    let uvs = scene.meshes()[scene.instances()[lamp].mesh].light_map_uvs().iter().flatten().flatten();
    let corners: Vec<Vec2> = uvs.map(|uv| *uv * 128.0).collect();
    assert!(corners.iter().all(|corner| corner.fract() == Vec2::ZERO), "{corners:?}");
    let bound = |pick: fn(Vec2, Vec2) -> Vec2| corners.iter().copied().reduce(pick).expect("has corners");
    bound(Vec2::max) - bound(Vec2::min)
}

#[test]
fn furnace() {
    compare("furnace.gltf", furnace::build().embedded().as_bytes());
    let scene = scene("furnace.gltf");
    assert_eq!((scene.triangle_count(), scene.warnings()), (12, &[][..]));
    assert_closed_inward(&triangles(&scene, scene.instances()), 1.0);
    let material = &scene.materials()[0];
    assert_eq!((material.albedo, material.emission), (Vec3::splat(0.5), Vec3::ONE));
    let atlas = atlas(&scene, 64);
    assert!(atlas.shared && atlas.overlapping_texels == 0);
    for uv in scene.meshes()[0].light_map_uvs().iter().flatten().flatten() {
        assert_eq!((*uv * 64.0).fract(), Vec2::ZERO, "a chart's corner is on no texel border");
    }
}

#[test]
fn cornell() {
    compare("cornell.gltf", cornell::build().embedded().as_bytes());
    let scene = scene("cornell.gltf");
    assert_eq!(scene.warnings(), [""; 0]);
    assert_eq!((scene.instances().len(), scene.meshes().len()), (4, 4));
    let atlas = atlas(&scene, 128);
    assert!(atlas.shared && atlas.overlapping_texels == 0);
    let lamp: Vec<_> = scene.materials().iter().filter(|material| material.is_emissive()).collect();
    assert!((lamp[0].emission - Vec3::new(17.0, 12.0, 4.0)).length() < 1e-4);
    // From the middle of the room every wall shows its front.
    let room = &scene.meshes()[scene.instances()[0].mesh];
    let middle = Vec3::new(0.0, 1.0, 0.0);
    assert!(room.positions().iter().all(|[a, b, c]| (*b - *a).cross(*c - *a).dot(middle - *a) > 0.0));
    let on_the_left = |corners: &[Vec3; 3]| corners.iter().all(|p| p.x < -0.99);
    let left = room.positions().iter().zip(room.materials()).find(|(corners, _)| on_the_left(corners));
    assert_eq!(left.map(|(_, material)| scene.materials()[*material as usize].name.as_str()), Some("red"));
    for block in &scene.instances()[2..] {
        assert_faces_outward(&scene, block.mesh);
    }
}

#[test]
fn tiny_lamp() {
    compare("tiny_lamp.gltf", tiny_lamp::build().embedded().as_bytes());
    let scene = scene("tiny_lamp.gltf");
    assert_eq!(scene.instances().len(), 5);
    assert_eq!(lamp_texels(&scene, 1), Vec2::splat(4.0));
    let lamp = &scene.meshes()[scene.instances()[1].mesh];
    assert_eq!(scene.materials()[lamp.materials()[0] as usize].emission, Vec3::splat(32_000.0));
    assert!(lamp.positions().iter().all(|[a, b, c]| (*b - *a).cross(*c - *a).y < 0.0), "the lamp does not face down");
    assert_closed_inward(&triangles(&scene, &scene.instances()[..1]), 4.0 * 4.0 * 2.6);
    for block in &scene.instances()[2..] {
        assert_faces_outward(&scene, block.mesh);
    }
}

#[test]
fn doorway() {
    compare("doorway.gltf", doorway::build().embedded().as_bytes());
    let scene = scene("doorway.gltf");
    assert_eq!(scene.instances().len(), 4);
    assert_eq!(lamp_texels(&scene, 3), Vec2::splat(4.0));
    let lamp = &scene.meshes()[scene.instances()[3].mesh];
    assert_eq!(scene.materials()[lamp.materials()[0] as usize].emission, Vec3::splat(1200.0));
    // Rooms, opening and lamp are one closed space.
    let opening = 0.1 * 0.15 * 2.0;
    assert_closed_inward(&triangles(&scene, scene.instances()), 2.0 * 3.0 * 3.0 * 2.6 + opening);
}

#[test]
fn courtyard() {
    compare(courtyard::TILES, &courtyard::tiles());
    compare(courtyard::SIGN, &courtyard::sign());
    compare("courtyard.gltf", courtyard::build().embedded().as_bytes());
    let scene = scene("courtyard.gltf");
    let warning = "2 triangles have no light-map coordinates";
    assert!(matches!(scene.warnings(), [one] if one.starts_with(warning)), "{:?}", scene.warnings());
    let columns: Vec<_> = scene.instances().iter().filter(|i| i.name.starts_with("column")).collect();
    assert_eq!(columns.len(), 8);
    assert_faces_outward(&scene, columns[0].mesh);
    assert_eq!(columns.iter().filter(|i| i.transform.matrix3.determinant() < 0.0).count(), 1);
    assert_eq!(scene.textures().len(), 2);
    let kinds: Vec<_> = scene.lights().iter().map(|light| std::mem::discriminant(&light.kind)).collect();
    assert_eq!(kinds.len(), 3);
    let LightKind::Directional { direction } = scene.lights()[0].kind else { panic!("{:?}", scene.lights()[0]) };
    assert!(direction.y < -0.7, "the sun shines along {direction}");
    let LightKind::Spot { direction, .. } = scene.lights()[2].kind else { panic!("{:?}", scene.lights()[2]) };
    assert!(direction.y < -0.999, "the spotlight shines along {direction}");
    let atlas = atlas(&scene, 512);
    assert!(!atlas.shared && atlas.overlapping_texels == 0);
}

/// Seen from a point inside a standing shape that is convex from there, every face shows its back.
fn assert_faces_outward(scene: &Scene, mesh: usize) {
    let inside = Vec3::new(0.0, 0.25, 0.0);
    for [a, b, c] in scene.meshes()[mesh].positions() {
        let normal = (*b - *a).cross(*c - *a);
        let axis = Vec3::new(0.0, a.y.clamp(inside.y, f32::MAX) - 1e-3, 0.0);
        let from = if normal.y.abs() > 0.99 * normal.length() { axis } else { Vec3::new(0.0, a.y, 0.0) };
        assert!(normal.dot(*a - from) > 0.0, "a face of mesh {mesh} at {a} points inward");
    }
}
