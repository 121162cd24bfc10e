//! Budgets of every size, and devices without timestamps. NUMERICS 9, case 18.

use crate::live::{AMPLE, Live};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use lightoven::baker::{FrameSettings, MeasuredBy, Ran, Timing};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{LightKind, Scene};
use std::time::Duration;

fn scene() -> Scene {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 2.0));
    stage.light(LightKind::Directional { direction: glam::Vec3::NEG_Z });
    let light = Quad { chart: None, ..level_square(1.0, 2.0, Facing::Down, Chart::large(0), lamp) };
    let floors = (0..4).map(|i| level_square(1.0, 0.1 * i as f32, Facing::Up, Chart::large(i), grey));
    stage.with(&floors.chain([light]).collect::<Vec<_>>())
}

#[test]
fn no_budget_does_nothing() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    for _ in 0..200 {
        let report = live.frame(0.01, Duration::ZERO);
        assert_eq!((report.ran, report.rays, report.dispatches), (Ran::empty(), 0, 0));
    }
    assert_eq!(live.baker.light_map().generation, 0);
    live.warm_up();
    live.finish();
}

/// A budget in which nothing fits still gets a light map, in small steps.
#[test]
fn a_tiny_budget_makes_progress() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    let (mut most, mut frames) = (0, 0);
    while live.baker.light_map().generation == 0 {
        let report = live.frame(0.01, Duration::from_nanos(1));
        most = most.max(report.dispatches);
        frames += 1;
        assert!(frames < 64 * 100, "no light map in {frames} frames");
    }
    println!("a light map after {frames} frames of a nanosecond, at most {most} dispatches each");
    // Rays, and the radiance that follows from them.
    assert_eq!(most, 2);
    live.finish();
}

/// However large the budget, a frame goes round once.
#[test]
fn a_huge_budget_goes_round_once() {
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), frames) else { return };
    live.warm_up();
    let texels = live.baker.statistics().texels;
    for budget in [AMPLE, Duration::from_secs(1_000_000), Duration::MAX] {
        for _ in 0..5 {
            let report = live.frame(0.01, budget);
            assert!(report.rays <= 16 * texels && report.samples_per_texel <= 16.0);
        }
    }
    live.finish();
}

/// The host's clock takes the timestamps' place, and the frames still hold about what their budget allows.
#[test]
fn without_timestamps() {
    let frames = FrameSettings { timing: Timing::Host, ..FrameSettings::default() };
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), frames) else { return };
    let (mut used, mut count) = (Duration::ZERO, 0);
    for frame in 0..300 {
        live.baker.set_time(Duration::from_millis(10 * frame)).unwrap();
        let (report, timing) = live.engine.record_frame(&mut live.baker, Duration::from_millis(8), None);
        if report.dispatches > 0 && frame >= 100 {
            let timing = timing.unwrap();
            assert_eq!(timing.measured_by, MeasuredBy::Host);
            used += timing.bake;
            count += 1;
        }
    }
    println!("{count} frames of 8 ms took {:?} on average", used / count);
    assert!(live.baker.light_map().generation > 5 && used / count < Duration::from_millis(80));
    live.finish();
}

/// Direct light is traced again only when something that it depends on has changed.
#[test]
fn a_still_scene_leaves_direct_light_alone() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    live.warm_up();
    live.frames(20, 0.01);
    let ran = |live: &mut Live| (0..5).fold(Ran::empty(), |ran, _| ran | live.frame(0.01, AMPLE).ran);
    assert!(!ran(&mut live).intersects(Ran::DIRECT | Ran::UPDATE | Ran::TOP_LEVEL | Ran::IMPORTANCE));
    live.baker.set_emission(1, glam::Vec3::ONE).unwrap();
    let after = ran(&mut live);
    assert!(after.contains(Ran::UPDATE) && !after.intersects(Ran::DIRECT | Ran::TOP_LEVEL), "{after:?}");
    let light = lightoven::scene::Light {
        name: "sun".into(),
        intensity: glam::Vec3::ONE,
        kind: LightKind::Directional { direction: glam::Vec3::NEG_ONE },
    };
    live.baker.set_light(0, light).unwrap();
    let after = ran(&mut live);
    assert!(after.contains(Ran::UPDATE | Ran::DIRECT) && !after.contains(Ran::TOP_LEVEL), "{after:?}");
    assert_eq!(after.names().collect::<Vec<_>>(), ["update", "direct", "bake", "source", "publish", "importance"]);
    live.finish();
}

