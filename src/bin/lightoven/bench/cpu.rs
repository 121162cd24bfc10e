//! obvhs's own traversal of its own hierarchy with its own triangle test, on all cores.

use glam::{DVec3, Vec3};
use lightoven::Query;
use lightoven::bvh::Ray;
use lightoven::scene::Scene;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Rays that a thread takes at a time: about a millisecond.
const BLOCK: usize = 4096;
/// Rays that hierarchies are tried with, and how often.
const TRIAL_RAYS: usize = 1 << 17;
const TRIALS: usize = 8;

/// A scene as obvhs traces it: all triangles in world space, in the order of its leaves.
pub(crate) struct Cpu {
    hierarchy: Hierarchy,
    triangles: Vec<RtTriangle>,
    /// Which hierarchy it is.
    pub(crate) name: &'static str,
    pub(crate) threads: usize,
}

enum Hierarchy {
    Binary(Bvh2),
    Wide(CwBvh),
}

/// A hierarchy that obvhs builds.
struct Offer {
    name: &'static str,
    shape: Shape,
    parameters: BvhBuildParams,
}

enum Shape {
    Binary,
    Wide,
}

impl Offer {
    const fn new(name: &'static str, shape: Shape, parameters: BvhBuildParams) -> Self {
        Self { name, shape, parameters }
    }
}

/// Those that are made to be fast to trace.
const OFFERS: [Offer; 6] = [
    Offer::new("Bvh2, medium build", Shape::Binary, BvhBuildParams::medium_build()),
    Offer::new("Bvh2, slow build", Shape::Binary, BvhBuildParams::slow_build()),
    Offer::new("Bvh2, very slow build", Shape::Binary, BvhBuildParams::very_slow_build()),
    Offer::new("CwBvh, medium build", Shape::Wide, BvhBuildParams::medium_build()),
    Offer::new("CwBvh, slow build", Shape::Wide, BvhBuildParams::slow_build()),
    Offer::new("CwBvh, very slow build", Shape::Wide, BvhBuildParams::very_slow_build()),
];

/// Where a ray ends; infinite for a miss.
pub(crate) type Distance = f32;

impl Cpu {
    /// The fastest on these rays, for closest hits, of the hierarchies that obvhs offers. `centre`: the point of the world
    /// that is the rays' origin.
    pub(crate) fn fastest(scene: &Scene, centre: DVec3, rays: &[Ray]) -> Self {
        let triangles = world_triangles(scene, centre);
        let rays = &rays[..rays.len().min(TRIAL_RAYS)];
        let mut found = vec![0.0; rays.len()];
        let mut offers: Vec<(Duration, Self)> =
            OFFERS.iter().map(|offer| (Duration::MAX, Self::new(&triangles, offer))).collect();
        // In turn, and the best of each: a machine that others use slows one more than the other.
        for _ in 0..TRIALS {
            for (best, cpu) in &mut offers {
                *best = (*best).min(cpu.trace(rays, Query::Closest, &mut found));
            }
        }
        let fastest = (0..offers.len()).min_by_key(|place| offers[*place].0).unwrap_or(0);
        offers.swap_remove(fastest).1
    }

    fn new(triangles: &[Triangle], offer: &Offer) -> Self {
        let in_order =
            |indices: &[u32]| indices.iter().map(|index| RtTriangle::from(&triangles[*index as usize])).collect();
        let mut unused = Duration::ZERO;
        let (hierarchy, triangles) = match offer.shape {
            Shape::Binary => {
                let bvh = build_bvh2_from_tris(triangles, offer.parameters, &mut unused);
                let triangles = in_order(&bvh.primitive_indices);
                (Hierarchy::Binary(bvh), triangles)
            }
            Shape::Wide => {
                let bvh = build_cwbvh_from_tris(triangles, offer.parameters, &mut unused);
                let triangles = in_order(&bvh.primitive_indices);
                (Hierarchy::Wide(bvh), triangles)
            }
        };
        let threads = thread::available_parallelism().map_or(1, usize::from);
        Self { hierarchy, triangles, name: offer.name, threads }
    }

    /// Traces with all cores into `found`, `[ray]`, and returns how long it took. Of [`Query::Occluded`] a distance means
    /// only that there is a hit.
    pub(crate) fn trace(&self, rays: &[Ray], query: Query, found: &mut [Distance]) -> Duration {
        let triangles = self.triangles.as_slice();
        let test = |ray: &obvhs::ray::Ray, primitive: usize| triangles[primitive].intersect(ray);
        let distance = |missed: bool| if missed { f32::INFINITY } else { 0.0 };
        match (&self.hierarchy, query) {
            (Hierarchy::Binary(bvh), Query::Closest) => self.for_each(rays, found, |ray| {
                let mut hit = RayHit::none();
                bvh.ray_traverse(ray, &mut hit, test);
                hit.t
            }),
            (Hierarchy::Wide(bvh), Query::Closest) => self.for_each(rays, found, |ray| {
                let mut hit = RayHit::none();
                bvh.ray_traverse(ray, &mut hit, test);
                hit.t
            }),
            (Hierarchy::Binary(bvh), Query::Occluded) => {
                self.for_each(rays, found, |ray| distance(bvh.ray_traverse_miss(ray, test)))
            }
            (Hierarchy::Wide(bvh), Query::Occluded) => {
                self.for_each(rays, found, |ray| distance(bvh.ray_traverse_miss(ray, test)))
            }
        }
    }

    fn for_each(
        &self,
        rays: &[Ray],
        found: &mut [Distance],
        trace: impl Fn(obvhs::ray::Ray) -> Distance + Sync,
    ) -> Duration {
        let started = Instant::now();
        let work = Mutex::new(rays.chunks(BLOCK).zip(found.chunks_mut(BLOCK)));
        let next = || work.lock().unwrap_or_else(PoisonError::into_inner).next();
        thread::scope(|scope| {
            for _ in 0..self.threads {
                scope.spawn(|| {
                    while let Some((rays, found)) = next() {
                        rays.iter().zip(found).for_each(|(ray, found)| *found = trace(encode(ray)));
                    }
                });
            }
        });
        started.elapsed()
    }
}

fn encode(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

fn world_triangles(scene: &Scene, centre: DVec3) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for instance in scene.instances() {
        let transform = scene.centred(instance, centre);
        let place = |corner: Vec3| transform.transform_point3(corner.as_dvec3()).as_vec3a();
        let placed = scene.meshes()[instance.mesh].positions().iter().map(|corners| {
            let [v0, v1, v2] = corners.map(place);
            Triangle { v0, v1, v2 }
        });
        triangles.extend(placed);
    }
    triangles
}

/// Instruction sets that obvhs was compiled for, of those that matter to it.
pub(crate) fn target_features() -> Vec<&'static str> {
    let all = [
        ("sse2", cfg!(target_feature = "sse2")),
        ("avx", cfg!(target_feature = "avx")),
        ("avx2", cfg!(target_feature = "avx2")),
        ("fma", cfg!(target_feature = "fma")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("neon", cfg!(target_feature = "neon")),
    ];
    all.into_iter().filter(|(_, enabled)| *enabled).map(|(name, _)| name).collect()
}
