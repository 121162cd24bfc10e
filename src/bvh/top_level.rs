//! The top level, over instances: built well once, and quickly again whenever an instance has moved.

use super::encode::{self, Bounds};
use super::{BottomLevel, Bvh, InstanceRecord, Node, build};
use crate::error::{Error, ErrorKind, Result};
use glam::DAffine3;
use obvhs::aabb::Aabb;
use std::ops::Range;

/// A bottom level's own reach may be exceeded this much before the padding of its boxes no longer holds, see `encode.rs`.
const REACH_SLACK: f64 = 2.0;

/// Where the instances are, and memory to build the top level in: once it has grown, a build allocates nothing.
#[derive(Debug, Clone, Default)]
pub(super) struct Placing {
    /// `[instance]`, relative to the hierarchy's centre.
    transforms: Vec<DAffine3>,
    /// `[instance]`: whether rays can meet it.
    present: Vec<bool>,
    /// Holds every box that any instance has had since it was last checked that all meshes can be seen from all of it.
    world: Option<Bounds>,
    leaves: Vec<Leaf>,
    work: Vec<Branch>,
}

/// An instance in the top level.
#[derive(Debug, Clone, Copy)]
struct Leaf {
    instance: u32,
    /// Entries of the stack that its bottom level takes.
    below: u32,
    aabb: Aabb,
}

/// Leaves that are still to be parted.
#[derive(Debug, Clone)]
struct Branch {
    leaves: Range<usize>,
    parent: u32,
    side: usize,
    /// Inner nodes above.
    depth: u32,
}

impl Placing {
    pub(super) fn new(transforms: Vec<DAffine3>) -> Self {
        Self { present: vec![true; transforms.len()], transforms, ..Self::default() }
    }
}

impl Bvh {
    /// Moves an instance: `transform` is object to world, as in the scene. Its record changes at once, the top level with
    /// [`Bvh::rebuild_top_level`]. `false`: it was there already.
    ///
    /// # Errors
    /// Nothing is changed. `InvalidSettings`: a transform that is singular or not finite. `Unsupported`: the scene has no
    /// top level; or the object moved so far away or became so small beside the scene that its boxes are no longer wide
    /// enough for rounding, and the scene is to be built anew.
    pub(crate) fn place(&mut self, instance: usize, transform: &DAffine3) -> Result<bool> {
        if self.top_root.is_none() {
            return Err(Error::new(ErrorKind::Unsupported, "a scene without a top level cannot be moved in part"));
        }
        let inverse = transform.inverse();
        if !(transform.is_finite() && transform.matrix3.determinant() != 0.0 && inverse.is_finite()) {
            return Err(Error::settings(format!("the transform of instance {instance} is singular or not finite")));
        }
        let transform = DAffine3 { translation: transform.translation - self.centre, ..*transform };
        let previous = std::mem::replace(&mut self.placing.transforms[instance], transform);
        if previous == transform {
            return Ok(false);
        }
        if let Err(error) = self.check_placing(instance) {
            self.placing.transforms[instance] = previous;
            return Err(error);
        }
        self.instances[instance].place(&transform, &transform.inverse());
        Ok(true)
    }

    /// The largest coordinate that anything has had so far.
    pub(crate) fn world_reach(&self) -> f64 {
        self.placing.world.map_or(0.0, Bounds::reach)
    }

    /// Lets rays meet an instance or pass it by, from the next [`Bvh::rebuild_top_level`] on.
    pub(crate) fn set_present(&mut self, instance: usize, present: bool) {
        self.placing.present[instance] = present;
        let flags = &mut self.instances[instance].flags;
        *flags = if present { *flags & !InstanceRecord::ABSENT } else { *flags | InstanceRecord::ABSENT };
    }

