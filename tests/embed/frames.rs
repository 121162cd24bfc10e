//! Frames of a foreign engine: recorded and submitted, with a moving object, drawn with the light map.

use crate::engine::draw::Draw;
use crate::engine::{Engine, counting};
use crate::stage::{Chart, Facing, SIDE, Stage, level_square};
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{BakeSettings, Baker, Clock, FrameSettings, Mode, Ran};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{Light, LightKind, Mobility, Resolution, Scene};
use std::time::Duration;

/// A floor under a lamp, and a square that moves between them.
fn scene() -> Scene {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 5.0));
    let floor = level_square(4.0, 0.0, Facing::Up, Chart::large(0), grey);
    let light = level_square(1.0, 3.0, Facing::Down, Chart::large(1), lamp);
    stage.place(&[floor, light], DAffine3::IDENTITY);
    stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(2), grey)], at(0.0));
    stage.desc.instances[1].mobility = Mobility::Movable;
    stage.light(LightKind::Point { position: DVec3::new(1.0, 1.0, 2.0), range: None });
    stage.build()
}

fn at(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 1.0))
}

fn baker(engine: &Engine, frames: FrameSettings) -> Baker {
    let settings =
        BakeSettings { resolution: Resolution::Texels(SIDE), mode: Mode::Frames(frames), ..BakeSettings::default() };
    Baker::new(engine.gpu(), &scene(), &settings).unwrap()
}

const BUDGET: Duration = Duration::from_millis(4);

#[derive(Clone, Copy, PartialEq)]
enum Way {
    Record,
    Submit,
}

/// Sixty frames in which the object moves, then 140 in which it moves on.
fn run(backend: BackendChoice, way: Way) {
    let Some(mut engine) = Engine::new(backend) else { return };
    let mut baker = baker(&engine, FrameSettings::default());
    let mut draw = Draw::new(&engine.device, 64);
    let (mut ran, mut generation) = (Ran::empty(), 0);
    for frame in 0..200 {
        if frame == 100 {
            counting::take();
        }
        counting::frame(|| baker.set_transform(1, at(f64::from(frame) * 0.01 - 1.0))).unwrap();
        let (report, timing) = match way {
            Way::Record => engine.record_frame(&mut baker, BUDGET, Some(&mut draw)),
            Way::Submit => engine.submit_frame(&mut baker, BUDGET, Some(&mut draw)),
        };
        assert!(!report.held_up && report.ran.contains(Ran::UPDATE | Ran::TOP_LEVEL));
        assert_eq!(timing.map(|timing| timing.frame), Some(report.frame));
        ran |= report.ran;
        assert!(baker.light_map().generation >= generation);
        generation = baker.light_map().generation;
    }
    let counts = counting::take();
    assert_eq!(counts, counting::Counts::default(), "in frames 100 to 199");
    assert!(ran.is_all() && generation > 2, "{ran:?}, {generation} light maps");
    let map = baker.read_back().unwrap();
    let lit = map.pixels.iter().filter(|pixel| pixel[0] > 0.0).count();
    println!("{:?}: {generation} light maps, {lit} of {} texels lit", engine.gpu().backend(), map.pixels.len());
    assert!(lit * 10 > map.pixels.len() * 9);
    drop(baker);
    draw.destroy(&engine.device);
    engine.finish();
}

#[test]
fn recorded_software() {
    run(BackendChoice::Software, Way::Record);
}

#[test]
fn recorded_ray_query() {
    run(BackendChoice::RayQuery, Way::Record);
}

#[test]
fn submitted_software() {
    run(BackendChoice::Software, Way::Submit);
}

#[test]
fn submitted_ray_query() {
    run(BackendChoice::RayQuery, Way::Submit);
}

/// As many frames under way as were allowed, and one more: the last is held up, and nobody waits.
fn overlapping(backend: BackendChoice) {
    let Some(engine) = Engine::new(backend) else { return };
    let settings = FrameSettings { frames_in_flight: 2, ..FrameSettings::default() };
    let mut baker = baker(&engine, settings);
    let mut draw = Draw::new(&engine.device, 64);
    let moving = |baker: &mut Baker, frame: usize| baker.set_transform(1, at(frame as f64 * 0.01 - 1.0)).unwrap();
    let reports = engine.record_in_flight(&mut baker, BUDGET, [150, 2], &mut draw, moving);
    assert!(reports.iter().all(|report| !report.held_up && report.ran.contains(Ran::TOP_LEVEL)));
    let generation = baker.light_map().generation;
    assert!(generation > 2, "{generation} light maps");
    let reports = engine.record_in_flight(&mut baker, BUDGET, [60, 3], &mut draw, moving);
    let held_up = reports.iter().filter(|report| report.held_up).count();
    println!("{generation} light maps in 150 frames; of 60 frames that were too many at once {held_up} were held up");
    assert!(held_up > 10 && held_up < 50, "{held_up}");
    assert!(reports.iter().all(|report| !report.held_up || (report.ran.is_empty() && report.rays == 0)));
    drop(baker);
    draw.destroy(&engine.device);
    engine.finish();
}

#[test]
fn overlapping_software() {
    overlapping(BackendChoice::Software);
}

#[test]
fn overlapping_ray_query() {
    overlapping(BackendChoice::RayQuery);
}

/// Two bakers on one device do not see each other.
#[test]
fn two_bakers() {
    let mut engine = Engine::new(BackendChoice::Software).unwrap();
    // Time stands still: all samples weigh alike, however the frames fall.
    let settings = FrameSettings { quanta: Some(1), clock: Clock::Engine, ..FrameSettings::default() };
    let frame = |engine: &mut Engine, baker: &mut Baker| {
        engine.record_frame(baker, Duration::from_millis(4), None);
        baker.light_map().sweeps
    };
    let mut alone = baker(&engine, settings);
    while frame(&mut engine, &mut alone) < 8 {}
    let (mut one, mut other) = (baker(&engine, settings), baker(&engine, settings));
    let dark =
        Light { name: "dark".into(), intensity: Vec3::ZERO, kind: LightKind::Directional { direction: Vec3::NEG_Z } };
    other.set_light(0, dark).unwrap();
    loop {
        frame(&mut engine, &mut other);
        if frame(&mut engine, &mut one) >= 8 {
            break;
        }
    }
    let [alone_map, one_map, other_map] = [&mut alone, &mut one, &mut other].map(|baker| baker.read_back().unwrap());
    assert!(one_map == alone_map, "the other baker is seen");
    assert!(other_map != alone_map);
    drop((alone, one, other));
    engine.finish();
}
