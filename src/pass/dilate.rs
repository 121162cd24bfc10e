//! Fills texels without light of their own with the nearest one's. Reads the surface map; works in the light map and in
//! two images of its own. One invocation a texel of the whole map, a pass for each halving of the step.

use super::Context;
use crate::error::Result;
use crate::gpu::layout::{Push, SQUARE_GROUP, binding};
use crate::gpu::{BindingSet, Commands, ComputePipeline, DILATE, Image, ImageDesc, Recorder, Resource};
use ash::vk;

pub(crate) struct Dilate {
    pipeline: ComputePipeline,
    /// Reads the one image and writes the other, and the other way round.
    sets: [BindingSet; 2],
    nearest: [Image; 2],
}

impl Dilate {
    /// In a light map whose lit texels cover, and no others.
    pub(crate) fn new(context: Context<'_>, commands: &mut Commands, light_map: &Image) -> Result<Self> {
        let maps = context.maps;
        let image = |name| {
            let (size, format) = (maps.size, vk::Format::R32_UINT);
            let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_DST;
            Image::new(context.gpu, ImageDesc { name, size, format, usage, mip_levels: 1 })
        };
        let nearest = [image("nearest texel, one")?, image("nearest texel, other")?];
        commands.run(|recorder| {
            recorder.initialise(&[&nearest[0], &nearest[1]]);
            Ok(())
        })?;
        let resources = |before, after| {
            [
                (binding::SURFACE, Resource::StorageImage(&maps.surface)),
                (binding::LIGHT_MAP, Resource::StorageImage(light_map)),
                (binding::NEAREST_BEFORE, Resource::StorageImage(before)),
                (binding::NEAREST_AFTER, Resource::StorageImage(after)),
            ]
        };
        let (there, back) = (resources(&nearest[0], &nearest[1]), resources(&nearest[1], &nearest[0]));
        let pipeline = ComputePipeline::new(context.gpu, &DILATE, context.constants, &there)?;
        let sets = [pipeline.bind(&there)?, pipeline.bind(&back)?];
        Ok(Self { pipeline, sets, nearest })
    }

    /// Finds the nearest texels and fills.
    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, push: &Push) {
        for (index, step_texels) in steps(push.map_size).chain([0]).enumerate() {
            self.record_step(recorder, push, index, step_texels);
        }
    }

    /// Finds the nearest texels, and does not fill.
    pub(crate) fn record_search(&self, recorder: &mut Recorder<'_>, push: &Push) {
        for (index, step_texels) in steps(push.map_size).enumerate() {
            self.record_step(recorder, push, index, step_texels);
        }
    }

    /// What a search has found.
    pub(crate) fn into_nearest(self, map_size: [u32; 2]) -> Image {
        let [one, other] = self.nearest;
        // The first step writes the other.
        if steps(map_size).count() % 2 == 1 { other } else { one }
    }

    fn record_step(&self, recorder: &mut Recorder<'_>, push: &Push, index: usize, step_texels: u32) {
        let groups = push.map_size.map(|side| side.div_ceil(SQUARE_GROUP).max(1));
        let push = Push { step_texels, first_quantum: index as u32, ..*push };
        recorder.dispatch(&self.pipeline, &self.sets[index % 2], &push, groups, c"dilate");
    }
}

/// How far each pass looks: down to 1, and once more at 1 for what a jump misses.
fn steps(map_size: [u32; 2]) -> impl Iterator<Item = u32> {
    let largest = map_size[0].max(map_size[1]).next_power_of_two() / 2;
    (0..=largest.max(1).ilog2()).rev().map(|shift| 1 << shift).chain([1])
}
