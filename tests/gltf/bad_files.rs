//! Files, containers and what they refer to.

use crate::gltf_builder::base64;
use crate::{Folder, assert_invalid, glb, primitive, refused, square};
use lightoven::ErrorKind::{InvalidScene, Io, Unsupported};
use serde_json::json;

/// Asserts the kind and that the message names all of `parts`.
#[track_caller]
fn assert_refused((kind, message): (lightoven::ErrorKind, String), expected: lightoven::ErrorKind, parts: &[&str]) {
    assert_eq!(kind, expected, "{message}");
    for part in parts {
        assert!(message.contains(part), "'{message}' does not name '{part}'");
    }
}

#[test]
fn files_that_cannot_be_read() {
    let folder = Folder::new();
    assert_refused(folder.refused("no such.glb"), Io, &["no such.glb", "No such file"]);
    assert_refused(folder.refused(""), Io, &["a folder"]);
}

#[test]
fn files_that_are_no_gltf() {
    for content in ["", "hello", "{}", "[]", "{\"asset\": 3}", "\u{89}PNG"] {
        let folder = Folder::new().with("some.gltf", content);
        assert_refused(folder.refused("some.gltf"), InvalidScene, &["some.gltf' is not glTF"]);
    }
    let folder = Folder::new().with("deep.gltf", "[".repeat(1_000_000));
    assert_refused(folder.refused("deep.gltf"), InvalidScene, &["is not glTF"]);
    let old = Folder::new().with("old.gltf", "{\"asset\": {\"version\": \"1.0\"}, \"meshes\": {}}");
    assert_refused(old.refused("old.gltf"), Unsupported, &["version '1.0'", "allowed is 2"]);
}

#[test]
fn truncated_glb_files() {
    let whole = glb(&square());
    for length in [4, 11, 12, 19, 20, 100, whole.len() - 1] {
        let folder = Folder::new().with("cut.glb", &whole[..length]);
        assert_refused(folder.refused("cut.glb"), InvalidScene, &["cut.glb", "truncated"]);
    }
    let with = |offset: usize, word: u32| {
        let mut bytes = whole.clone();
        bytes[offset..offset + 4].copy_from_slice(&word.to_le_bytes());
        Folder::new().with("odd.glb", bytes).refused("odd.glb")
    };
    assert_refused(with(4, 3), Unsupported, &["GLB version 3", "allowed is 2"]);
    assert_refused(with(8, 5), InvalidScene, &["length of 5 bytes"]);
    assert_refused(with(12, u32::MAX), InvalidScene, &["JSON chunk", "4294967295"]);
    assert_refused(with(16, 0), InvalidScene, &["type", "'JSON' is expected"]);
}

#[test]
fn buffers_that_are_missing_or_short() {
    let builder = square();
    let with = |buffer: serde_json::Value| {
        let mut root = builder.root.clone();
        root["buffers"] = json!([buffer]);
        Folder::new().with("short.bin", [0; 8]).with("s.gltf", root.to_string()).refused("s.gltf")
    };
    assert_refused(with(json!({ "byteLength": 8, "uri": "gone.bin" })), Io, &["buffer 0", "gone.bin", "No such"]);
    assert_refused(with(json!({ "byteLength": 8 })), InvalidScene, &["buffer 0 has no URI"]);
    let short = with(json!({ "byteLength": 99, "uri": "short.bin" }));
    assert_refused(short, InvalidScene, &["buffer 0", "short.bin", "8 bytes", "99"]);
    assert_refused(with(json!({ "byteLength": 8, "uri": "." })), Io, &["buffer 0", "a folder"]);
    assert_refused(with(json!({ "byteLength": 8, "uri": "/dev/zero" })), InvalidScene, &["buffer 0", "relative"]);
    // However deep the folder is: above the root is the root.
    let endless = "../".repeat(32) + "dev/zero";
    assert_refused(with(json!({ "byteLength": 8, "uri": endless })), Io, &["buffer 0", "/dev/zero"]);
    assert_refused(with(json!({ "byteLength": 8, "uri": "a%ff.bin" })), InvalidScene, &["buffer 0", "a%ff", "UTF-8"]);
    assert_refused(with(json!({ "byteLength": 8, "uri": "%00" })), InvalidScene, &["buffer 0", "names no file"]);
    assert_refused(
        with(json!({ "byteLength": 8, "uri": "%2Fetc/hostname" })),
        InvalidScene,
        &["buffer 0", "relative paths"],
    );
    let web = with(json!({ "byteLength": 8, "uri": "https://a.example/b.bin" }));
    assert_refused(web, Unsupported, &["buffer 0", "https"]);
    assert_refused(with(json!({ "byteLength": 8, "uri": "data:;base64,*" })), InvalidScene, &["buffer 0", "base64"]);
}

