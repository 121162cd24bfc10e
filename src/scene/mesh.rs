//! Triangles, as they are described and as they are kept.

use super::{Material, unit};
use crate::error::{Error, Result};
use glam::{Vec2, Vec3};

/// A mesh, not yet checked.
#[derive(Debug, Clone, Default)]
pub struct MeshDesc {
    /// Shown in messages.
    pub name: String,
    /// Its parts, each of one material.
    pub parts: Vec<MeshPart>,
}

/// Triangles of one material. Attribute arrays are `[vertex]` and, where present, as long as `positions`.
#[derive(Debug, Clone, Default)]
pub struct MeshPart {
    /// Object-space positions, counter-clockwise seen from the front.
    pub positions: Vec<Vec3>,
    /// Shading normals, any length but 0; absent: the triangle's own.
    pub normals: Option<Vec<Vec3>>,
    /// Light-map coordinates in \[0,1\]; absent: the part blocks and emits light and receives none.
    pub light_map_uvs: Option<Vec<Vec2>>,
    /// Coordinates in the albedo texture, its transform applied; absent: (0, 0).
    pub albedo_uvs: Option<Vec<Vec2>>,
    /// Coordinates in the emission texture, its transform applied; absent: (0, 0).
    pub emission_uvs: Option<Vec<Vec2>>,
    /// `[3 * triangle]` positions in the arrays above; empty: every three vertices are a triangle.
    pub indices: Vec<u32>,
    /// Position in the scene's list of materials.
    pub material: usize,
}

/// A checked mesh. Every array is `[triangle]`.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    name: String,
    positions: Vec<[Vec3; 3]>,
    normals: Vec<[Vec3; 3]>,
    light_map_uvs: Vec<Option<[Vec2; 3]>>,
    albedo_uvs: Vec<[Vec2; 3]>,
    emission_uvs: Vec<[Vec2; 3]>,
    materials: Vec<u32>,
}

/// Light-map coordinates this far outside \[0,1\] are rounding, and clamped.
const UV_SLACK: f32 = 1e-4;

impl Mesh {
    pub(super) fn new(desc: MeshDesc, materials: &[Material], warnings: &mut Vec<String>) -> Result<Self> {
        let mut mesh = Self { name: desc.name, ..Self::default() };
        let textured = |part: &MeshPart| {
            let material = &materials[part.material];
            material.albedo_texture.is_some() || material.emission_texture.is_some()
        };
        let mut dropped = Dropped::default();
        for (index, part) in desc.parts.iter().enumerate() {
            part.check(&mesh.name, index, materials.len())?;
        }
        let keep_texcoords = desc.parts.iter().any(textured);
        for part in &desc.parts {
            mesh.append(part, keep_texcoords, &mut dropped);
        }
        dropped.report(&mesh.name, warnings);
        Ok(mesh)
    }

    fn append(&mut self, part: &MeshPart, keep_texcoords: bool, dropped: &mut Dropped) {
        for corners in part.triangles() {
            let positions = corners.map(|v| part.positions[v]);
            let Some(normal) = geometric_normal(positions) else {
                dropped.zero_area += 1;
                continue;
            };
            let uvs = part.light_map_uvs.as_ref().map(|uvs| corners.map(|v| uvs[v].clamp(Vec2::ZERO, Vec2::ONE)));
            let uvs = uvs.filter(|uvs| {
                let has_area = uv_area(*uvs) > 0.0;
                dropped.zero_uv_area += usize::from(!has_area);
                has_area
            });
            let vertex_normal = |v: usize| part.normals.as_ref().map_or(normal, |n| unit(n[v]).unwrap_or(normal));
            self.positions.push(positions);
            self.normals.push(corners.map(vertex_normal));
            self.light_map_uvs.push(uvs);
            self.materials.push(part.material as u32);
            if keep_texcoords {
                let texcoords =
                    |uvs: &Option<Vec<Vec2>>| corners.map(|v| uvs.as_ref().map_or(Vec2::ZERO, |uvs| uvs[v]));
                self.albedo_uvs.push(texcoords(&part.albedo_uvs));
                self.emission_uvs.push(texcoords(&part.emission_uvs));
            }
        }
    }

    /// The mesh's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Object-space corners.
    pub fn positions(&self) -> &[[Vec3; 3]] {
        &self.positions
    }

    /// Unit shading normals at the corners.
    pub fn normals(&self) -> &[[Vec3; 3]] {
        &self.normals
    }

