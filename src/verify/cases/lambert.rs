//! Case 8, on the host alone: Lambert's form factor of a polygon, by which other cases know what their triangles give.

use super::{Case, Checks};
use crate::error::Result;
use crate::gpu::Gpu;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) const CASES: [Case; 3] = [
    Case::closed_form(8, "polygon before or beside a point", squares),
    Case::closed_form(8, "polygon of any shape", any_shape),
    Case::closed_form(8, "polygons all round a point", all_round),
];

/// What part of the hemisphere over a point, weighed by the cosine, a polygon above the horizon takes up. Positive where
/// the point sees the corners run counter-clockwise: from in front.
pub(super) fn lambert(point: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let corner = |i: usize| (polygon[i % polygon.len()] - point).normalize();
    let edge = |i: usize| {
        let (a, b) = (corner(i), corner(i + 1));
        a.dot(b).clamp(-1.0, 1.0).acos() * b.cross(a).normalize().dot(normal)
    };
    (0..polygon.len()).map(edge).sum::<f64>() / TAU
}

const TOLERANCE: f64 = 1e-6;

/// Cases 6 and 7.
fn squares(_: &Gpu, checks: &mut Checks) -> Result<()> {
    let level = [(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)];
    for (height, factor) in [(0.1, 0.968_340), (1.0, 0.239_456), (10.0, 0.003_172_53)] {
        let square = level.map(|(x, y)| DVec3::new(x, y, height));
        let found = lambert(DVec3::ZERO, DVec3::Z, &square);
        checks.within(format!("square at a height of {height}"), found, factor, TOLERANCE);
    }
    for (away, factor) in [(1.0, 0.055_734), (0.1, 0.221_739), (0.01, 0.247_159), (0.001, 0.249_716)] {
        let square = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)].map(|(y, z)| DVec3::new(away, y, z));
        let found = lambert(DVec3::ZERO, DVec3::Z, &square);
        checks.within(format!("wall at a distance of {away}"), found, factor, TOLERANCE);
    }
    Ok(())
}

/// Evenly spread over 0 to 1, and the same in every run: `index` times a number that no fraction comes near.
fn spread(index: usize, dimension: usize) -> f64 {
    // The root of x^9 = x + 1, for 8 dimensions; Roberts, "The unreasonable effectiveness of quasirandom sequences".
    const ROOT: f64 = 1.085_070_245_491_450_8;
    (0.5 + (index + 1) as f64 * ROOT.powi(-(dimension as i32 + 1))).fract()
}

/// A polygon in a plane, its corners at any distance round a middle.
struct Polygon {
    middle: DVec3,
    /// Toward the point.
    normal: DVec3,
    corners: Vec<DVec3>,
}

/// Above the horizon of a point at the origin and before it, with dents, and close to it at times.
fn polygon(index: usize) -> Polygon {
    let from = |dimension, least: f64, most: f64| least + (most - least) * spread(index, dimension);
    let (height, azimuth) = (from(0, 0.3, 1.0), from(1, 0.0, TAU));
    let away = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0) * (1.0 - height * height).sqrt() + DVec3::Z * height;
    let middle = away * from(2, 0.5, 3.0);
    let (side, other) = away.any_orthonormal_pair();
    // Inclined by at most 57 degrees, which its corners stay before the point with.
    let (lean, toward) = (from(3, 0.0, 1.0), from(4, 0.0, TAU));
    let normal = -away * lean.cos() + (side * toward.cos() + other * toward.sin()) * lean.sin();
    let (u, v) = normal.any_orthonormal_pair();
    let v = if u.cross(v).dot(normal) > 0.0 { v } else { -v };
    let count = 3 + index % 6;
    let reach = middle.z * 0.9;
    let corner = |i: usize| {
        let angle = TAU * (i as f64 + 0.8 * spread(index * 8 + i, 5)) / count as f64;
        let radius = reach * (0.3 + 0.7 * spread(index * 8 + i, 6));
        middle + (u * angle.cos() + v * angle.sin()) * radius
    };
    Polygon { middle, normal, corners: (0..count).map(corner).collect() }
}

