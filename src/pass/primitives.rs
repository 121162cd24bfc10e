//! Per-triangle data in the hierarchy's order, as the shaders read it.

use super::sheets;
use crate::bvh::Bvh;
use crate::features::Features;
use crate::gpu::layout::{Material, Primitive};
use crate::scene::{Mesh, Scene, Sidedness};
use glam::{DMat3, Vec2, Vec3};

/// What the device needs of triangles and materials.
pub(super) struct Encoded {
    /// `[primitive]`.
    pub(super) primitives: Vec<Primitive>,
    pub(super) radiators: Radiators,
}

/// What emits.
#[derive(Debug, Clone, Default)]
pub(crate) struct Radiators {
    /// The scene's materials, then one for each unmapped triangle with a textured emission.
    pub(crate) materials: Vec<Material>,
    /// Of the latter: the material, and the mean colour of its texture over the triangle.
    tinted: Vec<(usize, Vec3)>,
}

impl Radiators {
    fn new(scene: &Scene) -> Self {
        let material = |m: &crate::scene::Material| Material {
            albedo: m.albedo.into(),
            pad0: 0,
            emission: m.emission.into(),
            pad1: 0,
        };
        Self { materials: scene.materials().iter().map(material).collect(), tinted: Vec::new() }
    }

    fn add_tinted(&mut self, material: usize, tint: Vec3) -> u32 {
        let emission = Vec3::from(self.materials[material].emission) * tint;
        self.materials.push(Material { albedo: [0.0; 3], pad0: 0, emission: emission.into(), pad1: 0 });
        self.tinted.push((material, tint));
        self.materials.len() as u32 - 1
    }

    /// Changes what one of the scene's materials emits. `false`: it was that already.
    pub(crate) fn set_emission(&mut self, material: usize, emission: Vec3) -> bool {
        let own = self.materials.len() - self.tinted.len();
        let (own, tinted) = self.materials.split_at_mut(own);
        if std::mem::replace(&mut own[material].emission, emission.into()) == emission.to_array() {
            return false;
        }
        for (copy, (original, tint)) in tinted.iter_mut().zip(&self.tinted) {
            if *original == material {
                copy.emission = (emission * *tint).into();
            }
        }
        true
    }
}

pub(super) fn encode(scene: &Scene, bvh: &Bvh, features: Features) -> Encoded {
    let mut encoded = Encoded {
        primitives: vec![bytemuck::Zeroable::zeroed(); bvh.triangles.len()],
        radiators: Radiators::new(scene),
    };
    for ((mesh, range), order) in scene.meshes().iter().zip(&bvh.meshes).zip(&bvh.order) {
        let sheets = if features.contains(Features::IMPORTANCE) { sheets::of_mesh(mesh) } else { Vec::new() };
        for (slot, triangle) in order.iter().enumerate() {
            let index = range.first_primitive as usize + slot;
            let primitive = encoded.primitive(scene, bvh, mesh, *triangle as usize);
            let sheet = sheets.get(*triangle as usize).copied().unwrap_or_default();
            encoded.primitives[index] = Primitive { sheet, ..primitive };
        }
    }
    encoded
}

impl Encoded {
    fn primitive(&mut self, scene: &Scene, bvh: &Bvh, mesh: &Mesh, triangle: usize) -> Primitive {
        let material = mesh.materials()[triangle];
        let uvs = mesh.light_map_uvs()[triangle];
        let double = scene.materials()[material as usize].sidedness == Sidedness::Double;
        let mut flags = if double { Primitive::DOUBLE_SIDED } else { 0 };
        flags |= if uvs.is_some() { Primitive::MAPPED } else { 0 };
        let corners = bvh.corners();
        let to_world = bvh.baked_transform.map(|transform| transform.matrix3.inverse().transpose());
        let normals = mesh.normals()[triangle];
        let shading = if is_flat(mesh.positions()[triangle], normals) { -1.0 } else { 1.0 };
        Primitive {
            uvs: corners.map(|c| uvs.unwrap_or_default()[c].into()),
            normals: corners.map(|c| octahedral(shading * world_normal(normals[c], to_world))),
            material: self.radiating_material(scene, mesh, triangle, uvs.is_none()),
            flags,
            sheet: 0,
        }
    }

