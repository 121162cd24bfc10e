//! The scene's textures on the device, of one kind, and the batches of triangles that share a pair of them.

use super::Maps;
use crate::bvh::Bvh;
use crate::error::Result;
use crate::features::{Features, baked_materials};
use crate::gpu::{Buffer, BufferDesc, Commands, Gpu, Image, ImageDesc, Location, Sampler};
use crate::scene::{Material, Mesh, Scene, TextureUse, Wrap};
use ash::vk;
use glam::Vec2;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// What a texture is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TextureKind {
    Albedo,
    Emission,
}

impl TextureKind {
    /// Those that the scene needs.
    pub(super) fn needed(features: Features) -> Vec<Self> {
        let kinds = [(Features::ALBEDO_TEXTURES, Self::Albedo), (Features::EMISSION_TEXTURES, Self::Emission)];
        kinds.into_iter().filter(|(feature, _)| features.contains(*feature)).map(|(_, kind)| kind).collect()
    }

    /// Where its means over texels are drawn to.
    pub(super) fn map(self, maps: &Maps) -> &Image {
        match self {
            Self::Albedo => &maps.albedo,
            Self::Emission => &maps.emission,
        }
    }

    fn of(self, material: &Material) -> Option<TextureUse> {
        match self {
            Self::Albedo => material.albedo_texture,
            Self::Emission => material.emission_texture,
        }
    }

    fn uvs(self, mesh: &Mesh) -> &[[Vec2; 3]] {
        match self {
            Self::Albedo => mesh.albedo_uvs(),
            Self::Emission => mesh.emission_uvs(),
        }
    }
}

/// The textures of a kind, where triangles lie in them, and one white pixel for materials without.
pub(super) struct Textures {
    pub(super) kind: TextureKind,
    /// `[texture]`, as the scene counts them.
    images: BTreeMap<usize, Image>,
    white: Image,
    samplers: Vec<([Wrap; 2], Sampler)>,
    plain: Sampler,
    /// `[3 * primitive + corner]`.
    pub(super) texcoords: Buffer,
}

impl Textures {
    pub(super) fn new(commands: &mut Commands, scene: &Scene, bvh: &Bvh, kind: TextureKind) -> Result<Self> {
        let gpu: Gpu = commands.gpu().clone();
        let white = desc("white", [1, 1]);
        let mut textures = Self {
            kind,
            images: BTreeMap::new(),
            white: commands.upload_image(white, &[[255_u8; 4]])?,
            samplers: Vec::new(),
            plain: Sampler::new(&gpu, [vk::SamplerAddressMode::REPEAT; 2])?,
            texcoords: upload_texcoords(commands, scene, bvh, kind)?,
        };
        for usage in baked_materials(scene).filter_map(|material| kind.of(material)) {
            if let Entry::Vacant(place) = textures.images.entry(usage.texture) {
                let texture = &scene.textures()[usage.texture];
                let desc = desc(&texture.name, [texture.width, texture.height]);
                place.insert(commands.upload_image(desc, &texture.pixels)?);
            }
            if !textures.samplers.iter().any(|(wrap, _)| *wrap == usage.wrap) {
                textures.samplers.push((usage.wrap, Sampler::new(&gpu, usage.wrap.map(address_mode))?));
            }
        }
        Ok(textures)
    }

    /// That of a batch.
    pub(super) fn of(&self, pair: Pair) -> (&Image, &Sampler) {
        let usage = match self.kind {
            TextureKind::Albedo => pair[0],
            TextureKind::Emission => pair[1],
        };
        let found = usage.and_then(|usage| {
            let sampler = self.samplers.iter().find(|(wrap, _)| *wrap == usage.wrap)?;
            Some((self.images.get(&usage.texture)?, &sampler.1))
        });
        found.unwrap_or((&self.white, &self.plain))
    }

