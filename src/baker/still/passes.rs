//! The passes of a static bake.

use crate::baker::Core;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::Recorder;
use crate::gpu::layout::Push;
use crate::pass::{Bake, Bounce, Context, Dilate, Direct, Resolve, Source};

pub(super) struct Passes {
    pub(super) direct: Option<Direct>,
    /// Where there is light that rays can find.
    pub(super) gathering: Option<Gathering>,
    pub(super) resolve: Resolve,
    pub(super) dilate: Dilate,
}

/// Those that rays need.
pub(super) struct Gathering {
    pub(super) source: Source,
    pub(super) bake: Bake,
    /// Where the rays of bounce epochs are kept.
    pub(super) bounce: Option<Bounce>,
}

impl Passes {
    /// Where the rays of bounce epochs are kept.
    pub(super) fn bounce(&self) -> Option<&Bounce> {
        self.gathering.as_ref()?.bounce.as_ref()
    }

    pub(super) fn new(core: &mut Core) -> Result<Self> {
        let context = Context { gpu: &core.gpu, constants: core.constants, scene: &core.scene, maps: &core.maps };
        let (texels, commands) = (&core.texels, &mut core.commands);
        let needs = |feature| core.features.contains(feature);
        let (lights, links, gathers) = (needs(Features::LIGHTS), needs(Features::LINKS), needs(Features::GATHERING));
        let gathering = || {
            Ok(Gathering {
                source: Source::new(context, texels)?,
                bake: Bake::new(context, texels)?,
                bounce: links.then(|| Bounce::new(context, texels)).transpose()?,
            })
        };
        let passes = Self {
            direct: lights.then(|| Direct::new(context, texels)).transpose()?,
            gathering: gathers.then(gathering).transpose()?,
            resolve: Resolve::new(context, texels, &context.maps.light_map[0])?,
            dilate: Dilate::new(context, commands, &context.maps.light_map[0])?,
        };
        // On no texel: drivers that compile at the first use do so here, and not in a slice.
        let nothing = Push { map_size: [0, 0], rays: 1, ..core.push };
        commands.run(|recorder| {
            if let Some(direct) = &passes.direct {
                direct.record(recorder, &nothing, 0..0);
            }
            if let Some(gathering) = &passes.gathering {
                gathering.record_first_use(recorder, &nothing);
            }
            passes.resolve.record(recorder, &nothing, 0..0);
            passes.dilate.record(recorder, &nothing);
            Ok(())
        })?;
        Ok(passes)
    }
}

impl Gathering {
    fn record_first_use(&self, recorder: &mut Recorder<'_>, nothing: &Push) {
        self.source.record(recorder, nothing, 0, 0..0);
        self.bake.record(recorder, nothing, 0, 0..0, 0..0);
        if let Some(bounce) = &self.bounce {
            bounce.record(recorder, nothing, 0..0);
        }
    }
}
