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
    /// The emission texture's colour, which the material's emission multiplies.
    pub(crate) emission: Image,
    /// Where in the texel rays start.
    pub(crate) footprint: Image,
    /// Irradiance from analytic lights.
    pub(crate) direct: Image,
    /// Mean gathered irradiance of the even quanta, and its samples. Dynamic: the running average.
    pub(crate) mean_even: Image,
    /// The same of the odd quanta. Dynamic: what the last visit gathered.
    pub(crate) mean_odd: Image,
    /// Outgoing radiance: what hits read. Dynamic: two, one read while the other is written.
    pub(crate) source: Vec<Image>,
    /// Irradiance and coverage. Dynamic: as many as the engine may still read while another is written.
    pub(crate) light_map: Vec<Image>,
}

/// One that the engine reads, one that frames under way may still read, one that is written.
const PUBLISHED: usize = 3;

const RADIANCE: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// Name, format and number of full size.
type Plan = (&'static str, vk::Format, usize);

fn plans(features: Features) -> [Plan; 9] {
    let dynamic = features.contains(Features::DYNAMIC);
    let several = |count| if dynamic { count } else { 1 };
    [
        ("surface map", vk::Format::R32G32B32A32_UINT, 1),
        ("albedo map", RADIANCE, 1),
        ("emission map", RADIANCE, 1),
        ("footprint map", vk::Format::R32_UINT, 1),
        ("direct map", RADIANCE, usize::from(features.contains(Features::LIGHTS))),
        (if dynamic { "running average" } else { "mean of even quanta" }, RADIANCE, 1),
        (if dynamic { "last visit" } else { "mean of odd quanta" }, RADIANCE, 1),
        ("source map", RADIANCE, several(2)),
        ("light map", RADIANCE, several(PUBLISHED)),
    ]
}

impl Maps {
    pub(crate) fn new(gpu: &Gpu, commands: &mut Commands, size: [u32; 2], features: Features) -> Result<Self> {
        let plans = plans(features);
        let usage = vk::ImageUsageFlags::STORAGE
            | vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_SRC
            | vk::ImageUsageFlags::TRANSFER_DST;
        let attachment = usage | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let image = |index: usize, usage| {
            let (name, format, count) = plans[index];
            let size = if count > 0 { size } else { [1, 1] };
            Image::new(gpu, ImageDesc { name, size, format, usage, mip_levels: 1 })
        };
        let several = |index: usize| (0..plans[index].2).map(|_| image(index, usage)).collect::<Result<Vec<_>>>();
        let maps = Self {
            size,
            surface: image(0, attachment)?,
            albedo: image(1, attachment)?,
            emission: image(2, attachment)?,
            footprint: image(3, usage)?,
            direct: image(4, usage)?,
            mean_even: image(5, usage)?,
            mean_odd: image(6, usage)?,
            source: several(7)?,
            light_map: several(8)?,
        };
        commands.run(|recorder| {
            recorder.initialise(&maps.all());
            Ok(())
        })?;
        Ok(maps)
    }

    fn all(&self) -> Vec<&Image> {
        let single = [
            &self.surface,
            &self.albedo,
            &self.emission,
            &self.footprint,
            &self.direct,
            &self.mean_even,
            &self.mean_odd,
        ];
        single.into_iter().chain(&self.source).chain(&self.light_map).collect()
    }

    /// Bytes that the images take, by name.
    pub(crate) fn bytes(size: [u32; 2], features: Features) -> impl Iterator<Item = (&'static str, u64)> {
        let texels = u64::from(size[0]) * u64::from(size[1]);
        let bytes = move |(name, format, count): Plan| (name, texels * texel_bytes(format) * count as u64);
        plans(features).into_iter().filter(|(_, _, count)| *count > 0).map(bytes)
    }
}

fn texel_bytes(format: vk::Format) -> u64 {
    match format {
        vk::Format::R32_UINT => 4,
        _ => 16,
    }
}