    /// Bytes that those of a kind take on the device, about.
    pub(super) fn bytes(scene: &Scene, kind: TextureKind, triangles: u64) -> u64 {
        let used: BTreeSet<usize> =
            baked_materials(scene).filter_map(|m| kind.of(m).map(|usage| usage.texture)).collect();
        let textures = used.iter().map(|index| &scene.textures()[*index]);
        let pixels: u64 = textures.map(|texture| u64::from(texture.width) * u64::from(texture.height)).sum();
        // With their mip levels.
        pixels * 4 * 4 / 3 + triangles * size_of::<[Vec2; 3]>() as u64
    }
}

fn desc(name: &str, size: [u32; 2]) -> ImageDesc<'_> {
    let mip_levels = size[0].max(size[1]).ilog2() + 1;
    ImageDesc { name, size, format: vk::Format::R8G8B8A8_SRGB, usage: vk::ImageUsageFlags::SAMPLED, mip_levels }
}

fn upload_texcoords(commands: &mut Commands, scene: &Scene, bvh: &Bvh, kind: TextureKind) -> Result<Buffer> {
    let mut texcoords = vec![[[0.0_f32; 2]; 3]; bvh.triangles.len()];
    for ((mesh, range), order) in scene.meshes().iter().zip(&bvh.meshes).zip(&bvh.order) {
        let first = range.first_primitive as usize;
        for (corners, triangle) in texcoords[first..].iter_mut().zip(order) {
            if let Some(uvs) = kind.uvs(mesh).get(*triangle as usize) {
                *corners = bvh.corners().map(|corner| uvs[corner].into());
            }
        }
    }
    let (size, usage) = (size_of_val(texcoords.as_slice()) as u64, vk::BufferUsageFlags::STORAGE_BUFFER);
    let desc = BufferDesc { name: "texture coordinates", size, usage, location: Location::Device };
    commands.upload(desc, &texcoords)
}

fn address_mode(wrap: Wrap) -> vk::SamplerAddressMode {
    match wrap {
        Wrap::Repeat => vk::SamplerAddressMode::REPEAT,
        Wrap::MirroredRepeat => vk::SamplerAddressMode::MIRRORED_REPEAT,
        Wrap::ClampToEdge => vk::SamplerAddressMode::CLAMP_TO_EDGE,
    }
}

/// The albedo and the emission texture of a batch.
pub(super) type Pair = [Option<TextureUse>; 2];

/// Mapped triangles of one mesh that share a pair of textures.
pub(super) struct Batch {
    pub(super) mesh: usize,
    pub(super) pair: Pair,
    /// In the list of all batches' primitives.
    pub(super) triangles: std::ops::Range<u32>,
}

/// All batches, in the order in which they are drawn for every kind, and the primitives in them.
pub(super) fn batches(scene: &Scene, bvh: &Bvh) -> (Vec<Batch>, Vec<u32>) {
    let (mut batches, mut list): (Vec<Batch>, Vec<u32>) = (Vec::new(), Vec::new());
    for (index, (mesh, range)) in scene.meshes().iter().zip(&bvh.meshes).enumerate() {
        // In the mesh's own order: where charts overlap the last triangle wins, as in other bakers.
        let mut slots: Vec<(usize, &u32)> = bvh.order[index].iter().enumerate().collect();
        slots.sort_by_key(|(_, triangle)| **triangle);
        for (slot, triangle) in slots {
            if mesh.light_map_uvs()[*triangle as usize].is_none() {
                continue;
            }
            let material = &scene.materials()[mesh.materials()[*triangle as usize] as usize];
            let pair = [material.albedo_texture, material.emission_texture];
            let end = list.len() as u32;
            list.push(range.first_primitive + slot as u32);
            match batches.last_mut() {
                Some(batch) if batch.mesh == index && batch.pair == pair => batch.triangles.end = end + 1,
                _ => batches.push(Batch { mesh: index, pair, triangles: end..end + 1 }),
            }
        }
    }
    (batches, list)
}
