//! Real game levels: what the reader finds in them.

use crate::levels::shared_scene;
use lightoven::io::gltf::{ReadSettings, read};
use lightoven::scene::{Atlas, Resolution, Scene};

fn level(name: &str) -> Option<Scene> {
    shared_scene(name).map(|path| read(&path, &ReadSettings::default()).expect("is valid"))
}

fn emissive_triangles(scene: &Scene) -> usize {
    let shines = |material: &&u32| scene.materials()[**material as usize].is_emissive();
    scene.instances().iter().map(|i| scene.meshes()[i.mesh].materials().iter().filter(shines).count()).sum()
}

fn unmapped_triangles(scene: &Scene) -> usize {
    let uvs = |mesh: usize| scene.meshes()[mesh].light_map_uvs().iter().filter(|uvs| uvs.is_none()).count();
    scene.instances().iter().map(|i| uvs(i.mesh)).sum()
}

#[test]
fn wrackdm17() {
    let Some(scene) = level("wrackdm17.glb") else { return };
    // 112 of the file's 8579 have corners on a line.
    assert_eq!(scene.triangle_count() + 112, 8579, "{:?}", scene.warnings());
    assert_eq!(emissive_triangles(&scene), 1044);
    assert!(Atlas::new(&scene, Resolution::Texels(384)).expect("fits").shared);
}

#[test]
fn islandctf() {
    let Some(scene) = level("islandctf.glb") else { return };
    assert_eq!(scene.triangle_count(), 14215, "{:?}", scene.warnings());
    assert!(scene.warnings().iter().any(|w| w.starts_with("4414 triangles have no light-map coordinates")));
    // 61 more have coordinates on a line.
    assert_eq!(unmapped_triangles(&scene), 4414 + 61, "{:?}", scene.warnings());
}
