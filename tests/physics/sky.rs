//! Case 14: a tilted plate between a uniform sky and a wide ground.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, mean};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{Quat, Vec3};
use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use std::f64::consts::PI;

on_both_back_ends!(level, inclined, upright, downward);

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
