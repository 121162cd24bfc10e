//! Case 14: a tilted plate between a uniform sky and a wide ground.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, mean};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{Quat, Vec3};
use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use lightoven::scene::{Sky, SkyMap};
use std::f64::consts::PI;

on_both_back_ends!(level, inclined, upright, downward, map_of_an_upper_half, map_of_a_side);

/// Radiance of the sky, and albedo of the ground.
const SKY: f32 = 2.0;
const GROUND: f32 = 0.6;
/// The ground's side; its horizon lies 2e-5 under the plate's, of which at most 1.3e-5 of the irradiance follow.
const WIDE: f32 = 1e5;

fn plate(gpu: &Gpu, degrees: f32) {
    let mut stage = Stage::new();
    let (black, ground) = (stage.material(0.0, 0.0), stage.material(GROUND, 0.0));
    stage.sky(SKY);
    let tilt = Quat::from_rotation_x(degrees.to_radians());
    let chart = Chart::new(1);
    let plate = Quad {
        corner: Vec3::Z,
        u: tilt * Vec3::X * 0.01,
        v: tilt * Vec3::Y * 0.01,
        chart: Some(chart),
        material: black,
    };
    let ground = level_square(WIDE, 0.0, Facing::Up, Chart::new(0), ground);
    let scene = stage.with(&[ground, plate]);
    let estimate = Estimate::of(gpu, &scene, 1024, Bounces::Limit(1), |map| mean(map, chart));
    let (sky, cos) = (PI * f64::from(SKY), f64::from(degrees).to_radians().cos());
    let expected = sky * (1.0 + cos) / 2.0 + f64::from(GROUND) * sky * (1.0 - cos) / 2.0;
    estimate.assert_is(&format!("sky and ground, tilt {degrees}"), gpu, expected, 2e-5 * sky, 1e-2);
}

fn level(gpu: &Gpu) {
    plate(gpu, 0.0);
}

fn inclined(gpu: &Gpu) {
    plate(gpu, 50.0);
}

fn upright(gpu: &Gpu) {
    plate(gpu, 90.0);
}

fn downward(gpu: &Gpu) {
    plate(gpu, 160.0);
}

/// Irradiance of a small plate under a map of 4 x 2 pixels, those for which `lit` (column, row) has a radiance of 1.
fn under_map(gpu: &Gpu, normal: Vec3, lit: fn(u32, u32) -> bool) -> f64 {
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let pixels = (0..8).map(|i| if lit(i % 4, i / 4) { Vec3::ONE } else { Vec3::ZERO }).collect();
    stage.desc.sky = Sky::Map(SkyMap { width: 4, height: 2, pixels });
    let chart = Chart::new(0);
    let (u, v) = normal.any_orthonormal_pair();
    let quad = Quad {
        corner: Vec3::ZERO,
        u,
        v: if u.cross(v).dot(normal) > 0.0 { v } else { -v },
        chart: Some(chart),
        material: black,
    };
    mean(&crate::estimate::bake(gpu, &stage.with(&[quad]), 64, Bounces::Auto, 0).0, chart)
}

/// The top row is straight up: exact, for every ray of a level plate sees that half or none.
fn map_of_an_upper_half(gpu: &Gpu) {
    let up = under_map(gpu, Vec3::Y, |_, row| row == 0);
    let down = under_map(gpu, Vec3::NEG_Y, |_, row| row == 0);
    println!("upper half lit, {}: {up} facing up, {down} facing down", gpu.backend().name());
    assert!((up - PI).abs() < 1e-5 && down == 0.0);
}

/// The two middle columns are the half toward +x.
fn map_of_a_side(gpu: &Gpu) {
    let [toward, away] =
        [Vec3::X, Vec3::NEG_X].map(|normal| under_map(gpu, normal, |column, _| column == 1 || column == 2));
    let quarter = under_map(gpu, Vec3::Z, |column, _| column == 2);
    println!("half toward +x lit, {}: {toward}, {away}; its +z quarter: {quarter}", gpu.backend().name());
    assert!((toward - PI).abs() < 1e-5 && away == 0.0);
    // Half of what a plate toward +z sees, within the noise of 64 stratified rays a texel over a whole chart.
    assert!((quarter - PI / 2.0).abs() < 0.02 * PI, "a quarter toward +x and +z gives {quarter}");
}
