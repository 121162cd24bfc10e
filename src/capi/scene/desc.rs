//! What a scene is described by.

use crate::capi::arguments::structures;
use std::ffi::c_char;

/// Triangles of one material. Attribute arrays are `[vertex]`.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenMeshPart {
    /// sizeof(LightovenMeshPart)
    pub struct_size: usize,
    /// Object-space x, y, z, `[vertex][3]`; triangles are counter-clockwise seen from the front. NULL where the count is 0.
    pub positions: *const f32,
    /// Shading normals, `[vertex][3]`, of any length but 0. NULL: the triangle's own.
    pub normals: *const f32,
    /// Light-map coordinates, 0 to 1, `[vertex][2]`. NULL: the part blocks and emits light and receives none.
    pub light_map_uvs: *const f32,
    /// Coordinates in the albedo texture, `[vertex][2]`. NULL: (0, 0).
    pub albedo_uvs: *const f32,
    /// Coordinates in the emission texture, `[vertex][2]`. NULL: (0, 0).
    pub emission_uvs: *const f32,
    /// At most 2^32 - 1.
    pub vertex_count: usize,
    /// `[3 * triangle]`, each below `vertex_count`. NULL where the count is 0.
    pub indices: *const u32,
    /// A multiple of 3, at most 2^32 - 1. 0: every three vertices are a triangle.
    pub index_count: usize,
    /// Index into the scene's materials.
    pub material: u32,
    /// 0.
    pub reserved: u32,
}

/// A mesh.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenMesh {
    /// sizeof(LightovenMesh)
    pub struct_size: usize,
    /// Shown in messages; UTF-8. NULL: none.
    pub name: *const c_char,
    /// `[part_count]`; NULL where the count is 0.
    pub parts: *const LightovenMeshPart,
    /// At most 2^32 - 1.
    pub part_count: usize,
}

/// Whether an instance may be moved, removed and added while a baker runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenMobility {
    /// It stays where it is: texels inside it are given up.
    Static = 0,
    /// It may move.
    Movable = 1,
}

/// A placed copy of a mesh.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenInstance {
    /// sizeof(LightovenInstance)
    pub struct_size: usize,
    /// Shown in messages; UTF-8. NULL: none.
    pub name: *const c_char,
    /// Object to world: three rows of four, as VkTransformMatrixKHR has them, in double precision. NULL: identity. A singular one
    /// leaves the instance out, with a warning, and those after it move up.
    pub object_to_world: *const f64,
    /// Index into the scene's meshes.
    pub mesh: u32,
    /// A LightovenMobility.
    pub mobility: u32,
}

/// What lies beyond a texture's edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenWrap {
    /// The texture again.
    Repeat = 0,
    /// The texture again, every other one mirrored.
    MirroredRepeat = 1,
    /// The edge's colour.
    ClampToEdge = 2,
}

/// A texture as a material uses it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenTextureUse {
    /// sizeof(LightovenTextureUse)
    pub struct_size: usize,
    /// Index into the scene's textures.
    pub texture: u32,
    /// A LightovenWrap, horizontally.
    pub wrap_u: u32,
    /// A LightovenWrap, vertically.
    pub wrap_v: u32,
    /// 0.
    pub reserved: u32,
}

/// An image with sRGB encoding.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenTexture {
    /// sizeof(LightovenTexture)
    pub struct_size: usize,
    /// Shown in messages; UTF-8. NULL: none.
    pub name: *const c_char,
    /// Red, green, blue and an alpha that is not used, 8 bits each: `[height][width][4]`, from the top. Not NULL.
    pub pixels: *const u8,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

/// Whether a surface answers when seen from behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenSidedness {
    /// Seen from behind it blocks light and is black.
    Single = 0,
    /// Both sides show the same light.
    Double = 1,
}

