//! Cases 4, 5, 6 and 7: light from one black square that shines, by each way of sampling.

use super::{Case, Checks};
use crate::baker::{Bounces, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::verify::estimate::{Estimate, How, MIXTURES, SAMPLINGS};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::Vec3;
use std::f64::consts::{PI, TAU};

pub(super) const CASES: [Case; 7] = [
    Case::closed_form(4, "parallel unit squares", parallel_squares),
    Case::closed_form(5, "perpendicular unit squares", perpendicular_squares),
    Case::closed_form(6, "point .1 under a unit square", point_close_to_a_square),
    Case::closed_form(6, "point 1 under a unit square", point_before_a_square),
    Case::closed_form(6, "point 10 under a unit square", point_far_away),
    Case::closed_form(7, "point before a wall", point_beside_a_wall),
    Case::closed_form(7, "point before a wall, variance of a ray", variance_beside_a_wall),
];

/// Both are black, material 0 shines.
fn scene(receiver: Quad, emitter: Quad) -> Result<Scene> {
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    stage.with(&[Quad { material: black, ..receiver }, Quad { material: lamp, ..emitter }])
}

/// What is expected, what beside noise is allowed, and what is resolved.
struct Expected {
    factor: f64,
    tolerance: f64,
    resolution: f64,
    /// By rays that are all aimed: beside what shines their variance has no bound.
    aimed_resolution: f64,
}

/// What part of the emitter's radiosity the receiver gets, by each way of sampling.
fn check_form_factor(
    gpu: &Gpu,
    checks: &mut Checks,
    what: &str,
    [receiver, emitter]: [Quad; 2],
    samples: u32,
    samplings: &[Sampling],
    expected: Expected,
) -> Result<()> {
    let (scene, chart) = (scene(receiver, emitter)?, receiver.mapped()?);
    for sampling in samplings {
        let how = How::new(samples, Bounces::Auto).by(*sampling);
        let estimate = Estimate::direct(gpu, &scene, how, chart)?.times(PI.recip());
        let Expected { factor, tolerance, resolution, aimed_resolution } = expected;
        let resolution = if *sampling == Sampling::Importance { aimed_resolution } else { resolution };
        checks.estimate(format!("{what}by {sampling}"), estimate, factor, tolerance, resolution);
    }
    Ok(())
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

fn parallel_squares(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let expected = Expected { factor: 0.199_824_9, tolerance: 1e-3, resolution: 1e-3, aimed_resolution: 1e-3 };
    check_form_factor(gpu, checks, "", [floor(), ceiling(1.0)], 1024, &SAMPLINGS, expected)
}

/// A shining wall over the floor's edge x = -.5.
fn wall() -> Quad {
    let corner = Vec3::new(-0.5, -0.5, 0.0);
    Quad { corner, u: Vec3::Y, v: Vec3::Z, chart: Some(Chart::new(1)), material: 0 }
}

/// Along an edge that they share the variance of rays that are all aimed has no bound: nothing is to be told by them.
fn perpendicular_squares(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let expected = Expected { factor: 0.200_043_8, tolerance: 1e-3, resolution: 2e-3, aimed_resolution: 2e-3 };
    let bounded = [Sampling::Cosine, MIXTURES[0], MIXTURES[1]];
    check_form_factor(gpu, checks, "", [floor(), wall()], 1024, &bounded, expected)
}

/// A receiver this small is a point: its own extent changes the answer by less than a millionth.
const POINT: f32 = 1e-4;

fn point_close_to_a_square(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let expected = Expected { factor: 0.968_340, tolerance: 1e-6, resolution: 8e-3, aimed_resolution: 3e-2 };
    check_form_factor(gpu, checks, "", [point(), ceiling(0.1)], 8192, &SAMPLINGS, expected)
}

fn point_before_a_square(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let expected = Expected { factor: 0.239_456, tolerance: 1e-6, resolution: 2e-3, aimed_resolution: 1e-3 };
    check_form_factor(gpu, checks, "", [point(), ceiling(1.0)], 8192, &SAMPLINGS, expected)
}

fn point_far_away(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let expected = Expected { factor: 0.003_172_53, tolerance: 1e-8, resolution: 5e-4, aimed_resolution: 1e-6 };
    check_form_factor(gpu, checks, "", [point(), ceiling(10.0)], 8192, &SAMPLINGS, expected)
}

/// A point at `distance` before the lower corner of an upright unit square.
fn beside_a_wall(distance: f32) -> [Quad; 2] {
    let receiver = level_square(distance.min(0.01) * 0.01, 0.0, Facing::Up, Chart::new(0), 0);
    let corner = Vec3::X * distance;
    [receiver, Quad { corner, u: Vec3::Z, v: Vec3::Y, chart: Some(Chart::new(1)), material: 0 }]
}

/// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-4, both sides 1.
fn beside_a_wall_factor(distance: f64) -> f64 {
    let far = (1.0 + distance * distance).sqrt();
    ((1.0 / distance).atan() - distance / far * (1.0 / far).atan()) / TAU
}

/// Rays that are all aimed have a standard deviation of 3.6 a ray at .1, of 32 at .01: nearer they are no estimate.
fn point_beside_a_wall(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    checks.within("the closed form at 1", beside_a_wall_factor(1.0), 0.055_734, 1e-6);
    for (distance, aimed_resolution) in [(1.0, 1e-4), (0.1, 2e-2)] {
        let factor = beside_a_wall_factor(distance);
        let expected = Expected { factor, tolerance: 1e-6, resolution: 2e-3, aimed_resolution };
        let what = format!("at {distance} ");
        let alone = [Sampling::Cosine, Sampling::Importance];
        check_form_factor(gpu, checks, &what, beside_a_wall(distance as f32), 8192, &alone, expected)?;
    }
    Ok(())
}

/// A mixture has a bound however near the wall is. Rays are stratified, and rays of a quantum share the techniques out:
/// that is measured with the rest.
fn variance_beside_a_wall(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const SAMPLES: u32 = 8192;
    // A ray weighs at most pi / share times the radiance, so that its relative variance is at most 1 / (share * factor) - 1:
    // 2.6^2 for a half at the wall, 6.2^2 for a tenth.
    let most = MIXTURES.into_iter().zip([3.0, 6.2]);
    let cases = [1.0, 0.1, 0.01, 0.001].into_iter().flat_map(|distance| most.clone().map(move |most| (distance, most)));
    for (distance, (sampling, most)) in cases {
        let [receiver, emitter] = beside_a_wall(distance as f32);
        let (scene, chart) = (scene(receiver, emitter)?, receiver.mapped()?);
        let how = How::new(SAMPLES, Bounces::Auto).by(sampling);
        let estimate = Estimate::direct(gpu, &scene, how, chart)?.times(PI.recip());
        let (expected, what) = (beside_a_wall_factor(distance), format!("at {distance} by {sampling}"));
        checks.estimate(&what, estimate, expected, 1e-6, 0.04 * expected);
        let rays = chart.texels().count() as f64 * f64::from(SAMPLES);
        let of_a_ray = estimate.standard_error * rays.sqrt() / estimate.mean;
        checks.at_most(format!("{what}, relative SD of a ray"), of_a_ray, most);
    }
    Ok(())
}
