//! Cases 9 and 10: a sphere above a point, and two discs, as many triangles.

use super::lambert::lambert;
use super::{Case, Checks};
use crate::baker::Bounces;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::MeshPart;
use crate::verify::estimate::{Estimate, How, SAMPLINGS};
use crate::verify::stage::{Chart, Facing, Quad, SIDE, Stage, level_square};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

pub(super) const CASES: [Case; 2] =
    [Case::closed_form(9, "sphere above a point", sphere), Case::closed_form(10, "discs on one axis", discs)];

pub(super) type Triangle = [DVec3; 3];

/// Every other texel of a light map, in rows, from a column on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    pub(super) first_column: usize,
    /// Side of the light map, texels.
    pub(super) side: u32,
}

impl Places {
    fn columns(self) -> usize {
        (self.side as usize - self.first_column) / 2
    }

    fn column_and_row(self, index: usize) -> [usize; 2] {
        [self.first_column + index % self.columns() * 2, 1 + index / self.columns() * 2]
    }

    /// Where it lies in the light map.
    pub(super) fn texel(self, index: usize) -> usize {
        let [column, row] = self.column_and_row(index);
        row * self.side as usize + column
    }
}

/// Right of the small charts.
const BESIDE: Places = Places { first_column: 40, side: SIDE };

/// Corners in a texel, counted from its own. Where the next facet stands up from a concave edge, a texel takes light only as
/// far along both axes as its centre sees: from near the middle of a level edge, over almost all of the triangle.
const CORNERS: [Vec2; 3] = [Vec2::new(0.02, 0.45), Vec2::new(0.98, 0.45), Vec2::new(0.5, 0.97)];

/// Each triangle in a texel of its own, from this place on.
pub(super) fn facets(triangles: &[Triangle], places: Places, first: usize, material: usize) -> MeshPart {
    let uvs = |index: usize| {
        let [column, row] = places.column_and_row(first + index);
        CORNERS.map(|corner| (Vec2::new(column as f32, row as f32) + corner) / places.side as f32)
    };
    MeshPart {
        positions: triangles.iter().flatten().map(|corner| corner.as_vec3()).collect(),
        light_map_uvs: Some((0..triangles.len()).flat_map(uvs).collect()),
        material,
        ..MeshPart::default()
    }
}

/// 320 triangles about the origin with corners at a distance of 1, counter-clockwise from outside.
pub(super) fn icosphere() -> Vec<Triangle> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let ring = |(a, b): (f64, f64)| {
        let corner = DVec3::new(0.0, a, b * golden).normalize();
        [corner, DVec3::new(corner.z, corner.x, corner.y), DVec3::new(corner.y, corner.z, corner.x)]
    };
    let corners: Vec<DVec3> = signs.into_iter().flat_map(ring).collect();
    let mut triangles = Vec::new();
    for (i, a) in corners.iter().enumerate() {
        for (j, b) in corners.iter().enumerate().skip(i + 1) {
            for c in &corners[j + 1..] {
                let adjacent = |x: &DVec3, y: &DVec3| x.dot(*y) > 0.4;
                if adjacent(a, b) && adjacent(b, c) && adjacent(a, c) {
                    triangles.push(if a.dot(b.cross(*c)) > 0.0 { [*a, *b, *c] } else { [*a, *c, *b] });
                }
            }
        }
    }
    let split = |[a, b, c]: Triangle| {
        let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    (0..2).fold(triangles, |triangles, _| triangles.into_iter().flat_map(split).collect())
}

pub(super) fn area([a, b, c]: &Triangle) -> f64 {
    0.5 * (*b - *a).cross(*c - *a).length()
}

/// A point on the ground that sees a whole sphere, of the area of one with this radius, 1 away, 37 degrees from the zenith.
fn sphere(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const RADIUS: f64 = 0.5;
    const AWAY: DVec3 = DVec3::new(0.6, 0.0, 0.8);
    let unit = icosphere();
    checks.count("triangles", unit.len() as u64, 320);
    let radius = RADIUS * (2.0 * TAU / unit.iter().map(area).sum::<f64>()).sqrt();
    let triangles: Vec<Triangle> = unit.iter().map(|corners| corners.map(|corner| corner * radius + AWAY)).collect();
    let seen = |corners: &Triangle| lambert(DVec3::ZERO, DVec3::Z, corners).max(0.0);
    let expected = triangles.iter().map(seen).sum::<f64>();
    checks.relative("the triangles' sum", expected, AWAY.z * RADIUS * RADIUS, 3e-3);
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    stage.place_parts(vec![facets(&triangles, BESIDE, 0, lamp)], DAffine3::IDENTITY);
    let chart = Chart::large(0);
    let scene = stage.with(&[level_square(1e-4, 0.0, Facing::Up, chart, black)])?;
    for sampling in SAMPLINGS {
        let how = How::new(512, Bounces::Auto).by(sampling);
        let estimate = Estimate::direct(gpu, &scene, how, chart)?.times(PI.recip());
        checks.estimate(format!("by {sampling}"), estimate, expected, 1e-6, 5e-3);
    }
    Ok(())
}

/// A disc of as many sides, of the area of a round one, about the axis z.
const SIDES: usize = 64;

fn rim(radius: f64, height: f64) -> Vec<DVec3> {
    let step = TAU / SIDES as f64;
    let radius = radius * (step / step.sin()).sqrt();
    let corner = |i: usize| DVec3::new((i as f64 * step).cos() * radius, (i as f64 * step).sin() * radius, height);
    (0..SIDES).map(corner).collect()
}

/// The upper disc shines; the lower one is a point at a time: the mean over rings of equal area, at their middles, by
/// Lambert, must be the closed form, and so must what rings of little squares receive.
fn discs(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const RINGS: usize = 8;
    let upper = rim(1.0, 1.0);
    let seen_from_below: Vec<DVec3> = upper.iter().rev().copied().collect();
    let radius = |ring: usize| ((ring as f64 + 0.5) / RINGS as f64).sqrt();
    let of_ring = |ring: usize| lambert(DVec3::X * radius(ring), DVec3::Z, &seen_from_below);
    let expected = (0..RINGS).map(of_ring).sum::<f64>() / RINGS as f64;
    checks.relative("the rings' mean", expected, 0.381_966, 3e-3);
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let middle = DVec3::Z;
    let wedges: Vec<Triangle> = (0..SIDES).map(|i| [middle, upper[(i + 1) % SIDES], upper[i]]).collect();
    stage.place_parts(vec![facets(&wedges, BESIDE, 0, lamp)], DAffine3::IDENTITY);
    let charts: Vec<Chart> = (0..RINGS as u32).map(Chart::new).collect();
    let on_ring = |(ring, chart): (usize, &Chart)| {
        let quad = level_square(1e-4, 0.0, Facing::Up, *chart, black);
        Quad { corner: quad.corner + Vec3::X * radius(ring) as f32, ..quad }
    };
    let quads: Vec<Quad> = charts.iter().enumerate().map(on_ring).collect();
    let scene = stage.with(&quads)?;
    for sampling in SAMPLINGS {
        let how = How::new(1024, Bounces::Auto).by(sampling);
        let estimate = Estimate::mean_of(&Estimate::each_direct(gpu, &scene, how, &charts)?).times(PI.recip());
        checks.estimate(format!("by {sampling}"), estimate, expected, 1e-6, 4e-3);
    }
    Ok(())
}
