//! Containers, accessors and primitives.

use crate::{Folder, SQUARE, SQUARE_UVS, assert_invalid, glb, primitive, scene, square};
use glam::{Vec2, Vec3};
use lightoven::scene::Scene;
use serde_json::json;

fn corners(scene: &Scene) -> Vec<[Vec3; 3]> {
    scene.meshes()[0].positions().to_vec()
}

fn square_corners() -> Vec<[Vec3; 3]> {
    [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v: usize| Vec3::from(SQUARE[v]))).to_vec()
}

#[test]
fn every_container_gives_the_same_scene() {
    let builder = square();
    let mut external = builder.root.clone();
    external["buffers"] = json!([{ "byteLength": builder.binary.len(), "uri": "the%20buffer.bin" }]);
    let folder = Folder::new()
        .with("a.gltf", builder.embedded())
        .with("b.glb", glb(&builder))
        .with("c.gltf", external.to_string())
        .with("the buffer.bin", &builder.binary);
    for (file, name) in [("a.gltf", "a"), ("b.glb", "b"), ("c.gltf", "c")] {
        let scene = folder.read(file).expect("is valid");
        assert_eq!(scene.name(), name);
        assert_eq!(corners(&scene), square_corners());
        assert_eq!(scene.meshes()[0].name(), "mesh 0");
        assert_eq!(scene.instances()[0].name, "node 0");
        assert_eq!(scene.meshes()[0].light_map_uvs()[1], Some([0, 2, 3].map(|v: usize| Vec2::from(SQUARE_UVS[v]))));
        assert_eq!(scene.warnings(), [""; 0]);
    }
}

