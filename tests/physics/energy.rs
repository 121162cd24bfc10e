//! What comes in goes out: closed rooms, dark ones, and rooms beside a lit one.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, How, bake, irradiance, mean};
use crate::stage::{Chart, Quad, Stage, room};
use glam::{DVec3, Vec3};
use lightoven::baker::{Bounces, LightMap};
use lightoven::gpu::Gpu;
use lightoven::scene::{LightKind, Scene};
use std::f64::consts::PI;

on_both_back_ends!(closed_room, black_scene, room_beside_a_lit_one);

const SIZE: Vec3 = Vec3::new(1.0, 2.0, 0.5);
const ALBEDOS: [f32; 6] = [0.5, 0.3, 0.1, 0.4, 0.0, 0.2];
const BOUNCES: u32 = 8;

/// All that is emitted is absorbed somewhere, and no more than that.
fn closed_room(gpu: &Gpu) {
    let mut stage = Stage::new();
    let mut walls = room(Vec3::ZERO, SIZE, Chart::large, 0);
    for (index, wall) in walls.iter_mut().enumerate() {
        wall.material = stage.material(ALBEDOS[index], if index == 1 { 1.0 } else { 0.0 });
    }
    let area = |wall: &Quad| f64::from(wall.u.cross(wall.v).length());
    let absorbed = |map: &LightMap| -> f64 {
        let wall =
            |(wall, albedo): (&Quad, f32)| mean(map, wall.chart.unwrap()) * area(wall) * (1.0 - f64::from(albedo));
        walls.iter().zip(ALBEDOS).map(wall).sum()
    };
    let emitted = PI * area(&walls[1]);
    // The tolerance: a texel across a wall's two triangles takes its light on one of them, and .5^9 of some light is missing.
    let figure = |map: &LightMap| absorbed(map) / emitted;
    let estimate = Estimate::of(gpu, &stage.with(&walls), How::new(64, Bounces::Limit(BOUNCES)), figure);
    estimate.assert_is("absorbed over emitted power", gpu, 1.0, 1e-3, 5e-3);
}

fn black_scene(gpu: &Gpu) {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 0.0);
    let walls = room(Vec3::ZERO, SIZE, Chart::new, grey);
    let (map, _) = bake(gpu, &stage.with(&walls), How::new(64, Bounces::Auto), 0);
    assert!(map.pixels.iter().all(|pixel| pixel[..3] == [0.0; 3]));
    assert!(map.pixels.iter().any(|pixel| pixel[3] == 1.0));
}

/// Two rooms, `gap` apart; the first is lit by its ceiling and by a lamp, the second by nothing.
fn two_rooms(gap: f32) -> (Scene, [Quad; 12]) {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.7, 0.0), stage.material(0.7, 1.0));
    let lit = room(Vec3::ZERO, Vec3::ONE, Chart::new, grey);
    let dark = room(Vec3::X * (1.0 + gap), Vec3::X * (1.0 + gap) + Vec3::ONE, |index| Chart::new(6 + index), grey);
    let mut walls: [Quad; 12] = std::array::from_fn(|i| if i < 6 { lit[i] } else { dark[i - 6] });
    walls[1].material = lamp;
    stage.light(LightKind::Point { position: DVec3::new(0.5, 0.4, 0.7), range: None });
    (stage.with(&walls), walls)
}

/// Not one ray and not one shadow ray passes a wall, however thin.
fn room_beside_a_lit_one(gpu: &Gpu) {
    for gap in [0.1, 1e-3] {
        let (scene, walls) = two_rooms(gap);
        let (map, _) = bake(gpu, &scene, How::new(1024, Bounces::Auto), 0);
        let of = |walls: &[Quad]| -> Vec<f64> {
            walls.iter().flat_map(|wall| irradiance(&map, wall.chart.unwrap_or(Chart::new(0)))).collect()
        };
        assert!(of(&walls[..6]).iter().all(|value| *value > 0.0));
        let leaks = of(&walls[6..]).into_iter().filter(|value| *value != 0.0).count();
        println!("walls {gap} thick, {}: {leaks} texels behind them are lit", gpu.backend().name());
        assert_eq!(leaks, 0);
    }
}
