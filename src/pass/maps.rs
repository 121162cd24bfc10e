//! Everything that is kept for each texel of the light map.

use crate::error::Result;
use crate::features::Features;
use crate::gpu::{Commands, Gpu, Image, ImageDesc};
use ash::vk;

/// Images of the light map's size, but where a feature is absent: those are 1 x 1.
pub(crate) struct Maps {
    pub(crate) size: [u32; 2],
    /// (instance + 1 or 0, primitive, barycentrics).
    pub(crate) surface: Image,
    /// fp32: fp16 would turn .9 into .8999, and a closed furnace of .99 would lose 2.5 %.
    pub(crate) albedo: Image,
    pub(crate) emission: Image,
    /// Where in the texel rays start.
    pub(crate) footprint: Image,
    /// Irradiance from analytic lights.
    pub(crate) direct: Image,
    /// Mean gathered irradiance of the even quanta, and its samples.
    pub(crate) mean_even: Image,
    /// The same of the odd quanta.
    pub(crate) mean_odd: Image,
    /// Outgoing radiance: what hits read.
    pub(crate) source: Image,
    /// Irradiance and coverage.
    pub(crate) light_map: Image,
}

/// Name, format, and the feature without which it is not needed.
type Plan = (&'static str, vk::Format, Option<Features>);

const RADIANCE: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
const PLANS: [Plan; 9] = [
    ("surface map", vk::Format::R32G32B32A32_UINT, None),
    ("albedo map", RADIANCE, None),
    ("emission map", RADIANCE, None),
    ("footprint map", vk::Format::R32_UINT, None),
    ("direct map", RADIANCE, Some(Features::LIGHTS)),
    ("mean of even quanta", RADIANCE, None),
    ("mean of odd quanta", RADIANCE, None),
    ("source map", RADIANCE, None),
    ("light map", RADIANCE, None),
];

impl Maps {
    pub(crate) fn new(gpu: &Gpu, commands: &mut Commands, size: [u32; 2], features: Features) -> Result<Self> {
        let usage = vk::ImageUsageFlags::STORAGE
            | vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_SRC
            | vk::ImageUsageFlags::TRANSFER_DST;
        let attachment = usage | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let image = |index: usize, usage| {
            let (name, format, feature) = PLANS[index];
            let size = if feature.is_none_or(|feature| features.contains(feature)) { size } else { [1, 1] };
            Image::new(gpu, ImageDesc { name, size, format, usage, mip_levels: 1 })
        };
        let maps = Self {
            size,
            surface: image(0, attachment)?,
            albedo: image(1, attachment)?,
            emission: image(2, attachment)?,
            footprint: image(3, usage)?,
            direct: image(4, usage)?,
            mean_even: image(5, usage)?,
            mean_odd: image(6, usage)?,
            source: image(7, usage)?,
            light_map: image(8, usage)?,
        };
        commands.run(|recorder| {
            recorder.initialise(&maps.all());
            Ok(())
        })?;
        Ok(maps)
    }

    fn all(&self) -> [&Image; 9] {
        [
            &self.surface,
            &self.albedo,
            &self.emission,
            &self.footprint,
            &self.direct,
            &self.mean_even,
            &self.mean_odd,
            &self.source,
            &self.light_map,
        ]
    }

    /// Bytes that the images take, by name.
    pub(crate) fn bytes(size: [u32; 2], features: Features) -> impl Iterator<Item = (&'static str, u64)> {
        let texels = u64::from(size[0]) * u64::from(size[1]);
        PLANS
            .into_iter()
            .filter(move |(_, _, feature)| feature.is_none_or(|feature| features.contains(feature)))
            .map(move |(name, format, _)| (name, texels * texel_bytes(format)))
    }
}

fn texel_bytes(format: vk::Format) -> u64 {
    match format {
        vk::Format::R32_UINT => 4,
        _ => 16,
    }
}
