//! What is stiff for rays that are aimed: NUMERICS section 9, cases 6, 7, 8 and 9.

use crate::device::on_both_back_ends;
use crate::estimate::{Estimate, How, MIXTURES, SAMPLINGS, bake, irradiance};
use crate::stage::{Chart, Facing, Quad, Stage, level_square, room};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use lightoven::baker::{AimedBy, Bounces, Sampling};
use lightoven::gpu::Gpu;
use lightoven::scene::{Scene, Sky, SkyMap};
use std::f64::consts::PI;

on_both_back_ends!(
    errors_of_all_magnitudes,
    many_magnitudes,
    one_magnitude,
    sizes_and_magnitudes,
    all_black,
    black_sky_map,
    a_lamp_among_floods,
    a_lamp_found_among_floods,
    source_that_touches,
    coplanar_source,
);

/// Case 6 at h = 1.
const FACTOR: f64 = 0.239_456;
const POINT: f32 = 1e-4;

/// A point and a shining unit square above it.
fn point_and_lamp(charts: [Chart; 2], black: usize, lamp: usize) -> [Quad; 2] {
    let [receiver, shining] = charts;
    [level_square(POINT, 0.0, Facing::Up, receiver, black), level_square(1.0, 1.0, Facing::Down, shining, lamp)]
}

/// Closed black boxes, each with a lamp of its own: the texels of the brightest are all that rays are aimed at.
fn many_magnitudes(gpu: &Gpu) {
    const RADIANCES: [f32; 4] = [1e-20, 1e-10, 1.0, 1e6];
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let mut receivers = Vec::new();
    for (index, radiance) in (0..).zip(RADIANCES) {
        let lamp = stage.material(0.0, radiance);
        let charts = [2 * index, 2 * index + 1].map(|chart| Chart::new(chart).inset(0.01));
        let mut quads = point_and_lamp(charts, black, lamp).to_vec();
        let walls = room(Vec3::new(-1.0, -1.0, -0.5), Vec3::new(1.0, 1.0, 1.5), Chart::new, black);
        quads.extend(walls.map(|wall| Quad { chart: None, ..wall }));
        stage.place(&quads, DAffine3::from_translation(DVec3::X * 3.0 * f64::from(index)));
        receivers.push(charts[0]);
    }
    let scene = stage.build();
    for sampling in MIXTURES {
        let how = How::new(8192, Bounces::Auto).by(sampling);
        for (estimate, radiance) in Estimate::each_direct(gpu, &scene, how, &receivers).into_iter().zip(RADIANCES) {
            let estimate = estimate.times(1.0 / (PI * f64::from(radiance)));
            // The dim ones are found by the cosine's rays alone: a half, or three of 32.
            let what = format!("radiance {radiance:e} among others, {sampling:?}");
            estimate.assert_is(&what, gpu, FACTOR, 1e-5, 1e-2);
        }
    }
}

/// Nothing is too bright or too dim for its square.
fn one_magnitude(gpu: &Gpu) {
    for radiance in [1e-20, 1e-12, 1e6, 1e12] {
        let mut stage = Stage::new();
        let (black, lamp) = (stage.material(0.0, 0.0), stage.material(0.0, radiance));
        let charts = [0, 1].map(|chart| Chart::new(chart).inset(0.01));
        let scene = stage.with(&point_and_lamp(charts, black, lamp));
        let how = How::new(1024, Bounces::Auto).by(MIXTURES[0]);
        let estimate = Estimate::direct(gpu, &scene, how, charts[0]).times(1.0 / (PI * f64::from(radiance)));
        estimate.assert_is(&format!("radiance {radiance:e} alone"), gpu, FACTOR, 1e-5, 2e-3);
    }
}

