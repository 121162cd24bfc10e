//! Where each instance lies in the light map.

mod coverage;
mod pack;

use super::{Instance, Mesh, Scene};
use crate::error::{Error, Result};
use coverage::Coverage;
use glam::{UVec2, Vec2};

/// Largest side of a light map, in texels.
pub const MAX_RESOLUTION: u32 = 16384;

/// How large the light map is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resolution {
    /// Side of the square map in texels, 1 to [`MAX_RESOLUTION`].
    Texels(u32),
    /// Texels for one scene unit of length, more than 0; the side follows from it.
    PerUnit(f32),
}

/// An instance's place: texel = light-map coordinate * `scale` + `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtlasRect {
    /// Texels for a light-map coordinate of 1.
    pub scale: Vec2,
    /// Texel of light-map coordinate (0, 0).
    pub offset: Vec2,
}

/// The layout of a light map.
#[derive(Debug, Clone, PartialEq)]
pub struct Atlas {
    /// Width and height in texels.
    pub size: UVec2,
    /// `[instance]`, in the scene's order.
    pub rects: Vec<AtlasRect>,
    /// Whether the instances' own coordinates already made up one atlas, which is then used as it is.
    pub shared: bool,
    /// Texels whose centre a surface covers. The bake also fills those that a surface only touches.
    pub covered_texels: usize,
    /// Texels that a surface covers or touches: about those that are baked.
    pub touched_texels: usize,
    /// Texels whose centre is covered more than once: their light is that of one of the surfaces.
    pub overlapping_texels: usize,
}

/// Instances whose charts cover each other in at most this share of the covered texels count as one shared atlas:
/// rounding at chart borders, not a layout in which instances lie on top of each other.
const SHARED_OVERLAP: f64 = 0.01;

impl Atlas {
    /// Lays out the scene's light map.
    ///
    /// Where all instances already share one atlas without overlap it is used as it is; otherwise each instance gets a
    /// rectangle of its own, its size by world area.
    ///
    /// # Errors
    /// `InvalidSettings` for a resolution outside its range or too small for the number of instances.
    pub fn new(scene: &Scene, resolution: Resolution) -> Result<Self> {
        check(resolution)?;
        let instances = scene.instances();
        let mapped = |instance: &Instance| mesh_of(scene, instance).light_map_uvs().iter().any(Option::is_some);
        let side = match resolution {
            Resolution::Texels(side) => side,
            Resolution::PerUnit(_) if !instances.iter().any(mapped) => 1,
            Resolution::PerUnit(density) => shared_side(scene, density)?,
        };
        let full = AtlasRect { scale: Vec2::splat(side as f32), offset: Vec2::ZERO };
        let (size, rects) = (UVec2::splat(side), vec![full; instances.len()]);
        let coverage = measure(scene, size, &rects, SHARED_OVERLAP);
        if coverage.between_instances as f64 <= SHARED_OVERLAP * coverage.covered as f64 {
            return Ok(Self::laid_out(size, rects, true, &coverage));
        }
        let (size, rects) = pack::pack(scene, resolution)?;
        let coverage = measure(scene, size, &rects, f64::INFINITY);
        Ok(Self::laid_out(size, rects, false, &coverage))
    }

    /// `[texel]`, row-major: whether a surface covers or touches it, but for what rounds the other way.
    pub(crate) fn touched(&self, scene: &Scene) -> Vec<bool> {
        measure(scene, self.size, &self.rects, f64::INFINITY).touched
    }

    fn laid_out(size: UVec2, rects: Vec<AtlasRect>, shared: bool, coverage: &Coverage) -> Self {
        let overlapping_texels = coverage.between_instances + coverage.within_instance;
        Self {
            size,
            rects,
            shared,
            covered_texels: coverage.covered,
            touched_texels: coverage.touched_texels(),
            overlapping_texels,
        }
    }
}

/// Broken off where instances share more than `most` of all texels: a level of thousands that all have the whole map would
/// take minutes to tell.
fn measure(scene: &Scene, size: UVec2, rects: &[AtlasRect], most: f64) -> Coverage {
    let mut coverage = Coverage::new(size);
    let texels = f64::from(size.x) * f64::from(size.y);
    for (index, (instance, rect)) in scene.instances().iter().zip(rects).enumerate() {
        for uvs in mesh_of(scene, instance).light_map_uvs().iter().flatten() {
            coverage.add(index as u32, uvs.map(|uv| uv * rect.scale + rect.offset));
        }
        if coverage.between_instances as f64 > most * texels {
            break;
        }
    }
    coverage
}

fn check(resolution: Resolution) -> Result<()> {
    match resolution {
        Resolution::Texels(side) if !(1..=MAX_RESOLUTION).contains(&side) => {
            Err(Error::settings(format!("the resolution is {side}; allowed is 1 to {MAX_RESOLUTION}")))
        }
        Resolution::PerUnit(density) if !(density > 0.0 && density.is_finite()) => {
            Err(Error::settings(format!("texels per unit is {density}; allowed is a finite number over 0")))
        }
        _ => Ok(()),
    }
}

fn mesh_of<'a>(scene: &'a Scene, instance: &Instance) -> &'a Mesh {
    &scene.meshes()[instance.mesh]
}

/// World area and light-map area (unit square = 1) of an instance's mapped triangles.
fn areas(scene: &Scene, instance: &Instance) -> (f64, f64) {
    let mesh = mesh_of(scene, instance);
    let mut total = (0.0, 0.0);
    for (positions, uvs) in mesh.positions().iter().zip(mesh.light_map_uvs()) {
        let Some(uvs) = uvs else { continue };
        let [a, b, c] = positions.map(|p| instance.transform.transform_point3(p.as_dvec3()));
        let [ua, ub, uc] = uvs.map(|uv| uv.as_dvec2());
        total.0 += 0.5 * (b - a).cross(c - a).length();
        total.1 += 0.5 * (ub - ua).perp_dot(uc - ua).abs();
    }
    total
}

/// Side of a shared atlas that has `density` texels for a scene unit on average.
fn shared_side(scene: &Scene, density: f32) -> Result<u32> {
    let (world, light_map) = scene
        .instances()
        .iter()
        .map(|instance| areas(scene, instance))
        .fold((0.0, 0.0), |sum, a| (sum.0 + a.0, sum.1 + a.1));
    let side = (f64::from(density) * (world / light_map).sqrt()).ceil();
    if side <= f64::from(MAX_RESOLUTION) {
        return Ok(side.max(1.0) as u32);
    }
    Err(Error::settings(format!(
        "{density} texels per unit need a light map of {side:.0} texels a side; allowed is at most {MAX_RESOLUTION}"
    )))
}
