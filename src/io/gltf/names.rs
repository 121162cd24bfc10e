//! What things are called in messages.

use gltf::{Image, Material, Mesh, Node};
use std::path::Path;

/// Names listed in one message; the rest is counted.
const MAX_LISTED: usize = 8;

/// The file's name without its folder and extension.
pub(super) fn of_file(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}

/// A node's name, or its position.
pub(super) fn of_node(node: &Node<'_>) -> String {
    given_or(node.name(), || format!("node {}", node.index()))
}

/// A mesh's name, or its position.
pub(super) fn of_mesh(mesh: &Mesh<'_>) -> String {
    given_or(mesh.name(), || format!("mesh {}", mesh.index()))
}

/// A material's name, or its position; the one of primitives without a material has a name of its own.
pub(super) fn of_material(material: &Material<'_>) -> String {
    given_or(material.name(), || match material.index() {
        Some(index) => format!("material {index}"),
        None => "default material".into(),
    })
}

/// An image's name or URI (unless its data is the URI), or its position.
pub(super) fn of_image(image: &Image<'_>, uri: Option<&str>) -> String {
    let uri = uri.filter(|uri| !uri.starts_with("data:"));
    given_or(image.name().or(uri), || format!("image {}", image.index()))
}

/// The first few names, quoted, and how many more there are.
pub(super) fn list(names: &[String]) -> String {
    let listed = names.iter().take(MAX_LISTED).map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_LISTED) {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}

pub(super) fn given_or(name: Option<&str>, otherwise: impl FnOnce() -> String) -> String {
    // A line break would forge another message.
    let plain = |name: &str| name.replace(char::is_control, "\u{fffd}");
    name.filter(|name| !name.is_empty()).map_or_else(otherwise, plain)
}
