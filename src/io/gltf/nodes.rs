//! The node hierarchy, flattened.

use super::names;
use crate::error::{Error, Result};
use crate::scene::Mobility;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::animation::Property;
use gltf::json::validation::Checked;
use gltf::scene::Transform;
use gltf::{Document, Node};

/// Rounding allowed in the last row of a node's matrix.
const AFFINE_SLACK: f32 = 1e-5;

/// A node and where it is.
pub(super) struct Placed<'a> {
    pub(super) node: Node<'a>,
    /// Node to world.
    pub(super) transform: DAffine3,
    /// Movable where an animation moves the node or one above it.
    pub(super) mobility: Mobility,
}

/// All nodes of the scene to be baked, parents before children, otherwise in the document's order.
pub(super) fn place(document: &Document) -> Result<Vec<Placed<'_>>> {
    let nodes: Vec<Node<'_>> = document.nodes().collect();
    let mut placed = Vec::new();
    let mut seen = vec![false; nodes.len()];
    // A stack of our own: a hierarchy may be deeper than the thread's.
    let mut pending: Vec<(usize, DAffine3, Mobility)> =
        roots(document).into_iter().map(|root| (root, DAffine3::IDENTITY, Mobility::Static)).collect();
    pending.reverse();
    let animated = animated(document, nodes.len());
    while let Some((index, parent, parent_mobility)) = pending.pop() {
        let node = &nodes[index];
        if std::mem::replace(&mut seen[index], true) {
            return Err(Error::scene(format!(
                "node {index} ('{}') is reached twice: it has two parents or is its own ancestor; allowed is a tree",
                names::of_node(node)
            )));
        }
        let transform = parent * local(node)?;
        let mobility = if animated[index] { Mobility::Movable } else { parent_mobility };
        let first_child = pending.len();
        pending.extend(node.children().map(|child| (child.index(), transform, mobility)));
        pending[first_child..].reverse();
        placed.push(Placed { node: node.clone(), transform, mobility });
    }
    Ok(placed)
}

/// `[node]`: whether an animation moves it.
fn animated(document: &Document, count: usize) -> Vec<bool> {
    let mut animated = vec![false; count];
    // Animations are not validated: what is broken in them moves nothing.
    for channel in document.as_json().animations.iter().flat_map(|animation| &animation.channels) {
        let moves = matches!(channel.target.path, Checked::Valid(path) if path != Property::MorphTargetWeights);
        if let Some(node) = animated.get_mut(channel.target.node.value()).filter(|_| moves) {
            *node = true;
        }
    }
    animated
}

/// The root nodes of the default scene, else of the first one, else of the whole document.
fn roots(document: &Document) -> Vec<usize> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().map(|node| node.index()).collect();
    }
    let mut is_root = vec![true; document.nodes().len()];
    for child in document.nodes().flat_map(|node| node.children()) {
        is_root[child.index()] = false;
    }
    (0..is_root.len()).filter(|index| is_root[*index]).collect()
}

/// Node to parent.
fn local(node: &Node<'_>) -> Result<DAffine3> {
    match node.transform() {
        Transform::Decomposed { translation, rotation, scale } => {
            let [x, y, z, w] = rotation.map(f64::from);
            Ok(DAffine3::from_scale_rotation_translation(
                DVec3::from(scale.map(f64::from)),
                DQuat::from_xyzw(x, y, z, w).normalize(),
                DVec3::from(translation.map(f64::from)),
            ))
        }
        Transform::Matrix { matrix } => {
            let last_row = matrix.map(|column| column[3]);
            if last_row.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(found, wanted)| (found - wanted).abs() > AFFINE_SLACK) {
                return Err(Error::scene(format!(
                    "node {} ('{}'): the last row of its matrix is {last_row:?}; allowed is 0, 0, 0, 1",
                    node.index(),
                    names::of_node(node)
                )));
            }
            let [x, y, z, t] = matrix.map(|[x, y, z, _]| DVec3::from([x, y, z].map(f64::from)));
            Ok(DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: t })
        }
    }
}
