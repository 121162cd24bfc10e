//! Objects that move, go and come: their shadows and their light follow within the latency. NUMERICS 9, case 21.

use crate::engine::counting;
use crate::live::{AMPLE, Live};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{FrameSettings, Ran};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{Light, LightKind, Mobility, Scene};

const FLOOR: f32 = 4.0;
/// Of frames of a sixtieth of a second: the latency.
const LATENCY_FRAMES: usize = 30;

fn at(x: f64, y: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, 0.5))
}

/// A floor, and above it a small square that moves; material 2 is the square's.
fn floor(lights: impl FnOnce(&mut Stage) -> Vec<Quad>) -> Scene {
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let mut quads = lights(&mut stage);
    quads.push(level_square(FLOOR, 0.0, Facing::Up, Chart::large(0), black));
    stage.place(&quads, DAffine3::IDENTITY);
    let square = stage.material(0.0, 0.0);
    // It shades both ways.
    let up = level_square(1.6, 0.0, Facing::Up, Chart::large(1), square);
    let down = level_square(1.6, 0.0, Facing::Down, Chart::large(2), square);
    stage.place(&[up, down], at(-1.0, 0.0));
    stage.desc.instances[1].mobility = Mobility::Movable;
    stage.build()
}

/// The floor's texels within the shadow of a square at (x, y), a little inside its border. The atlas gives the floor's
/// instance a rectangle of its own.
fn floor_texels(live: &Live, centre: [f64; 2]) -> Vec<usize> {
    let atlas = live.baker.atlas();
    let rect = atlas.rects[0];
    let inside = |[u, v]: [f64; 2]| {
        let place = [(u - 0.5) * f64::from(FLOOR), (v - 0.5) * f64::from(FLOOR)];
        (place[0] - centre[0]).abs() < 0.2 && (place[1] - centre[1]).abs() < 0.2
    };
    let side = crate::stage::SIDE as f32;
    let scale = rect.scale / side;
    let mut texels = Vec::new();
    for (texel, place) in Chart::large(0).texels().filter(|(_, place)| inside(*place)) {
        let (x, y) = (texel as u32 % crate::stage::SIDE, texel as u32 / crate::stage::SIDE);
        let place_in_map = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * scale + rect.offset;
        let (x, y) = (place_in_map.x as usize, place_in_map.y as usize);
        assert!(x < atlas.size.x as usize && y < atlas.size.y as usize, "{place:?}");
        texels.push(y * atlas.size.x as usize + x);
    }
    assert!(texels.len() >= 4);
    texels
}

/// What the middle of the shadow has at A and at B, relative to that of the floor without anything over it.
fn shades(live: &mut Live, open: f64) -> [f64; 2] {
    [[-1.0, 0.0], [1.0, 0.0]].map(|centre| {
        let texels = floor_texels(live, centre);
        live.mean(&texels) / open
    })
}

fn shadow_follows(backend: BackendChoice, scene: &Scene, dark: f64) {
    let Some(mut live) = Live::new(backend, scene, FrameSettings::default()) else { return };
    live.baker.remove_instance(1).unwrap();
    live.warm_up();
    live.frames(4 * LATENCY_FRAMES, 1.0 / 60.0);
    let open = live.mean(&floor_texels(&live, [0.0, 0.0]));
    live.baker.add_instance(1).unwrap();
    live.frames(4 * LATENCY_FRAMES, 1.0 / 60.0);
    let [shaded, lit] = shades(&mut live, open);
    println!("at A: {shaded:.3} under it and {lit:.3} at B, of the open floor");
    assert!(shaded < dark && lit > 0.7, "{shaded}, {lit}");

    counting::take();
    live.baker.set_transform(1, at(1.0, 0.0)).unwrap();
    let report = live.frame(1.0 / 60.0, AMPLE);
    assert!(report.ran.contains(Ran::TOP_LEVEL | Ran::UPDATE) && report.decaying);
    live.frames(LATENCY_FRAMES, 1.0 / 60.0);
    let [after_a, after_b] = shades(&mut live, open);
    println!("after the latency: {after_a:.3} at A, {after_b:.3} at B");
    // A tenth of the old light is left, and of its absence. Noise: a quarter of some 50 texels' mean, of over 100 rays each.
    let noise = 0.25 / (50.0_f64 * 100.0).sqrt() * 4.0;
    assert!(after_a > lit - 0.1 * (lit - shaded) - noise, "the old shadow stays: {after_a}");
    assert!(after_b < shaded + 0.1 * (lit - shaded) + noise, "the new shadow is late: {after_b}");
    assert_eq!(counting::take().draws, 0, "the g-buffer was drawn again");
    live.finish();
}

/// The light is a point: its shadow is traced anew at once.
fn under_a_point() -> Scene {
    floor(|stage| {
        stage.material(0.0, 0.0);
        stage.light(LightKind::Point { position: DVec3::Z * 2.0, range: None });
        Vec::new()
    })
}

#[test]
fn a_shadow_of_rays_software() {
    shadow_follows(BackendChoice::Software, &wide(), 0.3);
}

#[test]
fn a_shadow_of_rays_ray_query() {
    shadow_follows(BackendChoice::RayQuery, &wide(), 0.3);
}

/// A sky of light over the floor and the square near to it.
fn wide() -> Scene {
    floor(|stage| {
        let lamp = stage.material(0.0, 1.0);
        vec![Quad { chart: None, ..level_square(12.0, 4.0, Facing::Down, Chart::large(3), lamp) }]
    })
}

