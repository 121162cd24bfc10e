//! Materials, as glTF writes them.

use serde_json::{Value, json};

/// A diffuse surface.
pub(crate) fn matte(name: &str, [r, g, b]: [f64; 3]) -> Value {
    let pbr = json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0 });
    json!({ "name": name, "pbrMetallicRoughness": pbr })
}

/// The same material with a radiance of its own, `colour` times `strength`. The document then uses
/// `KHR_materials_emissive_strength`.
pub(crate) fn shining(mut material: Value, colour: [f64; 3], strength: u32) -> Value {
    material["emissiveFactor"] = json!(colour);
    material["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
    material
}
