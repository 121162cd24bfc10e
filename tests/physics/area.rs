//! Case 20: the area of a chart's texels is the surface's, and sums of luminance times area are what surfaces shine. The
//! root of the pyramid is not seen from outside; a wrong one would make every aimed ray's weight wrong, which other tests
//! would show.

use crate::device::on_both_back_ends;
use crate::estimate::{How, bake};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use lightoven::baker::{Bounces, Sampling};
use lightoven::gpu::Gpu;

on_both_back_ends!(alone, placed_and_stretched, evenness);

/// Charts end this far inside their outermost texels, so that no others are touched.
const INSET: f32 = 0.01;

fn surface() -> Quad {
    level_square(2.0, 0.0, Facing::Up, Chart::new(0).inset(INSET), 0)
}

/// Texels count whole: the outermost ones' insets are part of what is wanted.
fn assert_area(gpu: &Gpu, what: &str, matrices: &[DMat3]) {
    let mut stage = Stage::new();
    stage.material(0.5, 1.0);
    let mut expected = 0.0;
    for (index, matrix) in matrices.iter().enumerate() {
        let quad = Quad { chart: Some(Chart::new(index as u32).inset(INSET)), ..surface() };
        stage.place(&[quad], DAffine3 { matrix3: *matrix, translation: DVec3::X * 10.0 * index as f64 });
        let area = (*matrix * quad.u.as_dvec3()).cross(*matrix * quad.v.as_dvec3()).length();
        let chart = Chart::new(index as u32).inset(INSET);
        expected += area * (f64::from(chart.size) / chart.side()).powi(2);
    }
    let (_, statistics) = bake(gpu, &stage.build(), How::new(64, Bounces::Limit(0)), 0);
    assert_eq!(statistics.texels, matrices.len() as u64 * 36);
    let error = (statistics.area / expected - 1.0).abs();
    println!("{what}, {}: area {}, closed form {expected}: off by {error:.1e}", gpu.backend().name(), statistics.area);
    assert!(error <= 1e-5, "{what}: {} instead of {expected}", statistics.area);
}

fn alone(gpu: &Gpu) {
    assert_area(gpu, "one instance", &[DMat3::from_diagonal(DVec3::new(0.7, 3.0, 1.0))]);
}

fn placed_and_stretched(gpu: &Gpu) {
    let turn = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0));
    let stretch = DMat3::from_diagonal(DVec3::new(-2.0, 0.5, 7.0));
    assert_area(gpu, "instances", &[turn, turn * stretch * turn, stretch]);
}

/// Radiance of a surface, its matrix, and how far inside its outermost texels its chart ends. Only the part of a texel that
/// has surface counts.
const SHINING: [(f32, DVec3, f32); 4] = [
    (5.0, DVec3::new(0.3, 0.2, 1.0), INSET),
    (0.5, DVec3::new(-2.0, 0.5, 7.0), 0.0),
    (1e-3, DVec3::new(3.0, 30.0, 1.0), 0.4),
    (0.0, DVec3::new(4.0, -1.0, 1.0), -0.5),
];

/// Power squared over area times the sum of squared radiance times area, which is what decides whether rays are aimed.
fn evenness(gpu: &Gpu) {
    let mut stage = Stage::new();
    let turn = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0));
    let (mut power, mut squared, mut area) = (0.0, 0.0, 0.0);
    for (index, (radiance, stretch, inset)) in SHINING.into_iter().enumerate() {
        let chart = Chart::new(index as u32).inset(inset);
        let quad = Quad { chart: Some(chart), material: stage.material(0.0, radiance), ..surface() };
        let matrix3 = turn * DMat3::from_diagonal(stretch);
        stage.place(&[quad], DAffine3 { matrix3, translation: DVec3::X * 100.0 * index as f64 });
        let of_this = (matrix3 * quad.u.as_dvec3()).cross(matrix3 * quad.v.as_dvec3()).length();
        let radiance = f64::from(radiance);
        area += of_this;
        power += radiance * of_this;
        squared += radiance * radiance * of_this;
    }
    let how = How::new(64, Bounces::Limit(0)).by(Sampling::Mixture { cosine: 0.5 });
    let (_, statistics) = bake(gpu, &stage.build(), how, 0);
    let (expected, found) = (power * power / (area * squared), f64::from(statistics.sampling.evenness.unwrap()));
    let error = (found / expected - 1.0).abs();
    println!("evenness, {}: {found}, closed form {expected}: off by {error:.1e}", gpu.backend().name());
    assert!(error <= 1e-5, "{found} instead of {expected}");
}
