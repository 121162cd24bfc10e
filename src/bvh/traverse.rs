//! Rays on the CPU: the oracle of `bvh.glsl`, with its names and its order.

use super::{Bvh, FIRST_BITS, InstanceRecord, LEAF, MAX_STACK_SIZE, MIN_DIRECTION, Node, TFAR_SCALE, Triangle};
use glam::{Vec3, Vec3A};

/// A ray in world space, relative to [`Bvh::centre`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Hits at or before this are ignored; units of `direction`, at least 0.
    pub t_min: f32,
    /// Where it goes; any length but 0.
    pub direction: Vec3,
    /// Hits at or behind this are ignored; at most 1e30, where nothing is any more.
    pub t_max: f32,
}

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// Instance, in the scene's order.
    pub instance: u32,
    /// Global triangle slot.
    pub primitive: u32,
    /// Barycentric weight of corner 1.
    pub u: f32,
    /// Barycentric weight of corner 2.
    pub v: f32,
    /// Whether the corners are counter-clockwise seen from the ray's origin, in object space: a mirrored object shows
    /// the same side to the outside as the object itself. It is what Vulkan's ray query says of an instance without
    /// facing flags (tests/parity.rs); facing is determined in object space there, and the transform does not change it.
    pub front_face: bool,
}

/// The bits of a leaf's code that hold its first primitive or its instance.
const FIRST_MASK: u32 = (1 << FIRST_BITS) - 1;

/// Codes on the stack that no leaf has: nothing is left; an object is left for the top level.
const DONE: u32 = u32::MAX;
const LEAVE: u32 = u32::MAX - 1;

/// No instance: the ray is in the top level.
const NO_INSTANCE: u32 = u32::MAX;

impl Bvh {
    /// The closest hit with `t_min < t < t_max`; of equal ones, that which is met first. `skip` is the (instance,
    /// primitive) that the ray starts on.
    pub fn trace_closest(&self, ray: &Ray, skip: Option<(u32, u32)>) -> Option<Hit> {
        self.trace::<false>(ray, skip)
    }

    /// Whether anything lies between `t_min` and `t_max`.
    pub fn trace_occluded(&self, ray: &Ray, skip: Option<(u32, u32)>) -> bool {
        self.trace::<true>(ray, skip).is_some()
    }

    fn trace<const ANY: bool>(&self, ray: &Ray, skip: Option<(u32, u32)>) -> Option<Hit> {
        if self.triangles.is_empty() {
            return None;
        }
        let mut stack = [0; MAX_STACK_SIZE + 2];
        stack[0] = DONE;
        let mut height = 1;
        let world = LocalRay::new(ray.origin, ray.direction);
        let mut local = world;
        let mut instance = if self.top_root.is_some() { NO_INSTANCE } else { 0 };
        let mut hit = None;
        let mut t_hit = ray.t_max;
        let mut current = self.root();
        loop {
            while current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let (near0, hit0) = local.test_box(node.lo0, node.hi0, ray.t_min, t_hit);
                let (near1, hit1) = local.test_box(node.lo1, node.hi1, ray.t_min, t_hit);
                let second_first = hit1 & (!hit0 | (near1 < near0));
                let (near, far) = ordered(node, second_first);
                debug_assert!(height < self.stack_size as usize + 2, "the stack overflows");
                stack[height] = far;
                height += usize::from(hit0 & hit1);
                current = near;
                if !(hit0 | hit1) {
                    height -= 1;
                    current = stack[height];
                }
            }
            if current == DONE {
                return hit;
            }
            if current == LEAVE {
                instance = NO_INSTANCE;
                local = world;
            } else if instance == NO_INSTANCE {
                instance = current & FIRST_MASK;
                stack[height] = LEAVE;
                height += 1;
                let record = &self.instances[instance as usize];
                local = record.object_ray(ray);
                current = record.root;
                continue;
            } else if let Some(found) = self.test_leaf(&local, current, instance, ray.t_min, t_hit, skip) {
                t_hit = found.t;
                hit = Some(found);
                if ANY {
                    return hit;
                }
            }
            height -= 1;
            current = stack[height];
        }
    }

    /// The closest hit in a leaf of a bottom level.
    fn test_leaf(
        &self,
        local: &LocalRay,
        code: u32,
        instance: u32,
        t_min: f32,
        mut t_hit: f32,
        skip: Option<(u32, u32)>,
    ) -> Option<Hit> {
        let mut hit = None;
        let first = code & FIRST_MASK;
        let count = ((code & !LEAF) >> FIRST_BITS) + 1;
        for primitive in first..first + count {
            let found = local.test_triangle(&self.triangles[primitive as usize], t_min, t_hit);
            let Some((t, u, v, front_face)) = found else { continue };
            if skip != Some((instance, primitive)) {
                t_hit = t;
                hit = Some(Hit { t, instance, primitive, u, v, front_face });
            }
        }
        hit
    }
}

