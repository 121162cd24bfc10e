//! Extreme case 14: placed meshes have their normals and their area from their transform, whatever that is.

use super::{Case, Checks};
use crate::baker::Bounces;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{LightKind, Scene};
use crate::verify::estimate::{How, bake, irradiance};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

pub(super) const CASES: [Case; 6] = [
    Case::conduct("instance, turned", turned),
    Case::extreme(14, "instance, mirrored", mirrored),
    Case::extreme(14, "instance, stretched", stretched),
    Case::extreme(14, "instance, stretched a thousandfold", stretched_a_thousandfold),
    Case::extreme(14, "instance, mirrored and alone", mirrored_and_alone),
    Case::extreme(14, "instance, singular", singular),
];

const SUN: Vec3 = Vec3::new(-0.3, 0.5, -0.8);
/// A normal in two snorm16 is off by at most about half a code in each coordinate of the octahedron.
const OCTAHEDRAL: f64 = 4e-5;
/// What surfaces shine, so that rays are sent: areas are told by them. Far below what the sun's light is rounded by.
const FAINT: f32 = 1e-20;
/// How the charts lie: whole texels, nothing beside them.
const INSET: f32 = 0.01;

/// Two sloping plates in a mesh.
fn plates() -> [Quad; 2] {
    let plate = |corner, u, v, chart| Quad { corner, u, v, chart: Some(Chart::new(chart).inset(INSET)), material: 0 };
    [
        plate(Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5), Vec3::new(0.0, 1.0, 0.25), 0),
        plate(Vec3::X * 3.0, Vec3::new(1.0, 0.0, -0.75), Vec3::new(0.0, 1.0, 0.0), 1),
    ]
}

#[derive(Clone, Copy)]
enum Company {
    Another,
    None,
}

/// A level square beside them.
fn other() -> Quad {
    level_square(1.0, 0.0, Facing::Up, Chart::new(2).inset(INSET), 0)
}

/// The plates in the sun, beside another instance or alone.
fn placed(matrix: DMat3, company: Company) -> Stage {
    let mut stage = Stage::new();
    stage.material(0.0, FAINT);
    stage.light(LightKind::Directional { direction: SUN });
    stage.place(&plates(), DAffine3 { matrix3: matrix, translation: DVec3::new(5.0, -3.0, 1.0) });
    if let Company::Another = company {
        stage.place(&[other()], DAffine3::from_translation(DVec3::new(-1e3, 0.0, 0.0)));
    }
    stage
}

/// Compares what the plates get with the turned normals' cosine, and the texels' areas with the plates'.
fn check_sun_on(gpu: &Gpu, checks: &mut Checks, matrix: DMat3, company: Company) -> Result<()> {
    let scene = placed(matrix, company).build()?;
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    checks.count("texels inside something", statistics.invalid_texels, 0);
    let to_sun = -SUN.as_dvec3().normalize();
    // A mirrored object's front stays its front: its normals go by the inverse transposed, whatever the determinant's sign.
    let normals = matrix.inverse().transpose();
    // Texels count whole, also where the surface ends within.
    let whole = |chart: Chart| (f64::from(chart.size) / chart.side()).powi(2);
    let mut area = if let Company::Another = company { whole(other().mapped()?) } else { 0.0 };
    for (plate, name) in plates().iter().zip(["plate", "other plate"]) {
        let (u, v, chart) = (plate.u.as_dvec3(), plate.v.as_dvec3(), plate.mapped()?);
        let expected = (normals * u.cross(v)).normalize().dot(to_sun).max(0.0);
        area += (matrix * u).cross(matrix * v).length() * whole(chart);
        let values = irradiance(&map, chart)?;
        let (lowest, highest) =
            (values.iter().copied().fold(f64::MAX, f64::min), values.iter().copied().fold(0.0, f64::max));
        checks.within(format!("lowest irradiance of a {name}"), lowest, expected, OCTAHEDRAL);
        checks.within(format!("highest irradiance of a {name}"), highest, expected, OCTAHEDRAL);
    }
    checks.relative("area of the texels", statistics.area, area, 1e-4);
    Ok(())
}

fn tilt() -> DMat3 {
    DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0))
}

fn turned(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    check_sun_on(gpu, checks, tilt(), Company::Another)
}

fn mirrored(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    check_sun_on(gpu, checks, tilt() * mirror, Company::Another)
}

fn stretched(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let stretch = DMat3::from_diagonal(DVec3::new(3.0, 0.5, 1.5));
    check_sun_on(gpu, checks, tilt() * stretch, Company::Another)
}

fn stretched_a_thousandfold(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let stretch = DMat3::from_diagonal(DVec3::new(1.0, 1000.0, 1.0));
    check_sun_on(gpu, checks, stretch, Company::Another)
}

fn mirrored_and_alone(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mirror = DMat3::from_diagonal(DVec3::new(2.0, -1.0, 1.0));
    check_sun_on(gpu, checks, tilt() * mirror, Company::None)
}

/// Flattened, or shrunk to a line or a point, it is left out by name: what is beside it is baked as if it had never been.
fn singular(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let how = How::new(64, Bounces::Auto);
    let mut alone = Stage::new();
    alone.material(0.0, FAINT);
    alone.light(LightKind::Directional { direction: SUN });
    alone.place(&[other()], DAffine3::from_translation(DVec3::new(-1e3, 0.0, 0.0)));
    let wanted = bake(gpu, &alone.build()?, how, 0)?.0;
    let flat = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0));
    for (what, matrix) in [
        ("flat", flat),
        ("flat but for rounding", DMat3 { z_axis: DVec3::new(1.0, 1.0, 1e-13), ..flat }),
        ("a line", DMat3::from_diagonal(DVec3::Z)),
        ("a point", DMat3::ZERO),
    ] {
        let scene = Scene::new(placed(matrix, Company::Another).desc)?;
        let told = matches!(scene.warnings(), [only] if only.contains("'instance 0'") && only.contains("singular"));
        checks.holds(format!("{what}: a warning names the instance"), told);
        checks.count(format!("{what}: instances that are left"), scene.instances().len() as u64, 1);
        let found = bake(gpu, &scene, how, 0)?.0;
        checks.holds(format!("{what}: the rest is the same to the bit"), found == wanted);
    }
    Ok(())
}
