//! What lies in a texel beside the primitive that the g-buffer has there: a lamp's chart may be smaller than a texel and
//! share it with another's. Rays are aimed at all of them, for all answer with that texel's radiance; in a dynamic scene with
//! that and their own emission. What is dark at first is found by chance when it shines later.

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
const MOST: usize = 15;

/// Texels with more than one piece, on the device.
pub(crate) struct Pieces {
    /// `[texel]`: 0, or number << 24 | first.
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
            for index in range.first_primitive..range.first_primitive + range.count {
                let primitive = &device_scene.host_primitives[index as usize];
                if primitive.flags & Primitive::MAPPED != 0 {
                    let corners =
                        primitive.uvs.map(|[u, v]| Vec2::new(u * atlas[0] + atlas[2], v * atlas[1] + atlas[3]));
                    let piece = layout::Piece { instance: instance as u32, primitive: index };
                    collect(device_scene, size, surfaces, corners, piece, &mut found);
                }
            }
        }
        found.sort_unstable_by_key(|(texel, piece)| (*texel, piece.instance, piece.primitive));
        Self::upload(commands, device_scene, size, &found)
    }

    /// `found`: by texel.
    fn upload(
        commands: &mut Commands,
        device_scene: &DeviceScene,
        size: [u32; 2],
        found: &[(usize, layout::Piece)],
    ) -> Result<Self> {
        let size = if found.is_empty() { [1, 1] } else { size };
        let mut codes = vec![0_u32; size[0] as usize * size[1] as usize];
        let mut list: Vec<layout::Piece> = Vec::new();
        let mut shared_texels = 0;
        for of_texel in found.chunk_by(|(one, _), (other, _)| one == other) {
            let first = list.len();
            if first >= 1 << FIRST_BITS {
                break;
            }
            for (_, piece) in of_texel {
                let known = list[first..].iter().any(|other| device_scene.same_sheet(*other, *piece));
                if !known && list.len() - first < MOST {
                    list.push(*piece);
                }
            }
            codes[of_texel[0].0] = ((list.len() - first) as u32) << FIRST_BITS | first as u32;
            shared_texels += 1;
        }
        let (format, usage) = (PIECES, vk::ImageUsageFlags::STORAGE);
        let desc = ImageDesc { name: "pieces map", size, format, usage, mip_levels: 1 };
        let codes = commands.upload_image(desc, &codes)?;
        let bytes = size_of_val(list.as_slice()) as u64;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let list =
            commands.upload(BufferDesc { name: "pieces", size: bytes, usage, location: Location::Device }, &list)?;
        Ok(Self { codes, list, shared_texels })
    }
}

/// Adds the texels in which a primitive lies and is not what the g-buffer has.
fn collect(
    device_scene: &DeviceScene,
    [width, height]: [u32; 2],
    surfaces: &[[u32; 4]],
    corners: [Vec2; 3],
    piece: layout::Piece,
    found: &mut Vec<(usize, layout::Piece)>,
) {
    let emits = device_scene.emits(piece.primitive);
    let lo = corners[0].min(corners[1]).min(corners[2]).max(Vec2::ZERO).as_uvec2();
    let hi = corners[0].max(corners[1]).max(corners[2]).max(Vec2::ZERO).as_uvec2();
    for y in lo.y..=hi.y.min(height - 1) {
        for x in lo.x..=hi.x.min(width - 1) {
            let texel = y as usize * width as usize + x as usize;
            let [owner, primitive, ..] = surfaces[texel];
            let Some(instance) = owner.checked_sub(1) else { continue };
            let owner = layout::Piece { instance, primitive };
            let matters = emits || device_scene.emits(primitive);
            if matters
                && !device_scene.same_sheet(owner, piece)
                && area_within(corners, Vec2::new(x as f32, y as f32)) > LEAST_AREA
            {
                found.push((texel, piece));
            }
        }
    }
}

/// Area of a triangle within the unit square at `corner`: clipped side by side (Sutherland and Hodgman).
fn area_within(triangle: [Vec2; 3], corner: Vec2) -> f32 {
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
    let crosses = (0..polygon.len()).map(|i| polygon[i].perp_dot(polygon[(i + 1) % polygon.len()]));
    0.5 * crosses.sum::<f32>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_clipped_at_texels() {
        let triangle = [Vec2::new(0.0, 0.0), Vec2::new(2.0, 0.0), Vec2::new(0.0, 2.0)];
        let area = |x, y| area_within(triangle, Vec2::new(x, y));
        assert_eq!([area(0.0, 0.0), area(1.0, 0.0), area(0.0, 1.0)], [1.0, 0.5, 0.5]);
        assert_eq!([area(1.0, 1.0), area(-1.0, 0.0), area(5.0, 5.0)], [0.0; 3]);
        let within = [Vec2::new(3.25, 3.25), Vec2::new(3.75, 3.25), Vec2::new(3.25, 3.75)];
        assert_eq!(area_within(within, Vec2::splat(3.0)), 0.125);
    }
}
