//! Sheets: triangles of a mesh on which light-map coordinates and positions are one affine map. A texel that such
//! triangles share is one parallelogram in space, and a ray that is aimed at it may hit any of them.

use crate::scene::Mesh;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Corners that more triangles than this have in common join none: each sheet there goes through all of them.
const MOST_AT_A_CORNER: usize = 1000;
/// How far from a sheet's map a corner may lie, as a share of its triangle's longest side.
const TOLERANCE: f64 = 1e-4;

/// `[triangle]`: the first triangle of its sheet. Sheets grow over shared corners.
pub(super) fn of_mesh(mesh: &Mesh) -> Vec<u32> {
    let corners = corners_of(mesh);
    // Triangles at a corner, those left that are on no sheet yet, and the sheet that has last gone through them.
    let mut at: HashMap<[u32; 5], (Vec<u32>, Option<u32>)> = HashMap::new();
    for (triangle, corners) in corners.iter().enumerate() {
        for corner in corners.iter().flatten() {
            at.entry(corner.key()).or_default().0.push(triangle as u32);
        }
    }
    let mut sheets: Vec<Option<u32>> = vec![None; corners.len()];
    for first in 0..corners.len() {
        if sheets[first].is_some() {
            continue;
        }
        sheets[first] = Some(first as u32);
        let Some(map) = corners[first].as_ref().and_then(AffineMap::of) else { continue };
        let mut front = vec![first as u32];
        while let Some(triangle) = front.pop() {
            for corner in corners[triangle as usize].iter().flatten() {
                let Some((neighbours, gone_through)) = at.get_mut(&corner.key()) else { continue };
                if gone_through.replace(first as u32) == Some(first as u32) || neighbours.len() > MOST_AT_A_CORNER {
                    continue;
                }
                neighbours.retain(|neighbour| {
                    let known = &mut sheets[*neighbour as usize];
                    if known.is_none() && corners[*neighbour as usize].as_ref().is_some_and(|c| map.holds(c)) {
                        *known = Some(first as u32);
                        front.push(*neighbour);
                    }
                    known.is_none()
                });
            }
        }
    }
    sheets.into_iter().map(Option::unwrap_or_default).collect()
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    position: glam::Vec3,
    uv: glam::Vec2,
}

impl Corner {
    fn key(&self) -> [u32; 5] {
        let [x, y, z] = self.position.to_array();
        // Adding 0 makes -0 the same as 0.
        [x, y, z, self.uv.x, self.uv.y].map(|value| (value + 0.0).to_bits())
    }
}

/// `None`: the triangle has no place in the light map.
fn corners_of(mesh: &Mesh) -> Vec<Option<[Corner; 3]>> {
    let triangles = mesh.positions().iter().zip(mesh.light_map_uvs());
    let corners = |(positions, uvs): (&[glam::Vec3; 3], &Option<[glam::Vec2; 3]>)| {
        uvs.map(|uvs| [0, 1, 2].map(|i| Corner { position: positions[i], uv: uvs[i] }))
    };
    triangles.map(corners).collect()
}

/// From light-map coordinates to positions.
struct AffineMap {
    uv: DVec2,
    position: DVec3,
    along: [DVec3; 2],
}

impl AffineMap {
    /// `None`: the triangle has no area in the light map.
    fn of([a, b, c]: &[Corner; 3]) -> Option<Self> {
        let (uv, position) = (a.uv.as_dvec2(), a.position.as_dvec3());
        let (t1, t2) = (b.uv.as_dvec2() - uv, c.uv.as_dvec2() - uv);
        let (e1, e2) = (b.position.as_dvec3() - position, c.position.as_dvec3() - position);
        let inverse = 1.0 / t1.perp_dot(t2);
        let along = [(e1 * t2.y - e2 * t1.y) * inverse, (e2 * t1.x - e1 * t2.x) * inverse];
        along.iter().all(|way| way.is_finite()).then_some(Self { uv, position, along })
    }

    fn holds(&self, corners: &[Corner; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| corner.position.as_dvec3());
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        corners.iter().all(|corner| {
            let place = corner.uv.as_dvec2() - self.uv;
            let position = self.position + self.along[0] * place.x + self.along[1] * place.y;
            position.distance(corner.position.as_dvec3()) <= TOLERANCE * longest
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, MeshDesc, MeshPart, Scene, SceneDesc};
    use glam::{Vec2, Vec3};

    /// Two triangles of a square, one more of its plane with another scale in the light map, and a folded one.
    #[test]
    fn one_map_is_one_sheet() {
        let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let mut positions: Vec<Vec3> = square.map(|p| p.extend(0.0)).to_vec();
        let mut uvs: Vec<Vec2> = square.map(|p| p * 0.25).to_vec();
        positions.extend([Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.5, 2.0, 1.0)]);
        uvs.extend([Vec2::new(0.3, 0.0), Vec2::new(0.125, 0.5)]);
        let indices = vec![0, 1, 2, 0, 2, 3, 1, 4, 2, 3, 2, 5];
        let part = MeshPart { positions, light_map_uvs: Some(uvs), indices, ..MeshPart::default() };
        let meshes = vec![MeshDesc { name: "folded".into(), parts: vec![part] }];
        let desc = SceneDesc { meshes, materials: vec![Material::default()], ..SceneDesc::default() };
        let scene = Scene::new(desc).expect("is valid");
        assert_eq!(of_mesh(&scene.meshes()[0]), [0, 0, 2, 3]);
    }
}