/// A diffuse, possibly emissive surface. Colours are linear, Rec. 709.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenMaterial {
    /// sizeof(LightovenMaterial)
    pub struct_size: usize,
    /// Shown in messages; UTF-8. NULL: none.
    pub name: *const c_char,
    /// Multiplied with `albedo`. NULL: none.
    pub albedo_texture: *const LightovenTextureUse,
    /// Multiplied with `emission`. NULL: none.
    pub emission_texture: *const LightovenTextureUse,
    /// Diffuse albedo, at least 0. Over 0.999, or no number, it is clamped with a warning; before a texture up to 1 without one.
    pub albedo: [f32; 3],
    /// Emitted radiance, at least 0.
    pub emission: [f32; 3],
    /// A LightovenSidedness.
    pub sidedness: u32,
    /// 0.
    pub reserved: u32,
}

/// The kind of a light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenLightKind {
    /// Shines from a point into all directions.
    Point = 0,
    /// Shines from a point into a cone.
    Spot = 1,
    /// Shines from infinitely far away.
    Directional = 2,
}

/// An analytic light.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenLight {
    /// sizeof(LightovenLight)
    pub struct_size: usize,
    /// Shown in messages; UTF-8. NULL: none.
    pub name: *const c_char,
    /// Point and spot: world position.
    pub position: [f64; 3],
    /// Spot and directional: the way the light travels, of any length but 0.
    pub direction: [f32; 3],
    /// Linear Rec. 709. Point and spot: radiant intensity; directional: irradiance on a surface that faces it.
    pub intensity: [f32; 3],
    /// Point and spot: distance at which the light has faded to 0, scene units. 0: it never does.
    pub range: f32,
    /// Spot: angle from the axis up to which it shines fully, radians.
    pub inner_angle: f32,
    /// Spot: angle from the axis beyond which it does not shine, radians; more than `inner_angle`, at most pi/2.
    pub outer_angle: f32,
    /// A LightovenLightKind.
    pub kind: u32,
}

/// The kind of a sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenSkyKind {
    /// No light comes from it.
    Black = 0,
    /// The same radiance from everywhere.
    Constant = 1,
    /// A radiance for every direction.
    Map = 2,
}

/// What a ray sees that leaves the scene.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenSky {
    /// sizeof(LightovenSky)
    pub struct_size: usize,
    /// Map: radiance, linear Rec. 709, `[height][width][3]`, equirectangular, from the top. The y axis is up; a direction d is
    /// at column width * (atan2(d.z, d.x) / 2 pi + 1/2) and row height * acos(d.y) / pi. Else not looked at.
    pub pixels: *const f32,
    /// Map: columns, at least 1.
    pub width: u32,
    /// Map: rows, at least 1.
    pub height: u32,
    /// Constant: radiance, linear Rec. 709, at least 0.
    pub radiance: [f32; 3],
    /// A LightovenSkyKind.
    pub kind: u32,
}

/// Everything that makes up a scene.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenSceneDesc {
    /// sizeof(LightovenSceneDesc)
    pub struct_size: usize,
    /// Shown in messages and written into files; UTF-8. NULL: none.
    pub name: *const c_char,
    /// `[mesh_count]`; NULL where the count is 0, as with the other lists.
    pub meshes: *const LightovenMesh,
    /// At most 2^32 - 1, as the other counts.
    pub mesh_count: usize,
    /// `[instance_count]`
    pub instances: *const LightovenInstance,
    /// Number of instances.
    pub instance_count: usize,
    /// `[material_count]`
    pub materials: *const LightovenMaterial,
    /// Number of materials.
    pub material_count: usize,
    /// `[texture_count]`
    pub textures: *const LightovenTexture,
    /// Number of textures.
    pub texture_count: usize,
    /// `[light_count]`
    pub lights: *const LightovenLight,
    /// Number of lights.
    pub light_count: usize,
    /// NULL: black.
    pub sky: *const LightovenSky,
}

structures!(
    LightovenMeshPart = [80],
    LightovenMesh = [32],
    LightovenInstance = [32],
    LightovenTextureUse = [24],
    LightovenTexture = [32],
    LightovenMaterial = [64],
    LightovenLight = [80],
    LightovenSky = [40],
    LightovenSceneDesc = [104],
);
