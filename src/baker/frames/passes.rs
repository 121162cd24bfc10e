//! The passes of frames.

use crate::baker::Core;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::Push;
use crate::gpu::{Image, ImageDesc};
use crate::pass::{Bake, Context, Dilate, Direct, Publish, Resolve, Source};
use ash::vk;

pub(super) struct Passes {
    pub(super) direct: Option<Direct>,
    pub(super) bake: Bake,
    pub(super) source: Source,
    pub(super) publish: Publish,
}

impl Passes {
    /// Finds the texels that gutters are filled from, and runs every pass once on nothing: drivers that compile at the
    /// first use do so here, and not in a frame.
    pub(super) fn new(core: &mut Core) -> Result<Self> {
        let context = Context { gpu: &core.gpu, constants: core.constants, scene: &core.scene, maps: &core.maps };
        let (texels, push) = (&core.texels, &core.push);
        // The engine's light maps may hold light already, and texels of another coverage.
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::TRANSFER_DST;
        let (name, size, format) = ("lit texels", push.map_size, vk::Format::R32G32B32A32_SFLOAT);
        let lit = Image::new(&core.gpu, ImageDesc { name, size, format, usage, mip_levels: 1 })?;
        let resolve = Resolve::new(context, texels, &lit)?;
        let dilate = Dilate::new(context, &mut core.commands, &lit)?;
        core.commands.run(|recorder| {
            recorder.initialise(&[&lit]);
            resolve.record(recorder, push, 0..texels.count);
            dilate.record_search(recorder, push);
            Ok(())
        })?;
        let nearest = dilate.into_nearest(push.map_size);
        let lights = core.features.contains(Features::LIGHTS);
        let passes = Self {
            direct: lights.then(|| Direct::new(context, texels)).transpose()?,
            bake: Bake::new(context, texels)?,
            source: Source::new(context, texels)?,
            publish: Publish::new(context, nearest)?,
        };
        let nothing = Push { map_size: [0, 0], rays: 1, ..*push };
        core.commands.run(|recorder| {
            if let Some(direct) = &passes.direct {
                direct.record(recorder, &nothing, 0..0);
            }
            passes.bake.record(recorder, &nothing, 0, 0..0, 0..0);
            passes.source.record(recorder, &nothing, 0, 0..0);
            passes.publish.record(recorder, &nothing, 0, 0..1);
            Ok(())
        })?;
        Ok(passes)
    }
}
