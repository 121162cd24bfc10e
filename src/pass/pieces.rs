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
use glam::{DVec2, Vec2};
use std::sync::Arc;

/// Less of a triangle than this is not aimed at, square texels.
const LEAST_AREA: f32 = 1e-3;
/// Bits of a code that say where in the list a texel's pieces begin; above them, how many there are.
const FIRST_BITS: u32 = 24;
/// Pieces of a texel, at most; a texel of more is a heap of slivers.
const MOST: usize = 16;

/// Texels with more than one piece, on the device.
pub(crate) struct Pieces {
    /// `[texel]`: 0, where there is only what the g-buffer has, or number << 24 | first.
    pub(crate) codes: Arc<Image>,
    pub(crate) list: Arc<Buffer>,
}

impl Pieces {
    /// `surfaces`: the g-buffer's. Only texels are looked at in which something emits; `None`: there is no such texel.
    pub(crate) fn new(
        commands: &mut Commands,
        scene: &Scene,
        bvh: &Bvh,
        device_scene: &DeviceScene,
        size: [u32; 2],
        surfaces: &[[u32; 4]],
    ) -> Result<Option<Self>> {
        let look = Look { scene, bvh, device_scene, size, surfaces };
        let any_emits = device_scene.radiators.materials.iter().any(|material| material.emission != [0.0; 3]);
        if !any_emits {
            return Ok(None);
        }
        // Most texels hold their owner alone: what lies in the others is listed, and only there.
        let mut touched = vec![false; surfaces.len()];
        look.for_each(|chart, texel| touched[texel] |= look.owner(texel) != chart.owned());
        let mut found = Vec::new();
        let mut clipper = Clipper::default();
        look.for_each(|chart, texel| {
            found.extend(touched[texel].then(|| look.part(chart, texel, &mut clipper)).flatten())
        });
        found.sort_unstable_by_key(|part| (part.texel, part.instance, part.primitive));
        let (mut codes, mut list) = (Vec::new(), Vec::new());
        for parts in found.chunk_by(|one, other| one.texel == other.texel) {
            let owner = look.owner(parts[0].texel);
            let is_shared =
                parts.iter().any(|part| (part.instance, part.primitive) != (owner.instance, owner.primitive));
            if is_shared && list.len() < 1 << FIRST_BITS {
                let first = list.len();
                list.extend(pieces_of(device_scene, owner, parts));
                codes.push((parts[0].texel, ((list.len() - first) as u32) << FIRST_BITS | first as u32));
            }
        }
        if codes.is_empty() {
            return Ok(None);
        }
        Self::upload(commands, size, &codes, &list).map(Some)
    }

    /// `shared`: texels with their codes.
    fn upload(
        commands: &mut Commands,
        size: [u32; 2],
        shared: &[(usize, u32)],
        list: &[layout::Piece],
    ) -> Result<Self> {
        let codes = Self::upload_codes(commands, size, shared)?;
        let (bytes, usage) = (size_of_val(list) as u64, vk::BufferUsageFlags::STORAGE_BUFFER);
        let desc = BufferDesc { name: "pieces", size: bytes, usage, location: Location::Device };
        let list = Arc::new(commands.upload(desc, list)?);
        Ok(Self { codes, list })
    }

    fn upload_codes(commands: &mut Commands, size: [u32; 2], shared: &[(usize, u32)]) -> Result<Arc<Image>> {
        let mut codes = vec![0_u32; size[0] as usize * size[1] as usize];
        shared.iter().for_each(|(texel, code)| codes[*texel] = *code);
        let (format, usage) = (PIECES, vk::ImageUsageFlags::STORAGE);
        let desc = ImageDesc { name: "pieces map", size, format, usage, mip_levels: 1 };
        commands.upload_image(desc, &codes).map(Arc::new)
    }

    /// The codes of a map in which no texel is shared: that the feature is on all the same.
    pub(crate) fn codes_of_none(commands: &mut Commands, size: [u32; 2]) -> Result<Arc<Image>> {
        Self::upload_codes(commands, size, &[])
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

/// Where a primitive of an instance lies in the light map.
struct Chart {
    instance: u32,
    primitive: u32,
    /// Texels.
    corners: [Vec2; 3],
}

impl Chart {
    fn owned(&self) -> layout::Piece {
        layout::Piece { instance: self.instance, primitive: self.primitive, lo: 0, hi: 0 }
    }
}

/// What is looked through.
struct Look<'a> {
    scene: &'a Scene,
    bvh: &'a Bvh,
    device_scene: &'a DeviceScene,
    size: [u32; 2],
    surfaces: &'a [[u32; 4]],
}

impl Look<'_> {
    /// What the g-buffer has in a texel on a surface.
    fn owner(&self, texel: usize) -> layout::Piece {
        let [owner, primitive, ..] = self.surfaces[texel];
        layout::Piece { instance: owner - 1, primitive, lo: 0, hi: 0 }
    }

    /// Every texel on a surface that a chart touches, where it or what the g-buffer has there emits; and some beside it.
    fn for_each(&self, mut visit: impl FnMut(&Chart, usize)) {
        for (instance, placed) in self.scene.instances().iter().enumerate() {
            let range = &self.bvh.meshes[placed.mesh];
            let atlas = self.bvh.instances[instance].atlas;
            for primitive in range.first_primitive..range.first_primitive + range.count {
                let encoded = &self.device_scene.host_primitives[primitive as usize];
                if encoded.flags & Primitive::MAPPED == 0 {
                    continue;
                }
                let corners = encoded.uvs.map(|[u, v]| Vec2::new(u * atlas[0] + atlas[2], v * atlas[1] + atlas[3]));
                let chart = Chart { instance: instance as u32, primitive, corners };
                let emits = self.device_scene.emits(primitive);
                for texel in texels_of(corners, self.size) {
                    let [owner, owning, ..] = self.surfaces[texel];
                    if owner != 0 && (emits || self.device_scene.emits(owning)) {
                        visit(&chart, texel);
                    }
                }
            }
        }
    }

