//! A closed cube seen from inside: every surface has albedo 1/2 and emits 1.

use crate::faces::{Chart, Part, room};
use crate::gltf_builder::Builder;
use glam::Vec2;
use serde_json::json;

pub(crate) fn build() -> Builder {
    let faces = room([0.0; 3], [1.0; 3]);
    // 3 x 2 charts of 16 x 16 texels at 64, their sides on texel borders.
    let charts: Vec<Chart> = (0..6)
        .map(|i| Vec2::new((4 + 20 * (i % 3)) as f32, (12 + 24 * (i / 3)) as f32))
        .map(|min| Chart { min: min / 64.0, size: Vec2::splat(0.25) })
        .collect();
    let mut builder = Builder::new();
    let material = builder.push(
        "materials",
        json!({
            "name": "glowing grey", "emissiveFactor": [1, 1, 1],
            "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0 },
        }),
    );
    let primitive = Part::of(&faces, &charts).primitive(&mut builder, material, &[1]);
    let mesh = builder.push("meshes", json!({ "name": "cube", "primitives": [primitive] }));
    let node = builder.push("nodes", json!({ "name": "cube", "mesh": mesh }));
    builder.push("scenes", json!({ "nodes": [node] }));
    builder.root["scene"] = json!(0);
    builder
}
