//! What lies in a texel, where that is more than one primitive: a lamp's chart may be smaller than a texel and share it with
//! another's, or a texel hold several triangles of one lamp. Rays are aimed at all of them, for all answer with that texel's
//! radiance; in a dynamic scene with that and their own emission. What is dark at first is found by chance when it shines
//! later.

use super::maps::PIECES;
use super::scene::DeviceScene;
use crate::bvh::Bvh;
use crate::error::Result;
use crate::gpu::layout::{self, Primitive};
use crate::gpu::{Buffer, BufferDesc, Commands, Image, ImageDesc, Location};
use crate::scene::Scene;
use ash::vk;
use glam::Vec2;

/// Less of a triangle than this is not aimed at, square texels.
const LEAST_AREA: f32 = 1e-3;
/// Bits of a code that say where in the list a texel's pieces begin; above them, how many there are.
const FIRST_BITS: u32 = 24;
/// Pieces of a texel, at most; a texel of more is a heap of slivers.
const MOST: usize = 16;

/// Texels with more than one piece, on the device.
pub(crate) struct Pieces {
    /// `[texel]`: 0, where there is only what the g-buffer has, or number << 24 | first.
    pub(crate) codes: Image,
    pub(crate) list: Buffer,
    /// Texels that have any.
    pub(crate) shared_texels: u64,
}

impl Pieces {
    /// `surfaces`: the g-buffer's. Only texels are looked at in which something emits.
    pub(crate) fn new(
        commands: &mut Commands,
        scene: &Scene,
        bvh: &Bvh,
        device_scene: &DeviceScene,
        size: [u32; 2],
        surfaces: &[[u32; 4]],
    ) -> Result<Self> {
        let mut found = Vec::new();
        let any_emits = device_scene.radiators.materials.iter().any(|material| material.emission != [0.0; 3]);
        for (instance, placed) in scene.instances().iter().enumerate().filter(|_| any_emits) {
            let range = &bvh.meshes[placed.mesh];
            let atlas = bvh.instances[instance].atlas;
            for primitive in range.first_primitive..range.first_primitive + range.count {
                let encoded = &device_scene.host_primitives[primitive as usize];
                if encoded.flags & Primitive::MAPPED != 0 {
                    let corners = encoded.uvs.map(|[u, v]| Vec2::new(u * atlas[0] + atlas[2], v * atlas[1] + atlas[3]));
                    collect(device_scene, size, surfaces, corners, (instance as u32, primitive), &mut found);
                }
            }
        }
        found.sort_unstable_by_key(|part| (part.texel, part.instance, part.primitive));
        let mut shared: Vec<(usize, Vec<layout::Piece>)> = Vec::new();
        for parts in found.chunk_by(|one, other| one.texel == other.texel) {
            let [owner, primitive, ..] = surfaces[parts[0].texel];
            let owner = layout::Piece { instance: owner - 1, primitive, lo: 0, hi: 0 };
            if parts.iter().any(|part| part.primitive != primitive || part.instance != owner.instance) {
                shared.push((parts[0].texel, pieces_of(device_scene, owner, parts)));
            }
        }
        Self::upload(commands, size, &shared)
    }

    /// `shared`: texels with their pieces.
    fn upload(commands: &mut Commands, size: [u32; 2], shared: &[(usize, Vec<layout::Piece>)]) -> Result<Self> {
        let size = if shared.is_empty() { [1, 1] } else { size };
        let mut codes = vec![0_u32; size[0] as usize * size[1] as usize];
        let mut list: Vec<layout::Piece> = Vec::new();
        for (texel, pieces) in shared {
            if list.len() >= 1 << FIRST_BITS {
                break;
            }
            codes[*texel] = (pieces.len() as u32) << FIRST_BITS | list.len() as u32;
            list.extend(pieces);
        }
        let (format, usage) = (PIECES, vk::ImageUsageFlags::STORAGE);
        let desc = ImageDesc { name: "pieces map", size, format, usage, mip_levels: 1 };
        let codes = commands.upload_image(desc, &codes)?;
        let bytes = size_of_val(list.as_slice()) as u64;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let list =
            commands.upload(BufferDesc { name: "pieces", size: bytes, usage, location: Location::Device }, &list)?;
        Ok(Self { codes, list, shared_texels: shared.len() as u64 })
    }
}

/// A primitive's part of a texel.
struct Part {
    texel: usize,
    instance: u32,
    primitive: u32,
    /// From the texel's corner.
    lo: Vec2,
    hi: Vec2,
}

