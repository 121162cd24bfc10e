//! What is refused, by name; the bake goes on as it was.

use crate::engine::Engine;
use crate::live::{AMPLE, Live};
use crate::stage::{Chart, Facing, SIDE, Stage, level_square};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use lightoven::baker::{BakeSettings, Baker, Bounces, FrameId, FrameSettings, Mode, Stop};
use lightoven::gpu::{BackendChoice, DeviceFeatures, RawDevice, RawQueue};
use lightoven::scene::{Light, LightKind, Mobility, Resolution, Scene, Sky, SkyMap};
use std::ops::ControlFlow;
use std::time::Duration;

fn scene() -> Scene {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 1.0);
    stage.light(LightKind::Directional { direction: Vec3::NEG_Z });
    stage.place(&[level_square(2.0, 0.0, Facing::Up, Chart::large(0), grey)], DAffine3::IDENTITY);
    stage.place(&[level_square(0.5, 1.0, Facing::Up, Chart::large(1), grey)], DAffine3::IDENTITY);
    stage.desc.instances[1].mobility = Mobility::Movable;
    stage.build()
}

fn message<T>(result: lightoven::Result<T>) -> String {
    result.err().expect("is refused").to_string()
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is missing in: {message}");
    }
}

fn sun(intensity: Vec3) -> Light {
    Light { name: "sun".into(), intensity, kind: LightKind::Directional { direction: Vec3::NEG_Z } }
}

#[test]
fn changes_that_are_refused_change_nothing() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    live.warm_up();
    let baker = &mut live.baker;
    let identity = DAffine3::IDENTITY;
    assert_says(&message(baker.set_transform(7, identity)), &["no instance 7", "has 2"]);
    assert_says(&message(baker.set_transform(0, identity)), &["instance 0 'instance 0'", "static", "movable"]);
    let nan = DAffine3::from_translation(DVec3::new(f64::NAN, 0.0, 0.0));
    assert_says(&message(baker.set_transform(1, nan)), &["instance 1 'instance 1'", "NaN", "finite, invertible"]);
    let flat = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)));
    assert_says(&message(baker.set_transform(1, flat)), &["instance 1", "invertible"]);
    let far = DAffine3::from_translation(DVec3::X * 1e6);
    assert_says(&message(baker.set_transform(1, far)), &["instance 1", "too far"]);
    assert_says(&message(baker.remove_instance(2)), &["no instance 2"]);
    assert_says(&message(baker.add_instance(0)), &["instance 0", "static"]);
    assert_says(&message(baker.set_light(1, sun(Vec3::ONE))), &["no light 1", "has 1"]);
    assert_says(
        &message(baker.set_light(0, sun(Vec3::NEG_ONE))),
        &["the intensity of light 'sun'", "-1", "at least 0"],
    );
    assert_says(&message(baker.set_emission(3, Vec3::ONE)), &["no material 3", "has 1"]);
    let inf = Vec3::new(0.0, f32::INFINITY, 0.0);
    assert_says(&message(baker.set_emission(0, inf)), &["the emission of material 0", "inf", "finite"]);
    assert_says(&message(baker.set_sky(Sky::Constant(Vec3::NEG_ONE))), &["the sky's radiance", "-1"]);
    let map = SkyMap { width: 1, height: 1, pixels: vec![Vec3::ONE] };
    assert_says(&message(baker.set_sky(Sky::Map(map))), &["the sky is a map", "declared without"]);
    assert_says(&message(baker.complete(FrameId(1_000_000))), &["frame 1000000", "frames up to"]);
    let report = live.frame(0.01, AMPLE);
    assert!(!report.ran.intersects(lightoven::baker::Ran::UPDATE | lightoven::baker::Ran::TOP_LEVEL), "{report:?}");
    assert!(report.rays > 0);
    live.finish();
}

