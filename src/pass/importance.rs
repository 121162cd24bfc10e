//! Leaves and pyramids that rays are aimed by. Reads the surface, source and evidence maps and the sky; writes the pyramids, and sums
//! over work groups for the host. One invocation for four texels, then for four sums, level by level.

use super::Context;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::{Push, SQUARE_GROUP, binding};
use crate::gpu::{BindingSet, Buffer, BufferDesc, ComputePipeline, IMPORTANCE, Location, Recorder, Resource};
use crate::sampling::Evidence;
use ash::vk;
use std::ops::Range;

/// How a pyramid lies in its image: `glsl/include/pyramid.glsl` has the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pyramid {
    /// Size of level 0, a quarter of the leaves, padded to powers of two.
    base: [u32; 2],
}

impl Pyramid {
    pub(super) fn over(leaves: [u32; 2]) -> Self {
        Self { base: leaves.map(|side| side.max(1).div_ceil(2).next_power_of_two()) }
    }

    fn levels(self) -> u32 {
        self.base[0].max(self.base[1]).ilog2() + 1
    }

    fn size(self, level: u32) -> [u32; 2] {
        self.base.map(|side| (side >> level).max(1))
    }

    /// Level 0 at the left, the others below each other at its right.
    pub(super) fn image_size(self) -> [u32; 2] {
        let rows: u32 = (1..self.levels()).map(|level| self.size(level)[1]).sum();
        let columns = if self.levels() > 1 { self.size(1)[0] } else { 0 };
        [self.base[0] + columns, self.base[1].max(rows)]
    }
}

/// Levels up to this side are one work group's.
const ONE_GROUP_SIDE: u32 = 32;
/// `vec4`s that a work group sums up.
const SUMS: usize = 3;

pub(crate) struct Importance {
    pipeline: ComputePipeline,
    /// `[source map]`
    sets: Vec<BindingSet>,
    sky_set: BindingSet,
    pyramid: Pyramid,
    /// Of the sky map, where there is one.
    sky: Option<Pyramid>,
    sums: Buffer,
}

/// What the pass tells of the whole map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ImportanceSums {
    pub(crate) evidence: Evidence,
    /// Texels whose source is negative, infinite or no number, and counts as 0.
    pub(crate) invalid: u64,
    /// Share of the rays aimed at the light map that found the texel; and at the sky that left the scene.
    pub(crate) seen: [f64; 2],
}

impl Importance {
    pub(crate) fn new(context: Context<'_>) -> Result<Self> {
        let maps = context.maps;
        let pyramid = Pyramid::over(maps.size);
        let size = Self::sums_bytes(maps.size);
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let desc = BufferDesc { name: "importance sums", size, usage, location: Location::ReadBack };
        let sums = Buffer::new(context.gpu, desc)?;
        let resources = |source, pyramid| {
            let mut resources = context.scene.surface_resources();
            resources.extend([
                context.scene.sky(),
                (binding::SURFACE, Resource::StorageImage(&maps.surface)),
                (binding::SOURCE_MAP, Resource::Sampled(source)),
                (binding::EMISSION, Resource::StorageImage(&maps.emission)),
                (binding::SUMS, Resource::Storage(&sums)),
                (binding::PYRAMID, Resource::StorageImage(pyramid)),
                (binding::AIMED_LUMINANCE, Resource::StorageImage(&maps.aimed_luminance)),
                (binding::EVIDENCE, Resource::StorageImage(&maps.evidence)),
                (binding::PIECES_MAP, Resource::StorageImage(&maps.pieces)),
                (binding::PIECES, Resource::Storage(&context.scene.pieces)),
                (binding::SKY_EVIDENCE, Resource::StorageImage(&maps.sky_evidence)),
            ]);
            resources
        };
        let first = resources(&maps.source[0], &maps.importance);
        let pipeline = ComputePipeline::new(context.gpu, &IMPORTANCE, context.constants, &first)?;
        let set = |index: usize| pipeline.bind(&resources(&maps.source[index], &maps.importance));
        let sets = (0..maps.source.len()).map(set).collect::<Result<Vec<_>>>()?;
        let sky_set = pipeline.bind(&resources(&maps.source[0], &maps.sky_importance))?;
        let has_sky = Features::from_bits_retain(context.constants.features).contains(Features::SKY_MAP);
        let sky = has_sky.then(|| Pyramid::over(context.scene.sky_size()));
        Ok(Self { pipeline, sets, sky_set, pyramid, sky, sums })
    }