fn ordered(node: &Node, second_first: bool) -> (u32, u32) {
    if second_first { (node.child1, node.child0) } else { (node.child0, node.child1) }
}

impl InstanceRecord {
    /// The direction is not normalised: distances stay those of the world.
    pub(super) fn object_ray(&self, ray: &Ray) -> LocalRay {
        let rows = self.world_to_object;
        let along = |row: [f32; 4], v: Vec3| row[0] * v.x + row[1] * v.y + row[2] * v.z;
        let origin = Vec3::from(rows.map(|row| along(row, ray.origin) + row[3]));
        LocalRay::new(origin, Vec3::from(rows.map(|row| along(row, ray.direction))))
    }
}

/// A ray in the space of a level, with what the tests of boxes and triangles need of it.
#[derive(Clone, Copy)]
pub(super) struct LocalRay {
    origin: Vec3A,
    inv_dir: Vec3A,
    /// origin * inv_dir
    origin_inv_dir: Vec3A,
    /// Shear and scale of Woop, Benthin, Wald, Watertight Ray/Triangle Intersection, JCGT 2013, as rows: the ray
    /// becomes the z axis. Entries are 1, 0 and -d\[k\] / d\[kz\].
    row_x: Vec3A,
    row_y: Vec3A,
    row_z: Vec3A,
}

impl LocalRay {
    pub(super) fn new(origin: Vec3, direction: Vec3) -> Self {
        let kz = direction.abs().max_position();
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let axis = |k: usize| Vec3A::from(Vec3::AXES[k]);
        let row_z = axis(kz) / direction[kz];
        let inv_dir = Vec3A::from(direction.map(invert));
        let origin = Vec3A::from(origin);
        Self {
            origin,
            inv_dir,
            origin_inv_dir: origin * inv_dir,
            row_x: axis(kx) - axis(kz) * (direction[kx] / direction[kz]),
            row_y: axis(ky) - axis(kz) * (direction[ky] / direction[kz]),
            row_z,
        }
    }

    /// Distance at which the ray enters the box, and whether it does before `t_hit`.
    fn test_box(&self, lo: [f32; 3], hi: [f32; 3], t_min: f32, t_hit: f32) -> (f32, bool) {
        let t_lo = plane(Vec3A::from(lo), self.inv_dir, self.origin_inv_dir);
        let t_hi = plane(Vec3A::from(hi), self.inv_dir, self.origin_inv_dir);
        let tnear = t_lo.min(t_hi).max_element().max(t_min);
        let tfar = t_lo.max(t_hi).min_element().min(t_hit) * TFAR_SCALE;
        (tnear, tnear <= tfar)
    }

    /// (t, u, v, front face) where `t_min < t < t_hit`.
    ///
    /// The edge functions change their sign and nothing else with the order of two corners, because both products are
    /// rounded: a ray at a shared edge hits at least one of the two triangles.
    pub(super) fn test_triangle(&self, triangle: &Triangle, t_min: f32, t_hit: f32) -> Option<(f32, f32, f32, bool)> {
        let [a, b, c] = triangle.corners.map(|[x, y, z, _]| Vec3A::new(x, y, z) - self.origin);
        let (ax, ay) = (self.row_x.dot(a), self.row_y.dot(a));
        let (bx, by) = (self.row_x.dot(b), self.row_y.dot(b));
        let (cx, cy) = (self.row_x.dot(c), self.row_y.dot(c));
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        let t = (u * self.row_z.dot(a) + v * self.row_z.dot(b) + w * self.row_z.dot(c)) / det;
        // A comparison with NaN is false: det = 0 ends here, too.
        if !(det != 0.0 && t > t_min && t < t_hit) {
            return None;
        }
        // x, y, z are a right-handed frame. Seen along +z, a triangle that is counter-clockwise has a negative signed
        // area in it; det is minus twice the signed area. Seen along -z both change their sign.
        let along_z = self.row_z.element_sum() > 0.0;
        Some((t, v / det, w / det, (det > 0.0) == along_z))
    }
}

/// 1 / d, finite.
fn invert(d: f32) -> f32 {
    1.0 / if d.abs() < MIN_DIRECTION { MIN_DIRECTION.copysign(d) } else { d }
}

/// plane * inv_dir - origin * inv_dir; one fma an axis, as on the device, where the CPU has it: a call for each would
/// take longer than all else, and the padding of the boxes allows for either.
fn plane(plane: Vec3A, inv_dir: Vec3A, origin_inv_dir: Vec3A) -> Vec3A {
    if cfg!(target_feature = "fma") {
        plane.mul_add(inv_dir, -origin_inv_dir)
    } else {
        plane * inv_dir - origin_inv_dir
    }
}
