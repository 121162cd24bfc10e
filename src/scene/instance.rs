//! A placed copy of a mesh.

use super::Mesh;
use crate::error::{Error, Result};
use glam::DAffine3;

/// Whether an instance may be moved, removed and added while a baker runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Mobility {
    /// It stays where it is, and its texels and those of others know each other: a texel inside it is given up.
    #[default]
    Static,
    /// It may move. No texel is given up for it, since it may leave.
    Movable,
}

/// A placed copy of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// Shown in messages.
    pub name: String,
    /// Position of the mesh in the scene's list.
    pub mesh: usize,
    /// Object to world, in f64 so that a scene far from the origin keeps its precision. Mirroring and non-uniform
    /// scales are allowed; a singular one leaves the instance out, with a warning.
    pub transform: DAffine3,
    /// Whether it may move.
    pub mobility: Mobility,
}

impl Instance {
    /// `Ok(false)` when the instance has to be left out.
    pub(super) fn check(&self, meshes: &[Mesh], warnings: &mut Vec<String>) -> Result<bool> {
        let Self { name, mesh, transform, mobility: _ } = self;
        if *mesh >= meshes.len() {
            let count = meshes.len();
            return Err(Error::scene(format!("instance '{name}' refers to mesh {mesh}; the scene has {count}")));
        }
        if !transform.is_finite() {
            return Err(Error::scene(format!("the transform of instance '{name}' has a number that is not finite")));
        }
        let matrix = transform.matrix3;
        let scale = matrix.x_axis.length() * matrix.y_axis.length() * matrix.z_axis.length();
        // 1e-12 of the box that the axes span: a flattened object, whose normals have no direction.
        if matrix.determinant().abs() <= 1e-12 * scale || !matrix.inverse().is_finite() {
            warnings.push(format!("instance '{name}' is left out: its transform is singular"));
            return Ok(false);
        }
        Ok(true)
    }
}
