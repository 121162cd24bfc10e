//! Extreme case 19: what is beyond a limit is an error that says so, and nothing is dropped in silence.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Stop, estimate_memory};
use crate::bvh::{Bvh, Ray};
use crate::error::{ErrorKind, Result};
use crate::gpu::{Buffer, BufferDesc, Gpu, Image, ImageDesc, Location};
use crate::scene::atlas::MAX_RESOLUTION;
use crate::scene::{Atlas, MeshPart, Resolution, Scene};
use crate::tracer::Tracer;
use crate::verify::stage::{Chart, Facing, Stage, level_square};
use ash::vk;
use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::ops::ControlFlow;

pub(super) const CASES: [Case; 4] = [
    Case::extreme(19, "buffers and images beyond the device's limits", too_large_for_the_device),
    Case::extreme(19, "map beyond the device's memory", too_large_for_the_memory),
    Case::extreme(19, "settings and scenes beyond their limits", beyond_limits),
    Case::extreme(19, "hierarchy that would be deep", deep_hierarchy),
];

fn too_large_for_the_device(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let limit = gpu.info().max_storage_buffer_bytes;
    let (size, usage) = (limit.saturating_add(1), vk::BufferUsageFlags::STORAGE_BUFFER);
    let buffer = Buffer::new(gpu, BufferDesc { name: "all", size, usage, location: Location::Device });
    let words = ["buffer 'all'", &size.to_string(), &limit.to_string()];
    checks.refused("a buffer", &buffer, ErrorKind::OutOfMemory, &words);
    let limit = gpu.info().max_image_side;
    let (format, usage) = (vk::Format::R32_UINT, vk::ImageUsageFlags::STORAGE);
    let size = [8, limit + 1];
    let image = Image::new(gpu, ImageDesc { name: "all", size, format, usage, mip_levels: 1 });
    let words = ["image 'all'", &size[1].to_string(), &limit.to_string()];
    checks.refused("an image", &image, ErrorKind::InvalidSettings, &words);
    Ok(())
}

/// A level square with this chart, under a sky.
fn square(chart: Chart, transform: DAffine3) -> Result<Scene> {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.sky(1.0);
    stage.place(&[level_square(1.0, 0.0, Facing::Up, chart, 0)], transform);
    stage.build()
}

/// Said before anything is allocated.
fn too_large_for_the_memory(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = square(Chart::at([0, 0], 2).on(MAX_RESOLUTION), DAffine3::IDENTITY)?;
    let settings = BakeSettings { resolution: Resolution::Texels(MAX_RESOLUTION), ..BakeSettings::default() };
    let (needs, has) = (estimate_memory(&scene, &settings)?.1.most(), gpu.info().device_memory_bytes);
    if needs <= has {
        checks.skip(format!("the device has {has} bytes, and the largest map needs {needs}"));
        return Ok(());
    }
    let words = ["light map of 16384 x 16384", &needs.to_string(), &has.to_string()];
    checks.refused("the largest map", &Baker::new(gpu, &scene, &settings), ErrorKind::OutOfMemory, &words);
    Ok(())
}

fn beyond_limits(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = square(Chart::at([0, 0], 2), DAffine3::IDENTITY)?;
    let with = |resolution| Baker::new(gpu, &scene, &BakeSettings { resolution, ..BakeSettings::default() });
    for side in [0, MAX_RESOLUTION + 1, u32::MAX] {
        let words = [&side.to_string()[..], "1 to 16384"];
        checks.refused(format!("{side} texels"), &with(Resolution::Texels(side)), ErrorKind::InvalidSettings, &words);
    }
    for density in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e9] {
        let what = format!("{density} texels a unit");
        checks.refused(what, &with(Resolution::PerUnit(density)), ErrorKind::InvalidSettings, &["texels per unit"]);
    }
    let mut baker = with(Resolution::Texels(8))?;
    let none = Stop::default();
    for (what, stop) in [
        ("no sample", Stop { samples: Some(0), ..none }),
        ("2^32 - 1 samples", Stop { samples: Some(u32::MAX), ..none }),
        ("an error of 0", Stop { error: Some(0.0), ..none }),
        ("an error that is none", Stop { error: Some(f32::NAN), ..none }),
    ] {
        let outcome = baker.bake(&stop, &mut |_| ControlFlow::Break(()));
        checks.refused(what, &outcome, ErrorKind::InvalidSettings, &["allowed is"]);
    }
    let tiny = square(Chart::at([0, 0], 2), DAffine3::from_scale(DVec3::splat(1e-13)))?;
    let baker = Baker::new(gpu, &tiny, &BakeSettings::default());
    checks.refused("a scene too small", &baker, ErrorKind::InvalidScene, &["scene 'stage'", "1e-12"]);
    let huge = square(Chart::at([0, 0], 2), DAffine3::from_scale(DVec3::splat(1e13)))?;
    let baker = Baker::new(gpu, &huge, &BakeSettings::default());
    checks.refused("a mesh too far out", &baker, ErrorKind::InvalidScene, &["mesh 'mesh 0'", "1e10"]);
    Ok(())
}

/// Triangles whose places and sizes grow in a geometric series, which a builder likes to make a chain of. Each is found by a
/// ray of its own, on the device and on the host.
fn deep_hierarchy(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const COUNT: i32 = 1500;
    // From 1e-6 to 7e6, on both sides of the origin.
    let places: Vec<f32> = (0..COUNT).map(|index| 1e-6 * 1.02_f32.powi(index)).flat_map(|x| [x, -x]).collect();
    let corners = [Vec2::ZERO, Vec2::X, Vec2::Y];
    let positions =
        |x: &f32| corners.map(|corner| ((corner - Vec2::splat(0.25)) * 0.005 * *x).extend(0.0) + Vec3::X * *x);
    let light_map_uvs = Some(corners.into_iter().cycle().take(3 * places.len()).collect());
    let positions = places.iter().flat_map(positions).collect();
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.place_parts(vec![MeshPart { positions, light_map_uvs, ..MeshPart::default() }], DAffine3::IDENTITY);
    let scene = stage.build()?;
    let bvh = Bvh::build(&scene, &Atlas::new(&scene, Resolution::Texels(8))?)?;
    let down = |x: &f32| {
        let origin = Vec3::new(*x, 0.0, 1.0) - bvh.centre.as_vec3();
        Ray { origin, t_min: 0.0, direction: Vec3::NEG_Z, t_max: 1e30 }
    };
    let rays: Vec<Ray> = places.iter().map(down).collect();
    let is_met = |(index, primitive): (usize, Option<u32>)| {
        primitive.and_then(|primitive| bvh.order[0].get(primitive as usize)).is_some_and(|found| *found == index as u32)
    };
    let found = |primitives: Vec<Option<u32>>| primitives.into_iter().enumerate().filter(|hit| is_met(*hit)).count();
    let hits = Tracer::new(gpu, &scene, &bvh)?.trace(&rays, &vec![None; rays.len()])?;
    let on_device = hits.iter().map(|hit| hit.map(|hit| hit.primitive)).collect();
    let on_host = rays.iter().map(|ray| bvh.trace_closest(ray, None).map(|hit| hit.primitive)).collect();
    checks.count("triangles that are found on the device", found(on_device) as u64, rays.len() as u64);
    checks.count("triangles that are found on the host", found(on_host) as u64, rays.len() as u64);
    Ok(())
}
