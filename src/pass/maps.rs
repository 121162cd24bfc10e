//! Everything that is kept for each texel of the light map.

use super::bounce::Links;
use super::clusters::Sources;
use super::importance::Pyramid;
use super::nothing::Nothing;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::{Buffer, BufferDesc, Commands, Gpu, Image, ImageDesc, Location};
use ash::vk;
use std::sync::Arc;

/// Images of the light map's size. Those of absent features are [`Nothing`].
pub(crate) struct Maps {
    pub(crate) size: [u32; 2],
    /// (instance + 1 or 0, primitive, barycentrics).
    pub(crate) surface: Image,
    /// fp32: fp16 would turn .9 into .8999, and a closed furnace of .99 would lose 2.5 %.
    pub(crate) albedo: Arc<Image>,
    /// The emission texture's colour, which the material's emission multiplies.
    pub(crate) emission: Arc<Image>,
    /// Where in the texel rays start.
    pub(crate) footprint: Image,
    /// Irradiance from analytic lights.
    pub(crate) direct: Arc<Image>,
    /// Mean gathered irradiance of the even quanta, and its samples. Dynamic: the running average.
    pub(crate) mean_even: Arc<Image>,
    /// The same of the odd quanta. Dynamic: what the last visit gathered.
    pub(crate) mean_odd: Arc<Image>,
    /// Outgoing radiance: what hits read. Dynamic: two, one read while the other is written.
    pub(crate) source: Vec<Arc<Image>>,
    /// Pyramid over the light map that rays are aimed by, and over the sky map.
    pub(crate) importance: Arc<Image>,
    pub(crate) sky_importance: Arc<Image>,
    /// Luminance of the pyramid's leaves.
    pub(crate) aimed_luminance: Arc<Image>,
    /// Texels that are more than one piece: `pass/pieces.rs`. 1 x 1 until somebody has looked.
    pub(crate) pieces: Arc<Image>,
    /// Clusters of source texels; none until somebody has looked.
    pub(crate) sources: Sources,
    /// Where rays of bounce epochs ended; none until somebody keeps them.
    pub(crate) links: Links,
    /// `[group of the list of texels]`: which of its two fields take rays. Nothing in a dynamic scene, and where no rays are
    /// sent.
    pub(crate) activity: Arc<Buffer>,
    /// What rays tell of other ways to aim them; of light from the sky map.
    pub(crate) evidence: Arc<Image>,
    pub(crate) sky_evidence: Arc<Image>,
    /// Irradiance and coverage. Dynamic: as many as the engine may still read while another is written.
    pub(crate) light_map: Vec<Arc<Image>>,
}

/// One that the engine reads, one that frames under way may still read, one that is written.
const PUBLISHED: usize = 3;

const RADIANCE: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// Where in the list a texel's pieces are.
pub(super) const PIECES: vk::Format = vk::Format::R32_UINT;

