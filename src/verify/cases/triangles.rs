//! Extreme case 11: triangles without area, slivers and duplicates are dropped or hit once.

use super::{Case, Checks};
use crate::baker::{Bounces, LightMap};
use crate::bvh::{Bvh, MAX_STACK_SIZE};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Atlas, Resolution, Scene, Sidedness};
use crate::verify::estimate::{Estimate, How, SAMPLINGS, bake, mean};
use crate::verify::stage::{Chart, Facing, Quad, SIDE, Stage, level_square, room};
use glam::{DAffine3, Vec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 4] = [
    Case::extreme(11, "triangles without area", without_area),
    Case::extreme(11, "slivers", slivers),
    Case::extreme(11, "duplicates in a furnace", duplicates),
    Case::extreme(11, "duplicates of a lamp", duplicates_of_a_lamp),
];

fn chart(index: u32) -> Chart {
    Chart::new(index).inset(0.01)
}

/// What every texel of a furnace of albedo .5 gets.
const FURNACE: f64 = 2.0 * PI;

/// Walls that shine and reflect, and a material that shines as they do, seen from both sides.
fn furnace() -> (Stage, [Quad; 6], usize) {
    let mut stage = Stage::new();
    let (wall, equal) = (stage.material(0.5, 1.0), stage.material(0.0, 2.0));
    stage.desc.materials[equal].sidedness = Sidedness::Double;
    (stage, room(Vec3::splat(-1.0), Vec3::ONE, chart, wall), equal)
}

/// The lowest and highest of all texels.
fn check_furnace(checks: &mut Checks, what: &str, map: &LightMap, texels: u64) {
    let baked: Vec<f64> = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).map(|pixel| pixel[0].into()).collect();
    checks.count(format!("{what}texels"), baked.len() as u64, texels);
    checks.relative(format!("{what}lowest irradiance"), baked.iter().copied().fold(f64::MAX, f64::min), FURNACE, 2e-4);
    checks.relative(format!("{what}highest irradiance"), baked.iter().copied().fold(0.0, f64::max), FURNACE, 2e-4);
}

const WALLS: u64 = 6 * 36;

/// A point, a line of three corners and one of two, many times over: they are dropped and counted.
fn without_area(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (mut stage, walls, _) = furnace();
    stage.place(&walls, DAffine3::IDENTITY);
    let part = &mut stage.desc.meshes[0].parts[0];
    let first = part.positions.len() as u32;
    let corner = part.positions[0];
    part.positions.extend([corner, corner + Vec3::ONE * 0.5, corner + Vec3::ONE]);
    part.light_map_uvs.iter_mut().for_each(|uvs| uvs.extend_from_within(..3));
    part.albedo_uvs.iter_mut().chain(&mut part.emission_uvs).for_each(|uvs| uvs.extend_from_within(..3));
    for _ in 0..1000 {
        part.indices.extend([first; 3]);
        part.indices.extend([first, first + 1, first + 2]);
        part.indices.extend([first, first, first + 2]);
    }
    let scene = Scene::new(stage.desc)?;
    checks.count("triangles that are left", scene.triangle_count() as u64, 12);
    let told = matches!(scene.warnings(), [one] if one.contains("'mesh 0'") && one.contains("3000 triangles without"));
    checks.holds("a warning names the mesh and counts them", told);
    let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    check_furnace(checks, "", &map, WALLS);
    Ok(())
}

/// A million times as long as they are wide, and some as short as that, with charts and without. They shine as
/// the room does: where one were lost, hit from inside out, or took the light from the rest, it would show.
fn slivers(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (stage, walls, equal) = furnace();
    let mut quads = walls.to_vec();
    let sizes = [[1.0, 1e-6], [1e-6, 1.0], [1e-6, 1e-6], [1e-6, 1e-12]];
    for (index, [long, wide]) in (0..).zip(sizes) {
        for (height, chart) in [(-0.5, Some(chart(6 + index))), (0.5, None)] {
            let corner = Vec3::new(0.0, 0.0, height + 0.01 * index as f32);
            let (u, v) = (Vec3::new(long, 0.3 * long, 0.0), Vec3::new(0.0, wide, 0.2 * wide));
            quads.push(Quad { corner, u, v, chart, material: equal });
        }
    }
    let scene = stage.with(&quads)?;
    checks.count("triangles", scene.triangle_count() as u64, 12 + 16);
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    check_furnace(checks, "", &map, WALLS + 4 * 36);
    for (index, size) in (0..).zip(sizes) {
        let light = mean(&map, chart(6 + index))?;
        checks.relative(format!("irradiance of a sliver of {size:?}"), light, FURNACE, 2e-4);
    }
    checks.count("texels inside something", statistics.invalid_texels, 0);
    Ok(())
}

/// Each wall three times in the same place: its texels' rays do not meet its likes.
fn duplicates(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (stage, walls, _) = furnace();
    let scene = stage.with(&[walls, walls, walls].concat())?;
    checks.count("triangles", scene.triangle_count() as u64, 36);
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    check_furnace(checks, "", &map, WALLS);
    checks.count("texels inside something", statistics.invalid_texels, 0);
    Ok(())
}

/// It shines once, however rays are sent. So many in a place must not make the hierarchy deep.
fn duplicates_of_a_lamp(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const COUNT: usize = 60;
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let floor = level_square(1.0, 0.0, Facing::Up, Chart::large(0), black);
    let ceiling = level_square(1.0, 1.0, Facing::Down, chart(1), lamp);
    let scene = stage.with(&[vec![floor], vec![ceiling; COUNT]].concat())?;
    let bvh = Bvh::build(&scene, &Atlas::new(&scene, Resolution::Texels(SIDE))?)?;
    checks.at_most("entries of the hierarchy's stack", bvh.stack_size.into(), MAX_STACK_SIZE as f64 / 8.0);
    for sampling in SAMPLINGS {
        let how = How::new(512, Bounces::Auto).by(sampling);
        let estimate = Estimate::direct(gpu, &scene, how, floor.mapped()?)?.times(PI.recip());
        // Closed-form case 4.
        checks.estimate(format!("form factor by {sampling}"), estimate, 0.199_824_9, 1e-3, 2e-3);
    }
    Ok(())
}
