//! glTF 2.0 in: `.gltf` and `.glb`, with external or embedded buffers and images.
//!
//! What becomes of a file:
//! - The nodes of its default scene (else of its first scene, else all root nodes) become instances and lights.
//! - A node that an animation moves, or a node above it, is movable.
//! - `TEXCOORD_1` is the light map; a primitive without it blocks and emits light and receives none.
//! - Base colour is albedo. The metallic factor is not looked at: a light map holds diffuse light, and a metal's share
//!   of it is best guessed by its base colour.
//! - Emission is `emissiveFactor` times its texture times `KHR_materials_emissive_strength`.
//! - Alpha modes MASK and BLEND count as opaque, skinned meshes stay in their bind pose, morph targets at rest; a
//!   warning names them.
//!
//! Nothing in a file is trusted: every index, offset and length is checked before it is used.

mod accessors;
mod bounds;
mod container;
mod document;
mod geometry;
mod images;
mod lights;
mod materials;
mod names;
mod nodes;
mod resource;

use crate::error::Result;
use crate::scene::{Instance, Scene, SceneDesc};
use bounds::Buffers;
use geometry::Meshes;
use materials::Materials;
use nodes::Placed;
use std::path::Path;

/// What a scene's surfaces answer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SidednessChoice {
    /// As the materials' `doubleSided` says.
    #[default]
    AsWritten,
    /// Every surface answers on both sides, as in Blender.
    AllDouble,
}

/// How a file is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct ReadSettings {
    /// Default: as written.
    pub sidedness: SidednessChoice,
}

/// Reads a `.gltf` or `.glb` file; which of the two it is is told by its content.
///
/// The scene is named after the file. What had to be left out or taken for something else is said in
/// [`Scene::warnings`]. Only images that a material in use needs are decoded.
///
/// # Errors
/// - `Io`: the file, or a buffer or image that it names, cannot be read.
/// - `Unsupported`: a glTF version other than 2, an extension that the file requires, an image that is neither PNG nor
///   JPEG, a URI scheme that is neither relative nor `data:`.
/// - `InvalidScene`: the file is no glTF or contradicts itself, or [`Scene::new`] rejects what it describes.
pub fn read(path: &Path, settings: &ReadSettings) -> Result<Scene> {
    checked(read_desc(path, settings)?)
}

/// Reads a `.gltf` or `.glb` file that is in memory. `name`: that of the scene, and of the file in messages; what the file
/// refers to is read from `folder`, and without one it refers to nothing outside itself.
///
/// # Errors
/// As [`read`]; `InvalidScene` too for a file that refers to others, without a folder.
pub fn read_bytes(name: &str, bytes: Vec<u8>, folder: Option<&Path>, settings: &ReadSettings) -> Result<Scene> {
    let path = Path::new(name);
    let (mut desc, warnings) = describe(path, container::take_apart(path, bytes)?, folder, settings)?;
    name.clone_into(&mut desc.name);
    checked((desc, warnings))
}

fn checked((desc, warnings): (SceneDesc, Vec<String>)) -> Result<Scene> {
    let mut scene = Scene::new(desc)?;
    warnings.into_iter().for_each(|warning| scene.warn(warning));
    Ok(scene)
}

/// Reads a file as [`read`] does, for something to be added before [`Scene::new`] checks it; what had to be left out or
/// taken for something else comes with it, one sentence each.
///
/// # Errors
/// As [`read`], but for what [`Scene::new`] rejects.
pub fn read_desc(path: &Path, settings: &ReadSettings) -> Result<(SceneDesc, Vec<String>)> {
    describe(path, container::open(path)?, path.parent().or(Some(Path::new(""))), settings)
}

fn describe(
    path: &Path,
    container: container::Container,
    folder: Option<&Path>,
    settings: &ReadSettings,
) -> Result<(SceneDesc, Vec<String>)> {
    let document = document::parse(path, &container.json)?;
    let buffers = Buffers::load(&document, container.binary, folder)?;

    let mut materials = Materials::new(settings.sidedness);
    let mut meshes = Meshes::new(&document);
    let mut desc = SceneDesc { name: names::of_file(path), ..SceneDesc::default() };
    for Placed { node, transform, mobility } in nodes::place(&document)? {
        if let Some(mesh) = node.mesh() {
            let mesh = meshes.place(&mesh, node.skin().is_some(), &buffers, &mut materials)?;
            desc.instances.push(Instance { name: names::of_node(&node), mesh, transform, mobility });
        }
        if let Some(light) = node.light() {
            desc.lights.push(lights::read(&light, &node, &transform));
        }
    }
    let mut warnings = meshes.warnings();
    warnings.extend(materials.warnings());
    desc.meshes = meshes.into_meshes();
    (desc.materials, desc.textures) = materials.load(&document, &buffers, folder)?;
    Ok((desc, warnings))
}
