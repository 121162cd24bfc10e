//! Which primitives belong together: a binary tree over boxes, by obvhs.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::{Bvh2, leaf_collapser};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// PLOC merges one pair a pass where all boxes are the same: a chain as deep as there are boxes, in quadratic time. A
/// box that occurs more often than this makes the tree a balanced one.
const MAX_REPEATS: usize = 32;

/// Trees deeper than this (inner nodes on a path) are built anew, balanced. A level of 41 k triangles reaches 38. A
/// balanced tree over 2^26 primitives has 26, so that no scene needs more than [`super::MAX_STACK_SIZE`].
const MAX_DEPTH: u32 = super::MAX_STACK_SIZE as u32 / 2;

/// Share of the nodes that reinsertion tries to place better: all, as in obvhs's slowest preset but for the pre-split,
/// which would put a triangle into several leaves, and twice. On two game levels of 8 k and 14 k triangles 1.0 brings 1 and
/// 6 % more rays a second than 0.2 and takes 19 and 27 ms for 8 and 13; 2.0 brings 3 to 4 % more and takes 28 and 34 ms.
const REINSERTION_RATIO: f32 = 2.0;

/// Nodes that are tried at most, for reinsertion, not PLOC, is what a large tree takes. A level subdivided into a million
/// triangles, where this is a quarter of the nodes: 2.1 s on two idle cores, and 1.6 times that for all of them; the expected
/// cost of a ray (surface area heuristic) is 16.5, with all of them 15.6.
const MOST_REINSERTED: f32 = 250_000.0;

/// Cost of a node in triangle tests when leaves are merged, as in obvhs's presets: the fewest nodes. From 0.5 to
/// 3 the rays a second are the same within the noise of 3 %, at 1.9 times to once the nodes.
const TRAVERSAL_COST: f32 = 3.0;

/// A tree over boxes, which must be finite, at most `leaf_size` of them in a leaf; no node without boxes.
pub(super) fn tree(boxes: &[Aabb], leaf_size: u32) -> Bvh2 {
    if most_repeated(boxes) > MAX_REPEATS {
        return balanced(boxes, leaf_size);
    }
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        indices,
        SortPrecision::U64,
        2,
    );
    let ratio = (MOST_REINSERTED / boxes.len().max(1) as f32).min(REINSERTION_RATIO);
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut tree, ratio, None);
    if leaf_size > 1 {
        leaf_collapser::collapse(&mut tree, leaf_size, TRAVERSAL_COST);
        optimizer.run(&mut tree, 2.0 * ratio, None);
    }
    if depth(&tree) > MAX_DEPTH { balanced(boxes, leaf_size) } else { tree }
}

/// How often the most frequent box occurs, judged by a hash of its bits: a collision only costs quality.
fn most_repeated(boxes: &[Aabb]) -> usize {
    let hash = |b: &Aabb| {
        let values = b.min.to_array().into_iter().chain(b.max.to_array());
        values.fold(0u64, |h, v| (h ^ u64::from(v.to_bits())).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29))
    };
    let mut hashes: Vec<u64> = boxes.iter().map(hash).collect();
    hashes.sort_unstable();
    hashes.chunk_by(|a, b| a == b).map(<[u64]>::len).max().unwrap_or(0)
}

/// A tree split at the median of the longest axis: less good, but its depth is the logarithm of the number of boxes.
fn balanced(boxes: &[Aabb], leaf_size: u32) -> Bvh2 {
    let mut primitives: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default(); usize::from(!boxes.is_empty())];
    let mut work = vec![(0, 0..boxes.len())];
    while let Some((node, range)) = work.pop() {
        let slots = &mut primitives[range.clone()];
        let bounds = slots.iter().fold(Aabb::empty(), |sum, p| sum.union(&boxes[*p as usize]));
        if slots.len() <= leaf_size as usize {
            if !slots.is_empty() {
                nodes[node] = Bvh2Node::new(bounds, slots.len() as u32, range.start as u32);
            }
            continue;
        }
        let centre = |p: u32| boxes[p as usize].center();
        let axis = centre_spread(slots.iter().map(|p| centre(*p))).max_position();
        slots.select_nth_unstable_by(slots.len() / 2, |a, b| centre(*a)[axis].total_cmp(&centre(*b)[axis]));
        let (first, middle) = (nodes.len(), range.start + range.len() / 2);
        nodes.resize(first + 2, Bvh2Node::default());
        nodes[node] = Bvh2Node::new(bounds, 0, first as u32);
        work.push((first, range.start..middle));
        work.push((first + 1, middle..range.end));
    }
    Bvh2 { nodes, primitive_indices: primitives, ..Bvh2::default() }
}

fn centre_spread(centres: impl Iterator<Item = Vec3A>) -> Vec3A {
    centres.fold(Aabb::empty(), |mut sum, c| *sum.extend(c)).diagonal()
}

/// Inner nodes on the longest path.
fn depth(tree: &Bvh2) -> u32 {
    let mut deepest = 0;
    let mut work = vec![(0, 0)];
    while let Some((index, above)) = work.pop() {
        deepest = deepest.max(above);
        match tree.nodes.get(index) {
            Some(node) if !node.is_leaf() => {
                let first = node.first_index as usize;
                work.extend([(first, above + 1), (first + 1, above + 1)]);
            }
            _ => {}
        }
    }
    deepest
}
