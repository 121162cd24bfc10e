//! Traces given rays. Reads rays and the hierarchy; writes answers. One invocation a ray.

use super::DeviceScene;
use crate::error::Result;
use crate::gpu::layout::{GROUP, Push, binding};
use crate::gpu::{BindingSet, Buffer, ComputePipeline, Constants, Gpu, Recorder, Resource, TRACE};

/// What is asked of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Query {
    /// What it hits first.
    Closest,
    /// Whether it hits anything.
    Occluded,
}

pub(crate) struct Trace {
    closest: ComputePipeline,
    occluded: ComputePipeline,
}

impl Trace {
    pub(crate) fn new(gpu: &Gpu, constants: Constants, scene: &DeviceScene) -> Result<Self> {
        // Only the kinds matter.
        let resources = resources(scene, &scene.primitives, &scene.primitives);
        let pipeline =
            |query| ComputePipeline::new(gpu, &TRACE, Constants { query: query as u32, ..constants }, &resources);
        Ok(Self { closest: pipeline(Query::Closest)?, occluded: pipeline(Query::Occluded)? })
    }

    /// For both queries.
    pub(crate) fn bind(&self, scene: &DeviceScene, rays: &Buffer, answers: &Buffer) -> Result<BindingSet> {
        self.closest.bind(&resources(scene, rays, answers))
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, query: Query, set: &BindingSet, push: &Push, count: u32) {
        let push = Push { texel_count: count, ..*push };
        let (pipeline, name) = match query {
            Query::Closest => (&self.closest, c"trace closest"),
            Query::Occluded => (&self.occluded, c"trace occluded"),
        };
        recorder.dispatch(pipeline, set, &push, [count.div_ceil(GROUP), 1], name);
    }
}

fn resources<'a>(scene: &'a DeviceScene, rays: &'a Buffer, answers: &'a Buffer) -> Vec<(u32, Resource<'a>)> {
    let mut resources = scene.tracing_resources();
    resources.extend([(binding::RAYS, Resource::Storage(rays)), (binding::ANSWERS, Resource::Storage(answers))]);
    resources
}
