//! Outgoing radiance of every texel. Reads albedo, emission and irradiance; writes the source map, and sums over work
//! groups for the host. One invocation a texel of the list.

use super::{Context, TexelList, groups_of};
use crate::error::Result;
use crate::gpu::layout::{Push, binding};
use crate::gpu::{BindingSet, ComputePipeline, Recorder, Resource, SOURCE};
use std::ops::Range;

pub(crate) struct Source {
    pipeline: ComputePipeline,
    /// `[source map]`
    sets: Vec<BindingSet>,
}

/// What the pass tells of the whole map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SourceSums {
    /// Mean luminance over the surface.
    pub(crate) mean_radiance: f64,
    /// Surface, in square scene units; every texel counts whole.
    pub(crate) area: f64,
    /// Largest albedo of any channel.
    pub(crate) max_albedo: f64,
    /// Texels whose radiance was not finite, and counts as 0.
    pub(crate) invalid: u64,
}

impl Source {
    pub(crate) fn new(context: Context<'_>, texels: &TexelList) -> Result<Self> {
        let maps = context.maps;
        let resources = |source| {
            let mut resources = context.scene.surface_resources();
            resources.extend([
                (binding::TEXELS, Resource::Storage(&texels.buffer)),
                (binding::SURFACE, Resource::StorageImage(&maps.surface)),
                (binding::MEAN_EVEN, Resource::StorageImage(&maps.mean_even)),
                (binding::MEAN_ODD, Resource::StorageImage(&maps.mean_odd)),
                (binding::DIRECT, Resource::StorageImage(&maps.direct)),
                (binding::ALBEDO, Resource::StorageImage(&maps.albedo)),
                (binding::EMISSION, Resource::StorageImage(&maps.emission)),
                (binding::SOURCE_IMAGE, Resource::StorageImage(source)),
                (binding::SUMS, Resource::Storage(&texels.sums)),
            ]);
            resources
        };
        let pipeline = ComputePipeline::new(context.gpu, &SOURCE, context.constants, &resources(&maps.source[0]))?;
        let sets = maps.source.iter().map(|source| pipeline.bind(&resources(source))).collect::<Result<Vec<_>>>()?;
        Ok(Self { pipeline, sets })
    }

    /// `source`: which map is written. The sums are those of the last recording.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, source: usize, texels: Range<u32>) {
        let push = Push { first_texel: texels.start, texel_count: texels.end - texels.start, ..*push };
        recorder.dispatch(&self.pipeline, &self.sets[source], &push, groups_of(&push), c"source");
    }
}

impl SourceSums {
    /// Of no texels.
    pub(crate) const NOTHING: Self = Self { mean_radiance: 0.0, area: 0.0, max_albedo: 0.0, invalid: 0 };

    /// After the pass has run.
    pub(crate) fn read(texels: &TexelList) -> Self {
        let mut total = [0.0; 4];
        for [power, area, albedo, invalid] in texels.read_sums() {
            total = [total[0] + power, total[1] + area, f64::max(total[2], albedo), total[3] + invalid];
        }
        let [power, area, max_albedo, invalid] = total;
        let mean_radiance = if area > 0.0 { power / area } else { 0.0 };
        Self { mean_radiance, area, max_albedo, invalid: invalid as u64 }
    }
}
