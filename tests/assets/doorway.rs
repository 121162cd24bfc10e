//! Two closed rooms and a narrow opening between them. The lamp is in one; most of the other is lit by what its light
//! leaves on the walls.

use crate::faces::{Face, Piece, room, scene};
use crate::gltf_builder::Builder;
use crate::materials::{matte, shining};
use glam::Vec2;
use serde_json::json;

/// Side and height of a room. The lit one lies toward -x, the dark one toward +x.
const SIDE_LENGTH: f32 = 3.0;
const HEIGHT: f32 = 2.6;
/// Half the thickness of the wall between them, in whose middle x is 0.
const HALF_WALL: f32 = 0.05;
/// The opening reaches from the floor to this height, and from one z to the other.
const OPENING_TOP: f32 = 2.0;
const OPENING: [f32; 2] = [-0.1, 0.05];
/// The lamp fills a hole in the lit room's ceiling: the hole's corner, from that of the ceiling, and its side. It lights
/// the wall opposite the opening, which is .8 m away, and shows itself to a strip of the dark room.
const LAMP_AT: [f32; 2] = [0.8, 2.0];
const LAMP_SIDE: f32 = 0.1;
const RADIANCE: u32 = 1200;

/// Texels a side for which charts are padded, and texels for a metre. The lamp's and the opening's charts have sizes of
/// their own.
const SIDE: f32 = 128.0;
const DENSITY: f32 = 10.0;
const LAMP_TEXELS: f32 = 4.0;
/// Texels for a metre through the opening, and along it; at least 2.
const OPENING_DENSITY: Vec2 = Vec2::new(20.0, 10.0);

const PLASTER: usize = 0;
const LAMP: usize = 1;

const FLOOR: usize = 0;
const CEILING: usize = 1;
const LEFT: usize = 4;
const RIGHT: usize = 5;

/// Both rooms, the lit one first; the wall between them has the opening on both sides.
fn rooms() -> [[Face; 6]; 2] {
    let half = SIDE_LENGTH / 2.0;
    let mut lit = room([-HALF_WALL - SIDE_LENGTH, 0.0, -half], [-HALF_WALL, HEIGHT, half]);
    let mut dark = room([HALF_WALL, 0.0, -half], [HALF_WALL + SIDE_LENGTH, HEIGHT, half]);
    // Seen from the lit room the wall runs from -z to z, from the dark one the other way.
    let along = |z: f32| (z + half) / SIDE_LENGTH;
    let (from, to, top) = (along(OPENING[0]), along(OPENING[1]), OPENING_TOP / HEIGHT);
    lit[RIGHT].hole = Some([Vec2::new(from, 0.0), Vec2::new(to, top)]);
    dark[LEFT].hole = Some([Vec2::new(1.0 - to, 0.0), Vec2::new(1.0 - from, top)]);
    let corner = Vec2::from(LAMP_AT);
    lit[CEILING].hole = Some([corner, corner + LAMP_SIDE].map(|at| at / SIDE_LENGTH));
    [lit, dark]
}

/// Threshold, lintel and the two jambs: a room without its left and right.
fn opening() -> Vec<Face> {
    let [from, to] = OPENING;
    let sides = room([-HALF_WALL, 0.0, from], [HALF_WALL, OPENING_TOP, to]);
    let size =
        |face: &Face| (OPENING_DENSITY * Vec2::new(face.u.length(), face.v.length())).round().max(Vec2::splat(2.0));
    sides[FLOOR..LEFT].iter().map(|face| Face { texels: Some(size(face)), ..*face }).collect()
}

pub(crate) fn build() -> Builder {
    let [lit, dark] = rooms();
    let lamp = Face { texels: Some(Vec2::splat(LAMP_TEXELS)), ..lit[CEILING].filling() };
    let pieces = [
        ("lit room", PLASTER, lit.to_vec()),
        ("dark room", PLASTER, dark.to_vec()),
        ("opening", PLASTER, opening()),
        ("lamp", LAMP, vec![lamp]),
    ]
    .map(|(name, material, faces)| Piece { name, material, faces, placed: json!({}) });
    let mut builder = Builder::new();
    builder.root["extensionsUsed"] = json!(["KHR_materials_emissive_strength"]);
    builder.push("materials", matte("plaster", [0.6; 3]));
    builder.push("materials", shining(matte("lamp", [0.6; 3]), [1.0; 3], RADIANCE));
    scene(&mut builder, "doorway", &pieces, SIDE, DENSITY);
    builder
}
