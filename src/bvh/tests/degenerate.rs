//! Triangles and transforms at the edge of what can be represented.

use super::support::*;
use super::{fixed, validate};
use crate::bvh::{Bvh, Ray};
use crate::scene::Scene;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use proptest::prelude::*;

/// Points, lines, needles, copies, and triangles far larger and smaller than the rest, all of about this size.
fn degenerates(random: &mut Random, count: usize, size: f32) -> Soup {
    let mut soup = Soup::new();
    for _ in 0..count {
        let (a, b, c) = (random.point(size), random.point(size), random.point(size));
        let triangle = match random.bits() % 10 {
            0 => [a, a, a],
            1 => [a, b, a],
            2 => [a, b, a + (b - a) * 0.5],
            3 => [a, b, a.lerp(b, random.unit()) + random.point(1e-6 * size)],
            4 => [a, a.next_to(), a.next_to().next_to().with_x(a.x)],
            5 => [a, a + (b - a) * 1e-5, a + (c - a) * 1e-5],
            6 => [a, b.with_z(a.z), c.with_z(a.z)],
            7 => soup.last().copied().unwrap_or([a, b, c]),
            8 => soup.first().map_or([a, b, c], |[a, b, c]| [*c, *b, *a]),
            _ => [a, b, c],
        };
        soup.push(triangle);
    }
    soup
}

/// The next number up in every component.
trait Next {
    fn next_to(self) -> Self;
}

impl Next for Vec3 {
    fn next_to(self) -> Self {
        self.map(f32::next_up)
    }
}

/// A turned, stretched, perhaps mirrored copy somewhere; `exponent`: of the scale.
fn transform(random: &mut Random, exponent: i32) -> DAffine3 {
    let rotation =
        DQuat::from_axis_angle(random.direction().as_dvec3().normalize_or(DVec3::X), f64::from(random.unit()));
    let stretch = [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1e-3, 1.0, 1.0)][random.bits() as usize % 3];
    let scale = 10_f64.powi(exponent);
    DAffine3::from_scale_rotation_translation(stretch * scale, rotation, random.point(4.0).as_dvec3() * scale)
}

/// From anywhere in the scene to a corner, the middle of an edge or a point of a triangle, or along an axis.
fn aimed(random: &mut Random, bvh: &Bvh, reach: f32) -> Ray {
    let origin = random.point(reach);
    let (instance, primitive) = (random.bits() as usize, random.bits() as usize % bvh.triangles.len());
    let [a, b, c] = bvh.triangles[primitive].corners.map(|[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()));
    let rows = bvh.instances[instance % bvh.instances.len()].object_to_world.map(|row| row.map(f64::from));
    let matrix = DMat3::from_cols_array_2d(&rows.map(|[x, y, z, _]| [x, y, z])).transpose();
    let world = DAffine3::from_mat3_translation(matrix, DVec3::from(rows.map(|row| row[3])));
    let target = match random.bits() % 4 {
        0 => a,
        1 => (a + b) * 0.5,
        2 => (a + b + c) / 3.0,
        _ => return ray(origin, Vec3::AXES[instance % 3] * if primitive.is_multiple_of(2) { 1.0 } else { -1.0 }),
    };
    ray(origin, (world.transform_point3(target).as_vec3() - origin).normalize_or(Vec3::Y))
}

/// Distance to the nearest triangle that a ray plainly hits, in f64: one of some width, met well inside and not at a
/// glancing angle.
fn plain_hit(bvh: &Bvh, scene: &Scene, ray: &Ray) -> Option<f64> {
    let instances = (0..).zip(scene.instances()).filter(|(_, instance)| !scene.meshes()[instance.mesh].is_empty());
    let hits = instances.flat_map(|(index, instance)| {
        let range = bvh.meshes[instance.mesh];
        (range.first_primitive..range.first_primitive + range.count).filter_map(move |primitive| {
            let (t, u, v, _) = exact(bvh, scene, ray, index, primitive);
            let inside = u.min(v).min(1.0 - u - v) > 1e-2 && t > 0.0;
            (inside && is_plain(bvh, scene, ray, index, primitive)).then_some(t)
        })
    });
    hits.reduce(f64::min)
}

/// Whether a triangle has some width beside the scene, and is not seen from its edge.
fn is_plain(bvh: &Bvh, scene: &Scene, ray: &Ray, instance: u32, primitive: u32) -> bool {
    let placed = &scene.instances()[instance as usize];
    let index = bvh.order[placed.mesh][(primitive - bvh.meshes[placed.mesh].first_primitive) as usize];
    let corners = scene.meshes()[placed.mesh].positions()[index as usize];
    let [a, b, c] = corners.map(|p| scene.centred(placed, bvh.centre).transform_point3(p.as_dvec3()));
    let normal = (b - a).cross(c - a);
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let width = normal.length() / longest;
    width > 1e-3 * bvh.world_reach() && normal.normalize().dot(ray.direction.as_dvec3()).abs() > 0.05
}

