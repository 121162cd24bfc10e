//! Cases 11, 12 and 13: analytic lights, taken at a texel's centre.

use crate::device::on_both_back_ends;
use crate::estimate::{How, bake};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DVec3, Vec3};
use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use lightoven::scene::LightKind;

on_both_back_ends!(point_light, point_light_with_range, spot_light, sun_on_a_level_plane, sun_on_a_tilted_plane);

/// Bakes one light over one black rectangle. The largest difference to `expected` of the texels' centres, relative to the
/// largest expected irradiance.
fn worst(gpu: &Gpu, quad: Quad, light: LightKind, expected: impl Fn(DVec3) -> f64) -> f64 {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(light);
    let (map, _) = bake(gpu, &stage.with(&[quad]), How::new(64, Bounces::Auto), 0);
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for (texel, at) in quad.chart.unwrap().texels() {
        let wanted = expected(quad.point(at));
        largest = largest.max(wanted);
        for channel in &map.pixels[texel][..3] {
            worst = worst.max((f64::from(*channel) - wanted).abs());
        }
    }
    assert!(largest > 0.0);
    worst / largest
}

fn assert_below(gpu: &Gpu, what: &str, error: f64, bound: f64) {
    println!("{what}, {}: worst texel off by {error:.2e} of the largest", gpu.backend().name());
    assert!(error <= bound, "{what}: off by {error:e}, allowed is {bound:e}");
}

fn plane() -> Quad {
    level_square(4.0, 0.0, Facing::Up, Chart::new(0), 0)
}

const POSITION: DVec3 = DVec3::new(0.3, -0.2, 1.25);

fn point_light(gpu: &Gpu) {
    let expected = |point: DVec3| POSITION.z / POSITION.distance(point).powi(3);
    let error = worst(gpu, plane(), LightKind::Point { position: POSITION, range: None }, expected);
    assert_below(gpu, "point light", error, 1e-5);
}

/// KHR_lights_punctual, "Range Property".
fn point_light_with_range(gpu: &Gpu) {
    const RANGE: f32 = 2.0;
    let expected = |point: DVec3| {
        let distance = POSITION.distance(point);
        let fade = (1.0 - (distance / f64::from(RANGE)).powi(4)).clamp(0.0, 1.0);
        fade * POSITION.z / distance.powi(3)
    };
    let error = worst(gpu, plane(), LightKind::Point { position: POSITION, range: Some(RANGE) }, expected);
    assert_below(gpu, "point light with a range", error, 1e-5);
}

/// KHR_lights_punctual, "Inner and Outer Cone Angles".
fn spot_light(gpu: &Gpu) {
    let (inner_angle, outer_angle) = (0.4_f32, 0.9_f32);
    let direction = Vec3::new(0.2, 0.1, -1.0);
    let expected = |point: DVec3| {
        let toward = (POSITION - point).normalize();
        let (inner, outer) = (f64::from(inner_angle).cos(), f64::from(outer_angle).cos());
        let scale = 1.0 / (inner - outer);
        let along = direction.as_dvec3().normalize().dot(-toward);
        let cone = (along * scale - outer * scale).clamp(0.0, 1.0);
        cone * cone * toward.z / POSITION.distance_squared(point)
    };
    let kind = LightKind::Spot { position: POSITION, direction, inner_angle, outer_angle, range: None };
    assert_below(gpu, "spot light", worst(gpu, plane(), kind, expected), 1e-5);
}

const SUN: Vec3 = Vec3::new(-0.3, 0.5, -0.8);

fn sun_on(gpu: &Gpu, what: &str, quad: Quad) {
    let normal = quad.u.as_dvec3().cross(quad.v.as_dvec3()).normalize();
    let share = normal.dot(-SUN.as_dvec3().normalize()).max(0.0);
    let error = worst(gpu, quad, LightKind::Directional { direction: SUN }, |_| share);
    assert_below(gpu, what, error, 1e-6);
}

fn sun_on_a_level_plane(gpu: &Gpu) {
    sun_on(gpu, "sun on a level plane", plane());
}

fn sun_on_a_tilted_plane(gpu: &Gpu) {
    let (u, v) = (Vec3::new(1.0, 0.2, 0.3), Vec3::new(-0.1, 0.9, 0.55));
    sun_on(gpu, "sun on a tilted plane", Quad { u, v, ..plane() });
    let behind = Quad { u: v, v: u, ..plane() };
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: SUN });
    let (map, _) = bake(gpu, &stage.with(&[behind]), How::new(64, Bounces::Auto), 0);
    assert!(map.pixels.iter().all(|pixel| pixel[..3] == [0.0; 3]), "the sun lights the back of a plane");
}
