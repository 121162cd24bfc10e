//! A bounding volume hierarchy over the scene, built on the host and traversed on the device.
//!
//! Two levels: a top level over instances, in world space relative to [`Scene::centre`], and below it one bottom level
//! for each mesh that is placed, in object space. A scene of exactly one instance, which does not move, has no top level;
//! its mesh is transformed to world space here, in f64.
//!
//! From here on "primitive" is a triangle's slot in [`Bvh::triangles`], which is the order of the leaves;
//! [`Bvh::order`] leads back to the mesh's own order. The traversal in `traverse.rs` reads the same arrays as the
//! shader, and is its oracle.

mod build;
mod encode;
mod top_level;
mod traverse;

pub use traverse::{Hit, Ray};

use crate::error::{Error, ErrorKind, Result};
use crate::scene::{Atlas, AtlasRect, Instance, Mesh, Mobility, Scene};
use bytemuck::{Pod, Zeroable};
use encode::Bounds;
use glam::{DAffine3, DVec3, Vec3};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use std::borrow::Cow;
use top_level::Placing;

/// Marks the code of a leaf.
pub const LEAF: u32 = 1 << 31;
/// Bits of a leaf's code that hold its first primitive or its instance; three bits above them hold the count less 1.
pub const FIRST_BITS: u32 = 26;
/// No scene needs a traversal stack of more entries than this, see `build.rs`.
pub const MAX_STACK_SIZE: usize = 96;
/// Distances to the far side of a box are scaled by this: 2 gamma(3) of Ize, Robust BVH Ray Traversal, JCGT 2013.
pub const TFAR_SCALE: f32 = 1.000_000_4;
/// A direction component closer to 0 than this becomes this, with its sign, before it is inverted in the box test.
pub const MIN_DIRECTION: f32 = 1e-20;
/// Largest coordinate relative to the scene's middle, in world and in object space: over 3.4e18, its product with
/// 1 / [`MIN_DIRECTION`] is infinite and every box would be missed.
pub const MAX_COORDINATE: f64 = 1e10;

const MAX_LEAF_SIZE: u32 = 4;
/// Both corners of the box of an empty child: a point that no ray reaches. (The box test does not tell lo from hi, so
/// that an inverted box would be hit by every ray.)
const EMPTY: [f32; 3] = [1e30; 3];

/// An inner node: the boxes and codes of both children.
///
/// A code is the index of a node, or for a leaf [`LEAF`] | (count - 1) << [`FIRST_BITS`] | first, where first is a
/// primitive in a bottom level and an instance in the top level. The root over a single leaf repeats the leaf's code
/// under a box that no ray reaches.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[expect(missing_docs, reason = "lo and hi are the corners of a child's box")]
pub struct Node {
    pub lo0: [f32; 3],
    pub child0: u32,
    pub hi0: [f32; 3],
    pub child1: u32,
    pub lo1: [f32; 3],
    pub _pad0: u32,
    pub hi1: [f32; 3],
    pub _pad1: u32,
}

/// A triangle's corners, w = 0: in object space, or in world space where [`Bvh::baked_transform`] is `Some`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Triangle {
    /// Counter-clockwise seen from the front.
    pub corners: [[f32; 4]; 3],
}

/// What the device knows of an instance.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct InstanceRecord {
    /// Rows; the world is relative to [`Bvh::centre`].
    pub object_to_world: [[f32; 4]; 3],
    /// Rows of the inverse, which was taken in f64.
    pub world_to_object: [[f32; 4]; 3],
    /// Root node of the mesh.
    pub root: u32,
    /// First primitive of the mesh.
    pub first_primitive: u32,
    /// [`InstanceRecord::MIRRORED`], [`InstanceRecord::ABSENT`], [`InstanceRecord::MOVABLE`].
    pub flags: u32,
    /// Unused.
    pub _pad: u32,
    /// Scale and offset from light-map coordinates to texels.
    pub atlas: [f32; 4],
}

impl InstanceRecord {
    /// The transform's determinant is negative.
    pub const MIRRORED: u32 = 1;
    /// Rays pass it by, and none start from it.
    pub const ABSENT: u32 = 2;
    /// It may move: its texels are not judged by where it is.
    pub const MOVABLE: u32 = 4;
}

/// Where a mesh lies; all 0 for one that no instance places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeshRange {
    /// Root node.
    pub root: u32,
    /// First primitive.
    pub first_primitive: u32,
    /// Number of primitives.
    pub count: u32,
}

/// What will be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// Nothing, whatever may be declared movable.
    None,
    /// What is declared movable.
    OfMovables,
    /// Nothing, and there is a top level even over a single instance.
    NoneUnderTop,
}