/// The integral of both cosines over pi times the squared distance, by areas.
fn integrated(polygon: &Polygon) -> f64 {
    let density = |at: DVec3| at.z * -at.dot(polygon.normal) / (PI * at.length_squared().powi(2));
    let count = polygon.corners.len();
    let of_wedge = |i: usize| {
        let (a, b) = (polygon.corners[i] - polygon.middle, polygon.corners[(i + 1) % count] - polygon.middle);
        // (s, t) of the unit square to s * ((1 - t) * a + t * b), whose density of area is s * |a x b|.
        let twice_the_area = a.cross(b).dot(polygon.normal);
        twice_the_area * over_square(|DVec2 { x: s, y: t }| s * density(polygon.middle + s * a.lerp(b, t)))
    };
    (0..count).map(of_wedge).sum()
}

/// Over the unit square, by Gauss and Legendre with three nodes in each of so many parts of both sides.
fn over_square(integrand: impl Fn(DVec2) -> f64) -> f64 {
    const PARTS: usize = 16;
    let reach = 0.6_f64.sqrt();
    let nodes = [(-reach, 5.0 / 18.0), (0.0, 8.0 / 18.0), (reach, 5.0 / 18.0)];
    let along: Vec<(f64, f64)> = (0..PARTS)
        .flat_map(|part| {
            nodes.map(|(at, weight)| ((part as f64 + 0.5 + 0.5 * at) / PARTS as f64, weight / PARTS as f64))
        })
        .collect();
    let row = |(y, weight): &(f64, f64)| {
        weight * along.iter().map(|(x, weight)| weight * integrand(DVec2::new(*x, *y))).sum::<f64>()
    };
    along.iter().map(row).sum()
}

fn any_shape(_: &Gpu, checks: &mut Checks) -> Result<()> {
    const POLYGONS: usize = 200;
    let mut worst = (0.0, 0.0);
    let mut largest = 0.0_f64;
    for polygon in (0..POLYGONS).map(polygon) {
        let (found, expected) = (lambert(DVec3::ZERO, DVec3::Z, &polygon.corners), integrated(&polygon));
        largest = largest.max(expected);
        // What is no number is the worst.
        if (found - expected).abs().total_cmp(&f64::abs(worst.0 - worst.1)).is_gt() {
            worst = (found, expected);
        }
    }
    checks.at_least("largest integral", largest, 0.2);
    checks.within(format!("worst of {POLYGONS} polygons"), worst.0, worst.1, TOLERANCE);
    Ok(())
}

/// What is all round takes up all of the hemisphere, wherever it stands and however it is cut: here the upper half of a
/// regular octahedron and of a box, turned.
fn all_round(_: &Gpu, checks: &mut Checks) -> Result<()> {
    let rim = |turn: f64, radius: f64, height: f64| -> [DVec3; 4] {
        std::array::from_fn(|i| DMat3::from_rotation_z(turn + i as f64 * FRAC_PI_2) * DVec3::new(radius, 0.0, height))
    };
    for turn in [0.0, 0.3, 1.1] {
        let below = rim(turn, 1.5, 0.0);
        let side = |i: usize, top: &[DVec3]| [&[below[(i + 1) % 4], below[i]], top].concat();
        let octahedron = (0..4).map(|i| lambert(DVec3::ZERO, DVec3::Z, &side(i, &[DVec3::Z * 0.7]))).sum();
        checks.within(format!("octahedron, turned by {turn}"), octahedron, 1.0, TOLERANCE);
        let above = rim(turn, 1.5, 0.4);
        let walls = (0..4).map(|i| lambert(DVec3::ZERO, DVec3::Z, &side(i, &[above[i], above[(i + 1) % 4]])));
        let lid: Vec<DVec3> = above.into_iter().rev().collect();
        let found = walls.sum::<f64>() + lambert(DVec3::ZERO, DVec3::Z, &lid);
        checks.within(format!("box, turned by {turn}"), found, 1.0, TOLERANCE);
    }
    Ok(())
}