    /// The material, or for an unmapped triangle with a textured emission one of its own that holds the mean: a hit on it
    /// has no texel to read.
    fn radiating_material(&mut self, scene: &Scene, mesh: &Mesh, triangle: usize, unmapped: bool) -> u32 {
        let index = mesh.materials()[triangle];
        let material = &scene.materials()[index as usize];
        // One that is dark now may shine later.
        let Some(texture) = material.emission_texture.filter(|_| unmapped) else { return index };
        let uvs = mesh.emission_uvs()[triangle];
        let mean = mean_over(&scene.textures()[texture.texture], texture.wrap, uvs);
        self.radiators.add_tinted(index as usize, mean)
    }
}

/// Normals that are the triangle's own, as near as their codes tell, are turned round: a shading normal that looks away
/// from the triangle gives way to the triangle's own (`surface_of` in `surface.glsl`), which no code has rounded.
fn is_flat([a, b, c]: [Vec3; 3], normals: [Vec3; 3]) -> bool {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let own = (b - a).cross(c - a).normalize_or_zero();
    normals.iter().all(|normal| normal.as_dvec3().distance(own) < OCTAHEDRAL_ERROR)
}

/// A code's direction is off by less.
const OCTAHEDRAL_ERROR: f64 = 1e-4;

fn world_normal(normal: Vec3, to_world: Option<DMat3>) -> Vec3 {
    to_world.map_or(normal, |matrix| (matrix * normal.as_dvec3()).normalize_or(normal.as_dvec3()).as_vec3())
}

/// A unit vector as two snorm16. Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors",
/// JCGT 3(2), 2014.
fn octahedral(n: Vec3) -> u32 {
    let p = Vec2::new(n.x, n.y) / (n.x.abs() + n.y.abs() + n.z.abs());
    let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
    let p = if n.z < 0.0 { Vec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y)) } else { p };
    let snorm = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    snorm(p.x) | snorm(p.y) << 16
}

/// Rows of equal small triangles that a triangle's mean is taken over, one point in the middle of each. A prime number: the
/// points keep step with no pattern. Chequerboards of 8 to 12 squares a side: off by .02 %; with 64 rows by .5 %.
const MEAN_ROWS: usize = 61;

/// Mean linear colour of a texture over a triangle of its coordinates.
fn mean_over(texture: &crate::scene::Texture, wrap: [crate::scene::Wrap; 2], uvs: [Vec2; 3]) -> Vec3 {
    let colour = |row: usize, column: usize, third: f32| {
        let [b1, b2] = [row, column].map(|place| (place as f32 + third / 3.0) / MEAN_ROWS as f32);
        texture.linear(wrap, uvs[0] + (uvs[1] - uvs[0]) * b1 + (uvs[2] - uvs[0]) * b2)
    };
    let mut sum = Vec3::ZERO;
    for row in 0..MEAN_ROWS {
        for column in 0..MEAN_ROWS - row {
            sum += colour(row, column, 1.0);
            // The one that points the other way, between this and its neighbours.
            if row + column + 1 < MEAN_ROWS {
                sum += colour(row, column, 2.0);
            }
        }
    }
    sum / (MEAN_ROWS * MEAN_ROWS) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octahedral_codes_are_within_an_ulp() {
        for n in [Vec3::X, -Vec3::Z, Vec3::new(1.0, -2.0, -3.0).normalize(), Vec3::new(-0.1, 0.2, 0.9).normalize()] {
            let code = octahedral(n);
            let snorm = |bits: u32| f32::from(bits as u16 as i16) / 32767.0;
            let e = Vec2::new(snorm(code & 0xffff), snorm(code >> 16));
            let mut d = e.extend(1.0 - e.x.abs() - e.y.abs());
            if d.z < 0.0 {
                (d.x, d.y) = ((1.0 - e.y.abs()) * e.x.signum(), (1.0 - e.x.abs()) * e.y.signum());
            }
            assert!(d.normalize().distance(n) < 1e-4, "{n} became {d}");
        }
    }

    #[test]
    fn half_of_a_chequerboard_is_white() {
        let pixel = |i: usize| if (i % 12 + i / 12).is_multiple_of(2) { [255; 4] } else { [0; 4] };
        let pixels = (0..144).map(pixel).collect();
        let texture = crate::scene::Texture { name: "chequers".into(), width: 12, height: 12, pixels };
        let wrap = [crate::scene::Wrap::ClampToEdge; 2];
        for uvs in [[Vec2::ZERO, Vec2::X, Vec2::ONE], [Vec2::ZERO, Vec2::ONE, Vec2::Y], [Vec2::X, Vec2::Y, Vec2::ZERO]]
        {
            let mean = mean_over(&texture, wrap, uvs).x;
            assert!((mean - 0.5).abs() < 1e-3, "{mean}");
        }
    }
}
