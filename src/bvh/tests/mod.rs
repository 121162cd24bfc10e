//! The hierarchy against brute force and against f64, its encoding, and its worst cases.

mod degenerate;
mod support;
mod watertight;

use super::*;
use glam::{DMat3, DQuat};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use support::*;

/// Everything that the encoding promises.
fn validate(bvh: &Bvh, scene: &Scene) {
    let mut seen = vec![0; bvh.triangles.len()];
    let mut visited = vec![0; bvh.nodes.len()];
    for (mesh, range) in bvh.meshes.iter().enumerate() {
        let mut order = bvh.order[mesh].clone();
        for (slot, index) in order.iter().enumerate() {
            let triangle = bvh.triangles[range.first_primitive as usize + slot];
            let corners = scene.meshes()[mesh].positions()[*index as usize];
            if bvh.baked_transform.is_none() {
                assert_eq!(triangle.corners, corners.map(|c| c.extend(0.0).to_array()));
            }
        }
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..range.count), "order is no permutation");
        if range.count > 0 {
            let mut walk = Walk {
                bvh,
                visited: &mut visited,
                leaf: &mut |first, count, inside| {
                    assert!(count <= MAX_LEAF_SIZE && first >= range.first_primitive);
                    for primitive in first..first + count {
                        seen[primitive as usize] += 1;
                        let corners = bvh.triangles[primitive as usize].corners;
                        assert!(
                            corners.iter().all(|c| inside(Vec3::new(c[0], c[1], c[2]))),
                            "corner outside its boxes"
                        );
                    }
                },
            };
            let depth = walk.depth(range.root, &mut Vec::new());
            assert!(depth <= bvh.stack_size);
        }
    }
    assert!(seen.iter().all(|n| *n == 1), "a triangle is not in exactly one leaf");
    let mut instances = vec![0; bvh.instances.len()];
    if let Some(root) = bvh.top_root {
        let mut walk = Walk {
            bvh,
            visited: &mut visited,
            leaf: &mut |first, count, _| {
                assert_eq!(count, 1);
                instances[first as usize] += 1;
            },
        };
        walk.depth(root, &mut Vec::new());
        let placed = |(i, n): (usize, &i32)| *n == i32::from(!scene.meshes()[scene.instances()[i].mesh].is_empty());
        assert!(instances.iter().enumerate().all(placed), "an instance is not in exactly one leaf");
    }
    assert!(visited.iter().all(|n| *n == 1), "a node is not reached exactly once");
    assert!((1..=MAX_STACK_SIZE as u32).contains(&bvh.stack_size));
}

/// Gets a leaf's first, its count, and whether a point lies in all boxes above it.
type Leaf<'a> = dyn FnMut(u32, u32, &dyn Fn(Vec3) -> bool) + 'a;

struct Walk<'a> {
    bvh: &'a Bvh,
    visited: &'a mut [u32],
    leaf: &'a mut Leaf<'a>,
}

impl Walk<'_> {
    /// Inner nodes on the longest path.
    fn depth(&mut self, code: u32, boxes: &mut Vec<(Vec3, Vec3)>) -> u32 {
        if code & LEAF != 0 {
            let inside = |p: Vec3| boxes.iter().all(|(lo, hi)| p.cmpgt(*lo).all() && p.cmplt(*hi).all());
            (self.leaf)(code & ((1 << FIRST_BITS) - 1), ((code & !LEAF) >> FIRST_BITS) + 1, &inside);
            return 0;
        }
        self.visited[code as usize] += 1;
        let node = self.bvh.nodes[code as usize];
        let mut deepest = 0;
        for (lo, hi, child) in [(node.lo0, node.hi0, node.child0), (node.lo1, node.hi1, node.child1)] {
            if lo == EMPTY {
                continue;
            }
            boxes.push((lo.into(), hi.into()));
            deepest = deepest.max(self.depth(child, boxes));
            boxes.pop();
        }
        deepest + 1
    }
}

