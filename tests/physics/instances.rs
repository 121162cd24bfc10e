//! Placed meshes: their normals turn with them, whatever the transform.

use crate::device::on_both_back_ends;
use crate::estimate::{How, bake, irradiance};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use lightoven::scene::LightKind;

on_both_back_ends!(turned, mirrored, stretched, stretched_a_thousandfold, mirrored_and_alone);

const SUN: Vec3 = Vec3::new(-0.3, 0.5, -0.8);
/// A normal in two snorm16 is off by at most about half a code in each coordinate of the octahedron.
const OCTAHEDRAL: f64 = 4e-5;

/// Two sloping plates in a mesh.
fn plates() -> [Quad; 2] {
    let plate = |corner, u, v, chart| Quad { corner, u, v, chart: Some(Chart::new(chart)), material: 0 };
    [
        plate(Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5), Vec3::new(0.0, 1.0, 0.25), 0),
        plate(Vec3::X * 3.0, Vec3::new(1.0, 0.0, -0.75), Vec3::new(0.0, 1.0, 0.0), 1),
    ]
}

/// Places the plates, beside another instance or alone, in the sun, and compares with the turned normals' cosine.
fn sun_on_placed(gpu: &Gpu, what: &str, matrix: DMat3, company: Company) {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: SUN });
    stage.place(&plates(), DAffine3 { matrix3: matrix, translation: DVec3::new(5.0, -3.0, 1.0) });
    if let Company::Another = company {
        let other = level_square(1.0, 0.0, Facing::Up, Chart::new(2), 0);
        stage.place(&[other], DAffine3::from_translation(DVec3::new(-1e3, 0.0, 0.0)));
    }
    let (map, statistics) = bake(gpu, &stage.build(), How::new(64, Bounces::Auto), 0);
    assert_eq!(statistics.invalid_texels, 0);
    let to_sun = -SUN.as_dvec3().normalize();
    // A mirrored object's front stays its front: its normals go by the inverse transposed, whatever the determinant's sign.
    let normals = matrix.inverse().transpose();
    for plate in plates() {
        let normal = (normals * plate.u.as_dvec3().cross(plate.v.as_dvec3())).normalize();
        let expected = normal.dot(to_sun).max(0.0);
        let values = irradiance(&map, plate.chart.unwrap());
        let error = values.iter().map(|value| (value - expected).abs()).fold(0.0, f64::max);
        println!("{what}, {}: {expected:.6}, worst texel off by {error:.1e}", gpu.backend().name());
        assert!(error <= OCTAHEDRAL, "{what}: {values:?} instead of {expected}");
    }
}

#[derive(Clone, Copy)]
enum Company {
    Another,
    None,
}

fn tilt() -> DMat3 {
    DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0))
}

fn turned(gpu: &Gpu) {
    sun_on_placed(gpu, "turned", tilt(), Company::Another);
}

fn mirrored(gpu: &Gpu) {
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    sun_on_placed(gpu, "mirrored", tilt() * mirror, Company::Another);
}

fn stretched(gpu: &Gpu) {
    let stretch = DMat3::from_diagonal(DVec3::new(3.0, 0.5, 1.5));
    sun_on_placed(gpu, "stretched", tilt() * stretch, Company::Another);
}

fn stretched_a_thousandfold(gpu: &Gpu) {
    let stretch = DMat3::from_diagonal(DVec3::new(1.0, 1000.0, 1.0));
    sun_on_placed(gpu, "stretched a thousandfold", stretch, Company::Another);
}

fn mirrored_and_alone(gpu: &Gpu) {
    let mirror = DMat3::from_diagonal(DVec3::new(2.0, -1.0, 1.0));
    sun_on_placed(gpu, "mirrored and alone", tilt() * mirror, Company::None);
}
