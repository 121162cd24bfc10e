//! A scene of more triangles with the same surfaces.

use glam::{DVec2, DVec3, Vec2, Vec3};
use lightoven::Result;
use lightoven::scene::{Mesh, MeshDesc, MeshPart, Scene, SceneDesc};
use std::ops::{Add, Div, Mul};

/// The scene with `n` * `n` triangles in the place of every one: each edge is cut into `n` equal parts.
///
/// # Errors
/// `InvalidScene` where a position is no longer finite.
pub(super) fn subdivided(scene: &Scene, n: u32) -> Result<Scene> {
    if n == 1 {
        return Ok(scene.clone());
    }
    Scene::new(SceneDesc {
        name: scene.name().to_owned(),
        meshes: scene.meshes().iter().map(|mesh| subdivided_mesh(mesh, n)).collect(),
        instances: scene.instances().to_vec(),
        materials: scene.materials().to_vec(),
        textures: scene.textures().to_vec(),
        lights: scene.lights().to_vec(),
        sky: scene.sky().clone(),
    })
}

/// Triangles that the hierarchy holds: those of a mesh count once, wherever it is placed.
pub(super) fn triangles_of(scene: &Scene) -> usize {
    let placed = |index: usize| scene.instances().iter().any(|instance| instance.mesh == index);
    let meshes = scene.meshes().iter().enumerate().filter(|(index, _)| placed(*index));
    meshes.map(|(_, mesh)| mesh.len()).sum()
}

/// A part for each run of triangles that have a material, and light-map coordinates or none, in common.
fn subdivided_mesh(mesh: &Mesh, n: u32) -> MeshDesc {
    let kind = |triangle: usize| (mesh.materials()[triangle], mesh.light_map_uvs()[triangle].is_some());
    let triangles: Vec<usize> = (0..mesh.len()).collect();
    let parts = triangles.chunk_by(|one, other| kind(*one) == kind(*other)).map(|run| part(mesh, run, n));
    MeshDesc { name: mesh.name().to_owned(), parts: parts.collect() }
}

fn part(mesh: &Mesh, run: &[usize], n: u32) -> MeshPart {
    let corners = grid(n);
    let spread3 = |of: &[[Vec3; 3]]| -> Vec<Vec3> {
        let points = |triangle: &usize| of[*triangle].map(Vec3::as_dvec3);
        run.iter().flat_map(|triangle| between(points(triangle), &corners, n)).map(DVec3::as_vec3).collect()
    };
    let spread2 = |of: &dyn Fn(usize) -> [Vec2; 3]| -> Vec<Vec2> {
        let points = |triangle: &usize| of(*triangle).map(Vec2::as_dvec2);
        run.iter().flat_map(|triangle| between(points(triangle), &corners, n)).map(|uv: DVec2| uv.as_vec2()).collect()
    };
    let texcoords = |of: &[[Vec2; 3]]| (!of.is_empty()).then(|| spread2(&|triangle| of[triangle]));
    let mapped = run.iter().all(|triangle| mesh.light_map_uvs()[*triangle].is_some());
    MeshPart {
        positions: spread3(mesh.positions()),
        normals: Some(spread3(mesh.normals())),
        light_map_uvs: mapped.then(|| spread2(&|triangle| mesh.light_map_uvs()[triangle].unwrap_or_default())),
        albedo_uvs: texcoords(mesh.albedo_uvs()),
        emission_uvs: texcoords(mesh.emission_uvs()),
        indices: Vec::new(),
        material: run.first().map_or(0, |triangle| mesh.materials()[*triangle] as usize),
    }
}

