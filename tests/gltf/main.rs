//! The glTF reader: every feature that it maps, and every input that it must refuse.

#[path = "../common/gltf_builder.rs"]
mod gltf_builder;
#[path = "../common/shared_scenes.rs"]
mod levels;

mod bad_documents;
mod bad_files;
mod geometry;
mod materials;
mod mutated;
mod mutations;
mod nodes;
mod shared_scenes;

use gltf_builder::Builder;
use lightoven::io::gltf::{ReadSettings, read};
use lightoven::scene::Scene;
use lightoven::{ErrorKind, Result};
use serde_json::{Value, json};
use tempfile::TempDir;

/// The corners of the unit square in z = 0, counter-clockwise from the origin.
const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
const SQUARE_UVS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Mesh 0, the unit square with light-map coordinates, on node 0, in scene 0.
/// Accessors: 0 positions, 1 light-map coordinates, 2 indices.
fn square() -> Builder {
    let mut builder = Builder::new();
    let positions = builder.vectors(&SQUARE);
    let uvs = builder.vectors(&SQUARE_UVS);
    let indices = builder.indices(&[0, 1, 2, 0, 2, 3]);
    let primitive = json!({ "attributes": { "POSITION": positions, "TEXCOORD_1": uvs }, "indices": indices });
    builder.push("meshes", json!({ "primitives": [primitive] }));
    builder.push("nodes", json!({ "mesh": 0 }));
    builder.push("scenes", json!({ "nodes": [0] }));
    builder
}

/// The first primitive of the first mesh.
fn primitive(builder: &mut Builder) -> &mut Value {
    &mut builder.root["meshes"][0]["primitives"][0]
}

/// A folder of its own for the files of one test.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder can be made"))
    }

    fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        self.put(name, content);
        self
    }

    fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.0.path().join(name), content).expect("the temporary folder can be written");
    }

    fn read(&self, name: &str) -> Result<Scene> {
        read(&self.0.path().join(name), &ReadSettings::default())
    }

    fn refused(&self, name: &str) -> (ErrorKind, String) {
        let error = self.read(name).expect_err("must be refused");
        (error.kind(), error.to_string())
    }
}

fn scene(builder: &Builder) -> Scene {
    Folder::new().with("scene.gltf", builder.embedded()).read("scene.gltf").expect("is valid")
}

fn refused(builder: &Builder) -> (ErrorKind, String) {
    Folder::new().with("scene.gltf", builder.embedded()).refused("scene.gltf")
}

/// Asserts that a document is an invalid scene, and that the message names all of `parts`.
fn assert_invalid(builder: &Builder, parts: &[&str]) {
    let (kind, message) = refused(builder);
    assert_eq!(kind, ErrorKind::InvalidScene, "{message}");
    for part in parts {
        assert!(message.contains(part), "'{message}' does not name '{part}'");
    }
}

/// The document as a GLB file.
fn glb(builder: &Builder) -> Vec<u8> {
    let mut root = builder.root.clone();
    root["buffers"] = json!([{ "byteLength": builder.binary.len() }]);
    container(serde_json::to_vec(&root).expect("is JSON"), &builder.binary)
}

/// A GLB file of these two chunks.
fn container(mut json: Vec<u8>, binary: &[u8]) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    bytes.extend([2, length as u32].map(u32::to_le_bytes).concat());
    for (kind, content) in [(b"JSON", json.as_slice()), (b"BIN\0", binary)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}
