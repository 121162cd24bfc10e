//! Materials in use and their textures.

use super::bounds::Buffers;
use super::images::{self, Views};
use super::{SidednessChoice, names};
use crate::error::Result;
use crate::scene::{MAX_ALBEDO, Material, Sidedness, Texture, TextureUse, Wrap};
use glam::{Affine2, Mat2, Vec2, Vec3};
use gltf::Document;
use gltf::material::AlphaMode;
use gltf::texture::{Info, WrappingMode};
use std::collections::HashMap;
use std::path::Path;

/// Where a texture's coordinates come from.
#[derive(Debug, Clone, Copy)]
pub(super) struct UvSource {
    /// `n` of `TEXCOORD_n`.
    pub(super) set: u32,
    /// KHR_texture_transform.
    pub(super) transform: Affine2,
}

/// A material in use.
struct Entry {
    material: Material,
    albedo_uvs: Option<UvSource>,
    emission_uvs: Option<UvSource>,
}

/// Materials in the order of their first use.
pub(super) struct Materials {
    choice: SidednessChoice,
    entries: Vec<Entry>,
    /// From the document's index; `None` is the default material.
    positions: HashMap<Option<usize>, usize>,
    /// The document's indices of images in use; a texture's position is its image's here.
    images: Vec<usize>,
    /// From the document's index.
    textures: HashMap<usize, usize>,
    not_opaque: Vec<String>,
}

impl Materials {
    pub(super) fn new(choice: SidednessChoice) -> Self {
        Self {
            choice,
            entries: Vec::new(),
            positions: HashMap::new(),
            images: Vec::new(),
            textures: HashMap::new(),
            not_opaque: Vec::new(),
        }
    }

    /// The position of a material among those in use.
    pub(super) fn place(&mut self, material: &gltf::Material<'_>) -> usize {
        if let Some(position) = self.positions.get(&material.index()) {
            return *position;
        }
        let entry = self.read(material);
        self.entries.push(entry);
        self.positions.insert(material.index(), self.entries.len() - 1);
        self.entries.len() - 1
    }

    /// Where the coordinates of a material's albedo and emission textures come from; `None` without the texture.
    pub(super) fn uv_sources(&self, position: usize) -> [Option<UvSource>; 2] {
        self.entries.get(position).map_or([None; 2], |entry| [entry.albedo_uvs, entry.emission_uvs])
    }

    /// A material's name.
    pub(super) fn name(&self, position: usize) -> &str {
        self.entries.get(position).map_or("", |entry| &entry.material.name)
    }

    fn read(&mut self, source: &gltf::Material<'_>) -> Entry {
        let name = names::of_material(source);
        if source.alpha_mode() != AlphaMode::Opaque {
            self.not_opaque.push(name.clone());
        }
        let pbr = source.pbr_metallic_roughness();
        let [r, g, b, _] = pbr.base_color_factor();
        let mut albedo = Vec3::new(r, g, b);
        // A factor of 0 leaves nothing of a texture, which then need not be decoded.
        let albedo_texture = pbr.base_color_texture().filter(|_| albedo != Vec3::ZERO);
        if albedo_texture.is_none() {
            // 1 is glTF's default and its upper limit; clamping it is nothing to warn of.
            albedo = albedo.map(|c| if c == 1.0 { MAX_ALBEDO } else { c });
        }
        let emission = Vec3::from(source.emissive_factor()) * source.emissive_strength().unwrap_or(1.0);
        let emission_texture = source.emissive_texture().filter(|_| emission != Vec3::ZERO);
        let single_sided = self.choice == SidednessChoice::AsWritten && !source.double_sided();
        let material = Material {
            name,
            albedo,
            albedo_texture: albedo_texture.as_ref().map(|info| self.texture_use(info)),
            emission,
            emission_texture: emission_texture.as_ref().map(|info| self.texture_use(info)),
            sidedness: if single_sided { Sidedness::Single } else { Sidedness::Double },
        };
        let [albedo_uvs, emission_uvs] = [albedo_texture, emission_texture].map(|info| info.as_ref().map(uv_source));
        Entry { material, albedo_uvs, emission_uvs }
    }

    fn texture_use(&mut self, info: &Info<'_>) -> TextureUse {
        let image = info.texture().source().index();
        let texture = *self.textures.entry(image).or_insert_with(|| {
            self.images.push(image);
            self.images.len() - 1
        });
        let sampler = info.texture().sampler();
        TextureUse { texture, wrap: [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())] }
    }

    /// What is taken for something else.
    pub(super) fn warnings(&self) -> Vec<String> {
        if self.not_opaque.is_empty() {
            return Vec::new();
        }
        let names = names::list(&self.not_opaque);
        vec![format!("materials with alpha mode MASK or BLEND count as opaque: {names}")]
    }

    /// The materials, and the textures that they need.
    pub(super) fn load(
        self,
        document: &Document,
        buffers: &Buffers,
        folder: Option<&Path>,
    ) -> Result<(Vec<Material>, Vec<Texture>)> {
        let views = Views { views: document.views().collect(), buffers, folder };
        let sources: Vec<gltf::Image<'_>> = document.images().collect();
        let json = &document.as_json().images;
        let mut pixels = 0;
        let textures = self.images.iter().map(|i| images::decode(&sources[*i], &json[*i], &views, &mut pixels));
        let textures = textures.collect::<Result<_>>()?;
        Ok((self.entries.into_iter().map(|entry| entry.material).collect(), textures))
    }
}

/// KHR_texture_transform: scale, then rotate, then translate. Counter-clockwise as one sees the image, whose v points
/// down: what Khronos's sample viewer and three.js do, and the opposite sign of the GLSL in the extension's text.
fn uv_source(info: &Info<'_>) -> UvSource {
    let Some(transform) = info.texture_transform() else {
        return UvSource { set: info.tex_coord(), transform: Affine2::IDENTITY };
    };
    let matrix = Mat2::from_angle(-transform.rotation()) * Mat2::from_diagonal(Vec2::from(transform.scale()));
    UvSource {
        set: transform.tex_coord().unwrap_or(info.tex_coord()),
        transform: Affine2::from_mat2_translation(matrix, Vec2::from(transform.offset())),
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
    }
}
