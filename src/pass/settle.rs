//! Settles where in each texel rays may start. Reads the surface map and the hierarchy; writes the footprint map.
//! One invocation a texel of the whole map, in slices of rows.

use super::Context;
use crate::error::Result;
use crate::gpu::layout::{Push, SQUARE_GROUP, binding};
use crate::gpu::{BindingSet, ComputePipeline, Recorder, Resource, SETTLE};
use std::ops::Range;

pub(crate) struct Settle {
    pipeline: ComputePipeline,
    set: BindingSet,
}

impl Settle {
    pub(crate) fn new(context: Context<'_>) -> Result<Self> {
        let mut resources = context.scene.tracing_resources();
        resources.extend([
            (binding::SURFACE, Resource::StorageImage(&context.maps.surface)),
            (binding::FOOTPRINT, Resource::StorageImage(&context.maps.footprint)),
        ]);
        let pipeline = ComputePipeline::new(context.gpu, &SETTLE, context.constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        Ok(Self { pipeline, set })
    }

    /// `rows`: its start is a multiple of the work group's side.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, rows: Range<u32>) {
        let groups = [push.map_size[0].div_ceil(SQUARE_GROUP), (rows.end - rows.start).div_ceil(SQUARE_GROUP)];
        // Which texels are given up depends on geometry alone, not on the seed.
        let push = Push { first_texel: rows.start, seed: [0, 0], ..*push };
        recorder.dispatch(&self.pipeline, &self.set, &push, groups, c"settle");
    }
}
