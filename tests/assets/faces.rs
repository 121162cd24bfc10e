//! Rectangles in space, and their charts in a light map.

use crate::gltf_builder::Builder;
use glam::{Vec2, Vec3};
use serde_json::{Value, json};

/// Texels between charts, and at the light map's border.
const GAP: f32 = 3.0;
const MARGIN: f32 = 2.0;

/// A rectangle, seen from the side that `u` x `v` points to.
#[derive(Clone, Copy)]
pub(crate) struct Face {
    pub(crate) origin: Vec3,
    pub(crate) u: Vec3,
    pub(crate) v: Vec3,
    /// Left out, as fractions of `u` and `v`: from, to.
    pub(crate) hole: Option<[Vec2; 2]>,
    /// Size of its chart in texels, where that is not by density.
    pub(crate) texels: Option<Vec2>,
}

/// A rectangle of the light map, in [0, 1].
#[derive(Clone, Copy)]
pub(crate) struct Chart {
    pub(crate) min: Vec2,
    pub(crate) size: Vec2,
}

impl Face {
    pub(crate) fn new(origin: [f32; 3], u: [f32; 3], v: [f32; 3]) -> Self {
        Self { origin: origin.into(), u: u.into(), v: v.into(), hole: None, texels: None }
    }

    fn size(&self) -> Vec2 {
        Vec2::new(self.u.length(), self.v.length())
    }

    /// What fills the face's hole; without a hole, the face again.
    pub(crate) fn filling(&self) -> Self {
        let [from, to] = self.hole.unwrap_or([Vec2::ZERO, Vec2::ONE]);
        Self {
            origin: self.origin + self.u * from.x + self.v * from.y,
            u: self.u * (to.x - from.x),
            v: self.v * (to.y - from.y),
            hole: None,
            texels: None,
        }
    }

    /// What is left beside the hole, as fractions; a hole that reaches the face's edge leaves fewer pieces.
    fn pieces(&self) -> Vec<[Vec2; 2]> {
        let Some([from, to]) = self.hole else { return vec![[Vec2::ZERO, Vec2::ONE]] };
        let (x, y) = ([0.0, from.x, to.x, 1.0], [0.0, from.y, to.y, 1.0]);
        let cells = (0..9).filter(|cell| *cell != 4).map(|cell| (cell % 3, cell / 3));
        let pieces = cells.map(|(i, j)| [Vec2::new(x[i], y[j]), Vec2::new(x[i + 1], y[j + 1])]);
        pieces.filter(|[from, to]| from.cmplt(*to).all()).collect()
    }
}

/// The sides of a box, facing outward. The underside is left out: these boxes stand sunk into something.
pub(crate) fn standing_box(min: [f32; 3], max: [f32; 3]) -> Vec<Face> {
    let [x, y, z] = min;
    let [w, h, d] = std::array::from_fn(|i| max[i] - min[i]);
    vec![
        Face::new([x, y, z + d], [w, 0.0, 0.0], [0.0, h, 0.0]),
        Face::new([x + w, y, z], [-w, 0.0, 0.0], [0.0, h, 0.0]),
        Face::new([x, y, z], [0.0, 0.0, d], [0.0, h, 0.0]),
        Face::new([x + w, y, z + d], [0.0, 0.0, -d], [0.0, h, 0.0]),
        Face::new([x, y + h, z + d], [w, 0.0, 0.0], [0.0, 0.0, -d]),
    ]
}

/// The sides of a room, facing inward: floor, ceiling, back, front, left, right.
pub(crate) fn room(min: [f32; 3], max: [f32; 3]) -> [Face; 6] {
    let ([x, y, z], [right, top, front]) = (min, max);
    let [w, h, d] = std::array::from_fn(|i| max[i] - min[i]);
    [
        Face::new([x, y, front], [w, 0.0, 0.0], [0.0, 0.0, -d]),
        Face::new([x, top, z], [w, 0.0, 0.0], [0.0, 0.0, d]),
        Face::new([x, y, z], [w, 0.0, 0.0], [0.0, h, 0.0]),
        Face::new([right, y, front], [-w, 0.0, 0.0], [0.0, h, 0.0]),
        Face::new([x, y, front], [0.0, 0.0, -d], [0.0, h, 0.0]),
        Face::new([right, y, z], [0.0, 0.0, d], [0.0, h, 0.0]),
    ]
}