/// The same of small and large scenes, whichever way rays are aimed: no weight may leave 32-bit floats and take light along.
fn sizes_and_magnitudes(gpu: &Gpu) {
    for (scale, radiance) in
        [(1e-6, 1e-30), (1e-6, 1e-18), (1e-6, 1e30), (1.0, 1e-30), (1.0, 1e30), (1e6, 1e-30), (1e6, 1e22)]
    {
        let mut stage = Stage::new();
        let [black, lamp] = [0.0, radiance].map(|emission| stage.material(0.0, emission));
        let charts = [0, 1].map(|chart| Chart::new(chart).inset(0.01));
        stage.place(&point_and_lamp(charts, black, lamp), DAffine3::from_scale(DVec3::splat(scale)));
        let scene = stage.build();
        for aimed_by in [AimedBy::Power, AimedBy::Distance, AimedBy::Visibility] {
            let how = How::new(1024, Bounces::Auto).by(MIXTURES[0]).aimed(aimed_by);
            for estimate in Estimate::each_direct(gpu, &scene, how, &charts[..1]) {
                let estimate = estimate.times(1.0 / (PI * f64::from(radiance)));
                let what = format!("radiance {radiance:e} in a scene of {scale:e}, by {aimed_by:?}");
                estimate.assert_is(&what, gpu, FACTOR, 1e-4, 0.05);
            }
        }
    }
}

/// What noise there is does not depend on the unit of light. (In powers of 2 only exponents differ.)
fn errors_of_all_magnitudes(gpu: &Gpu) {
    let error = |radiance: f32| {
        let mut stage = Stage::new();
        let [black, lamp] = [0.0, radiance].map(|emission| stage.material(0.0, emission));
        let scene = stage.with(&point_and_lamp([0, 1].map(|chart| Chart::new(chart).inset(0.01)), black, lamp));
        let statistics = bake(gpu, &scene, How::new(512, Bounces::Limit(0)).by(Sampling::Cosine), 0).1;
        f64::from(statistics.estimated_error.unwrap())
    };
    let one = error(1.0);
    assert!(one > 0.01, "{one} tells too little");
    for exponent in [-90, -60, 60, 90] {
        let other = error(2_f32.powi(exponent));
        println!("2^{exponent}, {}: {other:e}, of radiance 1 {one:e}", gpu.backend().name());
        assert!((other / one - 1.0).abs() < 1e-5);
    }
}

fn assert_black(gpu: &Gpu, what: &str, scene: &Scene, sampling: Sampling) {
    let (map, statistics) = bake(gpu, scene, How::new(64, Bounces::Auto).by(sampling), 0);
    assert!(map.pixels.iter().all(|pixel| pixel[..3] == [0.0; 3]), "{what}, {sampling:?}");
    assert!(map.pixels.iter().any(|pixel| pixel[3] == 1.0));
    assert_eq!(statistics.sampling.source_rays, 0, "{what}, {sampling:?}");
}

fn all_black(gpu: &Gpu) {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 0.0);
    let scene = stage.with(&room(Vec3::ZERO, Vec3::ONE, Chart::new, grey));
    SAMPLINGS.into_iter().chain([Sampling::Auto]).for_each(|sampling| assert_black(gpu, "a room", &scene, sampling));
}

/// Which has no pixel that could be aimed at.
fn black_map() -> Sky {
    Sky::Map(SkyMap { width: 3, height: 5, pixels: vec![Vec3::ZERO; 15] })
}

fn black_sky_map(gpu: &Gpu) {
    let charts = [0, 1].map(|chart| Chart::new(chart).inset(0.01));
    for radiance in [0.0, 1.0] {
        let mut stage = Stage::new();
        let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, radiance));
        stage.desc.sky = black_map();
        let scene = stage.with(&point_and_lamp(charts, grey, lamp));
        if radiance == 0.0 {
            SAMPLINGS.into_iter().for_each(|sampling| assert_black(gpu, "a black sky", &scene, sampling));
            continue;
        }
        let how = How::new(2048, Bounces::Limit(0)).by(MIXTURES[0]);
        let estimate = Estimate::direct(gpu, &scene, how, charts[0]).times(PI.recip());
        estimate.assert_is("a lamp under a black sky map", gpu, FACTOR, 1e-6, 2e-3);
    }
}

/// Case 8: a lamp with this share of all light, of a texel, and under the ground an evenly lit square of 64 units, which
/// the point does not see.
fn among_floods(share: f64) -> (Scene, Chart) {
    const FLOOD: f32 = 64.0;
    let radiance = (share * f64::from(FLOOD * FLOOD) / (1.0 - share)) as f32;
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let [lamp, flood] = [radiance, 1.0].map(|radiance| stage.material(0.0, radiance));
    let charts = [Chart::large(0), Chart::at([100, 20], 1)].map(|chart| chart.inset(0.01));
    let [receiver, shining] = point_and_lamp(charts, black, lamp);
    let flood = level_square(FLOOD, -1.0, Facing::Down, Chart::new(0).inset(0.01), flood);
    (stage.with(&[receiver, shining, flood]), charts[0])
}

