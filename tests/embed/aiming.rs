//! Rays that are aimed at what shines, while that changes.

use crate::live::{AMPLE, Live};
use crate::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DVec3, Vec3};
use lightoven::baker::{FrameSettings, Ran, Sampling};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{Mobility, Scene, Sky, SkyMap};
use std::f64::consts::PI;
use std::time::Duration;

const FLOOR: u32 = 0;

/// A black floor of side 1 under a black lamp of side .05, which may move and has texels; material 1 is the lamp's.
fn movable_lamp() -> Scene {
    let mut stage = Stage::new();
    let (black, lamp) = (stage.material(0.0, 0.0), stage.material(0.0, 100.0));
    stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(FLOOR), black)], DAffine3::IDENTITY);
    stage.place(&[level_square(0.05, 1.0, Facing::Down, Chart::new(0), lamp)], DAffine3::IDENTITY);
    stage.desc.instances[1].mobility = Mobility::Movable;
    stage.build()
}

/// No old light is left at the next visit.
fn forgetful() -> FrameSettings {
    FrameSettings { tolerable_latency: Duration::ZERO, quanta: Some(4), ..FrameSettings::default() }
}

/// Irradiance of a small lamp at (x, 0, 1), relative to that straight under it: cos^4.
fn beneath(x: f64, lamp_x: f64) -> f64 {
    (1.0 + (x - lamp_x).powi(2)).powi(-2)
}

fn follows_a_moving_lamp(backend: BackendChoice) {
    let Some(mut live) = Live::sampled(backend, &movable_lamp(), forgetful(), Sampling::Mixture { cosine: 0.5 }) else {
        return;
    };
    live.warm_up();
    live.frames(40, 0.01);
    let atlas = live.baker.atlas().clone();
    let pyramids = |live: &mut Live| live.frame(0.01, AMPLE).sampling.pyramids;
    let still = pyramids(&mut live);
    assert!((0..20).all(|_| pyramids(&mut live) == still), "a still scene builds pyramids");
    // Power 100, area .05^2.
    let under = 100.0 * 0.05 * 0.05;
    for lamp_x in [0.0, 0.4, -0.45] {
        let at = DAffine3::from_translation(DVec3::new(lamp_x, 0.0, 0.0));
        live.baker.set_transform(1, at).unwrap();
        let first = live.frame(0.01, AMPLE);
        assert!(lamp_x == 0.0 || first.ran.contains(Ran::IMPORTANCE | Ran::BAKE), "{:?}", first.ran);
        // What the lamp shows now, in a frame or two: cosine rays alone would leave noise of 100 %.
        live.frames(if lamp_x == 0.0 { 30 } else { 2 }, 0.01);
        let map = live.baker.read_back().unwrap();
        let rect = atlas.rects[0];
        let (mut sum, mut wanted) = (0.0, 0.0);
        for (texel, [u, v]) in Chart::large(FLOOR).texels() {
            let place = glam::Vec2::new((texel as u32 % 128) as f32 + 0.5, (texel as u32 / 128) as f32 + 0.5) / 128.0;
            let at = (place * rect.scale + rect.offset).as_uvec2();
            let (x, y) = (u - 0.5, v - 0.5);
            sum += f64::from(map.pixels[(at.y * atlas.size.x + at.x) as usize][0]);
            wanted += under * (1.0 + (x - lamp_x).powi(2) + y * y).powi(-2);
        }
        let sampling = live.frame(0.01, AMPLE).sampling;
        println!(
            "lamp at {lamp_x}: {:.4} of what a small lamp gives; {} pyramids, {:?} seen, straight under it {:.3}",
            sum / wanted,
            sampling.pyramids,
            sampling.source_seen,
            beneath(0.0, lamp_x)
        );
        assert!((sum / wanted - 1.0).abs() < 0.02, "{sum} is not {wanted}");
        assert!(sampling.source_rays > 0 && sampling.source_seen.is_some_and(|seen| seen > 0.9));
    }
    live.finish();
}

