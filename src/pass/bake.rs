//! Gathers light with rays. Reads the surface, footprint and source maps, what rays are aimed by, the sky and the hierarchy; merges into the mean
//! of the even or of the odd quanta, or in a dynamic scene into the running average. One invocation a texel of the list, a quantum of rays each.

use super::{Context, TexelList, groups_of};
use crate::error::Result;
use crate::gpu::layout::{Push, binding};
use crate::gpu::{BAKE, BindingSet, ComputePipeline, Image, Recorder, Resource};
use std::ops::Range;

pub(crate) struct Bake {
    pipeline: ComputePipeline,
    /// `[source map]`
    sets: Vec<BindingSet>,
}

impl Bake {
    pub(crate) fn new(context: Context<'_>, texels: &TexelList) -> Result<Self> {
        let resources = |source| resources(context, texels, source);
        let maps = context.maps;
        let pipeline = ComputePipeline::new(context.gpu, &BAKE, context.constants, &resources(&maps.source[0]))?;
        let sets = maps.source.iter().map(|source| pipeline.bind(&resources(source))).collect::<Result<Vec<_>>>()?;
        Ok(Self { pipeline, sets })
    }

    /// `push` says how many rays a quantum has and how many of them are aimed; `source` which map is read.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        push: &Push,
        source: usize,
        texels: Range<u32>,
        quanta: Range<u32>,
    ) {
        let push = Push {
            first_texel: texels.start,
            texel_count: texels.end - texels.start,
            first_quantum: quanta.start,
            quantum_count: quanta.end - quanta.start,
            ..*push
        };
        recorder.dispatch(&self.pipeline, &self.sets[source], &push, groups_of(&push), c"bake");
    }
}

/// What a shader sees that aims rays and reads the light map.
pub(super) fn resources<'a>(
    context: Context<'a>,
    texels: &'a TexelList,
    source: &'a Image,
) -> Vec<(u32, Resource<'a>)> {
    let maps = context.maps;
    let mut resources = context.scene.tracing_resources();
    resources.extend([
        (binding::TEXELS, Resource::Storage(&texels.buffer)),
        context.scene.sky(),
        (binding::SURFACE, Resource::StorageImage(&maps.surface)),
        (binding::FOOTPRINT, Resource::StorageImage(&maps.footprint)),
        (binding::EMISSION, Resource::StorageImage(&maps.emission)),
        (binding::SOURCE_MAP, Resource::Sampled(source)),
        (binding::MEAN_EVEN, Resource::StorageImage(&maps.mean_even)),
        (binding::MEAN_ODD, Resource::StorageImage(&maps.mean_odd)),
        (binding::IMPORTANCE, Resource::Sampled(&maps.importance)),
        (binding::SKY_IMPORTANCE, Resource::Sampled(&maps.sky_importance)),
        (binding::AIMED_LUMINANCE, Resource::StorageImage(&maps.aimed_luminance)),
        (binding::EVIDENCE, Resource::StorageImage(&maps.evidence)),
        (binding::PIECES_MAP, Resource::StorageImage(&maps.pieces)),
        (binding::PIECES, Resource::Storage(&context.scene.pieces)),
        (binding::SKY_EVIDENCE, Resource::StorageImage(&maps.sky_evidence)),
        (binding::CLUSTERS, Resource::Storage(&maps.sources.clusters)),
        (binding::CLUSTER_TEXELS, Resource::Storage(&maps.sources.texels)),
        (binding::CLUSTER_SUMS, Resource::Storage(&maps.sources.sums)),
        (binding::SEATS, Resource::StorageImage(&maps.sources.seats)),
        (binding::WEIGHTS, Resource::Storage(&maps.sources.weights)),
        (binding::SIGHTINGS, Resource::Storage(&maps.sources.sightings)),
        (binding::LINKS, Resource::Storage(&maps.links.buffer)),
        (binding::ACTIVITY, Resource::Storage(&maps.activity)),
    ]);
    resources
}
