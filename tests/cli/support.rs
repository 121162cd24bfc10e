//! Runs the tool, and makes scenes to run it on.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// The tool with its arguments.
pub(crate) fn tool<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lightoven"));
    // What one test compiled is not to be another's, nor the user's.
    command.args(arguments).env("LIGHTOVEN_PIPELINE_CACHE", "0");
    command
}

/// How a run ended.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

pub(crate) fn run<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>) -> Run {
    tool(arguments).output().expect("the tool starts").into()
}

/// One of the project's own scenes.
pub(crate) fn asset(name: &str) -> String {
    format!("{}/assets/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// A folder of a test's own.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("has room"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The same as text, for arguments.
    pub(crate) fn text(&self, name: &str) -> String {
        self.path(name).to_str().expect("is UTF-8").to_owned()
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        fs::write(self.path(name), content).expect("can be written");
        self.text(name)
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("is a folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("is readable").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// Runs a bake to `out.exr` in `folder`.
pub(crate) fn bake(folder: &Folder, scene: &str, more: &[&str]) -> Run {
    let output = folder.text("out.exr");
    run(["bake", scene, "-o", &output].iter().chain(more))
}

/// The failure of a bake: its exit code and what it must say; nothing may be left in its folder but the inputs.
pub(crate) fn assert_fails(folder: &Folder, scene: &str, more: &[&str], code: i32, says: &[&str]) {
    let before = folder.names();
    let found = bake(folder, scene, more);
    assert_eq!(found.code, Some(code), "{found:?}");
    assert!(found.stderr.contains("error: "), "{found:?}");
    assert!(!found.stderr.contains("panicked"), "{found:?}");
    for text in says {
        assert!(found.stderr.contains(text), "'{text}' is missing in {found:?}");
    }
    assert_eq!(folder.names(), before, "{found:?}");
}

/// Pixels of an EXR, as bits so that equal means the same.
pub(crate) fn pixel_bits(path: &Path) -> (u32, u32, Vec<[u32; 4]>) {
    let (width, height, pixels) = lightoven::io::exr::read_image(path).expect("is an EXR");
    (width, height, pixels.into_iter().map(|pixel| pixel.map(f32::to_bits)).collect())
}

pub(crate) fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("is there")).expect("is JSON")
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// What a report names is there.
pub(crate) fn assert_named(report: &Value, names: &[&str]) {
    for name in names {
        assert!(report[name].as_str().is_some_and(|text| !text.is_empty()), "{name}: {report}");
    }
}

/// All of it was said.
pub(crate) fn assert_says(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "'{part}' is missing in {text}");
    }
}

/// Values of options that a command refuses, writing nothing: option, value, what is named, what is said to be allowed.
pub(crate) fn assert_refused(command: &str, more: &[&str], bad: &[(&str, &str, &str, &str)]) {
    let folder = Folder::new();
    let scene = Quad::default().write(&folder);
    let before = folder.names();
    let report = folder.text("r.json");
    for (option, value, named, allowed) in bad {
        let found = run([command, &scene, "--report", &report].iter().chain(more).chain(&[*option, *value]));
        assert_eq!(found.code, Some(2), "{found:?}");
        assert_says(&found.stderr, &[option, named, allowed]);
    }
    assert_eq!(folder.names(), before);
}

/// Interrupts the tool after so many seconds. A signal before it listens ends it without a code; how long it takes to
/// listen depends on the machine.
#[cfg(unix)]
pub(crate) fn interrupted<S: AsRef<std::ffi::OsStr>>(arguments: impl IntoIterator<Item = S>, wait: u64) -> Run {
    let child = tool(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the tool starts");
    std::thread::sleep(Duration::from_secs(wait));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill starts");
    assert!(sent.success());
    child.wait_with_output().expect("ends").into()
}

/// A measurement that is interrupted before it has any figures says so and writes nothing.
#[cfg(unix)]
pub(crate) fn assert_no_figures_when_interrupted(arguments: &[&str]) {
    let folder = Folder::new();
    let report = folder.text("r.json");
    let found = [2, 8, 30]
        .into_iter()
        .map(|wait| interrupted(arguments.iter().chain(&["--report", &report]), wait))
        .find(|found| found.code.is_some())
        .expect("the tool listens within half a minute");
    assert_eq!(found.code, Some(130), "{found:?}");
    assert!(found.stderr.contains("no figures") && found.stdout.is_empty(), "{found:?}");
    assert!(folder.names().is_empty());
}

/// A unit square that faces up and shines, as glTF; tests spoil it.
pub(crate) struct Quad {
    pub(crate) positions: [[f32; 3]; 4],
    pub(crate) uvs: Option<[[f32; 2]; 4]>,
    pub(crate) indices: Vec<u16>,
    pub(crate) buffer: String,
    pub(crate) image: Option<String>,
}

impl Default for Quad {
    fn default() -> Self {
        Self {
            positions: [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            uvs: Some([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]),
            indices: vec![0, 1, 2, 0, 2, 3],
            buffer: "quad.bin".into(),
            image: None,
        }
    }
}

impl Quad {
    /// Positions, light-map coordinates, indices.
    fn binary(&self) -> Vec<u8> {
        let uvs = self.uvs.unwrap_or_default();
        let floats = self.positions.iter().flatten().chain(uvs.iter().flatten());
        let mut bytes: Vec<u8> = floats.flat_map(|f| f.to_le_bytes()).collect();
        bytes.extend(self.indices.iter().flat_map(|index| index.to_le_bytes()));
        bytes
    }

    fn json(&self, buffer: Value) -> String {
        let count = self.indices.len();
        let mut attributes = serde_json::json!({"POSITION": 0});
        if self.uvs.is_some() {
            attributes["TEXCOORD_1"] = 1.into();
        }
        let mut document = serde_json::json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "quad"}],
            "meshes": [{"name": "quad", "primitives": [{"attributes": attributes, "indices": 2, "material": 0}]}],
            "materials": [{"name": "shining", "emissiveFactor": [1.0, 1.0, 1.0]}],
            "buffers": [buffer],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": 48},
                {"buffer": 0, "byteOffset": 48, "byteLength": 32},
                {"buffer": 0, "byteOffset": 80, "byteLength": 2 * count}
            ],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 0, 1]},
                {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                {"bufferView": 2, "componentType": 5123, "count": count, "type": "SCALAR"}
            ]
        });
        if let Some(uri) = &self.image {
            document["images"] = serde_json::json!([{"uri": uri}]);
            document["textures"] = serde_json::json!([{"source": 0}]);
            document["materials"][0]["pbrMetallicRoughness"] = serde_json::json!({"baseColorTexture": {"index": 0}});
        }
        document.to_string()
    }

    /// Writes `quad.gltf` and `quad.bin`; gives the scene's path.
    pub(crate) fn write(&self, folder: &Folder) -> String {
        let binary = self.binary();
        folder.write("quad.bin", &binary);
        let buffer = serde_json::json!({"byteLength": binary.len(), "uri": self.buffer});
        folder.write("quad.gltf", self.json(buffer))
    }

    /// The same as one .glb.
    pub(crate) fn glb(&self) -> Vec<u8> {
        let binary = self.binary();
        let text = self.json(serde_json::json!({"byteLength": binary.len()}));
        let mut chunks = Vec::new();
        for (kind, content, padding) in [(b"JSON", text.as_bytes(), b' '), (b"BIN\0", &binary[..], 0)] {
            let length = content.len().next_multiple_of(4);
            chunks.extend((length as u32).to_le_bytes());
            chunks.extend(kind);
            chunks.extend(content);
            chunks.resize(chunks.len() + length - content.len(), padding);
        }
        let mut file = b"glTF".to_vec();
        file.extend([2, 12 + chunks.len() as u32].iter().flat_map(|word: &u32| word.to_le_bytes()));
        file.extend(chunks);
        file
    }
}
