//! The same bits however the work is cut: NUMERICS case 22.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;

use device::on_both_back_ends;
use lightoven::baker::{BakeSettings, Baker, ErrorEstimate, LightMap, Outcome, Progress, Sampling, Slice, Stop};
use lightoven::gpu::Gpu;
use lightoven::io::gltf::{self, ReadSettings};
use lightoven::scene::{Resolution, Scene, Sky, SkyMap};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

on_both_back_ends!(
    again,
    cut_differently,
    aimed_again_and_cut_differently,
    another_seed,
    continued,
    read_twice,
    watched,
    watched_adaptive,
    ended_at_once,
);

/// Instances, textures, lights, a sky of its own.
fn courtyard() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/courtyard.gltf");
    gltf::read(&path, &ReadSettings::default()).unwrap()
}

/// Bakes up to each of these numbers of samples in turn; the light map, and how many slices it took.
fn bake(gpu: &Gpu, samples: &[u32], slice: Slice, seed: u64) -> (LightMap, usize) {
    bake_by(gpu, &courtyard(), Sampling::Auto, samples, slice, seed)
}

fn bake_by(
    gpu: &Gpu,
    scene: &Scene,
    sampling: Sampling,
    samples: &[u32],
    slice: Slice,
    seed: u64,
) -> (LightMap, usize) {
    let settings =
        BakeSettings { resolution: Resolution::Texels(64), sampling, slice, seed, ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, scene, &settings).unwrap();
    let mut slices = 0;
    for samples in samples {
        let stop = Stop { samples: Some(*samples), ..Stop::default() };
        let mut count = |_: &_| {
            slices += 1;
            ControlFlow::Continue(())
        };
        baker.bake(&stop, &mut count).unwrap();
    }
    // Whatever the baker chooses: the first bounces' rays are aimed in either scene.
    assert!(baker.statistics().sampling.source_rays > 0, "no ray is aimed");
    (baker.read_back().unwrap(), slices)
}

