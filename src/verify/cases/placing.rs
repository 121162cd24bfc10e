//! Extreme cases 12 and 13: a scene's place and size do not change its light.

use super::{Case, Checks};
use crate::baker::{Bounces, LightMap};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::LightKind;
use crate::verify::estimate::{How, bake, mean};
use crate::verify::stage::{Chart, Facing, Stage, level_square, room};
use glam::{DAffine3, DQuat, DVec3, Vec3};

pub(super) const CASES: [Case; 4] = [
    Case::extreme(12, "room, moved by 1e6", far_from_the_origin),
    Case::extreme(12, "room of two centimetres, moved by 1e6", small_and_far),
    Case::extreme(13, "room, a millionth of the size", a_millionth),
    Case::extreme(13, "room, a million times the size", a_million),
];

const TABLE: u32 = 6;

/// A room without a ceiling under a sky, with a lamp on a wall and a table, in one mesh or in two.
fn open_room(gpu: &Gpu, transform: DAffine3, meshes: Meshes) -> Result<LightMap> {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.6, 0.0), stage.material(0.3, 2.0));
    stage.sky(1.0);
    stage.light(LightKind::Directional { direction: Vec3::new(0.5, 0.3, -1.0) });
    let [floor, _, mut wall, x1, y0, y1] = room(Vec3::splat(-1.0), Vec3::ONE, Chart::new, grey);
    wall.material = lamp;
    let walls = [floor, wall, x1, y0, y1];
    let table = level_square(1.0, -0.4, Facing::Up, Chart::new(TABLE), grey);
    match meshes {
        Meshes::One => stage.place(&[&walls[..], &[table]].concat(), transform),
        Meshes::Two => {
            stage.place(&walls, transform);
            stage.place(&[table], transform);
        }
    }
    Ok(bake(gpu, &stage.build()?, How::new(256, Bounces::Limit(8)), 0)?.0)
}

#[derive(Clone, Copy, Debug)]
enum Meshes {
    One,
    Two,
}

/// The same rays, but for those at an edge that rounding turns to the other side.
fn check_same_as_at_the_origin(gpu: &Gpu, checks: &mut Checks, transform: DAffine3) -> Result<()> {
    for meshes in [Meshes::One, Meshes::Two] {
        let (here, there) = (open_room(gpu, DAffine3::IDENTITY, meshes)?, open_room(gpu, transform, meshes)?);
        for chart in [0, 2, 3, 4, 5, TABLE] {
            let [here, there] = [&here, &there].map(|map| mean(map, Chart::new(chart)));
            let (here, there) = (here?, there?);
            checks.at_least(format!("light of surface {chart}, meshes: {meshes:?}"), here, 0.1);
            checks.relative(format!("surface {chart}, meshes: {meshes:?}"), there, here, 1e-3);
        }
    }
    Ok(())
}

fn far_from_the_origin(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_same_as_at_the_origin(gpu, checks, DAffine3::from_translation(FAR))
}

const FAR: DVec3 = DVec3::new(1e6, -1e6, 1e6);

/// Features of a centimetre, where 32-bit floats are six centimetres apart.
fn small_and_far(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let transform = DAffine3::from_scale_rotation_translation(DVec3::splat(0.01), DQuat::IDENTITY, FAR);
    check_same_as_at_the_origin(gpu, checks, transform)
}

fn a_millionth(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_same_as_at_the_origin(gpu, checks, DAffine3::from_scale(DVec3::splat(1e-6)))
}

fn a_million(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_same_as_at_the_origin(gpu, checks, DAffine3::from_scale(DVec3::splat(1e6)))
}
