//! Light goes once more along rays that were traced before. Reads links, the source map and the mean of the odd quanta,
//! which holds what came from elsewhere; writes the mean of the even quanta. One invocation a texel of the list.

use super::nothing::Nothing;
use super::{Context, TexelList, groups_of};
use crate::error::Result;
use crate::gpu::layout::{Link, Push, binding};
use crate::gpu::{BOUNCE, BindingSet, Buffer, BufferDesc, ComputePipeline, Gpu, Location, Recorder, Resource};
use ash::vk;
use std::ops::Range;
use std::sync::Arc;

/// Where the rays of a bounce epoch ended, `[ray][texel]`.
pub(crate) struct Links {
    pub(super) buffer: Arc<Buffer>,
    texels: u32,
    /// Of each texel.
    pub(crate) rays: u32,
}

/// Bytes of all links: as large as every device lets a storage buffer be.
const MOST_BYTES: u64 = 1 << 27;
/// Links of a texel, as far as they fit: where there are many texels, each of them matters less.
const RAYS: [u32; 3] = [16, 8, 4];

impl Links {
    /// Links that each of so many texels may keep; `None`: none fit.
    pub(crate) fn rays(texels: u64) -> Option<u32> {
        RAYS.into_iter().find(|rays| Self::bytes(texels, *rays) <= MOST_BYTES)
    }

    /// Bytes of so many links for each texel.
    pub(crate) fn bytes(texels: u64, rays: u32) -> u64 {
        texels * u64::from(rays) * size_of::<Link>() as u64
    }

    /// Of no texels.
    pub(super) fn none(nothing: &Nothing) -> Self {
        Self { buffer: nothing.buffer(), texels: 0, rays: 0 }
    }

    /// Room for `rays` links of each of `texels`.
    pub(crate) fn new(gpu: &Gpu, texels: u32, rays: u32) -> Result<Self> {
        let size = Self::bytes(u64::from(texels), rays);
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let desc = BufferDesc { name: "links", size, usage, location: Location::Device };
        Ok(Self { buffer: Arc::new(Buffer::new(gpu, desc)?), texels, rays })
    }

    /// From a texel's link to its next one.
    pub(crate) fn stride(&self) -> u32 {
        self.texels
    }
}

pub(crate) struct Bounce {
    pipeline: ComputePipeline,
    set: BindingSet,
}

impl Bounce {
    pub(crate) fn new(context: Context<'_>, texels: &TexelList) -> Result<Self> {
        let maps = context.maps;
        let resources = [
            (binding::TEXELS, Resource::Storage(&texels.buffer)),
            (binding::SOURCE_MAP, Resource::Sampled(&maps.source[0])),
            (binding::MEAN_EVEN, Resource::StorageImage(&maps.mean_even)),
            (binding::MEAN_ODD, Resource::StorageImage(&maps.mean_odd)),
            (binding::LINKS, Resource::Storage(&maps.links.buffer)),
        ];
        let pipeline = ComputePipeline::new(context.gpu, &BOUNCE, context.constants, &resources)?;
        let set = pipeline.bind(&resources)?;
        Ok(Self { pipeline, set })
    }

    /// `push.rays` and `push.link_stride` are those that the links were kept with.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push, texels: Range<u32>) {
        let push = Push { first_texel: texels.start, texel_count: texels.end - texels.start, ..*push };
        recorder.dispatch(&self.pipeline, &self.set, &push, groups_of(&push), c"bounce");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_maps_keep_fewer_links() {
        let squares = [(1, Some(16)), (1024, Some(16)), (1025, Some(8)), (2048, Some(4)), (4096, None)];
        for (side, rays) in squares {
            assert_eq!(Links::rays(side * side), rays, "{side} x {side}");
        }
    }
}
