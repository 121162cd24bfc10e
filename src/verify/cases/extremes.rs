//! Extreme cases 6, 7, 8 and 9: what is stiff for rays that are aimed.

use super::{Case, Checks};
use crate::baker::{AimedBy, Bounces, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Scene, Sky, SkyMap};
use crate::verify::estimate::{Estimate, How, MIXTURES, SAMPLINGS, bake, broken, irradiance};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square, room};
use glam::{DAffine3, DQuat, DVec3, Vec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 10] = [
    Case::extreme(6, "light of many magnitudes in a scene", many_magnitudes),
    Case::extreme(6, "light of one magnitude", one_magnitude),
    Case::extreme(6, "light and scenes of all magnitudes", sizes_and_magnitudes),
    Case::extreme(6, "estimated error in any unit of light", errors_of_all_magnitudes),
    Case::extreme(7, "all black", all_black),
    Case::extreme(7, "black sky map", black_sky_map),
    Case::extreme(8, "lamp among floods", a_lamp_among_floods),
    Case::extreme(8, "lamp among floods, aimed at", a_lamp_found_among_floods),
    Case::extreme(9, "source that touches", source_that_touches),
    Case::extreme(9, "coplanar source", coplanar_source),
];

/// Closed-form case 6 at h = 1.
pub(super) const FACTOR: f64 = 0.239_456;
pub(super) const POINT: f32 = 1e-4;

/// A point and a shining unit square above it.
fn point_and_lamp(charts: [Chart; 2], black: usize, lamp: usize) -> [Quad; 2] {
    let [receiver, shining] = charts;
    [level_square(POINT, 0.0, Facing::Up, receiver, black), level_square(1.0, 1.0, Facing::Down, shining, lamp)]
}

/// Closed black boxes, each with a lamp of its own: the texels of the brightest are all that rays are aimed at.
fn many_magnitudes(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
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
    let scene = stage.build()?;
    for sampling in MIXTURES {
        let how = How::new(8192, Bounces::Auto).by(sampling);
        for (estimate, radiance) in Estimate::each_direct(gpu, &scene, how, &receivers)?.into_iter().zip(RADIANCES) {
            let estimate = estimate.times(1.0 / (PI * f64::from(radiance)));
            // The dim ones are found by the cosine's rays alone: a half, or three of 32.
            checks.estimate(format!("radiance {radiance:e} by {sampling}"), estimate, FACTOR, 1e-5, 1e-2);
        }
    }
    Ok(())
}

/// Nothing is too bright or too dim for its square.
fn one_magnitude(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for radiance in [1e-20, 1e-12, 1e6, 1e12] {
        let mut stage = Stage::new();
        let (black, lamp) = (stage.material(0.0, 0.0), stage.material(0.0, radiance));
        let charts = [0, 1].map(|chart| Chart::new(chart).inset(0.01));
        let scene = stage.with(&point_and_lamp(charts, black, lamp))?;
        let how = How::new(1024, Bounces::Auto).by(MIXTURES[0]);
        let estimate = Estimate::direct(gpu, &scene, how, charts[0])?.times(1.0 / (PI * f64::from(radiance)));
        checks.estimate(format!("radiance {radiance:e}"), estimate, FACTOR, 1e-5, 2e-3);
    }
    Ok(())
}

/// The same of small and large scenes, whichever way rays are aimed: no weight may leave 32-bit floats and take light along.
fn sizes_and_magnitudes(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for (scale, radiance) in
        [(1e-6, 1e-30), (1e-6, 1e-18), (1e-6, 1e30), (1.0, 1e-30), (1.0, 1e30), (1e6, 1e-30), (1e6, 1e22)]
    {
        let mut stage = Stage::new();
        let [black, lamp] = [0.0, radiance].map(|emission| stage.material(0.0, emission));
        let charts = [0, 1].map(|chart| Chart::new(chart).inset(0.01));
        stage.place(&point_and_lamp(charts, black, lamp), DAffine3::from_scale(DVec3::splat(scale)));
        let scene = stage.build()?;
        for aimed_by in [AimedBy::Power, AimedBy::Distance, AimedBy::Visibility] {
            let how = How::new(1024, Bounces::Auto).by(MIXTURES[0]).aimed(aimed_by);
            for estimate in Estimate::each_direct(gpu, &scene, how, &charts[..1])? {
                let estimate = estimate.times(1.0 / (PI * f64::from(radiance)));
                let what = format!("radiance {radiance:e}, size {scale:e}, by {aimed_by:?}");
                checks.estimate(what, estimate, FACTOR, 1e-4, 0.05);
            }
        }
    }
    Ok(())
}

