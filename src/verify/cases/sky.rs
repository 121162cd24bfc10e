//! Cases 14 and 15: a tilted plate between a uniform sky and a wide ground, and plates under sky maps.

use super::{Case, Checks};
use crate::baker::{Bounces, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Scene, Sky, SkyMap};
use crate::verify::estimate::{Estimate, How, MIXTURES, bake, mean};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{Quat, Vec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 11] = [
    Case::closed_form(14, "sky and ground, level", level),
    Case::closed_form(14, "sky and ground, inclined", inclined),
    Case::closed_form(14, "sky and ground, upright", upright),
    Case::closed_form(14, "sky and ground, downward", downward),
    Case::closed_form(14, "sky of an upper half", map_of_an_upper_half),
    Case::closed_form(14, "sky of a side", map_of_a_side),
    Case::closed_form(14, "sky of an upper half, aimed at", aimed_at_an_upper_half),
    Case::closed_form(14, "sky of a side, aimed at", aimed_at_a_side),
    Case::closed_form(15, "sky with a bright row", bright_row),
    Case::closed_form(15, "sky with a bright pixel", bright_pixel),
    Case::closed_form(15, "sky, overcast", overcast),
];

/// Radiance of the sky, and albedo of the ground.
const SKY: f32 = 2.0;
const GROUND: f32 = 0.6;
/// The ground's side; its horizon lies 2e-5 under the plate's, of which at most 1.3e-5 of the irradiance follow.
const WIDE: f32 = 1e5;

fn check_plate(gpu: &Gpu, checks: &mut Checks, degrees: f32) -> Result<()> {
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
    let scene = stage.with(&[ground, plate])?;
    let estimate = Estimate::of(gpu, &scene, How::new(1024, Bounces::Limit(1)), |map| mean(map, chart))?;
    let (sky, cos) = (PI * f64::from(SKY), f64::from(degrees).to_radians().cos());
    let expected = sky * (1.0 + cos) / 2.0 + f64::from(GROUND) * sky * (1.0 - cos) / 2.0;
    checks.estimate(format!("irradiance at a tilt of {degrees} degrees"), estimate, expected, 2e-5 * sky, 1e-2);
    Ok(())
}

fn level(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_plate(gpu, checks, 0.0)
}

fn inclined(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_plate(gpu, checks, 50.0)
}

fn upright(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_plate(gpu, checks, 90.0)
}

fn downward(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_plate(gpu, checks, 160.0)
}

/// A black plate with this normal under a map.
fn scene_under(normal: Vec3, width: u32, height: u32, radiance: impl Fn(u32, u32) -> f32) -> Result<Scene> {
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let pixels = (0..width * height).map(|i| Vec3::splat(radiance(i % width, i / width))).collect();
    stage.desc.sky = Sky::Map(SkyMap { width, height, pixels });
    let (u, v) = normal.any_orthonormal_pair();
    let v = if u.cross(v).dot(normal) > 0.0 { v } else { -v };
    stage.with(&[Quad { corner: Vec3::ZERO, u, v, chart: Some(Chart::new(0)), material: black }])
}

/// A map of 4 x 2 pixels of which those for which `lit` (column, row) have a radiance of 1.
fn halves(normal: Vec3, lit: fn(u32, u32) -> bool) -> Result<Scene> {
    scene_under(normal, 4, 2, |column, row| f32::from(u8::from(lit(column, row))))
}

/// By rays by the cosine, which are stratified over the hemisphere.
fn stratified(gpu: &Gpu, normal: Vec3, lit: fn(u32, u32) -> bool) -> Result<f64> {
    let how = How::new(64, Bounces::Auto).by(Sampling::Cosine);
    mean(&bake(gpu, &halves(normal, lit)?, how, 0)?.0, Chart::new(0))
}

/// The top row is straight up: exact, for every ray of a level plate sees that half or none.
fn map_of_an_upper_half(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let top = |_, row| row == 0;
    checks.within("facing up", stratified(gpu, Vec3::Y, top)?, PI, 1e-5);
    checks.within("facing down", stratified(gpu, Vec3::NEG_Y, top)?, 0.0, 0.0);
    Ok(())
}

