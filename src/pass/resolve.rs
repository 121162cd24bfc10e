//! Irradiance into the light map, and the error that the half buffers tell. Reads the means and the direct map; writes
//! the light map, and sums over work groups for the host. One invocation a texel of the list, all at once.

use super::{Context, TexelList, groups_of};
use crate::error::Result;
use crate::gpu::layout::{Push, binding};
use crate::gpu::{BindingSet, ComputePipeline, Image, RESOLVE, Recorder, Resource};
use std::ops::Range;

pub(crate) struct Resolve {
    pipeline: ComputePipeline,
    set: BindingSet,
}

/// What the pass tells of the whole map.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ResolveSums {
    /// Mean luminance of the irradiance over the texels.
    pub(crate) mean: f64,
    /// Mean squared relative standard error: an estimate of relMSE.
    pub(crate) relative_mse: f64,
    /// `[group][field]`: the same as a sum over the texels of each field.
    pub(crate) fields: Vec<[f64; 2]>,
}

impl Resolve {
    pub(crate) fn new(context: Context<'_>, texels: &TexelList, light_map: &Image) -> Result<Self> {
        let maps = context.maps;
        let resources = [
            (binding::TEXELS, Resource::Storage(&texels.buffer)),
            (binding::MEAN_EVEN, Resource::StorageImage(&maps.mean_even)),
            (binding::MEAN_ODD, Resource::StorageImage(&maps.mean_odd)),
            (binding::DIRECT, Resource::StorageImage(&maps.direct)),
            (binding::LIGHT_MAP, Resource::StorageImage(light_map)),
            (binding::SUMS, Resource::Storage(&texels.sums)),
        ];
        let pipeline = ComputePipeline::new(context.gpu, &RESOLVE, context.constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        Ok(Self { pipeline, set })
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, texels: Range<u32>) {
        let push = Push { first_texel: texels.start, texel_count: texels.end - texels.start, ..*push };
        recorder.dispatch(&self.pipeline, &self.set, &push, groups_of(&push), c"resolve");
    }
}

impl ResolveSums {
    /// After the pass has run.
    pub(crate) fn read(texels: &TexelList) -> Self {
        let sums = texels.read_sums();
        let add = |sum: [f64; 3], [a, b, c, d]: &[f64; 4]| [sum[0] + a, sum[1] + b + c, sum[2] + d];
        let [luminance, error, count] = sums.iter().fold([0.0; 3], add);
        let count = count.max(1.0);
        let fields = sums.iter().map(|[_, one, other, _]| [*one, *other]).collect();
        Self { mean: luminance / count, relative_mse: error / count, fields }
    }
}
