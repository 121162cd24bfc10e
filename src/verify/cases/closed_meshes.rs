//! Extreme case 15: no ray leaves a closed mesh, whatever it is aimed at, on the device and on the host.

use super::{Case, Checks};
use crate::bvh::{Bvh, Hit, Ray};
use crate::error::Result;
use crate::gpu::{Backend, Gpu};
use crate::scene::{Atlas, MeshPart, Resolution};
use crate::tracer::Tracer;
use crate::verify::stage::Stage;
use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3};

pub(super) const CASES: [Case; 3] = [
    Case::extreme(15, "rays in a ball", ball),
    Case::extreme(15, "rays in a box, in the planes of its grid", grid),
    Case::extreme(15, "rays in a ball, stretched and mirrored", stretched),
];

const RAYS: usize = 70_000;

/// splitmix64
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Below 1.
    fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    fn point(&mut self, half: f32) -> Vec3 {
        (Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0) * half
    }

    fn axis(&mut self) -> Vec3 {
        let bits = self.bits();
        Vec3::AXES[bits as usize % 3] * if bits & 8 == 0 { 1.0 } else { -1.0 }
    }
}

type Triangles = Vec<[Vec3; 3]>;

/// Of side 2 around the origin, fronts outward, each face cut into `side`^2 squares.
fn cube(side: usize) -> Triangles {
    let at = |index: usize| index as f32 / side as f32 * 2.0 - 1.0;
    let mut triangles = Triangles::new();
    for (axis, sign) in [(0, 1.0), (1, 1.0), (2, 1.0), (0, -1.0), (1, -1.0), (2, -1.0)] {
        let corner = |i: usize, j: usize| {
            let mut point = Vec3::ZERO;
            (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (sign, sign * at(i), at(j));
            point
        };
        for (i, j) in (0..side * side).map(|square| (square / side, square % side)) {
            let (a, b, c, d) = (corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// A cube pushed out to the unit sphere: corners that meet are the same to the bit.
fn sphere(side: usize) -> Triangles {
    cube(side).into_iter().map(|corners| corners.map(Vec3::normalize)).collect()
}

/// The triangles as they are placed, traced on the device and on the host.
struct Closed {
    bvh: Bvh,
    tracer: Tracer,
    /// Share of rays that the device may lose.
    allowance: f64,
}

/// Vulkan asks drivers for watertight triangles too (Ray Traversal, Watertightness), and where they trace in software they
/// do not all keep to it: Mesa 25.0's lavapipe loses 326 of 70,000 rays that are aimed at a ball's corners and edges.
const LOST_BY_SOFTWARE_RAY_QUERIES: f64 = 0.01;

impl Closed {
    fn new(gpu: &Gpu, triangles: &Triangles, placed: &[DAffine3]) -> Result<Self> {
        let mut stage = Stage::new();
        stage.material(0.0, 0.0);
        for transform in placed {
            let positions: Vec<Vec3> = triangles.iter().flatten().copied().collect();
            let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE];
            let light_map_uvs = Some(corners.into_iter().cycle().take(positions.len()).collect());
            stage.place_parts(vec![MeshPart { positions, light_map_uvs, ..MeshPart::default() }], *transform);
        }
        let scene = stage.build()?;
        let bvh = Bvh::build(&scene, &Atlas::new(&scene, Resolution::Texels(8))?)?;
        let is_drivers = gpu.backend() == Backend::RayQuery && gpu.info().is_cpu();
        let allowance = if is_drivers { LOST_BY_SOFTWARE_RAY_QUERIES } else { 0.0 };
        Ok(Self { tracer: Tracer::new(gpu, &scene, &bvh)?, bvh, allowance })
    }

    /// Each ray hits a back, and any-hit queries say so too.
    fn check(&mut self, checks: &mut Checks, what: &str, rays: &[Ray]) -> Result<()> {
        let leaves = |hit: &Option<Hit>| hit.is_none_or(|hit| hit.front_face || hit.primitive == u32::MAX);
        let hits = self.tracer.trace(rays, &vec![None; rays.len()])?;
        let left = hits.iter().filter(|hit| leaves(hit)).count();
        checks.at_most(
            format!("rays {what} that leave on the device"),
            left as f64,
            self.allowance * rays.len() as f64,
        );
        let hits = rays.iter().map(|ray| self.bvh.trace_closest(ray, None));
        checks.count(format!("rays {what} that leave on the host"), hits.filter(leaves).count() as u64, 0);
        Ok(())
    }
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, t_min: 0.0, direction, t_max: 1e30 }
}

/// From inside to corners, along edges' points, to edges' middles and anywhere.
fn rays(targets: &Triangles, mut origin: impl FnMut(&mut Random) -> Vec3) -> Vec<Ray> {
    let mut random = Random(11);
    let shoot = |index: usize| {
        let from = origin(&mut random);
        let corners = targets[random.bits() as usize % targets.len()];
        let to = match index % 4 {
            0 => corners[0],
            1 => corners[1].lerp(corners[2], random.unit()),
            2 => corners[0].lerp(corners[1], 0.5),
            _ => from + random.point(1.0),
        };
        ray(from, to - from)
    };
    (0..RAYS).map(shoot).collect()
}

fn ball(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let ball = sphere(32);
    let mut closed = Closed::new(gpu, &ball, &[DAffine3::IDENTITY])?;
    closed.check(checks, "to corners and edges", &rays(&ball, |random| random.point(0.5)))
}

/// The planes are where the squares meet, which are the sides of boxes too.
fn grid(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const SQUARES: u64 = 16;
    let grid = cube(SQUARES as usize);
    let on_grid = |random: &mut Random| {
        let mut step = || (random.bits() % (SQUARES - 1) + 1) as f32 / SQUARES as f32 * 2.0 - 1.0;
        Vec3::new(step(), step(), step())
    };
    let mut closed = Closed::new(gpu, &grid, &[DAffine3::IDENTITY])?;
    closed.check(checks, "to corners and edges", &rays(&grid, on_grid))?;
    let mut random = Random(2);
    let along_axes: Vec<Ray> = (0..RAYS / 2).map(|_| ray(on_grid(&mut random), random.axis())).collect();
    closed.check(checks, "along axes", &along_axes)
}

/// Among two instances, so that rays are transformed on their way.
fn stretched(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let ball = sphere(16);
    let turn = DQuat::from_rotation_x(0.7);
    let scale = DVec3::new(-1000.0, 1.0, 30.0);
    let stretched = DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(5.0, 6.0, 7.0));
    let mut closed = Closed::new(gpu, &ball, &[stretched, DAffine3::from_translation(DVec3::Y * 4000.0)])?;
    let world = DAffine3 { translation: stretched.translation - closed.bvh.centre, ..stretched };
    let to_world = |point: Vec3| world.transform_point3(point.as_dvec3()).as_vec3();
    let targets: Triangles = ball.iter().map(|corners| corners.map(to_world)).collect();
    closed.check(checks, "to corners and edges", &rays(&targets, |random| to_world(random.point(0.5))))
}
