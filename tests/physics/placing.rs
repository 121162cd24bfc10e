//! A scene's place and size do not change its light: NUMERICS section 9, cases 12 and 13.

use crate::device::on_both_back_ends;
use crate::estimate::{How, bake, mean};
use crate::stage::{Chart, Facing, Stage, level_square, room};
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{Bounces, LightMap};
use lightoven::gpu::Gpu;
use lightoven::scene::LightKind;

on_both_back_ends!(far_from_the_origin, a_millionth, a_million);

const TABLE: u32 = 6;

/// A room without a ceiling under a sky, with a lamp on a wall and a table, in one mesh or in two.
fn open_room(gpu: &Gpu, transform: DAffine3, meshes: Meshes) -> LightMap {
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
    bake(gpu, &stage.build(), How::new(256, Bounces::Limit(8)), 0).0
}

#[derive(Clone, Copy, Debug)]
enum Meshes {
    One,
    Two,
}

/// The same rays, but for those at an edge that rounding turns to the other side.
fn assert_same_as_at_the_origin(gpu: &Gpu, what: &str, transform: DAffine3) {
    for meshes in [Meshes::One, Meshes::Two] {
        let (here, there) = (open_room(gpu, DAffine3::IDENTITY, meshes), open_room(gpu, transform, meshes));
        let charts = [0, 2, 3, 4, 5, TABLE].map(Chart::new);
        let off = |chart: Chart| (mean(&there, chart) / mean(&here, chart) - 1.0).abs();
        let worst = charts.into_iter().map(off).fold(0.0, f64::max);
        println!("{what}, {meshes:?}, {}: worst surface off by {worst:.1e}", gpu.backend().name());
        assert!(worst <= 1e-3, "{what}, {meshes:?}: off by {worst}");
    }
}

fn far_from_the_origin(gpu: &Gpu) {
    assert_same_as_at_the_origin(gpu, "moved by 1e6", DAffine3::from_translation(DVec3::new(1e6, -1e6, 1e6)));
}

fn a_millionth(gpu: &Gpu) {
    assert_same_as_at_the_origin(gpu, "a millionth of the size", DAffine3::from_scale(DVec3::splat(1e-6)));
}

fn a_million(gpu: &Gpu) {
    assert_same_as_at_the_origin(gpu, "a million times the size", DAffine3::from_scale(DVec3::splat(1e6)));
}