/// The hierarchy of a scene, as it goes to the device.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// Nodes of all levels, depth first; the top level's come last.
    pub nodes: Vec<Node>,
    /// `[primitive]`.
    pub triangles: Vec<Triangle>,
    /// `[mesh][slot]`: position in the mesh of the triangle that is primitive `first_primitive + slot`.
    pub order: Vec<Vec<u32>>,
    /// `[instance]`, in the scene's order.
    pub instances: Vec<InstanceRecord>,
    /// `[mesh]`, in the scene's order.
    pub meshes: Vec<MeshRange>,
    /// Root of the top level; `None`: rays start in node 0, the root of the only bottom level, as instance 0.
    pub top_root: Option<u32>,
    /// Entries of the traversal's stack in the worst case, both levels together; at least 1, at most
    /// [`MAX_STACK_SIZE`].
    pub stack_size: u32,
    /// The point of the scene's world that is the origin here.
    pub centre: DVec3,
    /// `Some`: the scene's only instance was transformed to world space by this (relative to `centre`), its record
    /// holds the identity, and normals and the like are the caller's to transform. See also [`Bvh::corners`].
    pub baked_transform: Option<DAffine3>,
    /// `[mesh]`; `None` for one without triangles or instances.
    levels: Vec<Option<BottomLevel>>,
    /// `[instance]`.
    mesh_of: Vec<usize>,
    bottom_nodes: usize,
    placing: Placing,
}

/// What the top level has to know of a bottom level.
#[derive(Debug, Clone, Copy)]
struct BottomLevel {
    bounds: Bounds,
    stack_size: u32,
    /// Largest coordinate that its boxes are padded for.
    reach: f64,
}

/// Boxes of a scene in which something moves are padded for a world this much larger, so that there is room to move. The
/// padding is then 2e-6 of the scene's extent.
const MOVING_REACH: f64 = 8.0;

impl Bvh {
    /// Builds the hierarchy. Meshes that no instance places are left out.
    ///
    /// # Errors
    /// `OutOfMemory` over 2^26 triangles or instances; `InvalidScene` where something is farther than
    /// [`MAX_COORDINATE`] from the scene's middle.
    pub fn build(scene: &Scene, atlas: &Atlas) -> Result<Self> {
        Self::build_for(scene, atlas, Motion::None)
    }

    /// The same, with what `motion` says.
    pub(crate) fn build_for(scene: &Scene, atlas: &Atlas, motion: Motion) -> Result<Self> {
        let centre = scene.centre();
        let mut transforms: Vec<DAffine3> = scene.instances().iter().map(|i| scene.centred(i, centre)).collect();
        let may_move = |instance: &Instance| motion == Motion::OfMovables && instance.mobility == Mobility::Movable;
        let moves = scene.instances().iter().any(may_move);
        let baked_transform = match transforms.as_mut_slice() {
            [only] if !moves && motion != Motion::NoneUnderTop => Some(std::mem::replace(only, DAffine3::IDENTITY)),
            _ => None,
        };
        let mesh_of: Vec<usize> = scene.instances().iter().map(|instance| instance.mesh).collect();
        let sources = sources(scene, &mesh_of, baked_transform.as_ref())?;
        let mut bvh = Self {
            nodes: Vec::new(),
            triangles: Vec::new(),
            order: vec![Vec::new(); sources.len()],
            instances: records(scene.instances(), atlas, may_move),
            meshes: vec![MeshRange::default(); sources.len()],
            top_root: None,
            stack_size: 1,
            centre,
            baked_transform,
            levels: sources.iter().map(|source| source.as_ref().map(Source::level)).collect(),
            mesh_of,
            bottom_nodes: 0,
            placing: Placing::new(transforms),
        };
        let room = if moves { MOVING_REACH } else { 1.0 };
        let reaches: Vec<f64> = bvh.reaches()?.into_iter().map(|reach| reach * room).collect();
        for (mesh, (source, reach)) in sources.iter().zip(reaches).enumerate() {
            if let Some(source) = source {
                bvh.append_mesh(mesh, source, reach);
            }
        }
        bvh.bottom_nodes = bvh.nodes.len();
        bvh.build_top_level();
        Ok(bvh)
    }

    /// Position of an instance's mesh in the scene's list.
    pub(crate) fn mesh_of(&self, instance: usize) -> usize {
        self.mesh_of[instance]
    }

    /// The node that rays start at.
    pub fn root(&self) -> u32 {
        self.top_root.unwrap_or(0)
    }

    /// Which corner of the mesh's triangle each corner of its [`Triangle`] is. A mirrored instance that was transformed
    /// to world space has two corners swapped, so that its front stays its front.
    pub fn corners(&self) -> [usize; 3] {
        match self.baked_transform {
            Some(transform) if transform.matrix3.determinant() < 0.0 => [0, 2, 1],
            _ => [0, 1, 2],
        }
    }

