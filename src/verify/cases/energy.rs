//! What comes in goes out: closed rooms, dark ones, and rooms beside a lit one.

use super::{Case, Checks};
use crate::baker::{Bounces, LightMap};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{LightKind, Scene};
use crate::verify::estimate::{Estimate, How, bake, irradiance, mean};
use crate::verify::stage::{Chart, Quad, Stage, room};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 3] = [
    Case::conduct("energy of a closed room", closed_room),
    Case::extreme(7, "energy of a black scene", black_scene),
    Case::conduct("energy of a room beside a lit one", room_beside_a_lit_one),
];

const SIZE: Vec3 = Vec3::new(1.0, 2.0, 0.5);
const ALBEDOS: [f32; 6] = [0.5, 0.3, 0.1, 0.4, 0.0, 0.2];
const BOUNCES: u32 = 8;

/// All that is emitted is absorbed somewhere, and no more than that.
fn closed_room(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let mut walls = room(Vec3::ZERO, SIZE, Chart::large, 0);
    for (index, wall) in walls.iter_mut().enumerate() {
        wall.material = stage.material(ALBEDOS[index], if index == 1 { 1.0 } else { 0.0 });
    }
    let area = |wall: &Quad| f64::from(wall.u.cross(wall.v).length());
    let absorbed = |map: &LightMap| -> Result<f64> {
        let wall =
            |(wall, albedo): (&Quad, f32)| Ok(mean(map, wall.mapped()?)? * area(wall) * (1.0 - f64::from(albedo)));
        walls.iter().zip(ALBEDOS).map(wall).sum()
    };
    let emitted = PI * area(&walls[1]);
    // The tolerance: a texel across a wall's two triangles takes its light on one of them, and .5^9 of some light is missing.
    let figure = |map: &LightMap| Ok(absorbed(map)? / emitted);
    let estimate = Estimate::of(gpu, &stage.with(&walls)?, How::new(64, Bounces::Limit(BOUNCES)), figure)?;
    checks.estimate("absorbed over emitted power", estimate, 1.0, 1e-3, 5e-3);
    Ok(())
}

fn black_scene(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 0.0);
    let walls = room(Vec3::ZERO, SIZE, Chart::new, grey);
    let (map, statistics) = bake(gpu, &stage.with(&walls)?, How::new(64, Bounces::Auto), 0)?;
    checks.count("lit texels", map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count() as u64, 0);
    checks.at_least("baked texels", map.pixels.iter().filter(|pixel| pixel[3] == 1.0).count() as f64, 6.0 * 36.0);
    checks.count("aimed rays", statistics.sampling.source_rays + statistics.sampling.sky_rays, 0);
    Ok(())
}

/// Two rooms, `gap` apart; the first is lit by its ceiling and by a lamp, the second by nothing.
fn two_rooms(gap: f32) -> Result<(Scene, [Quad; 12])> {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.7, 0.0), stage.material(0.7, 1.0));
    let lit = room(Vec3::ZERO, Vec3::ONE, Chart::new, grey);
    let dark = room(Vec3::X * (1.0 + gap), Vec3::X * (1.0 + gap) + Vec3::ONE, |index| Chart::new(6 + index), grey);
    let mut walls: [Quad; 12] = std::array::from_fn(|i| if i < 6 { lit[i] } else { dark[i - 6] });
    walls[1].material = lamp;
    stage.light(LightKind::Point { position: DVec3::new(0.5, 0.4, 0.7), range: None });
    Ok((stage.with(&walls)?, walls))
}

/// Not one ray and not one shadow ray passes a wall, however thin.
fn room_beside_a_lit_one(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for gap in [0.1, 1e-3] {
        let (scene, walls) = two_rooms(gap)?;
        let (map, _) = bake(gpu, &scene, How::new(1024, Bounces::Auto), 0)?;
        let of = |walls: &[Quad]| -> Result<Vec<f64>> {
            let of_walls: Result<Vec<_>> = walls.iter().map(|wall| irradiance(&map, wall.mapped()?)).collect();
            Ok(of_walls?.concat())
        };
        let unlit = of(&walls[..6])?.into_iter().filter(|value| !(*value > 0.0)).count();
        let leaks = of(&walls[6..])?.into_iter().filter(|value| *value != 0.0).count();
        checks.count(format!("dark texels before walls {gap} thick"), unlit as u64, 0);
        checks.count(format!("lit texels behind walls {gap} thick"), leaks as u64, 0);
    }
    Ok(())
}