/// A door that is told to be where it is, every frame, is no change: the scene is still, and its noise goes.
#[test]
fn what_is_told_again_is_no_change() {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 2.0));
    stage.light(LightKind::Directional { direction: glam::Vec3::NEG_Z });
    let light = Quad { chart: None, ..level_square(1.0, 2.0, Facing::Down, Chart::large(0), lamp) };
    stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(0), grey), light], glam::DAffine3::IDENTITY);
    stage.place(&[level_square(0.2, 0.5, Facing::Up, Chart::large(1), grey)], glam::DAffine3::IDENTITY);
    stage.desc.instances[1].mobility = lightoven::scene::Mobility::Movable;
    let scene = stage.build();
    let Some(mut live) = Live::new(BackendChoice::Software, &scene, FrameSettings::default()) else { return };
    live.warm_up();
    let tell = |live: &mut Live| {
        live.baker.set_transform(1, glam::DAffine3::IDENTITY).unwrap();
        live.baker.set_light(0, scene.lights()[0].clone()).unwrap();
        live.baker.set_emission(1, glam::Vec3::splat(2.0)).unwrap();
        live.baker.set_sky(lightoven::scene::Sky::Constant(glam::Vec3::ZERO)).unwrap();
        live.baker.add_instance(1).unwrap();
    };
    for _ in 0..150 {
        tell(&mut live);
        let report = live.frame(0.5, AMPLE);
        assert!(!report.ran.intersects(Ran::UPDATE | Ran::TOP_LEVEL | Ran::DIRECT), "{:?}", report.ran);
    }
    assert!(!live.frame(1.0 / 60.0, AMPLE).decaying);
    // What is absent moves unseen.
    live.baker.remove_instance(1).unwrap();
    live.frame(1.0 / 60.0, AMPLE);
    live.baker.set_transform(1, glam::DAffine3::from_translation(glam::DVec3::X)).unwrap();
    assert!(!live.frame(1.0 / 60.0, AMPLE).ran.contains(Ran::UPDATE));
    live.finish();
}

/// Only how time goes forward counts: the game's clock may begin anywhere, and be set back.
#[test]
fn time_that_is_set_back_stands_still() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    let frame = |live: &mut Live, now_s: f64| {
        live.baker.set_time(Duration::from_secs_f64(now_s)).unwrap();
        live.engine.record_frame(&mut live.baker, AMPLE, None).0
    };
    // The beginning decays, however late its clock.
    assert!(frame(&mut live, 1000.0).decaying);
    for step in 0..200 {
        frame(&mut live, 1000.0 + 0.2 * f64::from(step));
    }
    assert!(!frame(&mut live, 1040.0).decaying);
    live.baker.set_emission(1, glam::Vec3::ONE).unwrap();
    assert!(frame(&mut live, 0.0).decaying);
    for step in 0..200 {
        frame(&mut live, 0.2 * f64::from(step));
    }
    assert!(!frame(&mut live, 40.0).decaying, "40 s after the clock was set back");
    live.finish();
}

/// What a budget is worth is known once something has been measured.
#[test]
fn samples_for_a_budget_are_told() {
    let Some(mut live) = Live::new(BackendChoice::Software, &scene(), FrameSettings::default()) else { return };
    live.warm_up();
    let expected = live.baker.samples_per_texel(Duration::from_millis(10));
    println!("{expected:.2} samples a texel in 10 ms");
    assert!(expected > 0.0 && expected.is_finite());
    live.finish();
}
