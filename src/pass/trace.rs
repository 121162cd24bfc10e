//! Traces given rays. Reads rays and the hierarchy; writes answers. One invocation a ray.

use super::DeviceScene;
use crate::error::Result;
use crate::gpu::layout::{GROUP, Push, binding};
use crate::gpu::{BindingSet, Buffer, ComputePipeline, Constants, Gpu, Recorder, Resource, TRACE};

pub(crate) struct Trace {
    pipeline: ComputePipeline,
    set: BindingSet,
}

impl Trace {
    pub(crate) fn new(
        gpu: &Gpu,
        constants: Constants,
        scene: &DeviceScene,
        rays: &Buffer,
        answers: &Buffer,
    ) -> Result<Self> {
        let mut resources = scene.tracing_resources();
        resources.extend([(binding::RAYS, Resource::Storage(rays)), (binding::ANSWERS, Resource::Storage(answers))]);
        let pipeline = ComputePipeline::new(gpu, &TRACE, constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        Ok(Self { pipeline, set })
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, count: u32) {
        let push = Push { texel_count: count, ..*push };
        recorder.dispatch(&self.pipeline, &self.set, &push, [count.div_ceil(GROUP), 1], c"trace");
    }
}
