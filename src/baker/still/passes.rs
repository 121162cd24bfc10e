//! The passes of a static bake.

use crate::baker::Core;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::Push;
use crate::pass::{Bake, Bounce, Context, Dilate, Direct, Resolve, Source};

pub(super) struct Passes {
    pub(super) direct: Option<Direct>,
    pub(super) source: Source,
    pub(super) bake: Bake,
    /// Where the rays of bounce epochs are kept.
    pub(super) bounce: Option<Bounce>,
    pub(super) resolve: Resolve,
    pub(super) dilate: Dilate,
}

impl Passes {
    pub(super) fn new(core: &mut Core) -> Result<Self> {
        let context = Context { gpu: &core.gpu, constants: core.constants, scene: &core.scene, maps: &core.maps };
        let (texels, commands) = (&core.texels, &mut core.commands);
        let (lights, links) = (core.features.contains(Features::LIGHTS), core.features.contains(Features::LINKS));
        let passes = Self {
            direct: lights.then(|| Direct::new(context, texels)).transpose()?,
            source: Source::new(context, texels)?,
            bake: Bake::new(context, texels)?,
            bounce: links.then(|| Bounce::new(context, texels)).transpose()?,
            resolve: Resolve::new(context, texels, &context.maps.light_map[0])?,
            dilate: Dilate::new(context, commands, &context.maps.light_map[0])?,
        };
        // On no texel: drivers that compile at the first use do so here, and not in a slice.
        let nothing = Push { map_size: [0, 0], rays: 1, ..core.push };
        commands.run(|recorder| {
            if let Some(direct) = &passes.direct {
                direct.record(recorder, &nothing, 0..0);
            }
            passes.source.record(recorder, &nothing, 0, 0..0);
            passes.bake.record(recorder, &nothing, 0, 0..0, 0..0);
            if let Some(bounce) = &passes.bounce {
                bounce.record(recorder, &nothing, 0..0);
            }
            passes.resolve.record(recorder, &nothing, 0..0);
            passes.dilate.record(recorder, &nothing);
            Ok(())
        })?;
        Ok(passes)
    }
}