    pub(super) fn sums_bytes(size: [u32; 2]) -> u64 {
        let [columns, rows] = groups(Pyramid::over(size).base);
        u64::from(columns) * u64::from(rows) * (SUMS * 16) as u64
    }

    /// Rows of work groups of level 0: what [`Importance::record_leaves`] may be cut into.
    pub(crate) fn rows(&self) -> u32 {
        groups(self.pyramid.base)[1]
    }

    /// Records the light map's leaves, and level 0 of its pyramid where there are no clusters. `source`: which map is read; `sums`: whether it sums up for the host,
    /// which else may be reading.
    pub(crate) fn record_leaves(
        &self,
        recorder: &mut Recorder<'_>,
        push: &Push,
        source: usize,
        rows: Range<u32>,
        sums: bool,
    ) {
        let push = Push {
            instance: 0,
            first_level: 0,
            end_level: 1,
            first_texel: rows.start * SQUARE_GROUP,
            quantum_count: u32::from(sums),
            ..*push
        };
        let groups = [groups(self.pyramid.base)[0], rows.end - rows.start];
        recorder.dispatch(&self.pipeline, &self.sets[source], &push, groups, c"importance");
    }

    /// Records the levels above, once level 0 is whole.
    pub(crate) fn record_levels(&self, recorder: &mut Recorder<'_>, push: &Push) {
        let push = Push { instance: 0, ..*push };
        self.record_upper(recorder, &push, self.pyramid, &self.sets[0]);
    }

    /// Records the sky's pyramid, where there is a map.
    pub(crate) fn record_sky(&self, recorder: &mut Recorder<'_>, push: &Push) {
        let Some(pyramid) = self.sky else { return };
        let push = Push { instance: 1, first_level: 0, end_level: 1, first_texel: 0, ..*push };
        recorder.dispatch(&self.pipeline, &self.sky_set, &push, groups(pyramid.base), c"sky importance");
        self.record_upper(recorder, &push, pyramid, &self.sky_set);
    }

    fn record_upper(&self, recorder: &mut Recorder<'_>, push: &Push, pyramid: Pyramid, set: &BindingSet) {
        let levels = pyramid.levels();
        let mut level = 1;
        while level < levels {
            let size = pyramid.size(level);
            let one_group = size[0].max(size[1]) <= ONE_GROUP_SIDE;
            let (end, groups) = if one_group { (levels, [1, 1]) } else { (level + 1, groups(size)) };
            let push = Push { first_level: level, end_level: end, first_texel: 0, ..*push };
            recorder.dispatch(&self.pipeline, set, &push, groups, c"importance levels");
            level = end;
        }
    }

    /// What level 0 summed up, after it has run. `texels`: that take rays.
    pub(crate) fn read_sums(&self, texels: u32) -> ImportanceSums {
        let mut total = [[0.0_f64; 4]; SUMS];
        for group in self.sums.bytes().chunks_exact(SUMS * 16) {
            for (total, sum) in total.iter_mut().flatten().zip(group.chunks_exact(4)) {
                *total += f64::from(bytemuck::pod_read_unaligned::<f32>(sum));
            }
        }
        let [[power, squared, area, invalid], surfaces, sky] = total;
        let mean = |[a, b, c, _]: [f64; 4]| [a, b, c].map(|sum| sum / f64::from(texels.max(1)));
        ImportanceSums {
            evidence: Evidence { power, squared, area, surfaces: mean(surfaces), sky: mean(sky) },
            invalid: invalid as u64,
            seen: [surfaces[3], sky[3]].map(|sum| sum / f64::from(texels.max(1))),
        }
    }
}

fn groups(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(SQUARE_GROUP))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_fit_into_the_image() {
        let image = |leaves| Pyramid::over(leaves).image_size();
        assert_eq!((image([1, 1]), image([2, 2]), image([3, 2])), ([1, 1], [1, 1], [3, 1]));
        assert_eq!((image([512, 512]), image([384, 100])), ([384, 256], [384, 65]));
        // One row of leaves has as many levels below each other as a square.
        assert_eq!(image([1024, 1]), [768, 9]);
        assert_eq!(image([16384, 16384]), [12288, 8192]);
    }
}
