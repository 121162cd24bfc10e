//! The light map of a dynamic scene, gutters filled. Reads the running average, the direct map and the nearest texels;
//! writes one of the light maps. One invocation a texel of the whole map, in slices of rows.

use super::Context;
use crate::error::Result;
use crate::gpu::layout::{Push, SQUARE_GROUP, binding};
use crate::gpu::{BindingSet, ComputePipeline, Image, PUBLISH, Recorder, Resource};
use std::ops::Range;

pub(crate) struct Publish {
    pipeline: ComputePipeline,
    /// `[light map]`
    sets: Vec<BindingSet>,
    _nearest: Image,
}

impl Publish {
    /// `nearest`: for every texel the one whose light it shows.
    pub(crate) fn new(context: Context<'_>, nearest: Image) -> Result<Self> {
        let maps = context.maps;
        let resources = |light_map| {
            [
                (binding::SURFACE, Resource::StorageImage(&maps.surface)),
                (binding::MEAN_EVEN, Resource::StorageImage(&maps.mean_even)),
                (binding::MEAN_ODD, Resource::StorageImage(&maps.mean_odd)),
                (binding::DIRECT, Resource::StorageImage(&maps.direct)),
                (binding::LIGHT_MAP, Resource::StorageImage(light_map)),
                (binding::NEAREST_BEFORE, Resource::StorageImage(&nearest)),
            ]
        };
        let first = resources(&maps.light_map[0]);
        let pipeline = ComputePipeline::new(context.gpu, &PUBLISH, context.constants, &first)?;
        let sets = maps.light_map.iter().map(|map| pipeline.bind(&resources(map))).collect::<Result<Vec<_>>>()?;
        Ok(Self { pipeline, sets, _nearest: nearest })
    }

    /// `rows`: its start is a multiple of the work group's side.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, light_map: usize, rows: Range<u32>) {
        let groups = [push.map_size[0].div_ceil(SQUARE_GROUP).max(1), (rows.end - rows.start).div_ceil(SQUARE_GROUP)];
        let push = Push { first_texel: rows.start, ..*push };
        recorder.dispatch(&self.pipeline, &self.sets[light_map], &push, groups, c"publish");
    }
}