/// Corners of the small triangles, three by three: weights of a large one's corners, which sum to `n`. All turn the same way.
fn grid(n: u32) -> Vec<[u32; 3]> {
    let corner = |i: u32, j: u32| [n - i - j, i, j];
    let mut corners = Vec::new();
    for i in 0..n {
        for j in 0..n - i {
            corners.extend([corner(i, j), corner(i + 1, j), corner(i, j + 1)]);
            if i + j + 1 < n {
                corners.extend([corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
            }
        }
    }
    corners
}

/// Summed in f64, where f32 times a small number is exact: both triangles at an edge get the same points on it.
fn between<V>([a, b, c]: [V; 3], corners: &[[u32; 3]], n: u32) -> impl Iterator<Item = V>
where
    V: Copy + Add<Output = V> + Mul<f64, Output = V> + Div<f64, Output = V>,
{
    corners.iter().map(move |weights| {
        let [wa, wb, wc] = weights.map(f64::from);
        (a * wa + b * wb + c * wc) / f64::from(n)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;
    use lightoven::scene::{Instance, Material, Mobility};

    /// Two mapped triangles that share an edge, then one without light-map coordinates.
    fn scene() -> Scene {
        let positions = vec![Vec3::ZERO, Vec3::new(3.0, 0.1, 0.0), Vec3::new(3.3, 2.0, 1.0), Vec3::new(0.0, 2.7, 0.3)];
        let uvs = vec![Vec2::ZERO, Vec2::new(0.9, 0.0), Vec2::new(0.8, 0.7), Vec2::new(0.0, 0.6)];
        let normals = vec![Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::Z, Vec3::new(0.0, 0.6, 0.8)];
        let mapped = MeshPart {
            positions: positions.clone(),
            normals: Some(normals),
            light_map_uvs: Some(uvs),
            indices: vec![0, 1, 2, 0, 2, 3],
            ..MeshPart::default()
        };
        let unmapped = MeshPart { positions, indices: vec![1, 2, 3], material: 1, ..MeshPart::default() };
        let instance =
            Instance { name: "here".into(), mesh: 0, transform: DAffine3::IDENTITY, mobility: Mobility::Static };
        Scene::new(SceneDesc {
            meshes: vec![MeshDesc { name: "roof".into(), parts: vec![mapped, unmapped] }],
            instances: vec![instance],
            materials: vec![Material::default(); 2],
            ..SceneDesc::default()
        })
        .expect("is a scene")
    }

    fn areas(mesh: &Mesh) -> [f64; 2] {
        let world = |[a, b, c]: &[Vec3; 3]| (*b - *a).as_dvec3().cross((*c - *a).as_dvec3()).length();
        let map = |[a, b, c]: &[Vec2; 3]| (*b - *a).as_dvec2().perp_dot((*c - *a).as_dvec2());
        [mesh.positions().iter().map(world).sum(), mesh.light_map_uvs().iter().flatten().map(map).sum()]
    }

    #[test]
    fn surfaces_stay_as_they_are() {
        let scene = scene();
        for n in [1, 2, 3, 7] {
            let found = subdivided(&scene, n).expect("is a scene");
            let (before, mesh) = (&scene.meshes()[0], &found.meshes()[0]);
            let count = (n * n) as usize;
            assert_eq!((mesh.len(), triangles_of(&found)), (3 * count, 3 * count));
            let (small, large) = (areas(mesh), areas(before));
            assert!(small.iter().zip(large).all(|(s, l)| (s - l).abs() < 1e-5 * l), "{n}: {small:?} for {large:?}");
            for (index, corners) in mesh.positions().iter().enumerate() {
                assert_eq!(mesh.materials()[index], before.materials()[index / count]);
                // Whatever is interpolated is so by the same weights: positions tell light-map coordinates and normals.
                let whole = before.positions()[index / count];
                let inverse =
                    glam::DMat3::from_cols_array_2d(&whole.map(|p| (p + Vec3::Z).as_dvec3().to_array())).inverse();
                for (corner, position) in corners.iter().enumerate() {
                    let weights = (inverse * (*position + Vec3::Z).as_dvec3()).as_vec3();
                    let mix = |of: [Vec2; 3]| of[0] * weights.x + of[1] * weights.y + of[2] * weights.z;
                    let (uvs, expected) = (mesh.light_map_uvs()[index], before.light_map_uvs()[index / count]);
                    assert_eq!(uvs.is_some(), expected.is_some());
                    let apart = uvs.zip(expected).map_or(0.0, |(uvs, expected)| uvs[corner].distance(mix(expected)));
                    assert!(apart < 1e-5, "{n}, {index}: {apart}");
                    let normals = before.normals()[index / count];
                    let normal = (normals[0] * weights.x + normals[1] * weights.y + normals[2] * weights.z).normalize();
                    assert!(mesh.normals()[index][corner].distance(normal) < 1e-5, "{n}, {index}");
                }
            }
        }
    }

    /// Rays would go through gaps.
    #[test]
    fn triangles_meet_at_edges() {
        let found = subdivided(&scene(), 7).expect("is a scene");
        let points = |triangles: std::ops::Range<usize>| {
            let corners = found.meshes()[0].positions()[triangles].iter().flatten();
            corners.map(|p| p.to_array().map(f32::to_bits)).collect::<std::collections::BTreeSet<_>>()
        };
        let [one, other] = [points(0..49), points(49..98)];
        assert_eq!((one.len(), one.intersection(&other).count()), (36, 8));
    }
}