#[test]
fn indices_of_every_type_and_none() {
    for (kind, bytes) in [
        (5121, vec![0_u8, 1, 2, 0, 2, 3]),
        (5123, [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect()),
        (5125, [0_u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect()),
    ] {
        let mut builder = square();
        let view = builder.view(&bytes);
        let accessor = json!({ "bufferView": view, "componentType": kind, "count": 6, "type": "SCALAR" });
        let accessor = builder.push("accessors", accessor);
        primitive(&mut builder)["indices"] = json!(accessor);
        assert_eq!(corners(&scene(&builder)), square_corners());
    }
    let mut builder = square();
    let positions = builder.vectors(&[0, 1, 2, 0, 2, 3].map(|v: usize| SQUARE[v]));
    let uvs = builder.vectors(&[0, 1, 2, 0, 2, 3].map(|v: usize| SQUARE_UVS[v]));
    *primitive(&mut builder) = json!({ "attributes": { "POSITION": positions, "TEXCOORD_1": uvs } });
    assert_eq!(corners(&scene(&builder)), square_corners());
}

#[test]
fn strips_and_fans_keep_their_winding() {
    for (mode, indices) in [(5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])] {
        let mut builder = square();
        let indices = builder.indices(&indices);
        primitive(&mut builder)["indices"] = json!(indices);
        primitive(&mut builder)["mode"] = json!(mode);
        let scene = scene(&builder);
        assert_eq!(scene.triangle_count(), 2);
        for normals in scene.meshes()[0].normals() {
            assert_eq!(*normals, [Vec3::Z; 3], "mode {mode}");
        }
    }
    let mut short = square();
    primitive(&mut short)["indices"] = json!(null);
    primitive(&mut short)["attributes"] = json!({ "POSITION": 3 });
    primitive(&mut short)["mode"] = json!(5);
    short.vectors(&SQUARE[..2]);
    assert_eq!(scene(&short).triangle_count(), 0);
}

#[test]
fn primitives_that_are_no_triangles_are_left_out() {
    let mut builder = square();
    builder.root["meshes"][0]["name"] = json!("wires");
    let mut lines = primitive(&mut builder).clone();
    lines["mode"] = json!(1);
    let primitives = builder.root["meshes"][0]["primitives"].as_array_mut().expect("is a list");
    primitives.extend([lines.clone(), lines]);
    let scene = scene(&builder);
    assert_eq!(scene.triangle_count(), 2);
    let warning = &scene.warnings()[0];
    assert!(warning.contains("mesh 'wires': 2 primitives") && warning.contains("Lines"), "{warning}");
}

#[test]
fn unmapped_triangles_are_counted_over_instances() {
    let mut builder = square();
    let bare = json!({ "attributes": { "POSITION": 0 }, "indices": 2 });
    builder.root["meshes"][0]["primitives"].as_array_mut().expect("is a list").push(bare);
    builder.push("nodes", json!({ "mesh": 0, "translation": [0, 0, 5] }));
    builder.root["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = scene(&builder);
    assert_eq!(scene.triangle_count(), 8);
    assert!(scene.warnings()[0].starts_with("4 triangles have no light-map coordinates"), "{:?}", scene.warnings());
}

#[test]
fn sparse_and_strided_and_normalised_accessors() {
    let mut builder = square();
    let indices = builder.view(&[2]);
    let values = builder.view(&[3.0_f32, 4.0, 5.0].map(f32::to_le_bytes).concat());
    builder.root["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values },
    });
    let uvs: Vec<u8> = SQUARE_UVS.iter().flat_map(|uv| uv.map(|c| c as u8 * 255)).collect();
    let strided: Vec<u8> = uvs.chunks(2).flat_map(|uv| [uv[0], uv[1], 7, 7]).collect();
    let view = builder.view(&strided[..14]);
    builder.root["bufferViews"][view]["byteStride"] = json!(4);
    builder.root["accessors"][1] =
        json!({ "bufferView": view, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC2" });
    let scene = scene(&builder);
    assert_eq!(corners(&scene)[0][2], Vec3::new(3.0, 4.0, 5.0));
    assert_eq!(scene.meshes()[0].light_map_uvs()[0], Some([Vec2::ZERO, Vec2::X, Vec2::ONE]));
    builder.root["accessors"][0]["sparse"]["count"] = json!(9);
    assert_invalid(&builder, &["accessor 0", "9 sparse elements", "1 to 4"]);
}

#[test]
fn own_attributes_and_missing_bounds_do_no_harm() {
    let mut builder = square();
    primitive(&mut builder)["attributes"]["_BATCH"] = json!(1);
    builder.root["accessors"][0].as_object_mut().expect("is an object").remove("min");
    assert_eq!(scene(&builder).triangle_count(), 2);
}

#[test]
fn bind_pose_and_rest_shape_are_said() {
    let mut builder = square();
    builder.root["meshes"][0]["name"] = json!("hero");
    primitive(&mut builder)["targets"] = json!([{ "POSITION": 0 }]);
    builder.root["nodes"][0]["skin"] = json!(0);
    builder.push("skins", json!({ "joints": [0] }));
    let scene = scene(&builder);
    assert!(scene.warnings()[0].contains("bind pose: 'hero'"), "{:?}", scene.warnings());
    assert!(scene.warnings()[1].contains("morph targets are not applied: 'hero'"), "{:?}", scene.warnings());
}

/// Not a number of steps that grows with the square: a level may have so many, a trap more.
#[test]
fn tens_of_thousands_of_meshes_are_soon_read() {
    const COUNT: usize = 60_000;
    let mut builder = square();
    let (accessors, mesh) = (builder.root["accessors"].clone(), builder.root["meshes"][0].clone());
    let (mut all, mut meshes, mut nodes) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..COUNT {
        all.extend(accessors.as_array().expect("is a list").iter().cloned());
        let mut mesh = mesh.clone();
        let first = 3 * index;
        mesh["primitives"][0] =
            json!({ "attributes": { "POSITION": first, "TEXCOORD_1": first + 1 }, "indices": first + 2 });
        meshes.push(mesh);
        nodes.push(json!({ "mesh": index, "skin": 0 }));
    }
    builder.root["skins"] = json!([{ "joints": [0] }]);
    builder.root["scenes"][0]["nodes"] = json!((0..COUNT).collect::<Vec<_>>());
    (builder.root["accessors"], builder.root["meshes"], builder.root["nodes"]) =
        (all.into(), meshes.into(), nodes.into());
    let folder = Folder::new().with("many.gltf", builder.embedded());
    let start = std::time::Instant::now();
    let scene = folder.read("many.gltf").expect("is valid");
    let took = start.elapsed();
    assert_eq!(scene.instances().len(), COUNT);
    // A third of a second on two cores.
    assert!(took.as_secs() < 5, "took {took:?}");
}
