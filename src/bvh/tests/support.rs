//! Scenes, rays and answers to compare with.

use crate::bvh::traverse::LocalRay;
use crate::bvh::{Bvh, Hit, Ray};
use crate::scene::{Atlas, AtlasRect, Instance, Material, MeshDesc, MeshPart, Mobility, Scene, SceneDesc};
use glam::{DAffine3, DMat3, UVec2, Vec2, Vec3};

pub(super) type Soup = Vec<[Vec3; 3]>;

/// splitmix64
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(super) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    pub(super) fn point(&mut self, half: f32) -> Vec3 {
        (Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0) * half
    }

    /// Not normalised; one in eight is along an axis.
    pub(super) fn direction(&mut self) -> Vec3 {
        let bits = self.bits();
        if bits & 7 == 0 {
            let sign = if bits & 8 == 0 { 1.0 } else { -1.0 };
            return Vec3::AXES[(bits >> 8) as usize % 3] * sign;
        }
        self.point(1.0)
    }
}

/// Random triangles of many sizes, slivers among them.
pub(super) fn soup(random: &mut Random, count: usize) -> Soup {
    let triangle = |index: usize| {
        let (a, size) = (random.point(2.0), 2.0 * random.unit() * random.unit());
        let (b, c) = (a + random.point(size), a + random.point(size));
        if index.is_multiple_of(5) { [a, b, b.lerp(a, 0.5) + random.point(1e-6)] } else { [a, b, c] }
    };
    (0..count).map(triangle).collect()
}

pub(super) fn quad() -> Soup {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let (a, b, c, d) = (corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0));
    vec![[a, b, c], [a, c, d]]
}

/// A cube of side 2 around the origin, seen from outside, each face cut into `side`^2 squares.
pub(super) fn cube(side: usize) -> Soup {
    let at = |i: usize| i as f32 / side as f32 * 2.0 - 1.0;
    let mut triangles = Soup::new();
    for (axis, sign) in [(0, 1.0), (1, 1.0), (2, 1.0), (0, -1.0), (1, -1.0), (2, -1.0)] {
        let corner = |i: usize, j: usize| {
            let mut p = Vec3::ZERO;
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, sign * at(i), at(j));
            p
        };
        for (i, j) in (0..side * side).map(|k| (k / side, k % side)) {
            // The sign runs through the second axis, so that i grows against it on the far side.
            let (a, b, c, d) = (corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// A cube pushed out to the unit sphere.
pub(super) fn sphere(levels: u32) -> Soup {
    cube(1 << levels).into_iter().map(|corners| corners.map(|c| c.normalize())).collect()
}

pub(super) fn scene(soups: &[Soup], placed: &[(usize, DAffine3)]) -> Scene {
    let mesh = |(index, soup): (usize, &Soup)| MeshDesc {
        name: format!("m{index}"),
        parts: vec![MeshPart { positions: soup.iter().flatten().copied().collect(), ..MeshPart::default() }],
    };
    let instance = |(mesh, transform): &(usize, DAffine3)| Instance {
        name: "i".into(),
        mesh: *mesh,
        transform: *transform,
        mobility: Mobility::Static,
    };
    Scene::new(SceneDesc {
        meshes: soups.iter().enumerate().map(mesh).collect(),
        instances: placed.iter().map(instance).collect(),
        materials: vec![Material::default()],
        ..SceneDesc::default()
    })
    .expect("is valid")
}

pub(super) fn atlas(scene: &Scene) -> Atlas {
    let rect = AtlasRect { scale: Vec2::ONE, offset: Vec2::ZERO };
    Atlas {
        size: UVec2::ONE,
        rects: vec![rect; scene.instances().len()],
        shared: true,
        covered_texels: 1,
        touched_texels: 1,
        overlapping_texels: 0,
    }
}

pub(super) fn bvh_of(scene: &Scene) -> Bvh {
    Bvh::build(scene, &atlas(scene)).expect("is built")
}

pub(super) fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, t_min: 0.0, direction, t_max: 1e30 }
}

/// Every triangle of every instance.
pub(super) fn brute_force(bvh: &Bvh, ray: &Ray, skip: Option<(u32, u32)>) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    for (instance, record) in (0..).zip(&bvh.instances) {
        let Some(range) = bvh.meshes.iter().find(|m| m.count > 0 && m.first_primitive == record.first_primitive) else {
            continue;
        };
        let local = match bvh.top_root {
            Some(_) => record.object_ray(ray),
            None => LocalRay::new(ray.origin, ray.direction),
        };
        for primitive in (range.first_primitive..range.first_primitive + range.count)
            .filter(|primitive| skip != Some((instance, *primitive)))
        {
            let t_hit = best.map_or(ray.t_max, |hit| hit.t);
            let found = local.test_triangle(&bvh.triangles[primitive as usize], ray.t_min, t_hit);
            if let Some((t, u, v, front_face)) = found {
                best = Some(Hit { t, instance, primitive, u, v, front_face });
            }
        }
    }
    best
}

/// (t, u, v, front face) of the plane of a triangle in f64, from the scene's own numbers and in world space.
pub(super) fn exact(bvh: &Bvh, scene: &Scene, ray: &Ray, instance: u32, primitive: u32) -> (f64, f64, f64, bool) {
    let placed = &scene.instances()[instance as usize];
    let range = bvh.meshes[placed.mesh];
    let index = bvh.order[placed.mesh][(primitive - range.first_primitive) as usize];
    let corners = scene.meshes()[placed.mesh].positions()[index as usize];
    let corners = bvh.corners().map(|corner| corners[corner]);
    let [a, b, c] = corners.map(|p| scene.centred(placed, bvh.centre).transform_point3(p.as_dvec3()));
    let direction = ray.direction.as_dvec3();
    let solved = DMat3::from_cols(b - a, c - a, -direction).inverse() * (ray.origin.as_dvec3() - a);
    let mirrored = bvh.baked_transform.is_none() && placed.transform.matrix3.determinant() < 0.0;
    let front = ((b - a).cross(c - a).dot(direction) < 0.0) != mirrored;
    (solved.z, solved.x, solved.y, front)
}