#[test]
fn settings_out_of_range_are_named() {
    let Some(engine) = Engine::new(BackendChoice::Software) else { return };
    let scene = scene();
    let refused = |frames: FrameSettings, bounces| {
        let resolution = Resolution::Texels(SIDE);
        let settings = BakeSettings { resolution, bounces, mode: Mode::Frames(frames), ..BakeSettings::default() };
        message(Baker::new(engine.gpu(), &scene, &settings))
    };
    let default = FrameSettings::default();
    for threshold in [0.0, 1.0, -0.1, f64::NAN] {
        let message = refused(FrameSettings { decay_threshold: threshold, ..default }, Bounces::Auto);
        assert_says(&message, &["decay threshold", &threshold.to_string(), "between 0 and 1"]);
    }
    for count in [0, 9] {
        let message = refused(FrameSettings { frames_in_flight: count, ..default }, Bounces::Auto);
        assert_says(&message, &["frames in flight", &count.to_string(), "1 to 8"]);
    }
    assert_says(&refused(FrameSettings { quanta: Some(0), ..default }, Bounces::Auto), &["quanta", "0", "1 to 64"]);
    assert_says(&refused(default, Bounces::Limit(2)), &["limited to 2", "within frames is no limit"]);
    engine.finish();
}

/// A device of the library's own has no engine's frames, and nobody who promises to wait for them.
#[test]
fn a_device_of_our_own_has_no_frames() {
    let headless = lightoven::headless::Headless::new(&Default::default()).unwrap();
    let settings = BakeSettings { mode: Mode::Frames(FrameSettings::default()), ..BakeSettings::default() };
    let refused = message(Baker::new(headless.gpu(), &scene(), &settings));
    assert_says(&refused, &["within frames", "an engine's device", "lightoven's own"]);
}

/// A baker does what it was made for.
#[test]
fn the_other_mode_is_refused() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    let stop = Stop { samples: Some(64), ..Stop::default() };
    assert_says(
        &message(live.baker.bake(&stop, &mut |_| ControlFlow::Continue(()))),
        &["within frames", "at a stretch"],
    );
    live.warm_up();
    assert_says(&message(live.baker.submit(Duration::from_millis(1), &[], &[])), &["recorded or", "submitted"]);
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let mut still = Baker::new(live.engine.gpu(), &scene(), &settings).unwrap();
    assert_says(&message(still.set_emission(0, Vec3::ONE)), &["at a stretch", "within frames"]);
    assert_says(&message(still.complete(FrameId(1))), &["at a stretch"]);
    drop(still);
    live.finish();
}

/// An engine hands compiled pipelines in and takes them out; what is not as it was given is left aside.
#[test]
fn compiled_pipelines_are_taken_back() {
    let Some(engine) = Engine::new(BackendChoice::Software) else { return };
    let bytes = engine.gpu().pipeline_cache().unwrap();
    let damaged = bytes.iter().map(|byte| byte ^ 1).collect::<Vec<_>>();
    for pipeline_cache in [&bytes[..], &bytes[..bytes.len() - 1], &damaged, &[]] {
        let raw = RawDevice { pipeline_cache, ..engine.raw(BackendChoice::Software) };
        let gpu = engine.again(raw);
        assert_eq!(gpu.pipeline_cache().unwrap().len(), bytes.len());
    }
    engine.finish();
}

/// A device that was made without something is refused, whatever it may have.
#[test]
fn what_a_device_lacks_is_named() {
    let Some(engine) = Engine::new(BackendChoice::Software) else { return };
    let without = |feature| {
        let raw = engine.raw(BackendChoice::Software);
        engine.refused(RawDevice { features: raw.features.difference(feature), ..raw })
    };
    assert_says(&without(DeviceFeatures::TIMELINE_SEMAPHORE), &["created without the feature timelineSemaphore"]);
    assert_says(&without(DeviceFeatures::DYNAMIC_RENDERING), &["dynamicRendering", "'software'"]);
    assert_says(&without(DeviceFeatures::MAINTENANCE4), &["maintenance4"]);
    let other_family = |family| {
        let raw = engine.raw(BackendChoice::Software);
        engine.refused(RawDevice { queue: RawQueue { family, ..raw.queue }, ..raw })
    };
    assert_says(&other_family(99), &["the family of the queue is 99", "graphics and compute: 0"]);
    assert_says(&other_family(u32::MAX), &["4294967295"]);
    let raw = engine.raw(BackendChoice::Software);
    let compute_queue = Some(RawQueue { family: 99, ..raw.queue });
    let refused = engine.refused(RawDevice { compute_queue, ..raw });
    assert_says(&refused, &["the family of the queue for compute is 99", "with compute: 0"]);
    engine.finish();
    let Some(engine) = Engine::new(BackendChoice::RayQuery) else { return };
    let raw = engine.raw(BackendChoice::RayQuery);
    let message = engine.refused(RawDevice { device_extensions: &[], ..raw });
    assert_says(&message, &["created without the extension VK_KHR_", "'ray-query'"]);
    engine.finish();
}