/// The origins of rays lie this much nearer to the lamp, whose factor changes by a third of it.
const RAISED: f64 = 2.5e-4;

/// Rays that are aimed at what is not seen leave the lamp to the cosine's: no light is lost, nor counted twice, where one
/// in 2^24 of them goes to the lamp.
fn a_lamp_among_floods(gpu: &Gpu) {
    let share = 0.5_f64.powi(24);
    let (scene, chart) = among_floods(share);
    for sampling in MIXTURES {
        let how = How::new(512, Bounces::Auto).by(sampling);
        let radiance = share * 4096.0 / (1.0 - share);
        let estimate = Estimate::direct(gpu, &scene, how, chart).times(1.0 / (PI * radiance));
        estimate.assert_is(&format!("2^-24 of all light, {sampling:?}"), gpu, FACTOR, RAISED, 8e-3);
    }
}

/// And what is aimed at it finds it, as often as it should. (Rarer than this takes too many rays to tell.)
fn a_lamp_found_among_floods(gpu: &Gpu) {
    let share = 0.5_f64.powi(12);
    let (scene, chart) = among_floods(share);
    let how = How::new(4096, Bounces::Auto).by(Sampling::Importance);
    let radiance = share * 4096.0 / (1.0 - share);
    let estimate = Estimate::direct(gpu, &scene, how, chart).times(1.0 / (PI * radiance));
    estimate.assert_is("2^-12 of all light, by importance", gpu, FACTOR, RAISED, 0.2 * FACTOR);
}

/// A shining wall stands on the floor: no texel's estimate, of 64 rays, is beyond what a single ray may weigh.
fn source_that_touches(gpu: &Gpu) {
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let floor = level_square(1.0, 0.0, Facing::Up, Chart::large(0), black);
    // Its texels are as narrow as a hundred-thousandth of the wall's height.
    let strip = Quad { u: Vec3::X * 1e-4, chart: Some(Chart::new(0)), ..floor };
    let floor = Quad { corner: floor.corner + Vec3::X * 1e-4, ..floor };
    let wall = Quad { corner: strip.corner, u: Vec3::Y, v: Vec3::Z, chart: Some(Chart::new(1)), material: lamp };
    let scene = stage.with(&[floor, strip, wall]);
    for (sampling, cosine) in MIXTURES.into_iter().zip([0.5, 0.1]) {
        let (mut highest, mut values) = (0.0_f64, Vec::new());
        for seed in 0..2 {
            let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(sampling), seed);
            for chart in [floor.chart, strip.chart].into_iter().flatten() {
                values = irradiance(&map, chart);
                highest = values.iter().copied().fold(highest, f64::max);
            }
        }
        let bound = PI / cosine;
        println!("touching wall, {sampling:?}, {}: highest {highest}, bound {bound}", gpu.backend().name());
        assert!(highest <= bound && values.iter().any(|value| *value > 0.0));
    }
}

/// The plane lies askew, so that rounding could lift one above the other.
fn coplanar_source(gpu: &Gpu) {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0);
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let receiver = level_square(1.0, 0.0, Facing::Up, Chart::new(0), black);
    let beside = level_square(1.0, 0.0, Facing::Up, Chart::new(1), lamp);
    let beside = Quad { corner: beside.corner + Vec3::X, ..beside };
    let askew = DAffine3::from_rotation_translation(turn, DVec3::new(3.0, -2.0, 5.0));
    stage.place(&[receiver], askew);
    stage.place(&[beside], askew);
    let scene = stage.build();
    for sampling in SAMPLINGS {
        let (map, statistics) = bake(gpu, &scene, How::new(256, Bounces::Auto).by(sampling), 0);
        assert_eq!(statistics.sampling.source_rays > 0, sampling != Sampling::Cosine);
        let lit = map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count();
        assert_eq!(lit, 0, "{sampling:?}");
    }
}