    /// Light-map coordinates at the corners; `None`: the triangle receives no light.
    pub fn light_map_uvs(&self) -> &[Option<[Vec2; 3]>] {
        &self.light_map_uvs
    }

    /// Albedo texture coordinates at the corners; empty when no material of the mesh has a texture.
    pub fn albedo_uvs(&self) -> &[[Vec2; 3]] {
        &self.albedo_uvs
    }

    /// Emission texture coordinates at the corners; empty when no material of the mesh has a texture.
    pub fn emission_uvs(&self) -> &[[Vec2; 3]] {
        &self.emission_uvs
    }

    /// Positions in the scene's list of materials.
    pub fn materials(&self) -> &[u32] {
        &self.materials
    }
}

impl MeshPart {
    fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let count = if self.indices.is_empty() { self.vertex_count() } else { self.indices.len() } / 3;
        let vertex = |i: usize| if self.indices.is_empty() { i } else { self.indices[i] as usize };
        (0..count).map(move |t| [vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)])
    }

    fn check(&self, mesh: &str, part: usize, material_count: usize) -> Result<()> {
        let fail = |what: String| Err(Error::scene(format!("mesh '{mesh}', part {part}: {what}")));
        let count = self.vertex_count();
        if self.material >= material_count {
            return fail(format!("refers to material {}; the scene has {material_count}", self.material));
        }
        let corners = if self.indices.is_empty() { count } else { self.indices.len() };
        if !corners.is_multiple_of(3) {
            return fail(format!("has {corners} corners; allowed is a multiple of 3"));
        }
        if let Some(index) = self.indices.iter().find(|index| **index as usize >= count) {
            return fail(format!("index {index} is out of range; there are {count} vertices"));
        }
        if let Some((v, p)) = self.positions.iter().enumerate().find(|(_, p)| !p.is_finite()) {
            return fail(format!("the position of vertex {v} is {p}; it must be finite"));
        }
        if let Some(normals) = &self.normals {
            check_length("normals", normals.len(), count).or_else(fail)?;
            if let Some((v, n)) = normals.iter().enumerate().find(|(_, n)| !n.is_finite()) {
                return fail(format!("the normal of vertex {v} is {n}; it must be finite"));
            }
        }
        for (what, uvs) in [("albedo coordinates", &self.albedo_uvs), ("emission coordinates", &self.emission_uvs)] {
            let Some(uvs) = uvs else { continue };
            check_length(what, uvs.len(), count).or_else(fail)?;
            if let Some((v, uv)) = uvs.iter().enumerate().find(|(_, uv)| !uv.is_finite()) {
                return fail(format!("the {what} of vertex {v} are {uv}; they must be finite"));
            }
        }
        let Some(uvs) = &self.light_map_uvs else { return Ok(()) };
        check_length("light-map coordinates", uvs.len(), count).or_else(fail)?;
        let inside = |uv: &Vec2| uv.min_element() >= -UV_SLACK && uv.max_element() <= 1.0 + UV_SLACK && !uv.is_nan();
        match uvs.iter().enumerate().find(|(_, uv)| !inside(uv)) {
            Some((v, uv)) => fail(format!("the light-map coordinates of vertex {v} are {uv}; allowed is [0, 1]")),
            None => Ok(()),
        }
    }
}

fn check_length(what: &str, found: usize, expected: usize) -> Result<(), String> {
    if found == expected { Ok(()) } else { Err(format!("has {found} {what} for {expected} vertices")) }
}

/// Triangles that were dropped or changed, counted.
#[derive(Default)]
struct Dropped {
    zero_area: usize,
    zero_uv_area: usize,
}

impl Dropped {
    fn report(&self, mesh: &str, warnings: &mut Vec<String>) {
        if self.zero_area > 0 {
            warnings.push(format!("mesh '{mesh}': {} triangles without area are dropped", self.zero_area));
        }
        if self.zero_uv_area > 0 {
            let count = self.zero_uv_area;
            warnings.push(format!("mesh '{mesh}': {count} triangles without area in the light map receive no light"));
        }
    }
}

/// The unit normal, counter-clockwise seen from the front; `None` when the area is zero to f64 rounding of f32 corners.
fn geometric_normal([a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    (b - a).cross(c - a).try_normalize().map(|n| n.as_vec3())
}

/// Twice the unsigned area in the unit square, exact enough in f64 to tell a sliver from nothing.
fn uv_area([a, b, c]: [Vec2; 3]) -> f64 {
    let (a, b, c) = (a.as_dvec2(), b.as_dvec2(), c.as_dvec2());
    (b - a).perp_dot(c - a).abs()
}
