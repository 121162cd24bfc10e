//! Writes the rays that a bake sends. Reads the surface and footprint maps; writes rays. One invocation a texel of every
//! n-th work group of the list.

use super::bake::resources;
use super::{Context, TexelList};
use crate::error::Result;
use crate::gpu::layout::{GROUP, Push, binding};
use crate::gpu::{BindingSet, Buffer, ComputePipeline, EMIT, Recorder, Resource};

pub(crate) struct Emit {
    pipeline: ComputePipeline,
    set: BindingSet,
}

/// A selection of the list's work groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Groups {
    pub(crate) first: u32,
    /// From one to the next.
    pub(crate) step: u32,
    pub(crate) count: u32,
}

impl Emit {
    /// `rays` has room for `push.rays` of every texel that a dispatch goes through, whole work groups of them.
    pub(crate) fn new(context: Context<'_>, texels: &TexelList, rays: &Buffer) -> Result<Self> {
        let mut resources = resources(context, texels, &context.maps.source[0]);
        resources.push((binding::RAYS, Resource::Storage(rays)));
        let pipeline = ComputePipeline::new(context.gpu, &EMIT, context.constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        Ok(Self { pipeline, set })
    }

    /// `push.first_sample` is the first ray's of each texel.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, texels: &TexelList, groups: Groups) {
        let first_texel = groups.first * GROUP;
        let (step_texels, texel_count) = (groups.step * GROUP, texels.count.saturating_sub(first_texel));
        let push = Push { first_texel, step_texels, texel_count, ..*push };
        recorder.dispatch(&self.pipeline, &self.set, &push, [groups.count, 1], c"emit");
    }
}
