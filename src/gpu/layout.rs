//! What host and device share, as `glsl/include/layout.glsl` has it; `layout/tests.rs` compares the two.
//! The hierarchy's structs are in `crate::bvh`.

use crate::bvh::Ray;
use bytemuck::{Pod, Zeroable};

/// Bindings of set 0, the same number for the same thing in every shader.
pub(crate) mod binding {
    pub(crate) const HIERARCHY: u32 = 0;
    pub(crate) const TRIANGLES: u32 = 1;
    pub(crate) const PRIMITIVES: u32 = 2;
    pub(crate) const INSTANCES: u32 = 3;
    pub(crate) const MATERIALS: u32 = 4;
    pub(crate) const TEXELS: u32 = 5;
    pub(crate) const LIGHTS: u32 = 6;
    pub(crate) const SKY_MAP: u32 = 7;
    pub(crate) const SURFACE: u32 = 8;
    pub(crate) const FOOTPRINT: u32 = 9;
    pub(crate) const SOURCE_MAP: u32 = 10;
    pub(crate) const MEAN_EVEN: u32 = 11;
    pub(crate) const MEAN_ODD: u32 = 12;
    pub(crate) const TEXTURE: u32 = 13;
    pub(crate) const TEXCOORDS: u32 = 14;
    pub(crate) const TRIANGLE_TEXELS: u32 = 15;
    pub(crate) const DIRECT: u32 = 16;
    pub(crate) const ALBEDO: u32 = 17;
    pub(crate) const EMISSION: u32 = 18;
    pub(crate) const SOURCE_IMAGE: u32 = 19;
    pub(crate) const SUMS: u32 = 20;
    pub(crate) const LIGHT_MAP: u32 = 21;
    pub(crate) const NEAREST_BEFORE: u32 = 22;
    pub(crate) const NEAREST_AFTER: u32 = 23;
    pub(crate) const RAYS: u32 = 24;
    pub(crate) const ANSWERS: u32 = 25;
    pub(crate) const IMPORTANCE: u32 = 26;
    pub(crate) const SKY_IMPORTANCE: u32 = 27;
    pub(crate) const PYRAMID: u32 = 28;
    pub(crate) const EVIDENCE: u32 = 29;
    pub(crate) const SKY_EVIDENCE: u32 = 30;
    pub(crate) const PIECES_MAP: u32 = 31;
    pub(crate) const PIECES: u32 = 32;
    pub(crate) const AIMED_LUMINANCE: u32 = 33;
    pub(crate) const CLUSTERS: u32 = 34;
    pub(crate) const CLUSTER_TEXELS: u32 = 35;
    pub(crate) const CLUSTER_SUMS: u32 = 36;
    pub(crate) const SEATS: u32 = 37;
    pub(crate) const WEIGHTS: u32 = 38;
    pub(crate) const SIGHTINGS: u32 = 39;
    pub(crate) const GROUP_ENDS: u32 = 40;
    pub(crate) const LINKS: u32 = 41;
    pub(crate) const ACTIVITY: u32 = 42;
    pub(crate) const NODE_TEXELS: u32 = 43;
}

/// What a hit needs of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Primitive {
    /// Light-map coordinates of the corners.
    pub(crate) uvs: [[f32; 2]; 3],
    /// Shading normals of the corners, octahedral, two snorm16.
    pub(crate) normals: [u32; 3],
    pub(crate) material: u32,
    /// [`Primitive::MAPPED`], [`Primitive::DOUBLE_SIDED`].
    pub(crate) flags: u32,
    /// The same for triangles of a mesh on which light-map coordinates and positions are one affine map.
    pub(crate) sheet: u32,
}

impl Primitive {
    /// It has a place in the light map.
    pub(crate) const MAPPED: u32 = 1;
    /// It answers when seen from behind.
    pub(crate) const DOUBLE_SIDED: u32 = 2;
}

/// A primitive as an instance has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Piece {
    pub(crate) instance: u32,
    pub(crate) primitive: u32,
    /// How far its sheet reaches within a texel: least x and y, two unorm16.
    pub(crate) lo: u32,
    /// Greatest x and y; 0: the primitive's own bounds tell.
    pub(crate) hi: u32,
}

