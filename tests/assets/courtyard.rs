//! A courtyard in the sun, with an arcade in one corner.

use crate::faces::{Chart, Face, Part, charts, standing_box};
use crate::gltf_builder::{Builder, png};
use crate::materials::matte;
use glam::{Vec2, Vec3};
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2;

pub(crate) const TILES: &str = "courtyard_tiles.png";
pub(crate) const SIGN: &str = "courtyard_sign.png";

const PLASTER: usize = 0;
const PAVING: usize = 1;
const STONE: usize = 2;
const NEON: usize = 3;
const CLOTH: usize = 4;

/// A column's outline from the bottom up: half its side, height. The lowest ring is sunk into the ground.
const OUTLINE: [[f32; 2]; 6] = [[0.25, -0.05], [0.25, 0.2], [0.15, 0.3], [0.15, 2.1], [0.25, 2.2], [0.25, 2.4]];

/// Where columns stand, how they are turned about the vertical (quaternion y, w) and scaled.
const COLUMNS: [([f32; 3], [f32; 2], [f32; 3]); 8] = [
    ([1.9, 0.0, -1.6], [0.0, 1.0], [1.0, 1.0, 1.0]),
    ([4.4, 0.0, -1.6], [0.0, 1.0], [1.0, 1.0, 1.0]),
    ([1.9, 0.0, -3.4], [FRAC_1_SQRT_2, FRAC_1_SQRT_2], [1.0, 1.0, 1.0]),
    ([-3.5, 0.0, -2.5], [0.382683, 0.92388], [1.0, 1.0, 1.0]),
    ([-3.5, 0.0, 0.5], [0.258819, 0.965926], [1.0, 1.0, 1.0]),
    ([-3.5, 0.0, 3.0], [0.130526, 0.991445], [-1.0, 1.0, 1.0]),
    ([0.0, 0.0, 1.5], [0.382683, 0.92388], [2.2, 0.35, 2.2]),
    ([3.6, 0.0, 2.6], [-0.194, 0.981], [1.0, 0.8, 1.0]),
];

/// Paving tiles of four shades, with dark joints.
pub(crate) fn tiles() -> Vec<u8> {
    png(32, 32, |x, y| {
        if x % 16 == 0 || y % 16 == 0 {
            return [70, 66, 60];
        }
        let shade = [0, 24, 38, 12][(x / 16 + 2 * (y / 16)) as usize] + ((x * 7 + y * 13) % 5) as u8 * 3;
        [150 + shade, 140 + shade, 122 + shade]
    })
}

/// A white frame around an orange arrow on black.
pub(crate) fn sign() -> Vec<u8> {
    png(32, 16, |x, y| {
        let rise = y.abs_diff(8);
        let arrow = (6..20).contains(&x) && rise < 2 || (18..27).contains(&x) && rise < 27 - x;
        match (x.min(31 - x).min(y.min(15 - y)), arrow) {
            (0, _) => [255, 255, 255],
            (_, true) => [255, 120, 20],
            _ => [0, 0, 0],
        }
    })
}

fn materials(builder: &mut Builder) {
    builder.push("materials", matte("plaster", [0.8, 0.72, 0.58]));
    // Texture coordinates are metres; a texture is 1.6 m wide and lies askew.
    let transform = json!({ "scale": [0.625, 0.625], "rotation": 0.2, "offset": [0.1, 0.3] });
    let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let mut paving = matte("paving", [0.9, 0.9, 0.9]);
    paving["pbrMetallicRoughness"]["baseColorTexture"] = texture;
    builder.push("materials", paving);
    builder.push("materials", matte("stone", [0.6, 0.6, 0.62]));
    // Texture coordinates are metres here too; the sign is 1.6 m by 0.8 m, its image's top row up.
    let transform = json!({ "scale": [0.625, -1.25], "offset": [0.0, 1.0] });
    let mut neon = matte("neon", [0.05, 0.05, 0.05]);
    neon["emissiveFactor"] = json!([1, 1, 1]);
    neon["emissiveTexture"] = json!({ "index": 1, "extensions": { "KHR_texture_transform": transform } });
    neon["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": 8 } });
    builder.push("materials", neon);
    let mut cloth = matte("cloth", [0.55, 0.08, 0.1]);
    cloth["doubleSided"] = json!(true);
    builder.push("materials", cloth);
    builder.root["samplers"] = json!([{ "wrapS": 10497, "wrapT": 10497 }, { "wrapS": 33071, "wrapT": 33071 }]);
    builder.root["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1, "sampler": 1 }]);
    builder.root["images"] = json!([{ "uri": TILES }, { "uri": SIGN }]);
}

/// Ground, walls and the arcade's roof share one layout.
fn court(builder: &mut Builder) -> Value {
    let ground = Face::new([-5.0, 0.0, 4.0], [10.0, 0.0, 0.0], [0.0, 0.0, -8.0]);
    let mut faces = vec![ground];
    // Walls run into each other and the ground, so that no faces coincide.
    faces.extend(standing_box([-5.15, -0.05, -4.3], [5.15, 3.0, -4.0]));
    faces.extend(standing_box([-5.3, -0.05, -4.4], [-5.0, 3.1, 4.0]));
    faces.extend(standing_box([5.0, -0.05, -4.4], [5.3, 3.1, 4.0]));
    faces.extend(standing_box([1.5, 2.35, -4.1], [5.1, 2.55, -1.2]));
    faces.push(Face::new([1.5, 2.35, -4.1], [3.6, 0.0, 0.0], [0.0, 0.0, 2.9]));
    let charts = charts(&faces, 256.0, 10.0);
    let ground = Part::of(&faces[..1], &charts[..1]).primitive(builder, PAVING, &[0, 1]);
    let walls = Part::of(&faces[1..], &charts[1..]).primitive(builder, PLASTER, &[1]);
    json!([ground, walls])
}

