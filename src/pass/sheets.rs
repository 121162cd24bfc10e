//! Sheets: triangles of a mesh on which light-map coordinates and positions are one affine map. A texel that such
//! triangles share is one parallelogram in space, and a ray that is aimed at it may hit any of them.

use crate::scene::Mesh;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// How far from a sheet's map a corner may lie, as a share of its triangle's longest side.
const TOLERANCE: f64 = 1e-4;

/// `[triangle]`: the first triangle of its sheet. Sheets grow over shared corners.
pub(super) fn of_mesh(mesh: &Mesh) -> Vec<u32> {
    let corners = corners_of(mesh);
    let mut at: HashMap<[u32; 5], Vec<u32>> = HashMap::new();
    for (triangle, corners) in corners.iter().enumerate() {
        for corner in corners.iter().flatten() {
            at.entry(corner.key()).or_default().push(triangle as u32);
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
                for neighbour in &at[&corner.key()] {
                    let known = &mut sheets[*neighbour as usize];
                    if known.is_none() && corners[*neighbour as usize].as_ref().is_some_and(|c| map.holds(c)) {
                        *known = Some(first as u32);
                        front.push(*neighbour);
                    }
                }
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