#[test]
fn follows_a_moving_lamp_software() {
    follows_a_moving_lamp(BackendChoice::Software);
}

#[test]
fn follows_a_moving_lamp_ray_query() {
    follows_a_moving_lamp(BackendChoice::RayQuery);
}

/// Of two lamps, the one that shines.
#[test]
fn follows_a_switch() {
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let lamps = [stage.material(0.0, 100.0), stage.material(0.0, 0.0)];
    let lamp = |index: usize, x: f32| {
        let square = level_square(0.05, 1.0, Facing::Down, Chart::new(index as u32), lamps[index]);
        Quad { corner: square.corner + Vec3::X * x, ..square }
    };
    let floor = level_square(1.0, 0.0, Facing::Up, Chart::large(FLOOR), black);
    let scene = stage.with(&[floor, lamp(0, -0.3), lamp(1, 0.3)]);
    let Some(mut live) = Live::new(BackendChoice::Software, &scene, forgetful()) else { return };
    live.warm_up();
    live.frames(40, 0.01);
    let rows: Vec<_> = Chart::large(FLOOR).texels().collect();
    let mean_x = |live: &mut Live| {
        let values = live.irradiance(&rows.iter().map(|(texel, _)| *texel).collect::<Vec<_>>());
        let weighted: f64 = values.iter().zip(&rows).map(|(value, (_, [x, _]))| value * x).sum();
        weighted / values.iter().sum::<f64>()
    };
    let before = mean_x(&mut live);
    live.baker.set_emission(lamps[0], Vec3::ZERO).unwrap();
    live.baker.set_emission(lamps[1], Vec3::splat(100.0)).unwrap();
    live.frames(3, 0.01);
    let after = mean_x(&mut live);
    live.frames(20, 0.01);
    let sampling = live.frame(0.01, AMPLE).sampling;
    println!("light's middle at {before:.4}, then {after:.4}; {sampling:?}");
    assert!((before + after - 1.0).abs() < 0.01 && before < 0.48 && after > 0.52);
    assert!(sampling.cosine_share < 0.6 && sampling.source_seen.is_some_and(|seen| seen > 0.8), "{sampling:?}");
    live.finish();
}

/// A sky of which one pixel shines, and then another: straight up, and low.
#[test]
fn follows_the_sky() {
    let sky = |lit: usize| {
        let pixels = (0..32 * 16).map(|i| if i == lit { Vec3::splat(50.0) } else { Vec3::ZERO }).collect();
        Sky::Map(SkyMap { width: 32, height: 16, pixels })
    };
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    stage.desc.sky = sky(0);
    // Up is y for a sky: a floor that looks there.
    let floor = Quad { corner: Vec3::ZERO, u: Vec3::Z, v: Vec3::X, chart: Some(Chart::large(FLOOR)), material: black };
    let Some(mut live) = Live::new(BackendChoice::Software, &stage.with(&[floor]), forgetful()) else { return };
    let texels: Vec<usize> = Chart::large(FLOOR).texels().map(|(texel, _)| texel).collect();
    live.warm_up();
    for row in [0_u32, 3, 6] {
        live.baker.set_sky(sky(row as usize * 32 + 5)).unwrap();
        live.frames(20, 0.01);
        // Integral of cos over the pixel's solid angle.
        let [top, bottom] = [row, row + 1].map(|row| (PI * f64::from(row) / 16.0).sin().powi(2) / 2.0);
        let wanted = 50.0 * (2.0 * PI / 32.0) * (bottom - top);
        let found = live.mean(&texels);
        let sampling = live.frame(0.01, AMPLE).sampling;
        println!("row {row}: {found:.6}, {wanted:.6} wanted, {sampling:?}");
        assert!((found / wanted - 1.0).abs() < 0.01, "{found} is not {wanted}");
        assert!(sampling.sky_share > 0.2 && sampling.sky_seen.is_some_and(|seen| seen > 0.99), "{sampling:?}");
    }
    live.finish();
}