/// What noise there is does not depend on the unit of light. (In powers of 2 only exponents differ.)
fn errors_of_all_magnitudes(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let error = |radiance: f32| {
        let mut stage = Stage::new();
        let [black, lamp] = [0.0, radiance].map(|emission| stage.material(0.0, emission));
        let scene = stage.with(&point_and_lamp([0, 1].map(|chart| Chart::new(chart).inset(0.01)), black, lamp))?;
        let statistics = bake(gpu, &scene, How::new(512, Bounces::Limit(0)).by(Sampling::Cosine), 0)?.1;
        statistics.estimated_error.map(f64::from).ok_or_else(|| broken("no error is estimated".into()))
    };
    let one = error(1.0)?;
    checks.at_least("error of radiance 1", one, 0.01);
    for exponent in [-90, -60, 60, 90] {
        checks.relative(format!("error of radiance 2^{exponent}"), error(2_f32.powi(exponent))?, one, 1e-5);
    }
    Ok(())
}

fn check_black(gpu: &Gpu, checks: &mut Checks, scene: &Scene, sampling: Sampling) -> Result<()> {
    let (map, statistics) = bake(gpu, scene, How::new(64, Bounces::Auto).by(sampling), 0)?;
    let lit = map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count();
    checks.count(format!("texels that are not black by {sampling}"), lit as u64, 0);
    checks.holds(format!("texels are baked by {sampling}"), map.pixels.iter().any(|pixel| pixel[3] == 1.0));
    checks.count(format!("aimed rays by {sampling}"), statistics.sampling.source_rays, 0);
    Ok(())
}

fn all_black(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 0.0);
    let scene = stage.with(&room(Vec3::ZERO, Vec3::ONE, Chart::new, grey))?;
    let samplings = SAMPLINGS.into_iter().chain([Sampling::Auto]);
    samplings.into_iter().try_for_each(|sampling| check_black(gpu, checks, &scene, sampling))
}

/// Which has no pixel that could be aimed at.
fn black_map() -> Sky {
    Sky::Map(SkyMap { width: 3, height: 5, pixels: vec![Vec3::ZERO; 15] })
}

fn black_sky_map(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let charts = [0, 1].map(|chart| Chart::new(chart).inset(0.01));
    let lit_by = |radiance: f32| {
        let mut stage = Stage::new();
        let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, radiance));
        stage.desc.sky = black_map();
        stage.with(&point_and_lamp(charts, grey, lamp))
    };
    let dark = lit_by(0.0)?;
    SAMPLINGS.into_iter().try_for_each(|sampling| check_black(gpu, checks, &dark, sampling))?;
    let how = How::new(2048, Bounces::Limit(0)).by(MIXTURES[0]);
    let estimate = Estimate::direct(gpu, &lit_by(1.0)?, how, charts[0])?.times(PI.recip());
    checks.estimate("a lamp under a black sky map", estimate, FACTOR, 1e-6, 2e-3);
    Ok(())
}

/// A lamp with this share of all light, of a texel, and under the ground an evenly lit square of 64 units, which the point
/// does not see.
fn among_floods(share: f64) -> Result<(Scene, Chart)> {
    const FLOOD: f32 = 64.0;
    let radiance = (share * f64::from(FLOOD * FLOOD) / (1.0 - share)) as f32;
    let mut stage = Stage::new();
    let black = stage.material(0.0, 0.0);
    let [lamp, flood] = [radiance, 1.0].map(|radiance| stage.material(0.0, radiance));
    let charts = [Chart::large(0), Chart::at([100, 20], 1)].map(|chart| chart.inset(0.01));
    let [receiver, shining] = point_and_lamp(charts, black, lamp);
    let flood = level_square(FLOOD, -1.0, Facing::Down, Chart::new(0).inset(0.01), flood);
    Ok((stage.with(&[receiver, shining, flood])?, charts[0]))
}

/// The origins of rays lie this much nearer to the lamp, whose factor changes by a third of it.
const RAISED: f64 = 2.5e-4;