    fn append_mesh(&mut self, mesh: usize, source: &Source, reach: f64) {
        let first_primitive = self.triangles.len() as u32;
        let order = &mut self.order[mesh];
        let mut stack_size = 1;
        let root = encode::flatten(&source.tree, encode::box_pad(reach), &mut self.nodes, |primitives, depth| {
            stack_size = stack_size.max(depth);
            let first = first_primitive + order.len() as u32;
            order.extend_from_slice(primitives);
            encode::leaf_code(first, primitives.len() as u32)
        });
        let triangle =
            |index: &u32| Triangle { corners: source.triangles[*index as usize].map(|c| c.extend(0.0).into()) };
        self.triangles.extend(order.iter().map(triangle));
        self.meshes[mesh] = MeshRange { root, first_primitive, count: order.len() as u32 };
        self.levels[mesh] = Some(BottomLevel { stack_size, reach, ..source.level() });
    }
}

/// A mesh on its way into the hierarchy.
struct Source<'a> {
    triangles: Cow<'a, [[Vec3; 3]]>,
    tree: Bvh2,
}

impl<'a> Source<'a> {
    fn new(mesh: &'a Mesh, baked: Option<&DAffine3>) -> Self {
        let triangles = match baked {
            Some(transform) => mesh.positions().iter().map(|corners| bake(*corners, transform)).collect(),
            None => Cow::Borrowed(mesh.positions()),
        };
        let boxes: Vec<Aabb> = triangles.iter().map(|c| Aabb::from_points(&c.map(Vec3::to_vec3a))).collect();
        Self { tree: build::tree(&boxes, MAX_LEAF_SIZE), triangles }
    }

    fn level(&self) -> BottomLevel {
        BottomLevel { bounds: Bounds::of(self.tree.nodes[0].aabb()), stack_size: 1, reach: 0.0 }
    }
}

fn bake(corners: [Vec3; 3], transform: &DAffine3) -> [Vec3; 3] {
    let [a, b, c] = corners.map(|corner| transform.transform_point3(corner.as_dvec3()).as_vec3());
    if transform.matrix3.determinant() < 0.0 { [a, c, b] } else { [a, b, c] }
}

/// `[mesh]`: `None` for one without triangles or instances.
fn sources<'a>(scene: &'a Scene, mesh_of: &[usize], baked: Option<&DAffine3>) -> Result<Vec<Option<Source<'a>>>> {
    let mut placed = vec![false; scene.meshes().len()];
    mesh_of.iter().for_each(|mesh| placed[*mesh] = true);
    let is_used = |(mesh, placed): (&'a Mesh, bool)| (placed && !mesh.is_empty()).then_some(mesh);
    let used: Vec<Option<&Mesh>> = scene.meshes().iter().zip(placed).map(is_used).collect();
    check_count("triangles", used.iter().flatten().map(|mesh| mesh.len()).sum())?;
    check_count("instances", mesh_of.len())?;
    for mesh in used.iter().flatten() {
        check_positions(mesh, baked)?;
    }
    Ok(used.into_iter().map(|mesh| mesh.map(|mesh| Source::new(mesh, baked))).collect())
}

/// The limit of a leaf's code. Fewer than 2^31 nodes follow from it: there are fewer than triangles, meshes and
/// instances.
fn check_count(what: &str, count: usize) -> Result<()> {
    if count <= 1 << FIRST_BITS {
        return Ok(());
    }
    let limit = 1u32 << FIRST_BITS;
    Err(Error::new(
        ErrorKind::OutOfMemory,
        format!("the scene has {count} {what}; the hierarchy holds at most {limit}"),
    ))
}

/// Before the builder, whose surface areas must be finite.
fn check_positions(mesh: &Mesh, baked: Option<&DAffine3>) -> Result<()> {
    let transform = baked.copied().unwrap_or(DAffine3::IDENTITY);
    let reach = |c: &Vec3| transform.transform_point3(c.as_dvec3()).abs().max_element();
    let largest = mesh.positions().iter().flatten().map(reach).fold(0.0, f64::max);
    encode::check_reach(|| format!("mesh '{}'", mesh.name()), largest)
}

fn records(instances: &[Instance], atlas: &Atlas, may_move: impl Fn(&Instance) -> bool) -> Vec<InstanceRecord> {
    let record = |(index, instance): (usize, &Instance)| {
        let rect = |rect: &AtlasRect| [rect.scale.x, rect.scale.y, rect.offset.x, rect.offset.y];
        let flags = if may_move(instance) { InstanceRecord::MOVABLE } else { 0 };
        InstanceRecord { atlas: atlas.rects.get(index).map_or([0.0; 4], rect), flags, ..InstanceRecord::zeroed() }
    };
    instances.iter().enumerate().map(record).collect()
}

#[cfg(test)]
mod tests;
