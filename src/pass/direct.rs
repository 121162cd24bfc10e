//! Irradiance from analytic lights, with shadow rays. Reads the surface and footprint maps, the lights and the hierarchy;
//! writes the direct map. One invocation a texel of the list.

use super::{Context, TexelList, groups_of};
use crate::error::Result;
use crate::gpu::layout::{Push, binding};
use crate::gpu::{BindingSet, ComputePipeline, DIRECT, Recorder, Resource};
use std::ops::Range;

pub(crate) struct Direct {
    pipeline: ComputePipeline,
    set: BindingSet,
}

impl Direct {
    pub(crate) fn new(context: Context<'_>, texels: &TexelList) -> Result<Self> {
        let mut resources = context.scene.tracing_resources();
        resources.extend([
            (binding::TEXELS, Resource::Storage(&texels.buffer)),
            (binding::LIGHTS, Resource::Storage(&context.scene.lights)),
            (binding::SURFACE, Resource::StorageImage(&context.maps.surface)),
            (binding::FOOTPRINT, Resource::StorageImage(&context.maps.footprint)),
            (binding::DIRECT, Resource::StorageImage(&context.maps.direct)),
        ]);
        let pipeline = ComputePipeline::new(context.gpu, &DIRECT, context.constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        Ok(Self { pipeline, set })
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, texels: Range<u32>) {
        let push = Push { first_texel: texels.start, texel_count: texels.end - texels.start, ..*push };
        recorder.dispatch(&self.pipeline, &self.set, &push, groups_of(&push), c"direct");
    }
}
