//! Cases 14 and 15: a tilted plate between a uniform sky and a wide ground, and plates under sky maps.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, How, MIXTURES, bake, mean};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{Quat, Vec3};
use lightoven::baker::{Bounces, Sampling};
use lightoven::gpu::Gpu;
use lightoven::scene::{Scene, Sky, SkyMap};
use std::f64::consts::PI;

on_both_back_ends!(
    level,
    inclined,
    upright,
    downward,
    map_of_an_upper_half,
    map_of_a_side,
    aimed_at_an_upper_half,
    aimed_at_a_side,
    bright_row,
    bright_pixel,
    overcast,
);

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
    let estimate = Estimate::of(gpu, &scene, How::new(1024, Bounces::Limit(1)), |map| mean(map, chart));
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

/// A black plate with this normal under a map.
fn scene_under(normal: Vec3, width: u32, height: u32, radiance: impl Fn(u32, u32) -> f32) -> Scene {
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let pixels = (0..width * height).map(|i| Vec3::splat(radiance(i % width, i / width))).collect();
    stage.desc.sky = Sky::Map(SkyMap { width, height, pixels });
    let (u, v) = normal.any_orthonormal_pair();
    let v = if u.cross(v).dot(normal) > 0.0 { v } else { -v };
    stage.with(&[Quad { corner: Vec3::ZERO, u, v, chart: Some(Chart::new(0)), material: black }])
}

/// A map of 4 x 2 pixels of which those for which `lit` (column, row) have a radiance of 1.
fn halves(normal: Vec3, lit: fn(u32, u32) -> bool) -> Scene {
    scene_under(normal, 4, 2, |column, row| f32::from(u8::from(lit(column, row))))
}

/// By rays by the cosine, which are stratified over the hemisphere.
fn stratified(gpu: &Gpu, normal: Vec3, lit: fn(u32, u32) -> bool) -> f64 {
    let how = How::new(64, Bounces::Auto).by(Sampling::Cosine);
    mean(&bake(gpu, &halves(normal, lit), how, 0).0, Chart::new(0))
}

/// The top row is straight up: exact, for every ray of a level plate sees that half or none.
fn map_of_an_upper_half(gpu: &Gpu) {
    let up = stratified(gpu, Vec3::Y, |_, row| row == 0);
    let down = stratified(gpu, Vec3::NEG_Y, |_, row| row == 0);
    println!("upper half lit, {}: {up} facing up, {down} facing down", gpu.backend().name());
    assert!((up - PI).abs() < 1e-5 && down == 0.0);
}

/// The two middle columns are the half toward +x.
fn map_of_a_side(gpu: &Gpu) {
    let [toward, away] =
        [Vec3::X, Vec3::NEG_X].map(|normal| stratified(gpu, normal, |column, _| column == 1 || column == 2));
    let quarter = stratified(gpu, Vec3::Z, |column, _| column == 2);
    println!("half toward +x lit, {}: {toward}, {away}; its +z quarter: {quarter}", gpu.backend().name());
    assert!((toward - PI).abs() < 1e-5 && away == 0.0);
    // Half of what a plate toward +z sees, within the noise of 64 stratified rays a texel over a whole chart.
    assert!((quarter - PI / 2.0).abs() < 0.02 * PI, "a quarter toward +x and +z gives {quarter}");
}

/// By each mixture.
fn assert_aimed(gpu: &Gpu, what: &str, scene: &Scene, expected: f64, tolerance: f64, resolution: f64) {
    for sampling in MIXTURES {
        let how = How::new(4096, Bounces::Auto).by(sampling);
        let estimate = Estimate::direct(gpu, scene, how, Chart::new(0));
        estimate.assert_is(&format!("{what}, {sampling:?}"), gpu, expected, tolerance, resolution);
    }
}

fn aimed_at_an_upper_half(gpu: &Gpu) {
    assert_aimed(gpu, "upper half lit", &halves(Vec3::Y, |_, row| row == 0), PI, 1e-6, 2e-2);
    assert_aimed(gpu, "lower half lit", &halves(Vec3::Y, |_, row| row == 1), 0.0, 0.0, 0.0);
}

fn aimed_at_a_side(gpu: &Gpu) {
    let side = |column, _| column == 1 || column == 2;
    assert_aimed(gpu, "half toward +x lit", &halves(Vec3::X, side), PI, 1e-6, 2e-2);
    assert_aimed(gpu, "half toward -x lit", &halves(Vec3::NEG_X, side), 0.0, 0.0, 0.0);
    assert_aimed(gpu, "quarter toward +x and +z lit", &halves(Vec3::Z, |column, _| column == 2), PI / 2.0, 1e-6, 2e-2);
}

/// What a level plate gets of a row of radiance 1: pi times the difference of squared sines of the angles from the zenith.
fn of_row(row: u32, rows: u32) -> f64 {
    let [above, below] = [row, row + 1].map(|row| (f64::from(row) * PI / f64::from(rows)).sin().powi(2));
    PI * (below - above)
}

/// Neither side is a power of two: the pyramid is padded.
const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;
const BRIGHT_ROW: u32 = 5;

fn bright_row(gpu: &Gpu) {
    let scene = scene_under(Vec3::Y, WIDTH, HEIGHT, |_, row| if row == BRIGHT_ROW { 10.0 } else { 0.0 });
    let expected = 10.0 * of_row(BRIGHT_ROW, HEIGHT);
    assert_aimed(gpu, "bright row", &scene, expected, 1e-5 * expected, 1e-2 * expected);
}

/// The last of its row. Of the rest of the sky comes a hundredth as much.
fn bright_pixel(gpu: &Gpu) {
    let (bright, dim) = (1e4, 0.05);
    let scene =
        scene_under(
            Vec3::Y,
            WIDTH,
            HEIGHT,
            |column, row| {
                if (column, row) == (WIDTH - 1, BRIGHT_ROW) { bright } else { dim }
            },
        );
    let expected = f64::from(bright - dim) * of_row(BRIGHT_ROW, HEIGHT) / f64::from(WIDTH) + PI * f64::from(dim);
    assert_aimed(gpu, "bright pixel", &scene, expected, 1e-5 * expected, 1e-2 * expected);
}

/// Case 15, CIE: L = L_z (1 + 2 cos) / 3 above the horizon, nothing below, in 64 rows by their middles.
fn overcast(gpu: &Gpu) {
    const ROWS: u32 = 64;
    let radiance = |row: u32| {
        let cos = ((f64::from(row) + 0.5) * PI / f64::from(ROWS)).cos();
        if cos > 0.0 { (1.0 + 2.0 * cos) / 3.0 } else { 0.0 }
    };
    let scene = scene_under(Vec3::Y, 8, ROWS, |_, row| radiance(row) as f32);
    let closed = 7.0 * PI / 9.0;
    let of_rows = (0..ROWS).map(|row| radiance(row) * of_row(row, ROWS)).sum::<f64>();
    println!("overcast sky: rows {of_rows:.6}, closed form {closed:.6}");
    assert!((of_rows / closed - 1.0).abs() <= 1e-3);
    assert_aimed(gpu, "overcast sky", &scene, of_rows, 1e-5, 1e-2);
}