    /// Builds the top level anew over the instances that are present: a balanced tree, in memory that is there already.
    /// The nodes of the top level lie behind all others; their number is never larger than that of the instances.
    pub(crate) fn rebuild_top_level(&mut self) {
        self.nodes.truncate(self.bottom_nodes);
        self.gather_leaves();
        self.top_root = Some(self.bottom_nodes as u32);
        self.nodes.push(Node::EMPTY);
        let pad = encode::box_pad(self.world_reach());
        let Placing { leaves, work, .. } = &mut self.placing;
        self.stack_size = 1;
        work.clear();
        match leaves.len() {
            0 => {}
            1 => work.push(Branch { leaves: 0..1, parent: self.bottom_nodes as u32, side: 0, depth: 1 }),
            count => part(0..count, leaves, self.bottom_nodes as u32, 1, work),
        }
        while let Some(Branch { leaves: range, parent, side, depth }) = work.pop() {
            let bounds = leaves[range.clone()].iter().fold(Aabb::empty(), |sum, leaf| sum.union(&leaf.aabb));
            let code = if range.len() == 1 {
                let leaf = leaves[range.start];
                self.stack_size = self.stack_size.max(depth + leaf.below);
                encode::leaf_code(leaf.instance, 1)
            } else {
                let code = self.nodes.len() as u32;
                self.nodes.push(Node::EMPTY);
                part(range, leaves, code, depth + 1, work);
                code
            };
            let (lo, hi) = (bounds.min - pad, bounds.max + pad);
            self.nodes[parent as usize].set_child(side, lo.into(), hi.into(), code);
        }
        if let [only] = leaves.as_slice() {
            self.nodes[self.bottom_nodes].child1 = encode::leaf_code(only.instance, 1);
        }
    }

    /// Nodes that no top level changes.
    pub(crate) fn bottom_nodes(&self) -> usize {
        self.bottom_nodes
    }

    /// Nodes of all levels, whatever instances come and go.
    pub(crate) fn most_nodes(&self) -> usize {
        self.nodes.len().max(self.bottom_nodes + self.instances.len().max(1))
    }

    /// What `stack_size` is at most, whatever the instances do.
    pub(crate) fn most_stack_size(&self) -> u32 {
        if self.top_root.is_none() {
            return self.stack_size;
        }
        let below = self.levels.iter().flatten().map(|level| level.stack_size).max().unwrap_or(0);
        let depth = self.instances.len().max(2).next_power_of_two().ilog2();
        self.stack_size.max(depth + below)
    }

    /// The largest coordinate in each mesh's space: its own bounds, and all that a ray can start from.
    pub(super) fn reaches(&mut self) -> Result<Vec<f64>> {
        let mut reaches: Vec<f64> = self.levels.iter().map(|level| level.map_or(0.0, |l| l.bounds.reach())).collect();
        let boxes = (0..self.instances.len()).filter_map(|instance| self.placed_box(instance));
        let Some(world) = boxes.reduce(Bounds::union) else { return Ok(reaches) };
        encode::check_reach(|| "the scene".into(), world.reach())?;
        for (index, (mesh, transform)) in self.mesh_of.iter().zip(&self.placing.transforms).enumerate() {
            let reach = world.transformed(&transform.inverse()).reach();
            encode::check_reach(|| format!("the scene, seen from instance {index},"), reach)?;
            reaches[*mesh] = reaches[*mesh].max(reach);
        }
        self.placing.world = Some(world);
        Ok(reaches)
    }

    /// Writes instance records and the first top level.
    pub(super) fn build_top_level(&mut self) {
        for ((record, mesh), transform) in self.instances.iter_mut().zip(&self.mesh_of).zip(&self.placing.transforms) {
            record.place(transform, &transform.inverse());
            record.root = self.meshes[*mesh].root;
            record.first_primitive = self.meshes[*mesh].first_primitive;
        }
        self.gather_leaves();
        let leaves = &self.placing.leaves;
        if let (Some(_), [only]) = (self.baked_transform, leaves.as_slice()) {
            self.stack_size = only.below;
            return;
        }
        if leaves.is_empty() {
            self.nodes.push(Node::EMPTY);
            self.top_root = Some(self.bottom_nodes as u32);
            return;
        }
        let boxes: Vec<Aabb> = leaves.iter().map(|leaf| leaf.aabb).collect();
        let pad = encode::box_pad(self.world_reach());
        let mut deepest = 1;
        let root = encode::flatten(&build::tree(&boxes, 1), pad, &mut self.nodes, |primitives, depth| {
            let leaf = leaves[primitives[0] as usize];
            deepest = deepest.max(depth + leaf.below);
            encode::leaf_code(leaf.instance, 1)
        });
        self.stack_size = deepest;
        self.top_root = Some(root);
    }