    /// `None` where it is next to nothing.
    fn part(&self, chart: &Chart, texel: usize, clipper: &mut Clipper) -> Option<Part> {
        let width = self.size[0] as usize;
        let polygon = clipper.clip(chart.corners, Vec2::new((texel % width) as f32, (texel / width) as f32));
        let bounds = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let (lo, hi) = polygon.iter().fold(bounds, |(lo, hi), point| (lo.min(*point), hi.max(*point)));
        let Chart { instance, primitive, .. } = *chart;
        (area_of(polygon) > LEAST_AREA).then_some(Part { texel, instance, primitive, lo, hi })
    }
}

/// Far beyond what clipping rounds, texels: none that it finds a part in is left out.
const SLACK: f64 = 1.0 / 16.0;

/// Texels that a triangle touches, row by row, and some beside it.
fn texels_of(corners: [Vec2; 3], [width, height]: [u32; 2]) -> impl Iterator<Item = usize> {
    let lo = corners[0].min(corners[1]).min(corners[2]).max(Vec2::ZERO).as_uvec2();
    let hi = corners[0].max(corners[1]).max(corners[2]).max(Vec2::ZERO).as_uvec2();
    let corners = corners.map(Vec2::as_dvec2);
    (lo.y..=hi.y.min(height - 1)).flat_map(move |y| {
        let (left, right) = extent(corners, f64::from(y) - SLACK, f64::from(y) + 1.0 + SLACK);
        let row = y as usize * width as usize;
        let (first, last) = (lo.x.max((left - SLACK) as u32), hi.x.min(width - 1).min((right + SLACK) as u32));
        (first..=last).map(move |x| row + x as usize)
    })
}

/// How far a triangle reaches along x between two heights; infinity and its negative where it does not lie there.
fn extent(corners: [DVec2; 3], lowest: f64, highest: f64) -> (f64, f64) {
    let mut reach = (f64::INFINITY, f64::NEG_INFINITY);
    let mut add = |x: f64| reach = (reach.0.min(x), reach.1.max(x));
    for (index, a) in corners.iter().enumerate() {
        let b = corners[(index + 1) % 3];
        if (lowest..=highest).contains(&a.y) {
            add(a.x);
        }
        for height in [lowest, highest] {
            if (a.y < height) != (b.y < height) {
                add(a.x + (b.x - a.x) * (height - a.y) / (b.y - a.y));
            }
        }
    }
    reach
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

/// Clips triangles; keeps its memory.
#[derive(Default)]
struct Clipper {
    polygon: Vec<Vec2>,
    clipped: Vec<Vec2>,
}

impl Clipper {
    /// A triangle's part of the unit square at `corner`, from there: clipped side by side (Sutherland and Hodgman).
    fn clip(&mut self, triangle: [Vec2; 3], corner: Vec2) -> &[Vec2] {
        let Self { polygon, clipped } = self;
        polygon.clear();
        polygon.extend(triangle.map(|p| p - corner));
        for (normal, offset) in [(Vec2::X, 0.0), (Vec2::NEG_X, 1.0), (Vec2::Y, 0.0), (Vec2::NEG_Y, 1.0)] {
            let inside = |p: Vec2| p.dot(normal) + offset;
            clipped.clear();
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
            std::mem::swap(polygon, clipped);
        }
        polygon
    }
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
        let mut clipper = Clipper::default();
        let mut area = |x, y| area_of(clipper.clip(triangle, Vec2::new(x, y)));
        assert_eq!([area(0.0, 0.0), area(1.0, 0.0), area(0.0, 1.0)], [1.0, 0.5, 0.5]);
        assert_eq!([area(1.0, 1.0), area(-1.0, 0.0), area(5.0, 5.0)], [0.0; 3]);
        let within = [Vec2::new(3.25, 3.25), Vec2::new(3.75, 3.25), Vec2::new(3.25, 3.75)];
        assert_eq!(area_of(clipper.clip(within, Vec2::splat(3.0))), 0.125);
    }

    /// Every texel with a part, and none far from the triangle.
    #[test]
    fn rows_hold_what_is_clipped() {
        let size = [32, 24];
        let mut clipper = Clipper::default();
        let mut next = random();
        for _ in 0..500 {
            let triangle = [(); 3].map(|()| Vec2::new(40.0 * next() - 4.0, 32.0 * next() - 4.0));
            let found: Vec<usize> = texels_of(triangle, size).collect();
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
            for texel in 0..32 * 24 {
                let corner = Vec2::new((texel % 32) as f32, (texel / 32) as f32);
                let area = area_of(clipper.clip(triangle, corner));
                assert!(area <= LEAST_AREA || found.contains(&texel), "{triangle:?}, {corner}: {area}");
            }
        }
        assert_eq!(texels_of([Vec2::ZERO, Vec2::new(30.0, 0.0), Vec2::new(0.0, 0.5)], size).count(), 31);
    }

    /// Numbers from 0 to 1 (Knuth's MMIX generator).
    fn random() -> impl FnMut() -> f32 {
        let mut state = 7_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        }
    }

    #[test]
    fn bounds_are_rounded_outward() {
        assert_eq!(bounds(Vec2::ZERO, Vec2::ONE), [0, 0xffff_ffff]);
        assert_eq!(bounds(Vec2::splat(0.5), Vec2::new(0.6, 1.0)), [0x7fff_7fff, 0xffff_9999]);
        assert_eq!(bounds(Vec2::INFINITY, Vec2::NEG_INFINITY), [0, 0]);
    }
}
