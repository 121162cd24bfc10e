//! The JSON of a file, checked as far as its structure goes.

use crate::error::{Error, ErrorKind, Result};
use gltf::Document;
use gltf::json::validation::{Checked, Error as Violation, Validate};
use gltf::json::{self, Root, Value};
use gltf::mesh::Semantic;
use std::path::Path;

/// Extensions that this reader implements; a file may require them.
const EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_mesh_quantization", "KHR_texture_transform"];

/// Violations listed in a message; the rest is counted.
const MAX_LISTED: usize = 4;

/// Parses the JSON. Afterwards every index in what the reader looks at is in range and every enumeration is known.
pub(super) fn parse(path: &Path, json: &[u8]) -> Result<Document> {
    let file = path.display();
    let root = match Root::from_slice(json).or_else(|error| without_untargeted_channels(json).ok_or(error)) {
        Ok(root) => root,
        Err(error) => {
            // Where JSON does not fit, the version or an extension may be why, and is then the better message.
            if let Ok(value) = json::deserialize::from_slice::<Value>(json) {
                check_raw_requirements(path, &value)?;
            }
            return Err(Error::scene(format!("'{file}' is not glTF")).with_source(error));
        }
    };
    check_version(path, &root.asset.version)?;
    check_extensions(path, root.extensions_required.iter().map(String::as_str))?;
    check_attributes(path, &root)?;
    let violations = violations(&root);
    if violations.is_empty() {
        return Ok(Document::from_json_without_validation(root));
    }
    let listed = violations.iter().take(MAX_LISTED).cloned().collect::<Vec<_>>().join("; ");
    let more = match violations.len().saturating_sub(MAX_LISTED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    Err(Error::scene(format!("'{file}' is not valid glTF: {listed}{more}")))
}

/// The document without animation channels that name no node: they are to be ignored, and the crate does not know them.
/// `None`: there are none, or that does not help.
fn without_untargeted_channels(json: &[u8]) -> Option<Root> {
    let mut value = json::deserialize::from_slice::<Value>(json).ok()?;
    let animations = value.get_mut("animations")?.as_array_mut()?;
    for animation in animations.iter_mut() {
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            channels.retain(|channel| channel.pointer("/target/node").is_some());
        }
    }
    json::deserialize::from_value(value).ok()
}

fn check_raw_requirements(path: &Path, value: &Value) -> Result<()> {
    if let Some(version) = value.pointer("/asset/version").and_then(Value::as_str) {
        check_version(path, version)?;
    }
    let required = value.get("extensionsRequired").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    check_extensions(path, required.iter().filter_map(Value::as_str))
}

fn check_version(path: &Path, version: &str) -> Result<()> {
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    let context = format!("'{}' is glTF version '{}'; allowed is 2", path.display(), version.escape_debug());
    Err(Error::new(ErrorKind::Unsupported, context))
}

fn check_extensions<'a>(path: &Path, required: impl Iterator<Item = &'a str>) -> Result<()> {
    let unknown: Vec<String> =
        required.filter(|name| !EXTENSIONS.contains(name)).map(|name| format!("'{}'", name.escape_debug())).collect();
    if unknown.is_empty() {
        return Ok(());
    }
    let context = format!(
        "'{}' requires the glTF extensions {}; known are {}",
        path.display(),
        unknown.join(", "),
        EXTENSIONS.join(", ")
    );
    Err(Error::new(ErrorKind::Unsupported, context))
}

/// The crate's validation of a primitive indexes the accessors with its POSITION before it has checked it.
fn check_attributes(path: &Path, root: &Root) -> Result<()> {
    let count = root.accessors.len();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let Some(index) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else { continue };
            if index.value() >= count {
                return Err(Error::scene(format!(
                    "'{}': POSITION of mesh {m}, primitive {p} is accessor {}; there are {count}",
                    path.display(),
                    index.value()
                )));
            }
        }
    }
    Ok(())
}

/// What the crate's validation finds, less what does no harm here.
fn violations(root: &Root) -> Vec<String> {
    let mut found = Vec::new();
    root.validate(root, json::Path::new, &mut |path, violation| {
        let path = path();
        if !is_harmless(path.as_str(), violation) {
            found.push(format!("{}: {violation}", path.as_str()));
        }
    });
    found
}

/// Parts that are not relied on: animations, of which it is only asked what they move, cameras, attributes of an application's own (`_NAME`), the bounds of
/// positions, which real files leave out. Required extensions have been checked, and an accessor without a view is
/// zeros.
fn is_harmless(path: &str, violation: Violation) -> bool {
    let unread = path.starts_with("animations") || path.starts_with("cameras");
    let bounds = path.ends_with("[\"POSITION\"].min") || path.ends_with("[\"POSITION\"].max");
    let zeros = path.starts_with("accessors") && violation == Violation::Missing;
    unread || bounds || zeros || path.contains("<invalid semantic name>") || path.starts_with("extensionsRequired")
}
