//! A rectangle of its own for each instance.

use super::{AtlasRect, MAX_RESOLUTION, Resolution, areas, mesh_of};
use crate::error::{Error, Result};
use crate::scene::Scene;
use glam::{UVec2, Vec2};
use guillotiere::{SimpleAtlasAllocator, size2};

/// Empty texels on each side of a rectangle, for filters that look one texel past its edge.
const PADDING: u32 = 2;

/// What an instance needs: the box of its light-map coordinates, and texels for a coordinate of 1 at a density of 1.
struct Request {
    uv_min: Vec2,
    uv_size: Vec2,
    scale: f32,
}

/// The map's size and `[instance]` places.
pub(super) fn pack(scene: &Scene, resolution: Resolution) -> Result<(UVec2, Vec<AtlasRect>)> {
    let requests: Vec<Option<Request>> = scene.instances().iter().map(|instance| request(scene, instance)).collect();
    match resolution {
        Resolution::PerUnit(density) => smallest_side(&requests, density),
        Resolution::Texels(side) => largest_density(&requests, side),
    }
}

fn request(scene: &Scene, instance: &crate::scene::Instance) -> Option<Request> {
    let (world, light_map) = areas(scene, instance);
    let uvs = || mesh_of(scene, instance).light_map_uvs().iter().flatten().flatten();
    if light_map == 0.0 {
        return None;
    }
    let uv_min = uvs().fold(Vec2::ONE, |lo, uv| lo.min(*uv));
    let uv_max = uvs().fold(Vec2::ZERO, |hi, uv| hi.max(*uv));
    Some(Request { uv_min, uv_size: uv_max - uv_min, scale: (world / light_map).sqrt() as f32 })
}

/// Places all rectangles at `density` texels a unit; `None` where they do not fit into a square of `side`.
fn place(requests: &[Option<Request>], density: f32, side: u32) -> Option<Vec<AtlasRect>> {
    let texels = |request: &Request| (request.uv_size * request.scale * density).ceil().max(Vec2::ONE);
    let mut order: Vec<usize> = (0..requests.len()).filter(|i| requests[*i].is_some()).collect();
    // Tall ones first; the index keeps equal ones in the scene's order.
    order.sort_by_key(|i| (std::cmp::Reverse(requests[*i].as_ref().map(|r| texels(r).y as u32)), *i));
    let mut rects = vec![AtlasRect { scale: Vec2::ZERO, offset: Vec2::ZERO }; requests.len()];
    let mut allocator = SimpleAtlasAllocator::new(size2(side as i32, side as i32));
    for index in order {
        let Some(request) = &requests[index] else { continue };
        let size = texels(request);
        if size.max_element() > side as f32 {
            return None;
        }
        let padded = size.as_ivec2() + 2 * PADDING as i32;
        let place = allocator.allocate(size2(padded.x, padded.y))?;
        let min = Vec2::new(place.min.x as f32, place.min.y as f32) + PADDING as f32;
        let scale = Vec2::splat(request.scale * density);
        rects[index] = AtlasRect { scale, offset: min - request.uv_min * scale };
    }
    Some(rects)
}

fn smallest_side(requests: &[Option<Request>], density: f32) -> Result<(UVec2, Vec<AtlasRect>)> {
    let area: f32 = requests
        .iter()
        .flatten()
        .map(|r| (r.uv_size * r.scale * density).ceil() + 2.0 * PADDING as f32)
        .map(|s| s.x * s.y)
        .sum();
    let mut side = area.sqrt().ceil().min(MAX_RESOLUTION as f32) as u32;
    loop {
        if let Some(rects) = place(requests, density, side) {
            return Ok((UVec2::splat(side), rects));
        }
        if side == MAX_RESOLUTION {
            return Err(Error::settings(format!(
                "{density} texels per unit need a light map of more than {MAX_RESOLUTION} texels a side"
            )));
        }
        side = (side + side / 16 + 1).min(MAX_RESOLUTION);
    }
}

fn largest_density(requests: &[Option<Request>], side: u32) -> Result<(UVec2, Vec<AtlasRect>)> {
    let largest = requests.iter().flatten().map(|r| r.uv_size.max_element() * r.scale).fold(0.0, f32::max);
    let (mut fits, mut too_dense) = (None, side as f32 / largest);
    let mut lowest = 0.0;
    // 24 halvings find the density to f32 precision.
    for _ in 0..24 {
        let density = 0.5 * (lowest + too_dense);
        match place(requests, density, side) {
            Some(rects) => (lowest, fits) = (density, Some(rects)),
            None => too_dense = density,
        }
    }
    let count = requests.iter().flatten().count();
    let error = || {
        let context = format!("the resolution is {side}, too small for {count} instances that each need a rectangle");
        Error::settings(context)
    };
    Ok((UVec2::splat(side), fits.ok_or_else(error)?))
}
