//! Indices, offsets, lengths and numbers that contradict each other.

use crate::gltf_builder::Builder;
use crate::{SQUARE, SQUARE_UVS, assert_invalid, primitive, square};
use serde_json::{Value, json};

/// The square with one value of the document replaced.
fn with(pointer: &str, value: Value) -> Builder {
    let mut builder = square();
    let (parent, key) = pointer.rsplit_once('/').expect("is a pointer");
    builder.root.pointer_mut(parent).expect("exists")[key] = value;
    builder
}

#[test]
fn indices_into_lists() {
    assert_invalid(&with("/scene", json!(3)), &["scene", "out of bounds"]);
    assert_invalid(&with("/nodes/0/mesh", json!(3)), &["nodes[0].mesh"]);
    assert_invalid(&with("/nodes/0/children", json!([9])), &["nodes[0].children[0]"]);
    assert_invalid(&with("/bufferViews/0/buffer", json!(3)), &["bufferViews[0].buffer"]);
    assert_invalid(&with("/accessors/0/bufferView", json!(99)), &["accessors[0].bufferView"]);
    let primitive = "/meshes/0/primitives/0";
    assert_invalid(&with(&format!("{primitive}/attributes/POSITION"), json!(99)), &["POSITION of mesh 0", "99"]);
    assert_invalid(&with(&format!("{primitive}/attributes/TEXCOORD_1"), json!(99)), &["TEXCOORD_1"]);
    assert_invalid(&with(&format!("{primitive}/indices"), json!(99)), &["primitives[0].indices"]);
    assert_invalid(&with(&format!("{primitive}/material"), json!(0)), &["primitives[0].material"]);
    assert_invalid(&with(&format!("{primitive}/mode"), json!(9)), &["primitives[0].mode"]);
    assert_invalid(&with(&format!("{primitive}/attributes"), json!({})), &["POSITION", "Missing"]);
}

#[test]
fn views_outside_their_buffer() {
    for offset in [200, u64::MAX, u64::MAX - 40] {
        let builder = with("/bufferViews/0/byteOffset", json!(offset));
        assert_invalid(&builder, &["buffer view 0", &offset.to_string(), "buffer 0"]);
    }
    assert_invalid(&with("/bufferViews/2/byteLength", json!(4000)), &["buffer view 2", "4000", "buffer 0"]);
}

#[test]
fn accessors_outside_their_view() {
    assert_invalid(&with("/accessors/0/count", json!(5)), &["accessor 0 (POSITION of mesh", "5 elements", "48 bytes"]);
    for count in [u64::MAX, u64::MAX / 12, 1 << 60] {
        assert_invalid(&with("/accessors/0/count", json!(count)), &["accessor 0", &count.to_string()]);
    }
    assert_invalid(&with("/accessors/0/count", json!(0)), &["accessor 0", "count is 0"]);
    assert_invalid(&with("/accessors/1/byteOffset", json!(4)), &["accessor 1", "offset 4", "buffer view 1"]);
    assert_invalid(&with("/accessors/1/byteOffset", json!(u64::MAX)), &["accessor 1", "buffer view 1"]);
    assert_invalid(&with("/accessors/2/count", json!(7)), &["accessor 2 (indices of mesh", "12 bytes"]);
    assert_invalid(&with("/bufferViews/0/byteStride", json!(4)), &["buffer view 0", "is 4 bytes", "have 12"]);
    assert_invalid(&with("/bufferViews/0/byteStride", json!(16)), &["accessor 0", "16 apart"]);
    assert_invalid(&with("/bufferViews/0/byteStride", json!(0)), &["bufferViews[0].byteStride"]);
    // Zeros without a view cost the file nothing, however many there are.
    let mut empty = square();
    empty.root["accessors"][0] = json!({ "componentType": 5126, "count": 1_u64 << 40, "type": "VEC3" });
    assert_invalid(&empty, &["accessor 0", "1099511627776 elements"]);
}

#[test]
fn accessors_of_the_wrong_type() {
    let attributes = "/meshes/0/primitives/0/attributes";
    assert_invalid(&with(&format!("{attributes}/POSITION"), json!(1)), &["accessor 1", "Vec2", "allowed is Vec3"]);
    assert_invalid(&with(&format!("{attributes}/TEXCOORD_1"), json!(0)), &["accessor 0", "Vec3", "allowed is Vec2"]);
    assert_invalid(&with(&format!("{attributes}/NORMAL"), json!(2)), &["accessor 2", "NORMAL", "Scalar"]);
    assert_invalid(&with("/meshes/0/primitives/0/indices", json!(0)), &["accessor 0", "indices", "U8, U16 or U32"]);
    assert_invalid(&with("/accessors/0/componentType", json!(1)), &["accessors[0].componentType"]);
    assert_invalid(&with("/accessors/0/type", json!("VEC9")), &["accessors[0].type"]);
}

#[test]
fn numbers_out_of_their_range() {
    let named = |builder: &mut Builder| builder.root["meshes"][0]["name"] = json!("wall");
    let mut not_finite = square();
    named(&mut not_finite);
    let mut corners = SQUARE;
    corners[2][1] = f32::NAN;
    let accessor = not_finite.vectors(&corners);
    primitive(&mut not_finite)["attributes"]["POSITION"] = json!(accessor);
    assert_invalid(&not_finite, &["mesh 'wall'", "position of vertex 2", "NaN"]);

    let mut out_of_range = square();
    named(&mut out_of_range);
    let accessor = out_of_range.indices(&[0, 1, 4]);
    primitive(&mut out_of_range)["indices"] = json!(accessor);
    assert_invalid(&out_of_range, &["mesh 'wall'", "index 4", "4 vertices"]);

    let mut outside = square();
    named(&mut outside);
    let mut uvs = SQUARE_UVS;
    uvs[3][0] = 1.5;
    let accessor = outside.vectors(&uvs);
    primitive(&mut outside)["attributes"]["TEXCOORD_1"] = json!(accessor);
    assert_invalid(&outside, &["mesh 'wall'", "vertex 3", "1.5", "[0, 1]"]);

    let mut unequal = square();
    named(&mut unequal);
    let accessor = unequal.vectors(&SQUARE_UVS[..3]);
    primitive(&mut unequal)["attributes"]["TEXCOORD_1"] = json!(accessor);
    assert_invalid(&unequal, &["mesh 'wall'", "3 light-map coordinates for 4 vertices"]);
}

#[test]
fn material_numbers_out_of_their_range() {
    let mut builder = square();
    primitive(&mut builder)["material"] = json!(0);
    builder.push("materials", json!({ "name": "hole", "emissiveFactor": [-1, 0, 0] }));
    assert_invalid(&builder, &["emission of material 'hole'", "-1"]);
    builder.root["materials"][0] = json!({ "pbrMetallicRoughness": { "baseColorFactor": [-1, 0, 0, 1] } });
    assert_invalid(&builder, &["albedo of material 'material 0'", "-1"]);
    builder.root["materials"][0] = json!({ "emissiveTexture": { "index": 4 } });
    assert_invalid(&builder, &["materials[0].emissiveTexture"]);
    builder.root["materials"][0] = json!({ "alphaMode": "SOME" });
    assert_invalid(&builder, &["materials[0].alphaMode"]);
}
