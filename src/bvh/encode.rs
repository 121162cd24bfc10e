//! Trees as the GPU reads them: nodes with both children's boxes, triangles in the order of the leaves.

use super::{EMPTY, FIRST_BITS, InstanceRecord, LEAF, MAX_COORDINATE, Node};
use crate::error::{Error, Result};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;

/// Half an ulp of 1.
const UNIT_ROUNDOFF: f64 = 1.0 / (1 << 24) as f64;

/// Boxes are made larger by this many unit roundoffs of the largest coordinate L that a plane or an origin has in their
/// space.
///
/// The slab distance is fma(plane, inv_dir, -(origin * inv_dir)). The rounding of the product moves the plane by at
/// most u|origin| <= uL; without a fused operation the other product adds u|plane| <= uL; rounding the box outward
/// itself costs another uL. What is left, the rounding of inv_dir (2u where the reciprocal is good to one ulp) and of
/// the result (u), is relative to the distance, 6u between two axes, and lies within the 6.7u of [`super::TFAR_SCALE`].
/// One uL is spare: for origins that lie outside the bounds, by at most as much again.
const BOX_PAD: f64 = 4.0;

/// The same for the way to object space and back: the matrix (u), its product with a point (4u), and the same for a
/// direction over a distance of up to 2 sqrt(3) L (another 5u of 3.5 L), less than 32 u in all.
const TRANSFORM_PAD: f64 = 32.0;

/// An axis-aligned box in f64.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) lo: DVec3,
    pub(super) hi: DVec3,
}

impl Bounds {
    pub(super) fn of(aabb: &Aabb) -> Self {
        Self { lo: aabb.min.as_dvec3(), hi: aabb.max.as_dvec3() }
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    pub(super) fn holds(self, other: Self) -> bool {
        self.lo.cmple(other.lo).all() && self.hi.cmpge(other.hi).all()
    }

    /// The box around the transformed box.
    pub(super) fn transformed(self, transform: &DAffine3) -> Self {
        let (centre, half) = ((self.lo + self.hi) * 0.5, (self.hi - self.lo) * 0.5);
        let (centre, half) = (transform.transform_point3(centre), absolute(transform.matrix3) * half);
        Self { lo: centre - half, hi: centre + half }
    }

    /// The largest absolute coordinate.
    pub(super) fn reach(self) -> f64 {
        self.lo.abs().max(self.hi.abs()).max_element()
    }

    fn padded(self, pad: DVec3) -> Self {
        Self { lo: self.lo - pad, hi: self.hi + pad }
    }

    fn aabb(self) -> Aabb {
        Aabb::new(self.lo.as_vec3a(), self.hi.as_vec3a())
    }
}

fn absolute(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// The box of an instance in the top level: `object` transformed, with room for what the way to object space rounds.
pub(super) fn instance_box(object: Bounds, transform: &DAffine3, inverse: &DAffine3, world_reach: f64) -> Aabb {
    let there = absolute(inverse.matrix3) * DVec3::splat(world_reach) + inverse.translation.abs();
    let back = absolute(transform.matrix3) * there;
    object.transformed(transform).padded(TRANSFORM_PAD * UNIT_ROUNDOFF * back).aabb()
}

/// How far the boxes of a space are to be padded, `reach` being the largest coordinate in it.
pub(super) fn box_pad(reach: f64) -> f32 {
    (BOX_PAD * UNIT_ROUNDOFF * reach) as f32
}

/// `Ok` when boxes of this reach can be tested without overflow.
pub(super) fn check_reach(what: impl Fn() -> String, reach: f64) -> Result<()> {
    if reach <= MAX_COORDINATE {
        return Ok(());
    }
    Err(Error::scene(format!(
        "{} reaches the coordinate {reach:e}, the middle of the scene being 0; allowed is at most {MAX_COORDINATE:e}",
        what()
    )))
}

/// The code of a leaf of 1 to 8 primitives.
pub(super) fn leaf_code(first: u32, count: u32) -> u32 {
    LEAF | (count - 1) << FIRST_BITS | first
}

/// Appends a tree's nodes depth first and returns the root's index. `leaf` gets a leaf's primitives and the number of
/// inner nodes above it, and returns the leaf's code.
pub(super) fn flatten(tree: &Bvh2, pad: f32, nodes: &mut Vec<Node>, mut leaf: impl FnMut(&[u32], u32) -> u32) -> u32 {
    let root = nodes.len() as u32;
    nodes.push(Node::EMPTY);
    let Some(top) = tree.nodes.first() else { return root };
    let mut work = Vec::new();
    if top.is_leaf() {
        work.push((0, root, 0, 1));
    } else {
        push_children(top.first_index, root, 1, &mut work);
    }
    while let Some((index, parent, side, depth)) = work.pop() {
        let node = &tree.nodes[index as usize];
        let code = if node.is_leaf() {
            let first = node.first_index as usize;
            leaf(&tree.primitive_indices[first..first + node.prim_count as usize], depth)
        } else {
            let code = nodes.len() as u32;
            nodes.push(Node::EMPTY);
            push_children(node.first_index, code, depth + 1, &mut work);
            code
        };
        let aabb = node.aabb();
        let (lo, hi) = (aabb.min - pad, aabb.max + pad);
        nodes[parent as usize].set_child(side, lo.into(), hi.into(), code);
    }
    let root_node = &mut nodes[root as usize];
    if top.is_leaf() {
        root_node.child1 = root_node.child0;
    }
    root
}

/// (node, encoded parent, side, inner nodes above), the first child on top.
fn push_children(first: u32, parent: u32, depth: u32, work: &mut Vec<(u32, u32, usize, u32)>) {
    work.extend([(first + 1, parent, 1, depth), (first, parent, 0, depth)]);
}

impl Node {
    /// Two empty children.
    pub(super) const EMPTY: Self =
        Self { lo0: EMPTY, child0: LEAF, hi0: EMPTY, child1: LEAF, lo1: EMPTY, _pad0: 0, hi1: EMPTY, _pad1: 0 };

    pub(super) fn set_child(&mut self, side: usize, lo: Vec3, hi: Vec3, code: u32) {
        let (to_lo, to_hi, to_code) = match side {
            0 => (&mut self.lo0, &mut self.hi0, &mut self.child0),
            _ => (&mut self.lo1, &mut self.hi1, &mut self.child1),
        };
        (*to_lo, *to_hi, *to_code) = (lo.into(), hi.into(), code);
    }
}

impl InstanceRecord {
    pub(super) fn place(&mut self, transform: &DAffine3, inverse: &DAffine3) {
        self.object_to_world = rows(transform);
        self.world_to_object = rows(inverse);
        let mirrored = if transform.matrix3.determinant() < 0.0 { Self::MIRRORED } else { 0 };
        self.flags = self.flags & !Self::MIRRORED | mirrored;
    }
}

fn rows(transform: &DAffine3) -> [[f32; 4]; 3] {
    let matrix = transform.matrix3.transpose();
    let row = |axis: DVec3, offset: f64| axis.extend(offset).as_vec4().to_array();
    let offset = transform.translation;
    [row(matrix.x_axis, offset.x), row(matrix.y_axis, offset.y), row(matrix.z_axis, offset.z)]
}