/// Random transforms, some mirrored, some 1:1000.
fn transforms(random: &mut Random, count: usize) -> Vec<DAffine3> {
    let one = |random: &mut Random, index: usize| {
        let rotation =
            DQuat::from_axis_angle(random.direction().as_dvec3().normalize(), 3.0 * f64::from(random.unit()));
        let scale = [DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, 1e-3, 2.0)][index % 3];
        DAffine3::from_scale_rotation_translation(scale, rotation, random.point(3.0).as_dvec3())
    };
    (0..count).map(|index| one(random, index)).collect()
}

/// The same cases in every run.
fn fixed(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(fixed(24))]
    #[test]
    fn soups_are_traced_as_by_brute_force(seed: u64, count in 1usize..600, instances in 1usize..7) {
        let mut random = Random(seed);
        let mut soups = vec![soup(&mut random, count), soup(&mut random, 1 + count / 7)];
        let duplicates = soups[0].clone();
        soups[0].extend(duplicates.iter().take(9));
        let transforms = transforms(&mut random, instances);
        let scene = scene(&soups, &(0..instances).map(|i| (i % 2, transforms[i])).collect::<Vec<_>>());
        let bvh = bvh_of(&scene);
        validate(&bvh, &scene);
        for _ in 0..200 {
            let ray = ray(random.point(5.0), random.direction());
            let skip = bvh.trace_closest(&ray, None).map(|hit| (hit.instance, hit.primitive));
            for skip in [None, skip] {
                let (found, expected) = (bvh.trace_closest(&ray, skip), brute_force(&bvh, &ray, skip));
                prop_assert_eq!(found.map(|hit| hit.t), expected.map(|hit| hit.t));
                prop_assert_eq!(bvh.trace_occluded(&ray, skip), expected.is_some());
            }
        }
    }
}

#[test]
fn hits_agree_with_double_precision() {
    let mut random = Random(3);
    let soups = [soup(&mut random, 200)];
    for count in [1, 6] {
        let placed: Vec<_> = transforms(&mut random, count).into_iter().map(|t| (0, t)).collect();
        let scene = scene(&soups, &placed);
        let bvh = bvh_of(&scene);
        let mut hits = 0;
        for _ in 0..2000 {
            let ray = ray(random.point(4.0), random.direction());
            let Some(hit) = bvh.trace_closest(&ray, None) else { continue };
            hits += 1;
            let (t, u, v, front) = exact(&bvh, &scene, &ray, hit.instance, hit.primitive);
            assert!((t - f64::from(hit.t)).abs() < 1e-4 * (1.0 + t), "t is {}, should be {t}", hit.t);
            if (u.min(v).min(1.0 - u - v)) > 0.01 && placed[hit.instance as usize].1.matrix3.determinant().abs() > 0.1 {
                assert!((u - f64::from(hit.u)).abs() + (v - f64::from(hit.v)).abs() < 2e-2, "{hit:?} {u} {v}");
                assert_eq!(front, hit.front_face);
            }
        }
        assert!(hits > 100, "only {hits} rays hit");
    }
}

#[test]
fn a_mirrored_closed_mesh_shows_its_front_to_the_outside() {
    let ball = [sphere(2)];
    let mirror =
        |x: f64| DAffine3::from_scale_rotation_translation(DVec3::new(-1.0, 1.0, 1.0), DQuat::IDENTITY, DVec3::X * x);
    let plain = DAffine3::from_translation(DVec3::new(9.0, 0.0, 0.0));
    for placed in [vec![(0, mirror(0.0))], vec![(0, mirror(0.0)), (0, plain)]] {
        let scene = scene(&ball, &placed);
        let bvh = bvh_of(&scene);
        assert_eq!(bvh.corners(), if placed.len() == 1 { [0, 2, 1] } else { [0, 1, 2] });
        assert_eq!(bvh.instances[0].flags, u32::from(placed.len() > 1));
        let middle = (-bvh.centre).as_vec3();
        for direction in [Vec3::X, Vec3::NEG_X, Vec3::new(0.3, -0.9, 0.1), Vec3::NEG_Z] {
            let inside = bvh.trace_closest(&ray(middle, direction), None).expect("hits");
            let outside = bvh.trace_closest(&ray(middle - direction * 3.0, direction), None).expect("hits");
            assert!(!inside.front_face && outside.front_face);
        }
    }
}