/// Texels that rays are aimed at together.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Cluster {
    /// Mean place of what shines.
    pub(crate) centre: [f32; 3],
    /// Root of the mean squared distance from the centre.
    pub(crate) spread: f32,
    /// Mean normal, where it shines to the front alone.
    pub(crate) axis: [f32; 3],
    /// Share that shines whichever way.
    pub(crate) even: f32,
    /// Luminance times area.
    pub(crate) power: f32,
    /// In the list of clusters' texels.
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) pad0: u32,
}

/// Where a ray of a bounce epoch ended.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Link {
    /// x in the lower half, y in the upper.
    pub(crate) texel: u32,
    /// What that texel's radiance counts.
    pub(crate) weight: f32,
}

/// A material's factors.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Material {
    pub(crate) albedo: [f32; 3],
    pub(crate) pad0: u32,
    pub(crate) emission: [f32; 3],
    pub(crate) pad1: u32,
}

/// An analytic light.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Light {
    pub(crate) position: [f32; 3],
    /// 0 point, 1 spot, 2 directional.
    pub(crate) kind: u32,
    pub(crate) direction: [f32; 3],
    /// 0: none.
    pub(crate) range: f32,
    pub(crate) intensity: [f32; 3],
    pub(crate) cone_scale: f32,
    pub(crate) cone_offset: f32,
    pub(crate) pad0: u32,
    pub(crate) pad1: u32,
    pub(crate) pad2: u32,
}

/// A ray that the host asks about.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TracedRay {
    pub(crate) origin: [f32; 3],
    pub(crate) t_min: f32,
    pub(crate) direction: [f32; 3],
    pub(crate) t_max: f32,
    /// The triangle that the ray starts from; all ones: none.
    pub(crate) skip_instance: u32,
    pub(crate) skip_primitive: u32,
    pub(crate) pad: [u32; 2],
}

impl TracedRay {
    /// `skip` is the (instance, primitive) that the ray starts from.
    pub(crate) fn new(ray: &Ray, skip: Option<(u32, u32)>) -> Self {
        let (skip_instance, skip_primitive) = skip.unwrap_or((u32::MAX, u32::MAX));
        Self {
            origin: ray.origin.into(),
            t_min: ray.t_min,
            direction: ray.direction.into(),
            t_max: ray.t_max,
            skip_instance,
            skip_primitive,
            pad: [0; 2],
        }
    }

    /// The ray, and what it starts from.
    pub(crate) fn decode(&self) -> (Ray, Option<(u32, u32)>) {
        let Self { origin, t_min, direction, t_max, skip_instance, skip_primitive, .. } = *self;
        let ray = Ray { origin: origin.into(), t_min, direction: direction.into(), t_max };
        (ray, (skip_instance != u32::MAX).then_some((skip_instance, skip_primitive)))
    }
}

/// What a ray hit; `instance` is all ones for a miss.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Answer {
    pub(crate) t: f32,
    pub(crate) instance: u32,
    pub(crate) primitive: u32,
    pub(crate) front_face: u32,
    pub(crate) barycentrics: [f32; 2],
    pub(crate) pad: [u32; 2],
}

/// Push constants, the same block for every pass.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Push {
    pub(crate) map_size: [u32; 2],
    pub(crate) first_texel: u32,
    pub(crate) texel_count: u32,
    pub(crate) first_quantum: u32,
    pub(crate) quantum_count: u32,
    pub(crate) light_count: u32,
    pub(crate) root: u32,
    pub(crate) sky: [f32; 3],
    pub(crate) origin_offset: f32,
    pub(crate) seed: [u32; 2],
    pub(crate) instance: u32,
    pub(crate) step_texels: u32,
    pub(crate) mean_luminance: f32,
    pub(crate) rays: u32,
    pub(crate) source_rays: u32,
    pub(crate) sky_rays: u32,
    pub(crate) evidence_quantum: u32,
    pub(crate) first_level: u32,
    pub(crate) end_level: u32,
    pub(crate) first_sample: u32,
    pub(crate) history: f32,
    pub(crate) link_stride: u32,
}

/// Invocations of a work group that goes through the list of texels.
pub(crate) use crate::schedule::GROUP;
/// Side of a work group that goes through the whole map.
pub(crate) const SQUARE_GROUP: u32 = 8;
/// A footprint that says: no ray starts here.
pub(crate) const NO_FOOTPRINT: u32 = u32::MAX;

#[cfg(test)]
mod tests;
