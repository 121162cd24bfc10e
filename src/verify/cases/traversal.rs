//! Rays on the device against the same on the host. Closed form 21.

use super::{Case, Checks};
use crate::bvh::{Bvh, Hit, Ray};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Atlas, MeshPart, Resolution, Scene};
use crate::tracer::Tracer;
use crate::verify::estimate::broken;
use crate::verify::random::Random;
use crate::verify::stage::{Chart, Stage, room};
use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3};

pub(super) const CASES: [Case; 2] = [
    Case::closed_form(21, "rays in a room of instances", instances),
    Case::closed_form(21, "rays in a cloud of triangles", cloud),
];

const RAYS: usize = 500_000;
/// A ray this near to an edge, as a share of the triangle, may pass it on either side.
const EDGE: f32 = 1e-3;

/// Triangles of a hundredth to about the size of the cloud, every tenth of them thin.
fn triangles(count: usize, random: &mut Random) -> MeshPart {
    let mut part = MeshPart { light_map_uvs: Some(Vec::new()), ..MeshPart::default() };
    let uvs = part.light_map_uvs.get_or_insert_default();
    for triangle in 0..count {
        let (centre, size) = (random.vector(), 10.0_f32.powf(-2.0 * random.unit()));
        let side = random.vector() * size;
        let other =
            if triangle % 10 == 0 { side * 0.5 + random.vector() * (1e-3 * size) } else { random.vector() * size };
        let first = part.positions.len() as u32;
        part.positions.extend([centre, centre + side, centre + other]);
        uvs.extend([Vec2::ZERO, Vec2::X, Vec2::Y]);
        part.indices.extend([first, first + 1, first + 2]);
    }
    part
}

/// Without a top level.
fn cloud(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    stage.material(0.5, 0.0);
    stage.place_parts(vec![triangles(3000, &mut Random(1))], DAffine3::IDENTITY);
    compare(gpu, &stage.build()?, checks)
}

/// Turned, stretched and mirrored ones, within a room.
fn instances(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 0.0);
    stage.place(&room(Vec3::splat(-4.0), Vec3::splat(4.0), Chart::new, grey), DAffine3::IDENTITY);
    let mut random = Random(2);
    for place in 0..24_u32 {
        let mut number = || f64::from(random.unit());
        let mirror = if place % 3 == 0 { -1.0 } else { 1.0 };
        let scale = DVec3::new(mirror * (0.1 + number()), 0.1 + number(), 10.0_f64.powf(-number()));
        let turn = DQuat::from_rotation_x(6.0 * number()) * DQuat::from_rotation_z(6.0 * number());
        let at = DVec3::new(number(), number(), number()) * 6.0 - 3.0;
        let transform = DAffine3::from_scale_rotation_translation(scale, turn, at);
        stage.place_parts(vec![triangles(100, &mut random)], transform);
    }
    compare(gpu, &stage.build()?, checks)
}

/// From anywhere within the scene's bounds in all directions, every 64th along an axis.
fn rays(half: Vec3) -> Vec<Ray> {
    let mut random = Random(3);
    let ray = |index: usize| {
        let (origin, any) = (random.vector() * half, random.vector().normalize_or(Vec3::X));
        let direction = if index.is_multiple_of(64) { Vec3::AXES[index / 64 % 3] } else { any };
        Ray { origin, t_min: 0.0, direction, t_max: 1e30 }
    };
    (0..RAYS).map(ray).collect()
}

fn is_near_an_edge(hit: &Hit) -> bool {
    hit.u.min(hit.v).min(1.0 - hit.u - hit.v) <= EDGE
}

/// The same hit or miss, the same distance; the triangle may differ where two meet. Facing, and what a query for any hit
/// says, are compared where the triangle is the same.
fn compare(gpu: &Gpu, scene: &Scene, checks: &mut Checks) -> Result<()> {
    let (lo, hi) = scene.bounds().ok_or_else(|| broken("the scene is empty".into()))?;
    let bvh = Bvh::build(scene, &Atlas::new(scene, Resolution::Texels(64))?)?;
    let rays = rays(((hi - lo) * 0.5).as_vec3());
    let hits = Tracer::new(gpu, scene, &bvh)?.trace(&rays, &vec![None; rays.len()])?;
    let scale = (hi - lo).length() as f32;
    let (mut found, mut differ, mut beside, mut facing, mut any) = (0, 0, 0, 0, 0);
    for (ray, hit) in rays.iter().zip(&hits) {
        let expected = bvh.trace_closest(ray, None);
        found += u64::from(expected.is_some());
        any += u64::from(hit.is_some_and(|hit| hit.primitive == u32::MAX));
        let agree = match (hit, &expected) {
            (None, None) => true,
            (Some(one), Some(other)) => {
                let same = (one.instance, one.primitive) == (other.instance, other.primitive);
                facing += u64::from(same && one.front_face != other.front_face);
                (one.t - other.t).abs() <= 1e-5 * (one.t + scale)
            }
            _ => false,
        };
        if !agree {
            differ += 1;
            // Of two hits the nearer one is what only one of them has seen.
            let nearer = hit.iter().chain(&expected).min_by(|one, other| one.t.total_cmp(&other.t));
            beside += u64::from(!nearer.is_some_and(is_near_an_edge));
        }
    }
    let back_end = gpu.backend().name();
    let most = (RAYS / 100_000) as f64;
    checks.at_least("rays that hit", found as f64, 0.2 * RAYS as f64);
    checks.at_most(format!("rays of {back_end} that differ from the host's"), differ as f64, most);
    checks.count("of these not at an edge", beside, 0);
    checks.count("hits of the same triangle that face otherwise", facing, 0);
    checks.at_most("queries for any hit that say otherwise", any as f64, most);
    Ok(())
}
