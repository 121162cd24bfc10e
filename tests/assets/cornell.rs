//! The Cornell box, <https://www.graphics.cornell.edu/online/box/data.html>, straightened and 2 m wide.

use crate::faces::{Face, Part, charts, standing_box};
use crate::gltf_builder::Builder;
use crate::materials::{matte, shining};
use glam::Vec2;
use serde_json::{Value, json};

/// Metres for a unit of the original, which is 552.8 wide, 548.8 high and 559.2 deep.
const SCALE: f32 = 0.0036;
const HALF_WIDTH: f32 = 276.4 * SCALE;
const HEIGHT: f32 = 548.8 * SCALE;
const HALF_DEPTH: f32 = 279.6 * SCALE;
/// Half a block's side; the tall one is four times as high, the short one twice.
const HALF_BLOCK: f32 = 82.5 * SCALE;
/// Blocks reach this far into the floor, so that no faces coincide.
const SUNK: f32 = 0.01;

/// Texels a side for which charts are padded, and texels for a metre.
const SIDE: f32 = 128.0;
const DENSITY: f32 = 19.5;

const WHITE: usize = 0;
const RED: usize = 1;
const GREEN: usize = 2;
const LAMP: usize = 3;

/// Floor, ceiling, back; left; right; the lamp, which fills the ceiling's hole. The front is open.
fn room() -> [Face; 6] {
    let (w, h, d) = (HALF_WIDTH, HEIGHT, HALF_DEPTH);
    let mut ceiling = Face::new([-w, h, -d], [2.0 * w, 0.0, 0.0], [0.0, 0.0, 2.0 * d]);
    ceiling.hole = Some([[213.0, 227.0], [343.0, 332.0]].map(|corner| Vec2::from(corner) / Vec2::new(552.8, 559.2)));
    [
        Face::new([-w, 0.0, d], [2.0 * w, 0.0, 0.0], [0.0, 0.0, -2.0 * d]),
        ceiling,
        Face::new([-w, 0.0, -d], [2.0 * w, 0.0, 0.0], [0.0, h, 0.0]),
        Face::new([-w, 0.0, d], [0.0, 0.0, -2.0 * d], [0.0, h, 0.0]),
        Face::new([w, 0.0, -d], [0.0, 0.0, 2.0 * d], [0.0, h, 0.0]),
        ceiling.filling(),
    ]
}

fn block(height: f32) -> Vec<Face> {
    standing_box([-HALF_BLOCK, -SUNK, -HALF_BLOCK], [HALF_BLOCK, height, HALF_BLOCK])
}

fn materials(builder: &mut Builder) {
    for (name, albedo) in [("white", [0.725, 0.71, 0.68]), ("red", [0.63, 0.065, 0.05]), ("green", [0.14, 0.45, 0.091])]
    {
        builder.push("materials", matte(name, albedo));
    }
    // Radiance 17, 12, 4.
    builder.push("materials", shining(matte("lamp", [0.78; 3]), [1.0, 0.705882, 0.235294], 17));
}

pub(crate) fn build() -> Builder {
    let (room, short, tall) = (room(), block(4.0 * HALF_BLOCK / 2.0), block(4.0 * HALF_BLOCK));
    let all: Vec<Face> = room.iter().chain(&short).chain(&tall).copied().collect();
    let charts = charts(&all, SIDE, DENSITY);

    let mut builder = Builder::new();
    builder.root["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    materials(&mut builder);
    let mut node = |name: &str, parts: &[(std::ops::Range<usize>, usize)], placed: Value| {
        let primitives: Vec<Value> = parts
            .iter()
            .map(|(range, material)| {
                Part::of(&all[range.clone()], &charts[range.clone()]).primitive(&mut builder, *material, &[1])
            })
            .collect();
        let mesh = builder.push("meshes", json!({ "name": name, "primitives": primitives }));
        let mut node = placed;
        node["name"] = json!(name);
        node["mesh"] = json!(mesh);
        builder.push("nodes", node)
    };
    let (short_end, tall_end) = (room.len() + short.len(), all.len());
    let nodes = [
        node("room", &[(0..3, WHITE), (3..4, RED), (4..5, GREEN)], json!({})),
        node("lamp", &[(5..6, LAMP)], json!({})),
        // Turned by -16.6 and 17.2 degrees about the vertical.
        node(
            "short block",
            &[(6..short_end, WHITE)],
            json!({ "translation": [0.327, 0.0, 0.398], "rotation": [0.0, -0.144356, 0.0, 0.989526] }),
        ),
        node(
            "tall block",
            &[(short_end..tall_end, WHITE)],
            json!({ "translation": [-0.332, 0.0, -0.258], "rotation": [0.0, 0.149535, 0.0, 0.988756] }),
        ),
    ];
    builder.push("scenes", json!({ "name": "cornell", "nodes": nodes }));
    builder.root["scene"] = json!(0);
    builder
}
