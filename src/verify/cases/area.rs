//! Case 20: the area of a chart's texels is the surface's, and sums of luminance times area are what surfaces shine. The
//! root of the pyramid itself is not seen from outside; a wrong one would make every aimed ray's weight wrong, which other
//! cases would show.

use super::{Case, Checks};
use crate::baker::{Bounces, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::verify::estimate::{How, bake, broken};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DMat3, DQuat, DVec3};

pub(super) const CASES: [Case; 3] = [
    Case::closed_form(20, "area of an instance", alone),
    Case::closed_form(20, "area of instances, turned and stretched", placed_and_stretched),
    Case::closed_form(20, "area times luminance", evenness),
];

/// Charts end this far inside their outermost texels, so that no others are touched.
const INSET: f32 = 0.01;

fn surface() -> Quad {
    level_square(2.0, 0.0, Facing::Up, Chart::new(0).inset(INSET), 0)
}

/// Texels count whole: the outermost ones' insets are part of what is wanted.
fn check_area(gpu: &Gpu, checks: &mut Checks, matrices: &[DMat3]) -> Result<()> {
    let mut stage = Stage::new();
    stage.material(0.5, 1.0);
    let mut expected = 0.0;
    for (index, matrix) in matrices.iter().enumerate() {
        let chart = Chart::new(index as u32).inset(INSET);
        let quad = Quad { chart: Some(chart), ..surface() };
        stage.place(&[quad], DAffine3 { matrix3: *matrix, translation: DVec3::X * 10.0 * index as f64 });
        let area = (*matrix * quad.u.as_dvec3()).cross(*matrix * quad.v.as_dvec3()).length();
        expected += area * (f64::from(chart.size) / chart.side()).powi(2);
    }
    let (_, statistics) = bake(gpu, &stage.build()?, How::new(64, Bounces::Limit(0)), 0)?;
    checks.count("texels", statistics.texels, matrices.len() as u64 * 36);
    checks.relative("area", statistics.area, expected, 1e-5);
    Ok(())
}

fn alone(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_area(gpu, checks, &[DMat3::from_diagonal(DVec3::new(0.7, 3.0, 1.0))])
}

fn turn() -> DMat3 {
    DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0))
}

fn placed_and_stretched(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let stretch = DMat3::from_diagonal(DVec3::new(-2.0, 0.5, 7.0));
    check_area(gpu, checks, &[turn(), turn() * stretch * turn(), stretch])
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
fn evenness(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let (mut power, mut squared, mut area) = (0.0, 0.0, 0.0);
    for (index, (radiance, stretch, inset)) in SHINING.into_iter().enumerate() {
        let chart = Chart::new(index as u32).inset(inset);
        let quad = Quad { chart: Some(chart), material: stage.material(0.0, radiance), ..surface() };
        let matrix3 = turn() * DMat3::from_diagonal(stretch);
        stage.place(&[quad], DAffine3 { matrix3, translation: DVec3::X * 100.0 * index as f64 });
        let of_this = (matrix3 * quad.u.as_dvec3()).cross(matrix3 * quad.v.as_dvec3()).length();
        let radiance = f64::from(radiance);
        area += of_this;
        power += radiance * of_this;
        squared += radiance * radiance * of_this;
    }
    let how = How::new(64, Bounces::Limit(0)).by(Sampling::Mixture { cosine: 0.5 });
    let (_, statistics) = bake(gpu, &stage.build()?, how, 0)?;
    let found = statistics.sampling.evenness.ok_or_else(|| broken("the bake tells no evenness".into()))?;
    let shines = statistics.sampling.power.ok_or_else(|| broken("the bake tells no power".into()))?;
    checks.relative("power of the light", shines, power, 1e-5);
    checks.relative("evenness of the light", f64::from(found), power * power / (area * squared), 1e-5);
    Ok(())
}
