//! A scene that stays as it is, baked within frames: the plain mean, and the answers of a static bake.

use crate::live::{AMPLE, Live};
use crate::stage::{Chart, Facing, SIDE, Stage, level_square, room};
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{BakeSettings, Baker, FrameSettings, Slice, Stop};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{LightKind, Resolution, Scene, Sky, SkyMap};
use std::ops::ControlFlow;
use std::time::Duration;

fn texels(charts: std::ops::Range<u32>) -> Vec<usize> {
    charts.flat_map(|index| Chart::large(index).texels().map(|(texel, _)| texel).collect::<Vec<_>>()).collect()
}

/// A room with a lamp in it, a point light, grey walls.
fn lit_room() -> Scene {
    let mut stage = Stage::new();
    let grey = stage.material(0.6, 0.0);
    let lamp = stage.material(0.2, 4.0);
    let mut quads = room(Vec3::splat(-1.0), Vec3::ONE, Chart::large, grey).to_vec();
    quads.push(level_square(0.8, 0.9, Facing::Down, Chart::large(6), lamp));
    quads.push(level_square(0.8, 0.92, Facing::Up, Chart::large(7), grey));
    stage.light(LightKind::Point { position: DVec3::new(0.4, 0.3, -0.2), range: None });
    stage.with(&quads)
}

/// Dynamic and static agree in every bounce of a closed room.
fn as_a_static_bake(backend: BackendChoice) {
    let scene = lit_room();
    let Some(mut live) = Live::new(backend, &scene, FrameSettings::default()) else { return };
    live.warm_up();
    // Until the beginning has left, then a mean that lasts.
    live.frames(200, 0.2);
    assert!(!live.frame(0.2, AMPLE).decaying);
    live.frames(200, 0.2);
    let all = texels(0..8);
    let dynamic = live.irradiance(&all);
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let mut baker = Baker::new(live.engine.gpu(), &scene, &settings).unwrap();
    let stop = Stop { samples: Some(2048), ..Stop::default() };
    baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    let map = baker.read_back().unwrap();
    let still: Vec<f64> = all.iter().map(|texel| f64::from(map.pixels[*texel][0])).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let ratio = mean(&dynamic) / mean(&still);
    let squares = dynamic.iter().zip(&still).map(|(a, b)| (a - b) * (a - b));
    let rmse = (squares.sum::<f64>() / all.len() as f64).sqrt() / mean(&still);
    println!("{:.0} samples a texel", live.baker.statistics().samples_per_texel);
    println!("{backend:?}: dynamic over static {ratio:.5}, RMSE {:.3} %", 100.0 * rmse);
    assert!((ratio - 1.0).abs() < 2e-3 && rmse < 0.05, "{ratio}, {rmse}");
    drop(baker);
    live.finish();
}

#[test]
fn as_a_static_bake_software() {
    as_a_static_bake(BackendChoice::Software);
}

#[test]
fn as_a_static_bake_ray_query() {
    as_a_static_bake(BackendChoice::RayQuery);
}

/// The sky changes: a constant one, and a map of the size that was declared.
#[test]
fn the_sky_changes() {
    let sky = |radiance: f32| SkyMap { width: 4, height: 2, pixels: vec![Vec3::splat(radiance); 8] };
    for map in [false, true] {
        let mut stage = Stage::new();
        let black = stage.material(0.0, 0.0);
        if map {
            stage.desc.sky = Sky::Map(sky(1.0));
        }
        let scene = stage.with(&[level_square(1.0, 0.0, Facing::Up, Chart::large(0), black)]);
        let Some(mut live) = Live::new(BackendChoice::Software, &scene, FrameSettings::default()) else { return };
        live.warm_up();
        let pi = std::f32::consts::PI;
        for (value, expected) in [
            (Sky::Constant(Vec3::splat(2.0)), 2.0 * pi),
            (Sky::Black, 0.0),
            if map { (Sky::Map(sky(3.0)), 3.0 * pi) } else { (Sky::Constant(Vec3::splat(3.0)), 3.0 * pi) },
        ] {
            live.baker.set_sky(value).unwrap();
            live.frames(240, 1.0 / 60.0);
            let mean = live.mean(&texels(0..1));
            println!("map {map}: {mean}, {expected} expected");
            assert!((mean - f64::from(expected)).abs() < 2e-3, "{mean}, {expected} expected");
        }
        live.finish();
    }
}