/// Four sides unrolled without distortion, side by side, and the top.
fn column(builder: &mut Builder) -> Value {
    // Light-map coordinates for a metre; the widest ring is 0.5 m, the five charts are 0.2 apart.
    const SCALE: f32 = 0.3;
    let middle = |chart: usize| 0.1 + 0.2 * chart as f32;
    let mut part = Part::default();
    for (side, (across, out)) in
        [(Vec3::X, Vec3::Z), (Vec3::NEG_Z, Vec3::X), (Vec3::NEG_X, Vec3::NEG_Z), (Vec3::Z, Vec3::NEG_X)]
            .iter()
            .enumerate()
    {
        let mut along = 0.05;
        for rings in OUTLINE.windows(2) {
            let [[low, bottom], [high, top]] = [rings[0], rings[1]];
            let next = along + SCALE * Vec2::new(high - low, top - bottom).length();
            let corners = [
                (-low, low, bottom, along),
                (low, low, bottom, along),
                (high, high, top, next),
                (-high, high, top, next),
            ];
            let positions = corners.map(|(x, r, y, _)| *across * x + *out * r + Vec3::Y * y);
            part.quad(positions, corners.map(|(x, _, _, v)| Vec2::new(middle(side) + SCALE * x, v)), [Vec2::ZERO; 4]);
            along = next;
        }
    }
    let [r, y] = OUTLINE[OUTLINE.len() - 1];
    let corners = [[-r, r], [r, r], [r, -r], [-r, -r]];
    let uv = |[x, z]: [f32; 2]| Vec2::new(middle(4) + SCALE * x, 0.05 + SCALE * (r - z));
    part.quad(corners.map(|[x, z]| Vec3::new(x, y, z)), corners.map(uv), [Vec2::ZERO; 4]);
    json!([part.primitive(builder, STONE, &[1])])
}

fn lights(builder: &mut Builder) -> [usize; 3] {
    builder.root["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "name": "sun", "type": "directional", "color": [1.0, 0.93, 0.82], "intensity": 4 },
        { "name": "lantern", "type": "point", "color": [1.0, 0.7, 0.4], "intensity": 3, "range": 5 },
        { "name": "spotlight", "type": "spot", "color": [0.6, 0.8, 1.0], "intensity": 12, "range": 6,
          "spot": { "innerConeAngle": 0.3, "outerConeAngle": 0.6 } },
    ] } });
    let mut node = |light: usize, mut placed: Value| {
        placed["extensions"] = json!({ "KHR_lights_punctual": { "light": light } });
        builder.push("nodes", placed)
    };
    [
        // Down by 50 degrees, then turned by 30.
        node(0, json!({ "name": "sun", "rotation": [-0.408218, 0.23457, 0.109382, 0.875426] })),
        node(1, json!({ "name": "lantern", "translation": [3.2, 2.0, -2.6] })),
        // Straight down.
        node(
            2,
            json!({ "name": "spotlight", "translation": [4.4, 2.2, -3.2], "rotation": [-FRAC_1_SQRT_2, 0, 0, FRAC_1_SQRT_2] }),
        ),
    ]
}

pub(crate) fn build() -> Builder {
    let mut builder = Builder::new();
    builder.root["extensionsUsed"] =
        json!(["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_texture_transform"]);
    materials(&mut builder);
    let whole = [Chart { min: Vec2::ZERO, size: Vec2::ONE }];
    let neon = Face::new([-2.8, 1.4, -3.95], [1.6, 0.0, 0.0], [0.0, 0.8, 0.0]);
    let cloth = Face::new([-0.6, 1.2, -3.9], [0.7, 0.0, 0.15], [0.0, 1.5, 0.0]);
    let court = court(&mut builder);
    let column = column(&mut builder);
    let neon = json!([Part::of(&[neon], &whole).primitive(&mut builder, NEON, &[0, 1])]);
    // Decoration: blocks light and receives none.
    let cloth = json!([Part::of(&[cloth], &whole).primitive(&mut builder, CLOTH, &[])]);
    let mut nodes = Vec::new();
    for (name, primitives) in [("court", court), ("sign", neon), ("banner", cloth), ("column", column)] {
        let mesh = builder.push("meshes", json!({ "name": name, "primitives": primitives }));
        if name != "column" {
            nodes.push(builder.push("nodes", json!({ "name": name, "mesh": mesh })));
            continue;
        }
        for (i, (translation, [y, w], scale)) in COLUMNS.iter().enumerate() {
            let number = |c: &f32| c.to_string().parse::<f64>().expect("is a number");
            let list = |v: &[f32; 3]| v.iter().map(number).collect::<Vec<_>>();
            let node = json!({
                "name": format!("column {}", i + 1), "mesh": mesh, "translation": list(translation),
                "rotation": [0.0, number(y), 0.0, number(w)], "scale": list(scale),
            });
            nodes.push(builder.push("nodes", node));
        }
    }
    nodes.extend(lights(&mut builder));
    builder.push("scenes", json!({ "name": "courtyard", "nodes": nodes }));
    builder.root["scene"] = json!(0);
    builder
}