    fn level(&self, instance: usize) -> Option<BottomLevel> {
        self.levels[self.mesh_of[instance]]
    }

    fn placed_box(&self, instance: usize) -> Option<Bounds> {
        Some(self.level(instance)?.bounds.transformed(&self.placing.transforms[instance]))
    }

    /// Whether the boxes of all meshes are wide enough for where an instance now is.
    fn check_placing(&mut self, moved: usize) -> Result<()> {
        let Some(bounds) = self.placed_box(moved) else { return Ok(()) };
        let known = self.placing.world.unwrap_or(bounds);
        if known.holds(bounds) && self.check_reach(moved, moved, known).is_ok() {
            return Ok(());
        }
        // What came home again no longer counts.
        let boxes = (0..self.instances.len()).filter_map(|instance| self.placed_box(instance));
        let world = boxes.reduce(Bounds::union).unwrap_or(bounds);
        encode::check_reach(|| format!("instance {moved}"), world.reach())?;
        (0..self.instances.len()).try_for_each(|instance| self.check_reach(moved, instance, world))?;
        self.placing.world = Some(world);
        Ok(())
    }

    /// Whether the boxes of an instance's mesh are wide enough for rays from anywhere in the world.
    fn check_reach(&self, moved: usize, instance: usize, world: Bounds) -> Result<()> {
        let Some(level) = self.level(instance) else { return Ok(()) };
        let reach = world.transformed(&self.placing.transforms[instance].inverse()).reach();
        if reach <= level.reach * REACH_SLACK {
            return Ok(());
        }
        let what = format!(
            "instance {moved} moved too far away, or became too small: seen from instance {instance} the scene reaches the \
             coordinate {reach:e}, allowed is {:e}; build the scene anew",
            level.reach * REACH_SLACK
        );
        Err(Error::new(ErrorKind::Unsupported, what))
    }

    fn gather_leaves(&mut self) {
        let reach = self.world_reach();
        let mut leaves = std::mem::take(&mut self.placing.leaves);
        leaves.clear();
        for (instance, transform) in self.placing.transforms.iter().enumerate() {
            if let Some(level) = self.level(instance).filter(|_| self.placing.present[instance]) {
                let aabb = encode::instance_box(level.bounds, transform, &transform.inverse(), reach);
                leaves.push(Leaf { instance: instance as u32, below: level.stack_size, aabb });
            }
        }
        self.placing.leaves = leaves;
    }
}

/// Parts leaves at the median of the axis along which their middles lie widest apart: the depth is the logarithm of their
/// number, so that the traversal's stack has a bound before anything moves.
fn part(range: Range<usize>, leaves: &mut [Leaf], parent: u32, depth: u32, work: &mut Vec<Branch>) {
    let slots = &mut leaves[range.clone()];
    let spread = slots.iter().fold(Aabb::empty(), |mut sum, leaf| *sum.extend(leaf.aabb.center())).diagonal();
    let axis = spread.max_position();
    // Of equal middles the instance decides, so that the same scene gives the same tree.
    let key = |leaf: &Leaf| (leaf.aabb.center()[axis], leaf.instance);
    let order = |a: &Leaf, b: &Leaf| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1));
    slots.select_nth_unstable_by(slots.len() / 2, order);
    let middle = range.start + range.len() / 2;
    work.push(Branch { leaves: middle..range.end, parent, side: 1, depth });
    work.push(Branch { leaves: range.start..middle, parent, side: 0, depth });
}