/// A day of ten thousand times the night is gone in the end, and not frozen into the mean of the night.
#[test]
fn day_turns_to_night() {
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    stage.sky(1e4);
    let scene = stage.with(&[level_square(1.0, 0.0, Facing::Up, Chart::large(0), black)]);
    let Some(mut live) = Live::new(BackendChoice::Software, &scene, FrameSettings::default()) else { return };
    live.warm_up();
    live.frames(300, 0.2);
    live.baker.set_sky(Sky::Constant(Vec3::ONE)).unwrap();
    // At the end it is what 32 bits tell: without noise to dither them, changes below a step of some 1e4 quanta are lost.
    for (seconds, most) in [(8, 0.02), (12, 1e-3), (40, 1e-3)] {
        live.frames(seconds * 30, 1.0 / 30.0);
        let over = live.mean(&texels(0..1)) / std::f64::consts::PI - 1.0;
        println!("{seconds} s more: {over:.6} of the night too bright");
        assert!(over.abs() < most, "{over}");
    }
    live.finish();
}

/// By slices of a millisecond and by unlimited ones: the same bits, of a static bake and of frames.
#[test]
fn slices_leave_no_trace() {
    let scene = lit_room();
    let bits = |map: lightoven::baker::LightMap| map.pixels.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
    let Some(engine) = crate::engine::Engine::new(BackendChoice::Software) else { return };
    let baked = [Duration::from_millis(1), Duration::from_secs(100)].map(|slice| {
        let settings =
            BakeSettings { resolution: Resolution::Texels(SIDE), slice: Slice::Time(slice), ..BakeSettings::default() };
        let mut baker = Baker::new(engine.gpu(), &scene, &settings).unwrap();
        let stop = Stop { samples: Some(128), ..Stop::default() };
        baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
        bits(baker.read_back().unwrap())
    });
    assert!(baked[0] == baked[1], "slices of 1 ms and of 100 s differ");
    engine.finish();

    let framed = [Duration::from_millis(1), Duration::from_secs(100)].map(|budget| {
        let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
        let mut live = Live::new(BackendChoice::Software, &scene, frames).unwrap();
        let mut count = 0;
        // Time stands still: the light map is the mean of its sweeps.
        while live.baker.light_map().sweeps < 12 {
            live.frame(0.0, budget);
            count += 1;
        }
        assert_eq!(live.baker.light_map().sweeps, 12);
        println!("12 sweeps in {count} frames of {budget:?}");
        let map = bits(live.baker.read_back().unwrap());
        live.finish();
        map
    });
    assert!(framed[0] == framed[1], "budgets of 1 ms and of 100 s differ");
}

/// A mirrored, stretched object that is placed anew has the light of one that was there from the start.
#[test]
fn placed_anew() {
    let build = |transform: DAffine3| {
        let mut stage = Stage::new();
        let black = stage.material(0.0, 0.0);
        let lamp = stage.material(0.0, 2.0);
        let light = crate::stage::Quad { chart: None, ..level_square(2.0, 2.0, Facing::Down, Chart::large(3), lamp) };
        stage.place(&[level_square(4.0, -1.0, Facing::Up, Chart::large(1), black), light], DAffine3::IDENTITY);
        stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(0), black)], transform);
        stage.desc.instances[1].mobility = lightoven::scene::Mobility::Movable;
        stage.build()
    };
    let wanted = DAffine3::from_scale_rotation_translation(
        DVec3::new(-1.5, 0.7, 2.0),
        glam::DQuat::from_rotation_x(0.6),
        DVec3::new(0.3, 0.1, 0.4),
    );
    let mut means = [DAffine3::IDENTITY, wanted].map(|start| {
        let mut live = Live::new(BackendChoice::Software, &build(start), FrameSettings::default()).unwrap();
        live.warm_up();
        live.baker.set_transform(1, wanted).unwrap();
        live.frames(400, 1.0 / 60.0);
        // Both atlases are laid out by the areas at the start: compare the whole rectangle's mean.
        let (atlas, map) = (live.baker.atlas().clone(), live.baker.read_back().unwrap());
        let side = SIDE as f32;
        let rect = atlas.rects[1];
        let values: Vec<f64> = Chart::large(0)
            .texels()
            .map(|(texel, _)| {
                let place = glam::Vec2::new((texel as u32 % SIDE) as f32 + 0.5, (texel as u32 / SIDE) as f32 + 0.5);
                let at = (place / side * rect.scale + rect.offset).as_uvec2();
                f64::from(map.pixels[(at.y * atlas.size.x + at.x) as usize][0])
            })
            .collect();
        live.finish();
        values.iter().sum::<f64>() / values.len() as f64
    });
    means.sort_by(f64::total_cmp);
    println!("moved there and built there: {means:?}");
    assert!(means[0] > 0.1 && means[1] / means[0] < 1.02, "{means:?}");
}