proptest! {
    #![proptest_config(fixed(96))]

    /// Not compared with brute force: of triangles of a few units in the last place, which rays miss by far, the test of
    /// the corners' signs says anything, and the boxes keep most rays from them.
    #[test]
    fn degenerates_hide_no_plain_hit(
        seed: u64, count in 1_usize..200, instances in 1_usize..5, size in -6_i32..9, scale in -6_i32..9,
    ) {
        let mut random = Random(seed);
        let soups = [degenerates(&mut random, count, 10_f32.powi(size))];
        let placed: Vec<_> = (0..instances).map(|_| (0, transform(&mut random, scale))).collect();
        let scene = scene(&soups, &placed);
        let bvh = match Bvh::build(&scene, &atlas(&scene)) {
            Ok(bvh) => bvh,
            // Within an order of the limit: 4 + 1 scales from the middle, each of up to sqrt(3); seen from an instance that
            // is a thousandth as wide.
            Err(error) => {
                let reach = (size + scale).max(scale).max(size + 3).max(3);
                prop_assert!(reach >= 8 && error.to_string().contains("1e10"), "{error}");
                return Ok(());
            }
        };
        validate(&bvh, &scene);
        if bvh.triangles.is_empty() {
            return Ok(());
        }
        let reach = bvh.world_reach();
        for _ in 0..100 {
            let ray = aimed(&mut random, &bvh, reach as f32);
            let found = bvh.trace_closest(&ray, None);
            prop_assert_eq!(bvh.trace_occluded(&ray, None), found.is_some());
            prop_assert!(found.is_none_or(|hit| hit.t.is_finite() && hit.t > 0.0));
            let t = found.map_or(f64::INFINITY, |hit| hit.t.into());
            if let Some(plain) = plain_hit(&bvh, &scene, &ray) {
                prop_assert!(t <= plain + 1e-4 * reach, "{t} instead of {plain}: {ray:?}");
            }
            if let Some(hit) = found.filter(|hit| is_plain(&bvh, &scene, &ray, hit.instance, hit.primitive)) {
                let exact = exact(&bvh, &scene, &ray, hit.instance, hit.primitive).0;
                prop_assert!((t - exact).abs() <= 1e-4 * reach, "{t} instead of {exact}: {ray:?}");
            }
        }
    }

    /// Whatever numbers come: an error by name, or a hierarchy that is what it promises and can be traced.
    #[test]
    fn any_numbers_are_refused_or_traced(
        triangles in prop::collection::vec([corner(), corner(), corner()], 1..40),
        transforms in prop::collection::vec((prop::array::uniform9(entry()), prop::array::uniform3(entry())), 1..4),
    ) {
        let soups = [triangles.iter().map(|corners| corners.map(Vec3::from)).collect::<Soup>()];
        let affine = |(matrix, translation): &([f64; 9], [f64; 3])| {
            DAffine3::from_mat3_translation(DMat3::from_cols_array(matrix), DVec3::from_array(*translation))
        };
        let scene = scene(&soups, &transforms.iter().map(|transform| (0, affine(transform))).collect::<Vec<_>>());
        match Bvh::build(&scene, &atlas(&scene)) {
            Ok(bvh) => {
                prop_assert!(bvh.centre.is_finite());
                prop_assert!(bvh.triangles.iter().flat_map(|t| t.corners).flatten().all(f32::is_finite));
                validate(&bvh, &scene);
                for direction in [Vec3::X, Vec3::NEG_Y, Vec3::ONE, Vec3::new(1e-30, 1.0, -1e-10)] {
                    let hit = bvh.trace_closest(&ray(Vec3::ZERO, direction), None);
                    prop_assert!(hit.is_none_or(|hit| hit.t.is_finite()));
                }
            }
            Err(error) => prop_assert!(error.to_string().contains("reaches the coordinate"), "{error}"),
        }
    }
}

fn corner() -> impl Strategy<Value = [f32; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

/// Finite: others are refused before.
fn coordinate() -> impl Strategy<Value = f32> {
    let edges = [0.0, -0.0, 1.0, -1.0, f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45, 1e10, -1e9, 1e20, 1e-20];
    prop_oneof![
        2 => prop::sample::select(edges.to_vec()),
        2 => any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |number| number.is_finite()),
        6 => -2.0_f32..2.0,
    ]
}

fn entry() -> impl Strategy<Value = f64> {
    let edges = [0.0, 1.0, -1.0, 1e-9, 1e9, 1e-300, 1e300, f64::MAX, -f64::MAX, 5e-324];
    prop_oneof![
        1 => prop::sample::select(edges.to_vec()),
        1 => any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |number| number.is_finite()),
        30 => -2.0_f64..2.0,
    ]
}
