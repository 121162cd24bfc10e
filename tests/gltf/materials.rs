//! Materials, textures and images.

use crate::gltf_builder::{Builder, base64, png};
use crate::{Folder, SQUARE_UVS, primitive, scene, square};
use glam::{Vec2, Vec3};
use image::{DynamicImage, ImageFormat, Luma, Rgba};
use lightoven::io::gltf::{ReadSettings, SidednessChoice, read};
use lightoven::scene::{MAX_ALBEDO, Sidedness, Wrap};
use serde_json::{Value, json};

fn with_material(material: Value) -> Builder {
    let mut builder = square();
    let index = builder.push("materials", material);
    primitive(&mut builder)["material"] = json!(index);
    builder
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(bytes))
}

fn encoded(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, ImageFormat::Png).expect("fits into memory");
    bytes.into_inner()
}

#[test]
fn factors_become_albedo_and_emission() {
    let builder = with_material(json!({
        "name": "lamp", "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 1.0 },
        "emissiveFactor": [1, 0.5, 0], "doubleSided": true,
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 8 } },
    }));
    let scene = scene(&builder);
    let [material] = scene.materials() else { panic!("one material, not {:?}", scene.materials()) };
    assert_eq!(material.name, "lamp");
    assert_eq!(material.albedo, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!(material.emission, Vec3::new(8.0, 4.0, 0.0));
    assert_eq!(material.sidedness, Sidedness::Double);
}

#[test]
fn the_default_material_is_white_and_quiet() {
    let scene = scene(&square());
    assert_eq!(scene.materials()[0].albedo, Vec3::splat(MAX_ALBEDO));
    assert_eq!(scene.materials()[0].sidedness, Sidedness::Single);
    assert_eq!(scene.warnings(), [""; 0]);
}

#[test]
fn all_surfaces_can_be_double_sided() {
    let folder = Folder::new().with("scene.gltf", square().embedded());
    let settings = ReadSettings { sidedness: SidednessChoice::AllDouble };
    let scene = read(&folder.0.path().join("scene.gltf"), &settings).expect("is valid");
    assert_eq!(scene.materials()[0].sidedness, Sidedness::Double);
}

#[test]
fn alpha_modes_are_named_in_one_warning() {
    let mut builder = with_material(json!({ "name": "leaf", "alphaMode": "MASK" }));
    builder.push("materials", json!({ "name": "glass", "alphaMode": "BLEND" }));
    builder.push("materials", json!({ "name": "unused", "alphaMode": "BLEND" }));
    let mut glass = primitive(&mut builder).clone();
    glass["material"] = json!(1);
    builder.root["meshes"][0]["primitives"].as_array_mut().expect("is a list").push(glass);
    let scene = scene(&builder);
    assert_eq!(scene.warnings(), ["materials with alpha mode MASK or BLEND count as opaque: 'leaf', 'glass'"]);
}

#[test]
fn textures_transforms_and_samplers() {
    let mut builder = with_material(json!({
        "pbrMetallicRoughness": { "baseColorTexture": {
            "index": 0, "texCoord": 3, "extensions": { "KHR_texture_transform": {
                "texCoord": 0, "offset": [0.25, 0.5], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 4],
            } },
        } },
        "emissiveTexture": { "index": 1, "texCoord": 1 }, "emissiveFactor": [1, 1, 1],
    }));
    builder.root["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648 }]);
    builder.root["textures"] = json!([{ "source": 1, "sampler": 0 }, { "source": 1 }]);
    // Image 0 is needed by nothing: that it is missing does not matter.
    let pixels = png(2, 1, |x, _| [x as u8 * 255, 7, 9]);
    builder.root["images"] = json!([{ "uri": "missing.png" }, { "uri": data_uri(&pixels), "name": "tile" }]);
    let uvs = builder.vectors(&SQUARE_UVS);
    primitive(&mut builder)["attributes"]["TEXCOORD_0"] = json!(uvs);

    let scene = scene(&builder);
    let [texture] = scene.textures() else { panic!("one texture, not {}", scene.textures().len()) };
    assert_eq!((texture.name.as_str(), texture.width, texture.height), ("tile", 2, 1));
    assert_eq!(texture.pixels, [[0, 7, 9, 255], [255, 7, 9, 255]]);
    let material = &scene.materials()[0];
    let [albedo, emission] = [material.albedo_texture, material.emission_texture].map(|t| t.expect("has a texture"));
    assert_eq!((albedo.texture, albedo.wrap), (0, [Wrap::ClampToEdge, Wrap::MirroredRepeat]));
    assert_eq!((emission.texture, emission.wrap), (0, [Wrap::Repeat; 2]));
    // A quarter turn counter-clockwise, v down: (u, v) to (v, -u).
    let expected = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(|[u, v]| Vec2::new(0.25 + 4.0 * v, 0.5 - 2.0 * u));
    for (found, expected) in scene.meshes()[0].albedo_uvs()[0].iter().zip(expected) {
        assert!((*found - expected).length() < 1e-6, "{found} is not {expected}");
    }
    assert_eq!(scene.meshes()[0].emission_uvs()[0], [Vec2::ZERO, Vec2::X, Vec2::ONE]);
    assert_eq!(scene.warnings(), [""; 0]);
}

#[test]
fn every_kind_of_image_becomes_eight_bit_colour() {
    let grey = image::ImageBuffer::from_pixel(1, 1, Luma([128_u8]));
    let deep = image::ImageBuffer::from_pixel(1, 1, Rgba([65535_u16, 32896, 0, 65535]));
    for (bytes, expected) in [(encoded(grey), [128, 128, 128, 255]), (encoded(deep), [255, 128, 0, 255])] {
        let mut builder =
            with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": 1 } } }));
        builder.root["textures"] = json!([{ "source": 0 }]);
        let view = builder.view(&bytes);
        builder.root["images"] = json!([{ "bufferView": view, "mimeType": "image/png" }]);
        let scene = scene(&builder);
        assert_eq!(scene.textures()[0].pixels, [expected]);
        assert_eq!(scene.textures()[0].name, "image 0");
    }
}

#[test]
fn external_images_are_found_beside_the_file() {
    let mut builder =
        with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": 1 } } }));
    builder.root["textures"] = json!([{ "source": 0 }]);
    builder.root["images"] = json!([{ "uri": "a%20tile.png" }]);
    let folder = Folder::new().with("s.gltf", builder.embedded()).with("a tile.png", png(1, 1, |_, _| [1, 2, 3]));
    assert_eq!(folder.read("s.gltf").expect("is valid").textures()[0].pixels, [[1, 2, 3, 255]]);
}

#[test]
fn missing_coordinates_and_useless_textures() {
    let texture = json!({ "index": 0, "texCoord": 5 });
    let mut builder = with_material(json!({
        "name": "m", "emissiveTexture": texture, "emissiveFactor": [0, 0, 0],
        "pbrMetallicRoughness": { "baseColorTexture": texture, "baseColorFactor": [0, 0, 0, 1] },
    }));
    builder.root["textures"] = json!([{ "source": 0 }]);
    builder.root["images"] = json!([{ "uri": "missing.png" }]);
    assert!(scene(&builder).textures().is_empty());
    builder.root["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    builder.root["images"] = json!([{ "uri": data_uri(&png(1, 1, |_, _| [1, 2, 3])) }]);
    let warnings = scene(&builder).warnings().to_vec();
    assert!(warnings[0].contains("TEXCOORD_5 of mesh 'mesh 0', primitive 0 is missing"), "{warnings:?}");
    assert!(warnings[0].contains("material 'm'"), "{warnings:?}");
}