fn bits(map: &LightMap) -> Vec<[u32; 4]> {
    map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

fn again(gpu: &Gpu) {
    let [first, second] = [0; 2].map(|seed| bake(gpu, &[256], Slice::default(), seed).0);
    assert!(first.pixels.iter().any(|pixel| pixel[0] > 0.0));
    assert!(bits(&first) == bits(&second), "two bakes differ");
}

fn cut_differently(gpu: &Gpu) {
    let (timed, _) = bake(gpu, &[256], Slice::default(), 7);
    // The whole map at once, and a work group at a time.
    for texels in [u32::MAX, 1] {
        let (cut, slices) = bake(gpu, &[256], Slice::Texels(texels), 7);
        println!("{texels} texels a slice, {}: {slices} slices", gpu.backend().name());
        assert!(bits(&cut) == bits(&timed), "{texels} texels a slice give other bits than slices by time");
    }
}

/// A scene under a sky map, where some rays are always aimed, at texels and at pixels; and one with a tiny lamp, as it comes.
fn aimed_scenes() -> [(Scene, Sampling); 2] {
    let pixel = |i: u32| glam::Vec3::splat(if i == 11 { 50.0 } else { 0.1 });
    let mut courtyard = courtyard();
    courtyard.set_sky(Sky::Map(SkyMap { width: 7, height: 5, pixels: (0..35).map(pixel).collect() })).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/tiny_lamp.gltf");
    let tiny_lamp = gltf::read(&path, &ReadSettings::default()).unwrap();
    [(courtyard, Sampling::Mixture { cosine: 0.25 }), (tiny_lamp, Sampling::Auto)]
}

/// Aimed rays are numbered by texel and sample as others are, and so is what decides how many are aimed.
fn aimed_again_and_cut_differently(gpu: &Gpu) {
    for (scene, sampling) in aimed_scenes() {
        let by_slice = |slice| bits(&bake_by(gpu, &scene, sampling, &[192], slice, 5).0);
        let first = by_slice(Slice::default());
        for slice in [Slice::default(), Slice::Texels(u32::MAX), Slice::Texels(256)] {
            assert!(by_slice(slice) == first, "{}, {sampling:?}: {slice:?} gives other bits", scene.name());
        }
        let in_steps = bits(&bake_by(gpu, &scene, sampling, &[64, 192], Slice::default(), 5).0);
        assert!(in_steps == first, "{}, {sampling:?}: a bake that went on gives other bits", scene.name());
    }
}

fn another_seed(gpu: &Gpu) {
    let [low, other, high] = [1, 2, 1 << 32 | 1].map(|seed| bits(&bake(gpu, &[64], Slice::default(), seed).0));
    assert!(low != other && low != high && other != high, "two seeds give the same bits");
}

fn continued(gpu: &Gpu) {
    let (at_once, _) = bake(gpu, &[256], Slice::default(), 3);
    let (in_steps, _) = bake(gpu, &[64, 256], Slice::default(), 3);
    assert!(bits(&at_once) == bits(&in_steps), "a bake that went on differs from one without a stop");
}

fn stop_at(samples: u32) -> Stop {
    Stop { samples: Some(samples), ..Stop::default() }
}

/// A light map that is looked at on the way leaves no trace in the final one.
fn read_twice(gpu: &Gpu) {
    let settings = BakeSettings { resolution: Resolution::Texels(64), seed: 3, ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, &courtyard(), &settings).unwrap();
    let mut go_on = |_: &_| ControlFlow::Continue(());
    baker.bake(&stop_at(64), &mut go_on).unwrap();
    let early = baker.read_back().unwrap();
    baker.bake(&stop_at(256), &mut go_on).unwrap();
    let late = bits(&baker.read_back().unwrap());
    assert!(bits(&early) != late);
    assert!(bits(&bake(gpu, &[256], Slice::default(), 3).0) == late, "an earlier look changed the light map");
}

/// The clock of a bake that is watched runs on from call to call and stands still in between, and no early look warns of
/// bounces that are still to come.
fn watched(gpu: &Gpu) {
    let settings = BakeSettings { resolution: Resolution::Texels(64), seed: 3, ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, &courtyard(), &settings).unwrap();
    let mut clock = Duration::ZERO;
    for stop in [Stop { time: Some(Duration::from_millis(1)), ..Stop::default() }, stop_at(64), stop_at(256)] {
        let before = clock;
        baker
            .bake_until(&stop, &mut |progress| {
                assert!(progress.elapsed > clock, "{:?} after {clock:?}", progress.elapsed);
                clock = progress.elapsed;
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!(clock > before);
        baker.read_back().unwrap();
    }
    let warnings = &baker.statistics().warnings;
    assert!(!warnings.iter().any(|warning| warning.contains("bounces")), "{warnings:?}");
    let late = bits(&baker.read_back().unwrap());
    assert!(bits(&bake(gpu, &[256], Slice::default(), 3).0) == late, "looking on the way changed the light map");
    // All of that time is spent.
    let spent = Stop { time: Some(clock), ..Stop::default() };
    baker.bake_until(&spent, &mut |_| panic!("there is nothing left to do")).unwrap();
    // Far more than a slice takes.
    let pause = Duration::from_secs(2);
    std::thread::sleep(pause);
    let more = |progress: &Progress| {
        assert!(progress.elapsed < clock + pause, "{:?} after {clock:?}: the clock ran on", progress.elapsed);
        ControlFlow::Break(())
    };
    assert_eq!(baker.bake_until(&stop_at(512), &mut { more }).unwrap(), Outcome::Interrupted);
}

/// What an adaptive bake decides does not depend on who looks on the way.
fn watched_adaptive(gpu: &Gpu) {
    let settings = BakeSettings {
        resolution: Resolution::Texels(64),
        seed: 3,
        error: ErrorEstimate::Adaptive,
        ..BakeSettings::default()
    };
    let to_error = Stop { error: Some(0.01), ..Stop::default() };
    let baked = |looks: usize| {
        let mut baker = Baker::new(gpu, &courtyard(), &settings).unwrap();
        for _ in 0..looks {
            let mut slices = 0;
            let mut pause = |_: &_| {
                slices += 1;
                if slices > 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            baker.bake_until(&to_error, &mut pause).unwrap();
            baker.read_back().unwrap();
        }
        baker.bake_until(&to_error, &mut |_| ControlFlow::Continue(())).unwrap();
        assert!(baker.statistics().samples_per_texel < baker.statistics().most_samples, "no texel has stopped");
        bits(&baker.read_back().unwrap())
    };
    assert!(baked(0) == baked(9), "looking on the way changed the light map");
}

/// However early a bake is stopped, there is a light map: every texel has had the first few rays.
fn ended_at_once(gpu: &Gpu) {
    let settings =
        BakeSettings { resolution: Resolution::Texels(64), slice: Slice::Texels(1), ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, &courtyard(), &settings).unwrap();
    baker.bake(&stop_at(64), &mut |_| ControlFlow::Break(())).unwrap();
    let map = baker.read_back().unwrap();
    let lit = map.pixels.iter().filter(|pixel| pixel[3] == 1.0 && pixel[0] > 0.0).count();
    let covered = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).count();
    println!("stopped at once, {}: {lit} of {covered} texels have light", gpu.backend().name());
    assert!(lit * 2 > covered);
}
