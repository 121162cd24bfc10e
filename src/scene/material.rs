//! Materials and textures.

use super::{MAX_ALBEDO, check_light_quantity};
use crate::error::{Error, Result};
use glam::Vec3;

/// Whether a surface answers when seen from behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Sidedness {
    /// Seen from behind it blocks light and is black.
    #[default]
    Single,
    /// Both sides show the same light.
    Double,
}

/// What lies beyond a texture's edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture again, every other one mirrored.
    MirroredRepeat,
    /// The edge's colour.
    ClampToEdge,
}

/// A texture as a material uses it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TextureUse {
    /// Position in the scene's list.
    pub texture: usize,
    /// Beyond the edge, horizontally and vertically.
    pub wrap: [Wrap; 2],
}

/// An image with sRGB encoding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    /// Shown in messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// `[pixel]`, row-major from the top, sRGB-encoded; alpha is not used.
    pub pixels: Vec<[u8; 4]>,
}

/// A diffuse, possibly emissive surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Material {
    /// Shown in messages.
    pub name: String,
    /// Diffuse albedo, linear Rec. 709, at least 0. Over [`MAX_ALBEDO`], or no number, it is clamped with a warning; before a
    /// texture up to 1 without one.
    pub albedo: Vec3,
    /// Multiplied with `albedo`.
    pub albedo_texture: Option<TextureUse>,
    /// Emitted radiance, linear Rec. 709, at least 0.
    pub emission: Vec3,
    /// Multiplied with `emission`.
    pub emission_texture: Option<TextureUse>,
    /// Whether it answers when seen from behind.
    pub sidedness: Sidedness,
}

impl Material {
    /// Whether any part of it shines.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }

    /// Through a texture that is black all over nothing shines, and nothing is reflected: exporters write such, with a factor
    /// of 1. `black`: which textures are.
    pub(super) fn heed_black_textures(&mut self, black: &[bool]) {
        if self.albedo_texture.is_some_and(|usage| black[usage.texture]) {
            self.albedo = Vec3::ZERO;
        }
        if self.emission_texture.is_some_and(|usage| black[usage.texture]) {
            self.emission = Vec3::ZERO;
        }
    }

    pub(super) fn check(&mut self, texture_count: usize, warnings: &mut Vec<String>) -> Result<()> {
        let name = &self.name;
        check_light_quantity(|| format!("the emission of material '{name}'"), self.emission)?;
        for texture in [self.albedo_texture, self.emission_texture].into_iter().flatten() {
            let index = texture.texture;
            if index >= texture_count {
                return Err(Error::scene(format!(
                    "material '{name}' refers to texture {index}; the scene has {texture_count}"
                )));
            }
        }
        let albedo = self.albedo;
        if albedo.cmplt(Vec3::ZERO).any() {
            return Err(Error::scene(format!("the albedo of material '{name}' is {albedo}; allowed is at least 0")));
        }
        self.albedo = albedo.map(|c| if c <= MAX_ALBEDO { c } else { MAX_ALBEDO });
        // A white texture's factor of 1 is glTF's default and nothing to warn of: the product is clamped on the device.
        let most = if self.albedo_texture.is_some() { 1.0 } else { MAX_ALBEDO };
        if !albedo.cmple(Vec3::splat(most)).all() {
            warnings.push(format!("the albedo of material '{name}', {albedo}, is clamped to {MAX_ALBEDO}"));
        }
        Ok(())
    }
}

impl Texture {
    pub(super) fn is_black(&self) -> bool {
        self.pixels.iter().all(|[red, green, blue, _]| red | green | blue == 0)
    }

    pub(super) fn check(&self) -> Result<()> {
        let Self { name, width, height, pixels } = self;
        let expected = *width as usize * *height as usize;
        if expected > 0 && pixels.len() == expected {
            return Ok(());
        }
        let found = pixels.len();
        Err(Error::scene(format!(
            "texture '{name}' is {width} x {height} with {found} pixels; allowed is width x height of them, at least 1"
        )))
    }
}

impl Texture {
    /// The linear colour of the pixel at a texture coordinate.
    pub(crate) fn linear(&self, wrap: [Wrap; 2], uv: glam::Vec2) -> Vec3 {
        let x = wrap[0].pixel(uv.x, self.width);
        let y = wrap[1].pixel(uv.y, self.height);
        let [r, g, b, _] = self.pixels[y * self.width as usize + x];
        Vec3::new(linear_of_srgb(r), linear_of_srgb(g), linear_of_srgb(b))
    }
}

impl Wrap {
    fn pixel(self, coordinate: f32, size: u32) -> usize {
        let inside = match self {
            Self::Repeat => coordinate.rem_euclid(1.0),
            Self::MirroredRepeat => 1.0 - (coordinate.rem_euclid(2.0) - 1.0).abs(),
            Self::ClampToEdge => coordinate,
        };
        (inside * size as f32).clamp(0.0, size as f32 - 1.0) as usize
    }
}

fn linear_of_srgb(value: u8) -> f32 {
    decode_srgb(f32::from(value) / 255.0)
}

/// The linear value of an sRGB-encoded one of at least 0 (IEC 61966-2-1, its curve continued above 1).
pub(crate) fn decode_srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