#[test]
fn a_shadow_of_a_sun() {
    let scene = floor(|stage| {
        stage.material(0.0, 0.0);
        stage.light(LightKind::Directional { direction: Vec3::NEG_Z });
        Vec::new()
    });
    shadow_follows(BackendChoice::Software, &scene, 1e-6);
}

/// An object that shines carries its light along, and takes it with it.
#[test]
fn a_moving_light() {
    let Some(mut live) = Live::new(BackendChoice::Software, &under_a_point(), FrameSettings::default()) else { return };
    let off =
        Light { name: "off".into(), intensity: Vec3::ZERO, kind: LightKind::Point { position: DVec3::Z, range: None } };
    live.baker.set_light(0, off).unwrap();
    live.baker.set_emission(2, Vec3::splat(5.0)).unwrap();
    live.warm_up();
    live.frames(4 * LATENCY_FRAMES, 1.0 / 60.0);
    let [near, far] = shades(&mut live, 1.0);
    assert!(near > 5.0 * far && far > 0.0, "{near}, {far}");
    live.baker.set_transform(1, at(1.0, 0.0)).unwrap();
    live.frames(LATENCY_FRAMES + 1, 1.0 / 60.0);
    let [left, arrived] = shades(&mut live, 1.0);
    println!("light at A and B: {near:.3}, {far:.3}; after the move {left:.3}, {arrived:.3}");
    assert!((arrived / (0.9 * near + 0.1 * far) - 1.0).abs() < 0.15, "{arrived}");
    assert!((left / (0.9 * far + 0.1 * near) - 1.0).abs() < 0.25, "{left}");
    live.baker.remove_instance(1).unwrap();
    live.frames(3 * LATENCY_FRAMES, 1.0 / 60.0);
    let [gone_a, gone_b] = shades(&mut live, 1.0);
    assert!(gone_a < 0.01 * near && gone_b < 0.01 * near, "{gone_a}, {gone_b}");
    live.finish();
}

/// An object that was not there in the first frames is not dark when it comes.
#[test]
fn one_that_comes_late_is_lit_at_once() {
    let mut stage = Stage::new();
    let white = stage.material(0.5, 0.0);
    stage.sky(1.0);
    for (chart, x) in [(0, -1.0), (1, 1.0)] {
        let square = level_square(1.0, 0.0, Facing::Up, Chart::large(chart), white);
        stage.place(&[square], DAffine3::from_translation(DVec3::X * x));
    }
    stage.desc.instances[1].mobility = Mobility::Movable;
    let frames = FrameSettings { tolerable_latency: std::time::Duration::MAX, ..FrameSettings::default() };
    let Some(mut live) = Live::new(BackendChoice::Software, &stage.build(), frames) else { return };
    live.baker.remove_instance(1).unwrap();
    live.warm_up();
    live.frames(50, 1.0 / 60.0);
    live.baker.add_instance(1).unwrap();
    live.frames(2, 1.0 / 60.0);
    let rect = live.baker.atlas().rects[1];
    let middle = (rect.offset + rect.scale * chart_middle()).as_uvec2();
    let texel = (middle.y * live.baker.atlas().size.x + middle.x) as usize;
    let lit = live.irradiance(&[texel])[0];
    assert!((lit / std::f64::consts::PI - 1.0).abs() < 1e-3, "{lit}");
    live.finish();
}

/// Without any instance there is nothing to do, and nothing goes wrong; one that comes back is lit.
fn all_gone(backend: BackendChoice) {
    let mut stage = Stage::new();
    let white = stage.material(0.5, 0.0);
    stage.sky(1.0);
    for (chart, x) in [(0, -1.0), (1, 1.0)] {
        let square = level_square(1.0, 0.0, Facing::Up, Chart::large(chart), white);
        stage.place(&[square], DAffine3::from_translation(DVec3::X * x));
    }
    stage.desc.instances.iter_mut().for_each(|instance| instance.mobility = Mobility::Movable);
    let Some(mut live) = Live::new(backend, &stage.build(), FrameSettings::default()) else { return };
    live.warm_up();
    live.baker.remove_instance(0).unwrap();
    live.baker.remove_instance(1).unwrap();
    live.frames(10, 1.0 / 60.0);
    live.baker.remove_instance(1).unwrap();
    live.baker.add_instance(1).unwrap();
    live.frames(3 * LATENCY_FRAMES, 1.0 / 60.0);
    let rect = live.baker.atlas().rects[1];
    let middle = (rect.offset + rect.scale * chart_middle()).as_uvec2();
    let texel = (middle.y * live.baker.atlas().size.x + middle.x) as usize;
    let lit = live.irradiance(&[texel])[0];
    println!("under the sky again: {lit}, pi is expected");
    assert!((lit / std::f64::consts::PI - 1.0).abs() < 1e-3, "{lit}");
    live.finish();
}

/// Where the middle of the second large chart is in its light map.
fn chart_middle() -> glam::Vec2 {
    let side = crate::stage::SIDE;
    let texels: Vec<usize> = Chart::large(1).texels().map(|(texel, _)| texel).collect();
    let (first, last) = (texels[0] as u32, texels[texels.len() - 1] as u32);
    let middle = |a: u32, b: u32| (a + b + 1) as f32 / 2.0 / side as f32;
    glam::Vec2::new(middle(first % side, last % side), middle(first / side, last / side))
}

#[test]
fn all_gone_software() {
    all_gone(BackendChoice::Software);
}

#[test]
fn all_gone_ray_query() {
    all_gone(BackendChoice::RayQuery);
}