/// Charts for all faces, at one density where a face has no size of its own, on shelves, the tallest first. Each begins at
/// a texel's corner.
pub(crate) fn charts(faces: &[Face], side: f32, texels_per_metre: f32) -> Vec<Chart> {
    let sizes: Vec<Vec2> =
        faces.iter().map(|face| face.texels.unwrap_or_else(|| face.size() * texels_per_metre)).collect();
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by(|a, b| sizes[*b].y.total_cmp(&sizes[*a].y).then(a.cmp(b)));
    let mut charts = vec![Chart { min: Vec2::ZERO, size: Vec2::ZERO }; faces.len()];
    let (mut cursor, mut shelf) = (Vec2::splat(MARGIN), 0.0_f32);
    for face in order {
        let size = sizes[face];
        if cursor.x + size.x > side - MARGIN {
            cursor = Vec2::new(MARGIN, (cursor.y + shelf).ceil() + GAP);
            shelf = 0.0;
        }
        assert!((cursor + size).max_element() <= side - MARGIN, "face {face} does not fit at {texels_per_metre}/m");
        charts[face] = Chart { min: cursor / side, size: size / side };
        shelf = shelf.max(size.y);
        cursor.x = (cursor.x + size.x).ceil() + GAP;
    }
    charts
}

/// Triangles of one material.
#[derive(Default)]
pub(crate) struct Part {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    light_map_uvs: Vec<[f32; 2]>,
    texcoords: Vec<[f32; 2]>,
    indices: Vec<u16>,
}

impl Part {
    /// Faces with their charts; texture coordinates are metres along `u` and `v`.
    pub(crate) fn of(faces: &[Face], charts: &[Chart]) -> Self {
        let mut part = Self::default();
        for (face, chart) in faces.iter().zip(charts) {
            for [from, to] in face.pieces() {
                let corners = [from, Vec2::new(to.x, from.y), to, Vec2::new(from.x, to.y)];
                let positions = corners.map(|c| face.origin + face.u * c.x + face.v * c.y);
                part.quad(positions, corners.map(|c| chart.min + chart.size * c), corners.map(|c| face.size() * c));
            }
        }
        part
    }

    /// A planar quad, counter-clockwise seen from its front.
    pub(crate) fn quad(&mut self, positions: [Vec3; 4], light_map_uvs: [Vec2; 4], texcoords: [Vec2; 4]) {
        let first = self.positions.len() as u16;
        let normal = (positions[1] - positions[0]).cross(positions[3] - positions[0]).normalize();
        self.positions.extend(positions.map(|p| p.to_array()));
        self.normals.extend([normal.to_array(); 4]);
        self.light_map_uvs.extend(light_map_uvs.map(|uv| uv.to_array()));
        self.texcoords.extend(texcoords.map(|uv| uv.to_array()));
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }

    /// The part as a glTF primitive, with the texture coordinates that it is asked for.
    pub(crate) fn primitive(&self, builder: &mut Builder, material: usize, sets: &[u32]) -> Value {
        let mut attributes = json!({
            "POSITION": builder.vectors(&self.positions),
            "NORMAL": builder.vectors(&self.normals),
        });
        for set in sets {
            let values = if *set == 1 { &self.light_map_uvs } else { &self.texcoords };
            attributes[format!("TEXCOORD_{set}")] = json!(builder.vectors(values));
        }
        json!({ "attributes": attributes, "indices": builder.indices(&self.indices), "material": material })
    }
}

/// What becomes a node with a mesh of its own.
pub(crate) struct Piece {
    pub(crate) name: &'static str,
    pub(crate) material: usize,
    pub(crate) faces: Vec<Face>,
    /// The node's transform.
    pub(crate) placed: Value,
}

/// A scene of pieces that share one light map, with no other texture coordinates.
pub(crate) fn scene(builder: &mut Builder, name: &str, pieces: &[Piece], side: f32, texels_per_metre: f32) {
    let all: Vec<Face> = pieces.iter().flat_map(|piece| &piece.faces).copied().collect();
    let charts = charts(&all, side, texels_per_metre);
    let (mut nodes, mut rest) = (Vec::new(), &charts[..]);
    for Piece { name, material, faces, placed } in pieces {
        let (own, others) = rest.split_at(faces.len());
        rest = others;
        let primitive = Part::of(faces, own).primitive(builder, *material, &[1]);
        let mesh = builder.push("meshes", json!({ "name": name, "primitives": [primitive] }));
        let mut node = placed.clone();
        node["name"] = json!(name);
        node["mesh"] = json!(mesh);
        nodes.push(builder.push("nodes", node));
    }
    builder.push("scenes", json!({ "name": name, "nodes": nodes }));
    builder.root["scene"] = json!(0);
}