#[test]
fn far_from_the_origin_the_answers_are_those_of_the_origin() {
    let soups = [sphere(3), soup(&mut Random(5), 50)];
    let at = |offset: DVec3| {
        let turned = DAffine3::from_mat3_translation(DMat3::from_rotation_y(0.5), DVec3::new(0.5, 1.0, 0.0) + offset);
        bvh_of(&scene(&soups, &[(0, DAffine3::from_translation(offset)), (1, turned)]))
    };
    let (near, far) = (at(DVec3::ZERO), at(DVec3::new(1e6, -1e6, 1e6)));
    let mut random = Random(6);
    let mut different = 0;
    for _ in 0..2000 {
        let ray = ray(random.point(2.0), random.direction());
        let t = [&near, &far].map(|bvh| bvh.trace_closest(&ray, None).map_or(-1.0, |hit| hit.t));
        different += usize::from((t[0] - t[1]).abs() > 1e-3);
    }
    assert!(different <= 2, "{different} rays differ"); // silhouettes may
}

#[test]
fn an_empty_scene_and_empty_meshes_are_missed() {
    let down = ray(Vec3::Z, Vec3::NEG_Z);
    for (soups, placed) in [
        (vec![], vec![]),
        (vec![vec![]], vec![(0, DAffine3::IDENTITY)]),
        (vec![vec![]], vec![(0, DAffine3::IDENTITY); 3]),
        (vec![quad()], vec![]),
    ] {
        let bvh = bvh_of(&scene(&soups, &placed));
        assert_eq!((bvh.nodes.len(), bvh.stack_size, bvh.root()), (1, 1, 0));
        assert_eq!(bvh.trace_closest(&down, None), None);
    }
    let scene = scene(&[vec![], quad()], &[(0, DAffine3::IDENTITY), (1, DAffine3::IDENTITY)]);
    let bvh = bvh_of(&scene);
    validate(&bvh, &scene);
    assert_eq!(bvh.trace_closest(&ray(Vec3::new(0.2, 0.1, 1.0), Vec3::NEG_Z), None).expect("hits").instance, 1);
}

#[test]
fn a_single_triangle_is_hit_and_skipped() {
    for count in [1, 2] {
        let scene = scene(&[quad()[..1].to_vec()], &vec![(0, DAffine3::IDENTITY); count]);
        let bvh = bvh_of(&scene);
        validate(&bvh, &scene);
        let down = Ray { t_max: f32::INFINITY, ..ray(Vec3::new(0.2, -0.1, 1.0), Vec3::NEG_Z) };
        let hit = bvh.trace_closest(&down, None).expect("hits");
        assert_eq!((hit.t, hit.front_face), (1.0, true));
        let other = bvh.trace_closest(&down, Some((hit.instance, hit.primitive)));
        assert_eq!(other.map(|hit| hit.t), (count == 2).then_some(1.0));
        assert_eq!(bvh.trace_closest(&ray(Vec3::splat(2.0), Vec3::ONE), None), None);
    }
}

#[test]
fn coincident_triangles_and_instances_stay_shallow() {
    let heap: Vec<_> = std::iter::repeat_n(quad()[0], 5000).collect();
    let scene_of_one = scene(&[heap], &[(0, DAffine3::IDENTITY)]);
    let scene_of_many = scene(&[quad()], &vec![(0, DAffine3::IDENTITY); 5000]);
    for scene in [scene_of_one, scene_of_many] {
        let bvh = bvh_of(&scene);
        validate(&bvh, &scene);
        assert!(bvh.stack_size <= 14, "the stack needs {}", bvh.stack_size);
        assert!(bvh.trace_occluded(&ray(Vec3::new(0.2, -0.1, 1.0), Vec3::NEG_Z), None));
    }
}