/// Name, format, size and number; 0 of what is not needed.
type Plan = (&'static str, vk::Format, [u32; 2], usize);

/// `sky`: size of the sky map, where there is one.
fn plans(size: [u32; 2], sky: [u32; 2], features: Features) -> [Plan; 14] {
    let dynamic = features.contains(Features::DYNAMIC);
    let any = |wanted: Features| usize::from(features.intersects(wanted));
    let importance = usize::from(features.contains(Features::IMPORTANCE));
    let by_power = usize::from(importance == 1 && !features.contains(Features::CLUSTERS));
    let sky_importance = usize::from(features.contains(Features::IMPORTANCE | Features::SKY_MAP));
    let [pyramid, sky] = [size, sky].map(|leaves| Pyramid::over(leaves).image_size());
    let several = |count| if dynamic { count } else { 1 };
    [
        ("surface map", vk::Format::R32G32B32A32_UINT, size, 1),
        ("albedo map", RADIANCE, size, any(Features::ALBEDO_TEXTURES)),
        ("emission map", RADIANCE, size, any(Features::EMISSION_TEXTURES)),
        ("footprint map", vk::Format::R32_UINT, size, 1),
        ("direct map", RADIANCE, size, any(Features::LIGHTS)),
        (if dynamic { "running average" } else { "mean of even quanta" }, RADIANCE, size, any(Features::GATHERING)),
        (
            if dynamic { "last visit" } else { "mean of odd quanta" },
            RADIANCE,
            size,
            // That of bounces holds what comes from elsewhere than their links.
            any(Features::DYNAMIC | Features::HALVES | Features::LINKS),
        ),
        ("source map", RADIANCE, size, any(Features::GATHERING) * several(2)),
        ("importance pyramid", RADIANCE, pyramid, by_power),
        ("sky importance pyramid", RADIANCE, sky, sky_importance),
        ("aimed luminance", vk::Format::R32_SFLOAT, size, importance),
        ("evidence map", RADIANCE, size, importance),
        ("sky evidence map", RADIANCE, size, sky_importance),
        ("light map", RADIANCE, size, several(PUBLISHED)),
    ]
}

impl Maps {
    /// `sky`: size of the sky map, where there is one. `kept`: the light that these maps hold is taken over; they are those of
    /// other features.
    pub(crate) fn new(
        gpu: &Gpu,
        commands: &mut Commands,
        size: [u32; 2],
        sky: [u32; 2],
        features: Features,
        nothing: &Nothing,
        kept: Option<(&Self, Features)>,
    ) -> Result<Self> {
        let lit_directly = kept.filter(|(_, before)| (*before & features).contains(Features::LIGHTS));
        let kept = kept.map(|(kept, _)| kept);
        let plans = plans(size, sky, features);
        let usage = vk::ImageUsageFlags::STORAGE
            | vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_SRC
            | vk::ImageUsageFlags::TRANSFER_DST;
        let attachment = usage | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let image = |index: usize, usage| {
            let (name, format, size, _) = plans[index];
            Image::new(gpu, ImageDesc { name, size, format, usage, mip_levels: 1 })
        };
        let several = |index: usize, kept: Option<&Vec<Arc<Image>>>| match kept {
            Some(kept) => Ok(kept.clone()),
            None => (0..plans[index].3).map(|_| image(index, usage).map(Arc::new)).collect::<Result<Vec<_>>>(),
        };
        let optional = |index: usize, usage| match plans[index] {
            (_, format, _, 0) => Ok(nothing.image(format)),
            _ => image(index, usage).map(Arc::new),
        };
        let maps = Self {
            size,
            surface: image(0, attachment)?,
            albedo: optional(1, attachment)?,
            emission: optional(2, attachment)?,
            footprint: image(3, usage)?,
            direct: lit_directly.map_or_else(|| optional(4, usage), |(kept, _)| Ok(kept.direct.clone()))?,
            mean_even: kept.map_or_else(|| optional(5, usage), |kept| Ok(kept.mean_even.clone()))?,
            mean_odd: kept.map_or_else(|| optional(6, usage), |kept| Ok(kept.mean_odd.clone()))?,
            source: several(7, kept.map(|kept| &kept.source))?,
            importance: optional(8, usage)?,
            sky_importance: optional(9, usage)?,
            pieces: nothing.image(PIECES),
            sources: Sources::none(nothing),
            links: Links::none(nothing),
            activity: nothing.buffer(),
            aimed_luminance: optional(10, usage)?,
            evidence: optional(11, usage)?,
            sky_evidence: optional(12, usage)?,
            light_map: several(13, kept.map(|kept| &kept.light_map))?,
        };
        commands.run(|recorder| {
            recorder.initialise(&maps.own());
            Ok(())
        })?;
        Ok(maps)
    }

    /// What nobody else has: [`Nothing`], and what was taken over, is in its layout already.
    fn own(&self) -> Vec<&Image> {
        let shared = [
            &self.albedo,
            &self.emission,
            &self.direct,
            &self.mean_even,
            &self.mean_odd,
            &self.importance,
            &self.sky_importance,
            &self.aimed_luminance,
            &self.evidence,
            &self.sky_evidence,
        ];
        let shared = shared.into_iter().chain(&self.source).chain(&self.light_map);
        let own = shared.filter(|image| Arc::strong_count(image) == 1).map(|image| &**image);
        own.chain([&self.surface, &self.footprint]).collect()
    }

    /// Bytes that the images take, by name.
    pub(crate) fn bytes(
        size: [u32; 2],
        sky: [u32; 2],
        features: Features,
    ) -> impl Iterator<Item = (&'static str, u64)> {
        let bytes = move |(name, format, size, count): Plan| {
            (name, u64::from(size[0]) * u64::from(size[1]) * texel_bytes(format) * count as u64)
        };
        plans(size, sky, features).into_iter().filter(|(_, _, _, count)| *count > 0).map(bytes)
    }
}

/// Of so many groups of texels, which all take rays.
pub(crate) fn activity(commands: &mut Commands, groups: usize) -> Result<Arc<Buffer>> {
    let all = vec![0b11_u32; groups.max(1)];
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
    let size = size_of_val(all.as_slice()) as u64;
    commands.upload(BufferDesc { name: "activity", size, usage, location: Location::Device }, &all).map(Arc::new)
}

fn texel_bytes(format: vk::Format) -> u64 {
    match format {
        vk::Format::R32_UINT | vk::Format::R32_SFLOAT => 4,
        _ => 16,
    }
}
