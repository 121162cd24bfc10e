//! A valid file with bytes changed at random: refused or read, but never a panic.

use crate::gltf_builder::{Builder, png};
use crate::{Folder, SQUARE_UVS, glb, primitive, square};
use serde_json::json;

/// Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014.
struct SplitMix(u64);

impl SplitMix {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) % limit as u64) as usize
    }
}

/// A document that has everything the reader looks at.
pub(crate) fn specimen() -> Builder {
    let mut builder = square();
    let uvs = builder.vectors(&SQUARE_UVS);
    let normals = builder.vectors(&[[0.0, 0.0, 1.0]; 4]);
    let image = builder.view(&png(4, 4, |x, y| [x as u8 * 60, y as u8 * 60, 30]));
    let (indices, values) = (builder.view(&[1]), builder.view(&[0; 12]));
    builder.root["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": { "bufferView": indices, "componentType": 5121 }, "values": { "bufferView": values },
    });
    builder.root["accessors"][0]["byteOffset"] = json!(0);
    builder.root["bufferViews"][0]["byteStride"] = json!(12);
    builder.root["images"] = json!([{ "bufferView": image, "mimeType": "image/png" }]);
    builder.root["samplers"] = json!([{ "wrapS": 33071 }]);
    builder.root["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "scale": [2, 2], "rotation": 1 } } });
    builder.root["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": texture }, "emissiveTexture": texture,
        "emissiveFactor": [1, 1, 1], "alphaMode": "MASK",
    }]);
    builder.root["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "range": 9, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.5 } },
    ] } });
    builder.root["nodes"] = json!([
        { "mesh": 0, "children": [1], "rotation": [0, 0, 0, 1] },
        { "mesh": 0, "children": [2], "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1] },
        { "extensions": { "KHR_lights_punctual": { "light": 0 } } },
    ]);
    let primitive = primitive(&mut builder);
    primitive["material"] = json!(0);
    primitive["attributes"]["TEXCOORD_0"] = json!(uvs);
    primitive["attributes"]["NORMAL"] = json!(normals);
    let strip = json!({ "attributes": { "POSITION": 0 }, "mode": 5 });
    builder.root["meshes"][0]["primitives"].as_array_mut().expect("is a list").push(strip);
    builder
}

#[test]
fn changed_bytes_never_panic() {
    let original = glb(&specimen());
    let mut folder = Folder::new().with("m.glb", &original);
    folder.read("m.glb").expect("the specimen is valid");
    let mut random = SplitMix(20);
    let digits: Vec<usize> = (0..original.len()).filter(|i| original[*i].is_ascii_digit()).collect();
    let mut read = 0;
    for round in 0..4000 {
        let mut bytes = original.clone();
        for _ in 0..=random.below(3) {
            match round % 3 {
                // Numbers of the document: structure that parses and contradicts itself.
                0 => bytes[digits[random.below(digits.len())]] = b'0' + random.below(10) as u8,
                1 => bytes[random.below(original.len())] = random.below(256) as u8,
                _ => bytes[random.below(original.len())] ^= 1 << random.below(8),
            }
        }
        if round % 10 == 9 {
            bytes.truncate(random.below(bytes.len()));
        }
        folder = folder.with("m.glb", &bytes);
        read += usize::from(folder.read("m.glb").is_ok());
    }
    assert!(read > 0, "no mutation was harmless: the test tests nothing");
}