/// The two middle columns are the half toward +x.
fn map_of_a_side(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let side = |column, _| column == 1 || column == 2;
    checks.within("facing the side", stratified(gpu, Vec3::X, side)?, PI, 1e-5);
    checks.within("facing away", stratified(gpu, Vec3::NEG_X, side)?, 0.0, 0.0);
    // Half of what a plate toward +z sees, within the noise of 64 stratified rays a texel over a whole chart.
    let quarter = stratified(gpu, Vec3::Z, |column, _| column == 2)?;
    checks.within("quarter of the sphere toward +x and +z", quarter, PI / 2.0, 0.02 * PI);
    Ok(())
}

/// What is expected, what beside noise is allowed, and what is resolved.
struct Expected {
    irradiance: f64,
    tolerance: f64,
    resolution: f64,
}

/// By each mixture.
fn check_aimed(gpu: &Gpu, checks: &mut Checks, what: &str, scene: &Scene, expected: Expected) -> Result<()> {
    let Expected { irradiance, tolerance, resolution } = expected;
    for sampling in MIXTURES {
        let how = How::new(4096, Bounces::Auto).by(sampling);
        let estimate = Estimate::direct(gpu, scene, how, Chart::new(0))?;
        checks.estimate(format!("{what}, by {sampling}"), estimate, irradiance, tolerance, resolution);
    }
    Ok(())
}

const DARK: Expected = Expected { irradiance: 0.0, tolerance: 0.0, resolution: 0.0 };

fn half_lit(irradiance: f64) -> Expected {
    Expected { irradiance, tolerance: 1e-6, resolution: 2e-2 }
}

/// Within a share of 1e-5, known to a hundredth.
fn known(irradiance: f64) -> Expected {
    Expected { irradiance, tolerance: 1e-5 * irradiance, resolution: 1e-2 * irradiance }
}

fn aimed_at_an_upper_half(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_aimed(gpu, checks, "upper half", &halves(Vec3::Y, |_, row| row == 0)?, half_lit(PI))?;
    check_aimed(gpu, checks, "lower half", &halves(Vec3::Y, |_, row| row == 1)?, DARK)
}

fn aimed_at_a_side(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let side = |column, _| column == 1 || column == 2;
    check_aimed(gpu, checks, "facing the side", &halves(Vec3::X, side)?, half_lit(PI))?;
    check_aimed(gpu, checks, "facing away", &halves(Vec3::NEG_X, side)?, DARK)?;
    check_aimed(gpu, checks, "quarter", &halves(Vec3::Z, |column, _| column == 2)?, half_lit(PI / 2.0))
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

fn bright_row(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene_under(Vec3::Y, WIDTH, HEIGHT, |_, row| if row == BRIGHT_ROW { 10.0 } else { 0.0 })?;
    check_aimed(gpu, checks, "irradiance", &scene, known(10.0 * of_row(BRIGHT_ROW, HEIGHT)))
}

/// The last of its row. Of the rest of the sky comes a hundredth as much.
fn bright_pixel(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (bright, dim) = (1e4, 0.05);
    let radiance = |column, row| if (column, row) == (WIDTH - 1, BRIGHT_ROW) { bright } else { dim };
    let scene = scene_under(Vec3::Y, WIDTH, HEIGHT, radiance)?;
    let of_pixel = f64::from(bright - dim) * of_row(BRIGHT_ROW, HEIGHT) / f64::from(WIDTH);
    check_aimed(gpu, checks, "irradiance", &scene, known(of_pixel + PI * f64::from(dim)))
}

/// CIE: L = L_z (1 + 2 cos) / 3 above the horizon, nothing below, in 64 rows by their middles.
fn overcast(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const ROWS: u32 = 64;
    let radiance = |row: u32| {
        let cos = ((f64::from(row) + 0.5) * PI / f64::from(ROWS)).cos();
        if cos > 0.0 { (1.0 + 2.0 * cos) / 3.0 } else { 0.0 }
    };
    let scene = scene_under(Vec3::Y, 8, ROWS, |_, row| radiance(row) as f32)?;
    let of_rows = (0..ROWS).map(|row| radiance(row) * of_row(row, ROWS)).sum::<f64>();
    checks.relative("the rows' sum", of_rows, 7.0 * PI / 9.0, 1e-3);
    let expected = Expected { irradiance: of_rows, tolerance: 1e-5, resolution: 1e-2 };
    check_aimed(gpu, checks, "irradiance", &scene, expected)
}