#[test]
fn moving_an_instance_moves_its_hits() {
    let at = |z: f64| DAffine3::from_translation(DVec3::Z * z);
    let scene =
        scene(&[quad(), sphere(1)], &[(0, at(-4.0)), (0, at(4.0)), (1, DAffine3::from_translation(DVec3::X * 4.0))]);
    let mut bvh = bvh_of(&scene);
    let before = bvh.clone();
    let start = DVec3::new(0.2, 0.1, 8.0) - bvh.centre;
    let down = ray(start.as_vec3(), Vec3::NEG_Z);
    assert_eq!(bvh.trace_closest(&down, None).map(|hit| hit.t), Some(4.0));
    let moved = [at(-4.0), at(1.5), DAffine3::from_translation(DVec3::X * -3.0)];
    for (instance, transform) in moved.iter().enumerate() {
        bvh.place(instance, transform).expect("is moved");
    }
    bvh.rebuild_top_level();
    validate(&bvh, &scene);
    assert_eq!(bvh.trace_closest(&down, None).map(|hit| hit.t), Some(6.5));
    assert_eq!(bvh.nodes.len(), before.nodes.len());
    assert_eq!(bvh.nodes[..bvh.bottom_nodes], before.nodes[..bvh.bottom_nodes]);
    let good = bvh.clone();
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert!(bvh.place(0, &flat).is_err());
    let error = bvh.place(0, &at(1e4)).expect_err("is too far");
    assert_eq!(error.kind(), ErrorKind::Unsupported);
    bvh.rebuild_top_level();
    assert_eq!((&good.nodes, &good.instances), (&bvh.nodes, &bvh.instances));
}

#[test]
fn an_instance_that_is_taken_out_is_not_met() {
    let at = |z: f64| DAffine3::from_translation(DVec3::Z * z);
    let scene = scene(&[quad()], &[(0, at(-4.0)), (0, at(0.0)), (0, at(4.0))]);
    let mut bvh = bvh_of(&scene);
    let most = bvh.most_nodes();
    let down = ray((DVec3::new(0.2, 0.1, 8.0) - bvh.centre).as_vec3(), Vec3::NEG_Z);
    let mut met = |absent: &[usize]| {
        (0..3).for_each(|instance| bvh.set_present(instance, !absent.contains(&instance)));
        bvh.rebuild_top_level();
        assert!(bvh.nodes.len() <= most && bvh.stack_size <= bvh.most_stack_size());
        bvh.trace_closest(&down, None).map(|hit| hit.instance)
    };
    assert_eq!(
        [met(&[]), met(&[2]), met(&[1, 2]), met(&[0, 1, 2]), met(&[0])],
        [Some(2), Some(1), Some(0), None, Some(2)]
    );
}

/// A thousand instances, in any order, need no more stack than was promised when the pipelines were made.
#[test]
fn the_stack_has_a_bound_whatever_moves() {
    let mut random = Random(5);
    let place = |random: &mut Random| {
        DAffine3::from_translation(DVec3::from_array([0; 3].map(|_| f64::from(random.unit()) * 100.0)))
    };
    let instances: Vec<_> = (0..1000).map(|_| (0, place(&mut random))).collect();
    let scene = scene(&[soup(&mut random, 64)], &instances);
    let mut bvh = bvh_of(&scene);
    let promised = bvh.most_stack_size();
    for spread in [1.0, 0.0] {
        for instance in 0..1000 {
            let t = place(&mut random);
            bvh.place(instance, &DAffine3::from_translation(t.translation * spread)).expect("is moved");
        }
        bvh.rebuild_top_level();
        validate(&bvh, &scene);
        assert!(bvh.stack_size <= promised && bvh.nodes.len() <= bvh.most_nodes());
    }
}

#[test]
fn what_is_too_large_is_rejected_by_name() {
    let huge = scene(&[quad()], &[(0, DAffine3::from_scale(DVec3::splat(1e13)))]);
    let error = Bvh::build(&huge, &atlas(&huge)).expect_err("is too large").to_string();
    assert!(error.contains("mesh 'm0'") && error.contains("1e10"), "{error}");
    let error = check_count("triangles", (1 << 26) + 1).expect_err("are too many");
    assert_eq!(error.kind(), ErrorKind::OutOfMemory);
    assert!(error.to_string().contains("67108865 triangles"));
}

#[test]
fn the_same_scene_gives_the_same_hierarchy() {
    let scene = scene(&[soup(&mut Random(1), 9000)], &[(0, DAffine3::IDENTITY)]);
    let (a, b) = (bvh_of(&scene), bvh_of(&scene));
    assert!(a.nodes == b.nodes && a.triangles == b.triangles);
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_eq!((size_of::<Node>(), size_of::<Triangle>(), size_of::<InstanceRecord>()), (64, 48, 128));
}
