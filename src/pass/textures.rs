//! The scene's textures on the device, and the batches of triangles that share a pair of them.

use crate::bvh::Bvh;
use crate::error::Result;
use crate::gpu::{Commands, Gpu, Image, ImageDesc, Sampler};
use crate::scene::{Scene, TextureUse, Wrap};
use ash::vk;
use std::collections::BTreeMap;

/// The albedo and the emission texture of a batch.
pub(super) type Pair = [Option<TextureUse>; 2];

/// Textures, and one white pixel for materials without.
pub(super) struct Textures {
    images: Vec<Image>,
    white: Image,
    samplers: Vec<([Wrap; 2], Sampler)>,
    plain: Sampler,
}

impl Textures {
    pub(super) fn new(gpu: &Gpu, commands: &mut Commands, scene: &Scene) -> Result<Self> {
        let usage = vk::ImageUsageFlags::SAMPLED;
        let format = vk::Format::R8G8B8A8_SRGB;
        let white = ImageDesc { name: "white", size: [1, 1], format, usage, mip_levels: 1 };
        let mut textures = Self {
            images: Vec::new(),
            white: commands.upload_image(white, &[[255_u8; 4]])?,
            samplers: Vec::new(),
            plain: Sampler::new(gpu, [vk::SamplerAddressMode::REPEAT; 2])?,
        };
        for texture in scene.textures() {
            let size = [texture.width, texture.height];
            let mip_levels = size[0].max(size[1]).ilog2() + 1;
            let desc = ImageDesc { name: &texture.name, size, format, usage, mip_levels };
            textures.images.push(commands.upload_image(desc, &texture.pixels)?);
        }
        for usage in scene.materials().iter().flat_map(|m| [m.albedo_texture, m.emission_texture]).flatten() {
            if !textures.samplers.iter().any(|(wrap, _)| *wrap == usage.wrap) {
                textures.samplers.push((usage.wrap, Sampler::new(gpu, usage.wrap.map(address_mode))?));
            }
        }
        Ok(textures)
    }

    pub(super) fn of(&self, usage: Option<TextureUse>) -> (&Image, &Sampler) {
        let found = usage.and_then(|usage| {
            let sampler = self.samplers.iter().find(|(wrap, _)| *wrap == usage.wrap)?;
            Some((self.images.get(usage.texture)?, &sampler.1))
        });
        found.unwrap_or((&self.white, &self.plain))
    }
}

fn address_mode(wrap: Wrap) -> vk::SamplerAddressMode {
    match wrap {
        Wrap::Repeat => vk::SamplerAddressMode::REPEAT,
        Wrap::MirroredRepeat => vk::SamplerAddressMode::MIRRORED_REPEAT,
        Wrap::ClampToEdge => vk::SamplerAddressMode::CLAMP_TO_EDGE,
    }
}

/// Mapped triangles of one mesh that share a pair of textures.
pub(super) struct Batch {
    pub(super) mesh: usize,
    pub(super) pair: Pair,
    /// In the list of all batches' primitives.
    pub(super) triangles: std::ops::Range<u32>,
}

/// All batches, and the primitives in them.
pub(super) fn batches(scene: &Scene, bvh: &Bvh) -> (Vec<Batch>, Vec<u32>) {
    let (mut batches, mut list) = (Vec::new(), Vec::new());
    for (index, (mesh, range)) in scene.meshes().iter().zip(&bvh.meshes).enumerate() {
        let mut by_pair: BTreeMap<_, (Pair, Vec<u32>)> = BTreeMap::new();
        // In the mesh's own order: where charts overlap the last triangle wins, as in other bakers.
        let mut slots: Vec<(usize, &u32)> = bvh.order[index].iter().enumerate().collect();
        slots.sort_by_key(|(_, triangle)| **triangle);
        for (slot, triangle) in slots {
            if mesh.light_map_uvs()[*triangle as usize].is_none() {
                continue;
            }
            let material = &scene.materials()[mesh.materials()[*triangle as usize] as usize];
            let pair = [material.albedo_texture, material.emission_texture];
            let key = pair.map(|usage| usage.map(|usage| (usage.texture, usage.wrap.map(|wrap| wrap as u8))));
            let batch = by_pair.entry(key).or_insert_with(|| (pair, Vec::new()));
            batch.1.push(range.first_primitive + slot as u32);
        }
        for (pair, primitives) in by_pair.into_values() {
            let first = list.len() as u32;
            list.extend(primitives);
            batches.push(Batch { mesh: index, pair, triangles: first..list.len() as u32 });
        }
    }
    (batches, list)
}
