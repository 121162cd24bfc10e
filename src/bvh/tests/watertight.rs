//! No ray leaves a closed mesh.

use super::support::*;
use crate::bvh::Bvh;
use glam::{DAffine3, DQuat, DVec3, Vec3};

/// Rays from inside through vertices, edges and anywhere, some along axes: how many leave.
fn leaks(bvh: &Bvh, targets: &Soup, count: usize, origin: impl Fn(&mut Random) -> Vec3) -> usize {
    let mut random = Random(11);
    let shoot = |index: usize| {
        let from = origin(&mut random);
        let corners = targets[random.bits() as usize % targets.len()];
        let to = match index % 4 {
            0 => corners[0],
            1 => corners[1].lerp(corners[2], random.unit()),
            2 => corners[0].lerp(corners[1], 0.5),
            _ => from + random.direction(),
        };
        let hit = bvh.trace_closest(&ray(from, to - from), None);
        usize::from(hit.is_none_or(|hit| hit.front_face))
    };
    (0..count).map(shoot).sum()
}

#[test]
fn a_sphere_does_not_leak() {
    let ball = sphere(5);
    let bvh = bvh_of(&scene(std::slice::from_ref(&ball), &[(0, DAffine3::IDENTITY)]));
    assert_eq!(leaks(&bvh, &ball, 600_000, |random| random.point(0.5)), 0);
}

#[test]
fn a_cube_does_not_leak_in_the_planes_of_its_slabs() {
    let side = 16;
    let grid = cube(side);
    let bvh = bvh_of(&scene(std::slice::from_ref(&grid), &[(0, DAffine3::IDENTITY)]));
    let on_grid = |random: &mut Random| {
        let step = |bits: u64| (bits % (side as u64 - 1) + 1) as f32 / side as f32 * 2.0 - 1.0;
        let bits = random.bits();
        Vec3::new(step(bits & 0xffff), step(bits >> 16 & 0xffff), step(bits >> 32 & 0xffff))
    };
    assert_eq!(leaks(&bvh, &grid, 300_000, on_grid), 0);
    let mut random = Random(2);
    for _ in 0..100_000 {
        let bits = random.bits();
        let mut direction = Vec3::ZERO;
        direction[bits as usize % 3] = if bits & 8 == 0 { 1.0 } else { -1.0 };
        let hit = bvh.trace_closest(&ray(on_grid(&mut random), direction), None);
        assert!(hit.is_some_and(|hit| !hit.front_face), "a ray along an axis leaves the cube");
    }
}

#[test]
fn stretched_and_mirrored_instances_do_not_leak() {
    let ball = sphere(4);
    let turn = DQuat::from_rotation_x(0.7);
    let stretched =
        DAffine3::from_scale_rotation_translation(DVec3::new(-1000.0, 1.0, 30.0), turn, DVec3::new(5.0, 6.0, 7.0));
    let bvh = bvh_of(&scene(
        std::slice::from_ref(&ball),
        &[(0, stretched), (0, DAffine3::from_translation(DVec3::Y * 4000.0))],
    ));
    let world = DAffine3 { translation: stretched.translation - bvh.centre, ..stretched };
    let to_world = |p: Vec3| world.transform_point3(p.as_dvec3()).as_vec3();
    let targets: Soup = ball.iter().map(|corners| corners.map(to_world)).collect();
    assert_eq!(leaks(&bvh, &targets, 200_000, |random| to_world(random.point(0.5))), 0);
}

#[test]
fn tiny_and_huge_scenes_do_not_leak() {
    let ball = sphere(4);
    for scale in [1e-6, 1e6] {
        let grown = DAffine3::from_scale(DVec3::splat(scale));
        let beside = DAffine3 { translation: DVec3::X * scale * 3.0, ..grown };
        for placed in [vec![(0, grown)], vec![(0, grown), (0, beside)]] {
            let bvh = bvh_of(&scene(std::slice::from_ref(&ball), &placed));
            let to_world = |p: Vec3| (p.as_dvec3() * scale - bvh.centre).as_vec3();
            let targets: Soup = ball.iter().map(|corners| corners.map(to_world)).collect();
            assert_eq!(leaks(&bvh, &targets, 50_000, |random| to_world(random.point(0.5))), 0, "scale {scale}");
        }
    }
}
