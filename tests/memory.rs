//! A long run and many reloads take no more and no more memory, of the host or of the device.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[expect(dead_code, reason = "the tests of an engine's frames use the rest of it")]
#[path = "embed/engine/mod.rs"]
mod engine;

use engine::Engine;
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{BakeSettings, Baker, Clock, FrameSettings, Mode, Stop};
use lightoven::gpu::{BackendChoice, Gpu};
use lightoven::scene::{LightKind, Mobility, Resolution, Scene};
use lightoven::verify::stage::{Chart, Facing, Stage, level_square};
use std::ops::ControlFlow;
use std::time::Duration;

const FRAMES: u32 = 2000;
const RELOADS: u32 = 20;
/// Frames and reloads before the first look: drivers and allocators fill their caches.
const WARM_UP_FRAMES: u32 = 300;
const WARM_UP_RELOADS: u32 = 10;
/// What the host may come to hold beyond that. Measured on lavapipe with the validation layers, which keep a little of every
/// pipeline: nothing in 1,700 frames, 57 KiB a reload over 80 of them. A light map is 256 KiB: one that stayed in every
/// hundredth frame, or in every reload, would be seen.
const MARGIN_KIB: u64 = 4096;

/// Resident memory of the process, KiB; where the system tells.
fn resident_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// A floor under a lamp, a square that moves between them, and a point light.
fn scene() -> Scene {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 5.0));
    let floor = level_square(4.0, 0.0, Facing::Up, Chart::large(0), grey);
    let light = level_square(1.0, 3.0, Facing::Down, Chart::large(1), lamp);
    stage.place(&[floor, light], DAffine3::IDENTITY);
    stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(2), grey)], at(0.0));
    stage.desc.instances[1].mobility = Mobility::Movable;
    stage.light(LightKind::Point { position: DVec3::new(1.0, 1.0, 2.0), range: None });
    stage.build().unwrap()
}

fn at(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 1.0))
}

fn baker(gpu: &Gpu, scene: &Scene) -> Baker {
    let frames = FrameSettings { clock: Clock::Engine, quanta: Some(1), ..FrameSettings::default() };
    let mode = Mode::Frames(frames);
    let settings = BakeSettings { resolution: Resolution::Texels(128), mode, ..BakeSettings::default() };
    Baker::new(gpu, scene, &settings).unwrap()
}

/// Everything changes that may.
fn frame(engine: &mut Engine, baker: &mut Baker, frame: u32) {
    baker.set_time(Duration::from_millis(16 * u64::from(frame))).unwrap();
    baker.set_transform(1, at(f64::from(frame % 100) * 0.01 - 0.5)).unwrap();
    baker.set_emission(1, Vec3::splat(1.0 + (frame % 7) as f32)).unwrap();
    match frame % 50 {
        20 => baker.remove_instance(1).unwrap(),
        30 => baker.add_instance(1).unwrap(),
        _ => {}
    }
    engine.record_frame(baker, Duration::from_millis(4), None);
}

/// A scene that is built, baked at a stretch and within frames, and dropped.
fn reload(engine: &mut Engine) {
    let scene = scene();
    let settings = BakeSettings { resolution: Resolution::Texels(128), ..BakeSettings::default() };
    let mut still = Baker::new(engine.gpu(), &scene, &settings).unwrap();
    let stop = Stop { samples: Some(64), ..Stop::default() };
    still.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(still.read_back().unwrap().pixels.iter().any(|pixel| pixel[0] > 0.0));
    drop(still);
    let mut baker = baker(engine.gpu(), &scene);
    (0..20).for_each(|index| frame(engine, &mut baker, index));
    drop(baker);
}

/// What host and device hold, KiB and bytes.
fn held(engine: &Engine) -> [u64; 2] {
    [resident_kib().unwrap_or(0), engine.gpu().allocated_bytes()]
}

fn check(name: &str, [host_before, before]: [u64; 2], [host, now]: [u64; 2]) {
    println!("{name}: {host_before} KiB of the host and {before} bytes of the device; at the end {host} and {now}");
    assert_eq!(now, before, "{name}: bytes of the device");
    assert!(host <= host_before + MARGIN_KIB, "{name}: {} KiB more of the host", host - host_before);
}

/// One test, for the memory is that of the whole process.
#[test]
fn memory_stays_flat() {
    if resident_kib().is_none() {
        println!("this system does not tell how much memory the process holds: only the device's is looked at");
    }
    let mut engine = Engine::new(BackendChoice::Software).unwrap();
    let mut baker = baker(engine.gpu(), &scene());
    (0..WARM_UP_FRAMES).for_each(|index| frame(&mut engine, &mut baker, index));
    let before = held(&engine);
    (WARM_UP_FRAMES..FRAMES).for_each(|index| frame(&mut engine, &mut baker, index));
    check("frames", before, held(&engine));
    assert!(baker.light_map().generation > u64::from(FRAMES / 20));
    drop(baker);
    assert_eq!(engine.gpu().allocated_bytes(), 0);

    (0..WARM_UP_RELOADS).for_each(|_| reload(&mut engine));
    let before = held(&engine);
    (0..RELOADS).for_each(|_| reload(&mut engine));
    check("reloads", before, held(&engine));
    assert_eq!(engine.gpu().allocated_bytes(), 0);
    engine.finish();
}