/// Adds the texels in which a primitive lies, where it or what the g-buffer has there emits.
fn collect(
    device_scene: &DeviceScene,
    [width, height]: [u32; 2],
    surfaces: &[[u32; 4]],
    corners: [Vec2; 3],
    (instance, primitive): (u32, u32),
    found: &mut Vec<Part>,
) {
    let emits = device_scene.emits(primitive);
    let lo = corners[0].min(corners[1]).min(corners[2]).max(Vec2::ZERO).as_uvec2();
    let hi = corners[0].max(corners[1]).max(corners[2]).max(Vec2::ZERO).as_uvec2();
    for y in lo.y..=hi.y.min(height - 1) {
        for x in lo.x..=hi.x.min(width - 1) {
            let texel = y as usize * width as usize + x as usize;
            if surfaces[texel][0] == 0 || !(emits || device_scene.emits(surfaces[texel][1])) {
                continue;
            }
            let polygon = clip(corners, Vec2::new(x as f32, y as f32));
            if area_of(&polygon) > LEAST_AREA {
                let bounds = (Vec2::INFINITY, Vec2::NEG_INFINITY);
                let (lo, hi) = polygon.iter().fold(bounds, |(lo, hi), point| (lo.min(*point), hi.max(*point)));
                found.push(Part { texel, instance, primitive, lo, hi });
            }
        }
    }
}

/// A texel's sheets, the g-buffer's first, each with the bounds of all its parts.
fn pieces_of(device_scene: &DeviceScene, owner: layout::Piece, parts: &[Part]) -> Vec<layout::Piece> {
    let mut sheets: Vec<(layout::Piece, Vec2, Vec2)> = vec![(owner, Vec2::INFINITY, Vec2::NEG_INFINITY)];
    for part in parts {
        let piece = layout::Piece { instance: part.instance, primitive: part.primitive, lo: 0, hi: 0 };
        if let Some((_, lo, hi)) = sheets.iter_mut().find(|(known, ..)| device_scene.same_sheet(*known, piece)) {
            (*lo, *hi) = (lo.min(part.lo), hi.max(part.hi));
        } else if sheets.len() < MOST {
            sheets.push((piece, part.lo, part.hi));
        }
    }
    let bounded = |(piece, lo, hi): (layout::Piece, Vec2, Vec2)| {
        let [lo, hi] = bounds(lo, hi);
        layout::Piece { lo, hi, ..piece }
    };
    sheets.into_iter().map(bounded).collect()
}

/// As two unorm16 each, rounded outward; 0 where nothing is known.
fn bounds(lo: Vec2, hi: Vec2) -> [u32; 2] {
    const STEPS: f32 = 65535.0;
    let pack = |corner: Vec2| {
        let [x, y] = corner.clamp(Vec2::ZERO, Vec2::splat(STEPS)).to_array().map(|side| side as u32);
        x | y << 16
    };
    // What rounding has added to a side that is a step's is no more than a hundredth of one.
    let [lo, hi] = [(lo * STEPS + 0.01).floor(), (hi * STEPS - 0.01).ceil()];
    if lo.cmplt(hi).all() { [pack(lo), pack(hi)] } else { [0, 0] }
}

/// A triangle's part of the unit square at `corner`, from there: clipped side by side (Sutherland and Hodgman).
fn clip(triangle: [Vec2; 3], corner: Vec2) -> Vec<Vec2> {
    let mut polygon: Vec<Vec2> = triangle.map(|p| p - corner).to_vec();
    for (normal, offset) in [(Vec2::X, 0.0), (Vec2::NEG_X, 1.0), (Vec2::Y, 0.0), (Vec2::NEG_Y, 1.0)] {
        let inside = |p: Vec2| p.dot(normal) + offset;
        let mut clipped = Vec::with_capacity(polygon.len() + 1);
        for (index, p) in polygon.iter().enumerate() {
            let next = polygon[(index + 1) % polygon.len()];
            let (here, there) = (inside(*p), inside(next));
            if here >= 0.0 {
                clipped.push(*p);
            }
            if (here >= 0.0) != (there >= 0.0) {
                clipped.push(p.lerp(next, here / (here - there)));
            }
        }
        polygon = clipped;
    }
    polygon
}

fn area_of(polygon: &[Vec2]) -> f32 {
    let crosses = (0..polygon.len()).map(|i| polygon[i].perp_dot(polygon[(i + 1) % polygon.len()]));
    0.5 * crosses.sum::<f32>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_clipped_at_texels() {
        let triangle = [Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), Vec2::new(0.0, 2.0)];
        let area = |x, y| area_of(&clip(triangle, Vec2::new(x, y)));
        assert_eq!([area(0.0, 0.0), area(1.0, 0.0), area(0.0, 1.0)], [1.0, 0.5, 0.5]);
        assert_eq!([area(1.0, 1.0), area(-1.0, 0.0), area(5.0, 5.0)], [0.0; 3]);
        let within = [Vec2::new(3.25, 3.25), Vec2::new(3.75, 3.25), Vec2::new(3.25, 3.75)];
        assert_eq!(area_of(&clip(within, Vec2::splat(3.0))), 0.125);
    }

    #[test]
    fn bounds_are_rounded_outward() {
        assert_eq!(bounds(Vec2::ZERO, Vec2::ONE), [0, 0xffff_ffff]);
        assert_eq!(bounds(Vec2::splat(0.5), Vec2::new(0.6, 1.0)), [0x7fff_7fff, 0xffff_9999]);
        assert_eq!(bounds(Vec2::INFINITY, Vec2::NEG_INFINITY), [0, 0]);
    }
}
