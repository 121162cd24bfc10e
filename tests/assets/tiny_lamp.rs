//! A closed room with a few blocks, lit by one lamp so small that a ray sent by the cosine hardly ever finds it.

use crate::faces::{Face, Piece, room, scene, standing_box};
use crate::gltf_builder::Builder;
use crate::materials::{matte, shining};
use glam::Vec2;
use serde_json::json;

const HALF_SIDE: f32 = 2.0;
const HEIGHT: f32 = 2.6;
/// The lamp: its middle, half its side, its radiance. It faces down.
const LAMP_AT: [f32; 3] = [0.3, 2.2, -0.2];
const HALF_LAMP: f32 = 0.01;
const RADIANCE: u32 = 32_000;
/// Blocks reach this far into the floor, so that no faces coincide.
const SUNK: f32 = 0.01;

/// Texels a side for which charts are padded, and texels for a metre; the lamp's chart has a size of its own.
const SIDE: f32 = 128.0;
const DENSITY: f32 = 10.0;
const LAMP_TEXELS: f32 = 4.0;

const PLASTER: usize = 0;
const CLAY: usize = 1;
const LAMP: usize = 2;

struct Block {
    name: &'static str,
    /// Width, height, depth.
    size: [f32; 3],
    /// Where it stands on the floor: x, z.
    at: [f64; 2],
    /// How it is turned about the vertical: quaternion y, w.
    turn: [f64; 2],
}

/// Turned by 20, -15 and 35 degrees.
const BLOCKS: [Block; 3] = [
    Block { name: "tall block", size: [0.6, 1.6, 0.6], at: [-1.0, -0.9], turn: [0.173648, 0.984808] },
    Block { name: "low block", size: [1.0, 0.5, 0.6], at: [0.9, 0.5], turn: [-0.130526, 0.991445] },
    Block { name: "block", size: [0.8, 0.9, 0.5], at: [-0.7, 1.0], turn: [0.300706, 0.953717] },
];

fn block([width, height, depth]: [f32; 3]) -> Vec<Face> {
    standing_box([-width / 2.0, -SUNK, -depth / 2.0], [width / 2.0, height, depth / 2.0])
}

fn lamp() -> Face {
    let [x, y, z] = LAMP_AT;
    let side = 2.0 * HALF_LAMP;
    let mut face = Face::new([x - HALF_LAMP, y, z - HALF_LAMP], [side, 0.0, 0.0], [0.0, 0.0, side]);
    face.texels = Some(Vec2::splat(LAMP_TEXELS));
    face
}

fn materials(builder: &mut Builder) {
    builder.root["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    builder.push("materials", matte("plaster", [0.5; 3]));
    builder.push("materials", matte("clay", [0.6, 0.48, 0.4]));
    builder.push("materials", shining(matte("lamp", [0.5; 3]), [1.0; 3], RADIANCE));
}

pub(crate) fn build() -> Builder {
    let walls = room([-HALF_SIDE, 0.0, -HALF_SIDE], [HALF_SIDE, HEIGHT, HALF_SIDE]).to_vec();
    let mut pieces = vec![
        Piece { name: "room", material: PLASTER, faces: walls, placed: json!({}) },
        Piece { name: "lamp", material: LAMP, faces: vec![lamp()], placed: json!({}) },
    ];
    pieces.extend(BLOCKS.map(|Block { name, size, at: [x, z], turn: [y, w] }| {
        let placed = json!({ "translation": [x, 0.0, z], "rotation": [0.0, y, 0.0, w] });
        Piece { name, material: CLAY, faces: block(size), placed }
    }));
    let mut builder = Builder::new();
    materials(&mut builder);
    scene(&mut builder, "tiny lamp", &pieces, SIDE, DENSITY);
    builder
}
