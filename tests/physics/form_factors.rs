//! Cases 4, 5 and 6: light from one black square that shines.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, mean};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::Vec3;
use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use std::f64::consts::PI;

on_both_back_ends!(
    parallel_squares,
    perpendicular_squares,
    point_close_to_a_square,
    point_before_a_square,
    point_far_away
);

/// What part of the emitter's radiosity the receiver gets, over seeds. Both are black, material 0 shines.
fn form_factor(gpu: &Gpu, receiver: Quad, emitter: Quad, samples: u32) -> Estimate {
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let quads = [Quad { material: black, ..receiver }, Quad { material: lamp, ..emitter }];
    let chart = receiver.chart.unwrap();
    Estimate::of(gpu, &stage.with(&quads), samples, Bounces::Auto, |map| mean(map, chart) / PI)
}

/// Fine, for a texel across the square's two triangles takes its light on one of them: with 6 texels a side the mean is off
/// by 1.7 %, and by 1/n^2 of that with n times as many.
fn floor() -> Quad {
    level_square(1.0, 0.0, Facing::Up, Chart::large(0), 0)
}

fn point() -> Quad {
    level_square(POINT, 0.0, Facing::Up, Chart::new(0), 0)
}

fn ceiling(height: f32) -> Quad {
    level_square(1.0, height, Facing::Down, Chart::new(1), 0)
}

fn parallel_squares(gpu: &Gpu) {
    let estimate = form_factor(gpu, floor(), ceiling(1.0), 512);
    estimate.assert_is("parallel unit squares", gpu, 0.199_824_9, 1e-3, 1e-3);
}

/// A shining wall over the floor's edge x = -.5.
fn wall() -> Quad {
    let corner = Vec3::new(-0.5, -0.5, 0.0);
    Quad { corner, u: Vec3::Y, v: Vec3::Z, chart: Some(Chart::new(1)), material: 0 }
}

fn perpendicular_squares(gpu: &Gpu) {
    let estimate = form_factor(gpu, floor(), wall(), 512);
    estimate.assert_is("perpendicular unit squares", gpu, 0.200_043_8, 1e-3, 1e-3);
}

/// A receiver this small is a point: its own extent changes the answer by less than a millionth.
const POINT: f32 = 1e-4;

fn point_close_to_a_square(gpu: &Gpu) {
    let estimate = form_factor(gpu, point(), ceiling(0.1), 4096);
    estimate.assert_is("point .1 under a unit square", gpu, 0.968_340, 1e-6, 1e-3);
}

fn point_before_a_square(gpu: &Gpu) {
    let estimate = form_factor(gpu, point(), ceiling(1.0), 4096);
    estimate.assert_is("point 1 under a unit square", gpu, 0.239_456, 1e-6, 1e-3);
}

fn point_far_away(gpu: &Gpu) {
    let estimate = form_factor(gpu, point(), ceiling(10.0), 4096);
    estimate.assert_is("point 10 under a unit square", gpu, 0.003_172_53, 1e-8, 2e-4);
}