#[test]
fn images_that_cannot_be_decoded() {
    let with = |image: serde_json::Value| {
        let mut builder = square();
        let texture = json!({ "index": 0, "texCoord": 1 });
        builder.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } }));
        primitive(&mut builder)["material"] = json!(0);
        builder.push("textures", json!({ "source": 0 }));
        builder.push("images", image);
        refused(&builder)
    };
    let data = |bytes: &[u8]| json!({ "name": "tile", "uri": format!("data:image/png;base64,{}", base64(bytes)) });
    assert_refused(with(json!({ "uri": "gone.png" })), Io, &["image 0", "gone.png", "No such"]);
    assert_refused(with(json!({})), InvalidScene, &["image 0", "neither a URI nor a buffer view"]);
    assert_refused(with(json!({ "bufferView": 99 })), InvalidScene, &["images[0].bufferView"]);
    assert_refused(with(data(b"hello")), Unsupported, &["image 0 ('tile')", "PNG and JPEG"]);
    assert_refused(with(data(b"GIF89a")), Unsupported, &["image 0 ('tile')"]);
    assert_refused(with(data(b"\x89PNG\r\n\x1a\n")), InvalidScene, &["decode image 0 ('tile')"]);
}

#[test]
fn extensions_that_are_not_known() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"] {
        let mut builder = square();
        builder.root["extensionsRequired"] = json!(["KHR_texture_transform", name]);
        assert_refused(refused(&builder), Unsupported, &[&format!("requires the glTF extensions '{name}'")]);
        // With basisu alone a texture has no `source`, which the schema wants.
        builder.push("textures", json!({}));
        assert_refused(refused(&builder), Unsupported, &[name]);
    }
    let mut builder = square();
    builder.root["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    builder.root["accessors"][0]["count"] = json!(0);
    assert_invalid(&builder, &["accessor 0"]);
}

/// The beginning of a PNG file of this many pixels, followed by zeros.
fn png_head(width: u32, height: u32, bytes: usize) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend([width, height].map(u32::to_be_bytes).concat());
    header.extend([8, 2, 0, 0, 0]);
    let crc = header.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 })
    });
    let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    file.extend(header);
    file.extend((!crc).to_be_bytes());
    file.extend((bytes as u32).to_be_bytes());
    file.extend(b"IDAT");
    file.resize(file.len() + bytes, 0);
    file
}

#[test]
fn images_that_claim_more_than_they_hold() {
    let with_image = |bytes: &[u8]| {
        let mut builder = square();
        let image = builder.view(bytes);
        builder.root["images"] = json!([{ "bufferView": image, "name": "claim" }]);
        builder.root["textures"] = json!([{ "source": 0 }]);
        builder.root["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
        primitive(&mut builder)["material"] = json!(0);
        builder
    };
    assert_invalid(&with_image(&png_head(16384, 16384, 64)), &["image 0 ('claim')", "16384 x 16384", "cannot hold"]);
    assert_invalid(&with_image(&png_head(20000, 20000, 1 << 16)), &["decode image 0 ('claim')"]);
    assert_invalid(&with_image(&png_head(64, 64, 1000)), &["decode image 0 ('claim')"]);
}
