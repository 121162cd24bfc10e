//! What rays are aimed by, made as a whole or in parts: the leaves, and above them the clusters with their weights, or the
//! mip-map of sums.

use super::{Clusters, Context, Importance};
use crate::error::Result;
use crate::features::Features;
use crate::gpu::Recorder;
use crate::gpu::layout::Push;
use crate::pass::importance::ImportanceSums;
use std::ops::Range;

pub(crate) struct Aim {
    leaves: Importance,
    clusters: Option<Clusters>,
}

impl Aim {
    /// Nothing, where no rays are aimed.
    pub(crate) fn new(context: Context<'_>) -> Result<Option<Self>> {
        let features = Features::from_bits_retain(context.constants.features);
        if !features.contains(Features::IMPORTANCE) {
            return Ok(None);
        }
        let clusters = features.contains(Features::CLUSTERS).then(|| Clusters::new(context)).transpose()?;
        Ok(Some(Self { leaves: Importance::new(context)?, clusters }))
    }

    /// Bytes of what a map of this size is summed up in for the host.
    pub(crate) fn sums_bytes(size: [u32; 2]) -> u64 {
        Importance::sums_bytes(size)
    }

    /// On nothing: drivers that compile at the first use do so here. `push`: of a map of no texels.
    pub(crate) fn record_first_use(&self, recorder: &mut Recorder<'_>, push: &Push) {
        self.leaves.record_leaves(recorder, push, 0, 0..1, true);
        if let Some(clusters) = &self.clusters {
            clusters.record(recorder, push, 0..1);
            clusters.record_weights(recorder, push, 0..0);
        }
    }

    /// Parts that [`Aim::record`] may be cut into: rows of leaves, then as many parts of the clusters, which hold the same
    /// texels, and as many of the groups.
    pub(crate) fn parts(&self) -> u32 {
        let rows = self.leaves.rows();
        if self.clusters.is_some() { 3 * rows } else { rows }
    }

    /// Records some parts, in order; with the last one also what is made of all. `source`: which map is read; `sums`:
    /// whether the leaves are summed up for the host, which else may be reading.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        push: &Push,
        source: usize,
        parts: Range<u32>,
        sums: bool,
    ) {
        let rows = self.leaves.rows();
        // What the range has of the third that begins at `first`, where `count` things lie in a third.
        let within = |first: u32, count: u32| {
            let place =
                |part: u32| u64::from(part.clamp(first, first + rows) - first) * u64::from(count) / u64::from(rows);
            place(parts.start) as u32..place(parts.end) as u32
        };
        let of_leaves = within(0, rows);
        if !of_leaves.is_empty() {
            self.leaves.record_leaves(recorder, push, source, of_leaves, sums);
        }
        let Some(clusters) = &self.clusters else {
            if parts.end == rows {
                self.leaves.record_levels(recorder, push);
            }
            return;
        };
        let of_clusters = within(rows, clusters.count());
        if !of_clusters.is_empty() {
            clusters.record(recorder, push, of_clusters);
        }
        let of_groups = within(2 * rows, clusters.groups());
        if !of_groups.is_empty() {
            clusters.record_weights(recorder, push, of_groups);
        }
    }

    /// Records the sky's pyramid, where there is a map.
    pub(crate) fn record_sky(&self, recorder: &mut Recorder<'_>, push: &Push) {
        self.leaves.record_sky(recorder, push);
    }

    /// What the leaves summed up, after they have run. `texels`: that take rays.
    pub(crate) fn read_sums(&self, texels: u32) -> ImportanceSums {
        self.leaves.read_sums(texels)
    }

    /// One in so many texels tells what it sees.
    pub(crate) fn tells_every(&self) -> u32 {
        self.clusters.as_ref().map_or(1, Clusters::tells_every)
    }
}