/// Rays that are aimed at what is not seen leave the lamp to the cosine's: no light is lost, nor counted twice, where one
/// in 2^24 of them goes to the lamp.
fn a_lamp_among_floods(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let share = 0.5_f64.powi(24);
    let (scene, chart) = among_floods(share)?;
    for sampling in MIXTURES {
        let how = How::new(512, Bounces::Auto).by(sampling);
        let radiance = share * 4096.0 / (1.0 - share);
        let estimate = Estimate::direct(gpu, &scene, how, chart)?.times(1.0 / (PI * radiance));
        checks.estimate(format!("2^-24 of all light by {sampling}"), estimate, FACTOR, RAISED, 8e-3);
    }
    Ok(())
}

/// And what is aimed at it finds it, as often as it should.
fn a_lamp_found_among_floods(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let by_importance = |exponent: i32, samples: u32| {
        let share = 0.5_f64.powi(exponent);
        let (scene, chart) = among_floods(share)?;
        let how = How::new(samples, Bounces::Auto).by(Sampling::Importance).aimed(AimedBy::Power);
        let radiance = share * 4096.0 / (1.0 - share);
        Ok((Estimate::direct(gpu, &scene, how, chart)?.times(1.0 / (PI * radiance)), chart))
    };
    let (estimate, _) = by_importance(12, 4096)?;
    checks.estimate("2^-12 of all light by importance", estimate, FACTOR, RAISED, 0.2 * FACTOR);
    // Six of a hundred million rays are expected there: none of them in one run of 450, 16 or more in one of 1,600.
    const SAMPLES: u32 = 131_072;
    let (estimate, chart) = by_importance(24, SAMPLES)?;
    let rays = f64::from(SAMPLES) * f64::from(chart.size).powi(2) * 0.5_f64.powi(24);
    let found = estimate.mean / FACTOR * rays;
    checks.at_least("rays that find 2^-24 of all light", found, 0.5);
    checks.at_most("rays that find 2^-24 of all light", found, 16.0);
    Ok(())
}

/// A shining wall stands on the floor: no texel's estimate, of 64 rays, is beyond what a single ray may weigh.
fn source_that_touches(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let floor = level_square(1.0, 0.0, Facing::Up, Chart::large(0), black);
    // Its texels are as narrow as a hundred-thousandth of the wall's height.
    let strip = Quad { u: Vec3::X * 1e-4, chart: Some(Chart::new(0)), ..floor };
    let floor = Quad { corner: floor.corner + Vec3::X * 1e-4, ..floor };
    let wall = Quad { corner: strip.corner, u: Vec3::Y, v: Vec3::Z, chart: Some(Chart::new(1)), material: lamp };
    let scene = stage.with(&[floor, strip, wall])?;
    for (sampling, cosine) in MIXTURES.into_iter().zip([0.5, 0.1]) {
        let (mut highest, mut values) = (0.0_f64, Vec::new());
        for seed in 0..2 {
            let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(sampling), seed)?;
            for chart in [floor.chart, strip.chart].into_iter().flatten() {
                values = irradiance(&map, chart)?;
                highest = values.iter().copied().fold(highest, f64::max);
            }
        }
        checks.at_most(format!("highest irradiance by {sampling}"), highest, PI / cosine);
        checks.holds(format!("the strip is lit by {sampling}"), values.iter().any(|value| *value > 0.0));
    }
    Ok(())
}

/// The plane lies askew, so that rounding could lift one above the other.
fn coplanar_source(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0);
    let mut stage = Stage::new();
    let (lamp, black) = (stage.material(0.0, 1.0), stage.material(0.0, 0.0));
    let receiver = level_square(1.0, 0.0, Facing::Up, Chart::new(0), black);
    let beside = level_square(1.0, 0.0, Facing::Up, Chart::new(1), lamp);
    let beside = Quad { corner: beside.corner + Vec3::X, ..beside };
    let askew = DAffine3::from_rotation_translation(turn, DVec3::new(3.0, -2.0, 5.0));
    stage.place(&[receiver], askew);
    stage.place(&[beside], askew);
    let scene = stage.build()?;
    for sampling in SAMPLINGS {
        let (map, statistics) = bake(gpu, &scene, How::new(256, Bounces::Auto).by(sampling), 0)?;
        let aims = statistics.sampling.source_rays > 0;
        checks.holds(format!("rays are aimed as asked by {sampling}"), aims == (sampling != Sampling::Cosine));
        let lit = map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count();
        checks.count(format!("texels that are not black by {sampling}"), lit as u64, 0);
    }
    Ok(())
}
