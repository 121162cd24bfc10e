//! Light of three colours, each with an answer of its own: all else here is grey. Closed forms 1, 4, 11 and 14.

use super::{Case, Checks};
use crate::baker::{Bounces, FrameSettings, LightMap, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{LightKind, Scene, Sky, SkyMap};
use crate::verify::estimate::{Estimate, How, MIXTURES, SEEDS, bake};
use crate::verify::live::{Live, SIDE};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square, room};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 4] = [
    Case::closed_form(1, "furnace of three colours", furnace),
    Case::closed_form(1, "furnace of three colours within frames", furnace_in_frames),
    Case::closed_form(11, "coloured light of every kind", every_kind),
    Case::closed_form(14, "coloured sky map", sky_map),
];

const ALBEDO: Vec3 = Vec3::new(0.5, 0.8, 0.2);
const EMISSION: Vec3 = Vec3::new(1.0, 0.3, 2.0);
/// No two of its channels, and no two ratios of them, are alike.
const COLOUR: Vec3 = Vec3::new(1.0, 0.5, 0.125);

/// A closed room that shines and reflects, one colour unlike the other.
fn coloured_room(chart: impl Fn(u32) -> Chart) -> Result<Scene> {
    let mut stage = Stage::new();
    let wall = stage.material(0.0, 0.0);
    (stage.desc.materials[wall].albedo, stage.desc.materials[wall].emission) = (ALBEDO, EMISSION);
    stage.with(&room(Vec3::ZERO, Vec3::ONE, chart, wall))
}

const COLOURS: [&str; 3] = ["red", "green", "blue"];

/// pi L / (1 - albedo).
fn in_furnace(channel: usize) -> f64 {
    PI * f64::from(EMISSION[channel]) / (1.0 - f64::from(ALBEDO[channel]))
}

/// Lowest and highest light of each colour over the charts' texels.
fn check_furnace(checks: &mut Checks, map: &LightMap, charts: &[Chart], bound: f64) {
    for (channel, name) in COLOURS.into_iter().enumerate() {
        let expected = in_furnace(channel);
        let values = || charts.iter().flat_map(|chart| chart.texels()).map(|(texel, _)| map.pixels[texel][channel]);
        let (lo, hi) = (values().fold(f32::MAX, f32::min), values().fold(0.0, f32::max));
        checks.relative(format!("least {name}"), lo.into(), expected, bound);
        checks.relative(format!("most {name}"), hi.into(), expected, bound);
    }
}

fn furnace(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let charts = [0, 1, 2, 3, 4, 5].map(|index| Chart::new(index).inset(0.01));
    let scene = coloured_room(|index| charts[index as usize])?;
    let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(Sampling::Cosine), 0)?;
    // The bounces' tolerance, a ten-thousandth, is of the mean of all colours; light of the largest albedo is the last.
    check_furnace(checks, &map, &charts, 5e-4);
    // Rays that are aimed have noise, which all texels share in by their bounces: over seeds.
    let mean = |map: &LightMap, channel: usize| {
        let values = || charts.iter().flat_map(|chart| chart.texels()).map(|(texel, _)| map.pixels[texel][channel]);
        values().map(f64::from).sum::<f64>() / values().count() as f64
    };
    let how = How::new(128, Bounces::Auto).by(MIXTURES[0]);
    let maps: Vec<LightMap> = (0..SEEDS).map(|seed| Ok(bake(gpu, &scene, how, seed)?.0)).collect::<Result<_>>()?;
    for (channel, name) in COLOURS.into_iter().enumerate() {
        let estimate = Estimate::over(&maps.iter().map(|map| mean(map, channel)).collect::<Vec<_>>());
        let expected = in_furnace(channel);
        checks.estimate(format!("{name} by {}", MIXTURES[0]), estimate, expected, 2e-3 * expected, 0.05 * expected);
    }
    Ok(())
}

fn furnace_in_frames(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = |index| Chart::new(index).on(SIDE).inset(0.01);
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let mut live = Live::new(gpu, &coloured_room(chart)?, frames)?;
    live.warm_up()?;
    // Of what the first of them did not reflect yet, old light, this leaves a thousandth.
    live.frames(60, 0.1)?;
    check_furnace(checks, &live.baker.read_back()?, &[0, 1, 2, 3, 4, 5].map(chart), 1e-3);
    Ok(())
}

/// Every pixel, gutters too, has the light's own colour: what reflects is grey. `least`: pixels that are lit.
fn check_colour(checks: &mut Checks, what: &str, map: &LightMap, least: f64) {
    let lit = || map.pixels.iter().filter(|pixel| pixel[0] > 0.0);
    let off = |pixel: &[f32; 4]| {
        let expected = COLOUR * (pixel[0] / COLOUR.x);
        let apart = (Vec3::from_slice(pixel) - expected).abs() / expected;
        f64::from(apart.max_element())
    };
    checks.at_least(format!("{what}: lit pixels"), lit().count() as f64, least);
    checks.at_most(format!("{what}: share by which the worst is off"), lit().map(off).fold(0.0, f64::max), 1e-5);
    let unlit = map.pixels.iter().filter(|pixel| pixel[0] == 0.0 && pixel[..3] != [0.0; 3]).count();
    checks.count(format!("{what}: pixels that lack red"), unlit as u64, 0);
}

/// A lamp, lights and a sky over a grey floor between grey walls, one after the other.
fn every_kind(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let position = DVec3::new(0.2, 0.1, 0.8);
    let kinds = [
        LightKind::Point { position, range: None },
        LightKind::Spot { position, direction: Vec3::NEG_Z, inner_angle: 0.3, outer_angle: 0.9, range: None },
        LightKind::Directional { direction: Vec3::new(0.3, 0.2, -1.0) },
    ];
    let chart = Chart::new;
    for subject in ["a lamp", "a point light", "a spot light", "a sun", "a sky"] {
        let mut stage = Stage::new();
        let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 0.0));
        let mut quads = room(Vec3::splat(-1.0), Vec3::ONE, chart, grey).to_vec();
        quads.remove(1);
        let light = match subject {
            "a point light" => Some(0),
            "a spot light" => Some(1),
            "a sun" => Some(2),
            _ => None,
        };
        if let Some(kind) = light {
            stage.light(kinds[kind]);
            stage.desc.lights[0].intensity = COLOUR;
        }
        if subject == "a sky" {
            stage.desc.sky = Sky::Constant(COLOUR);
        }
        if subject == "a lamp" {
            stage.desc.materials[lamp].emission = COLOUR * 5.0;
            quads.push(Quad { chart: Some(chart(6)), ..level_square(0.5, 0.5, Facing::Down, chart(6), lamp) });
        }
        let scene = stage.with(&quads)?;
        let sampling = if subject == "a lamp" { MIXTURES[0] } else { Sampling::Auto };
        let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(sampling), 0)?;
        check_colour(checks, subject, &map, 200.0);
    }
    Ok(())
}

fn sky_map(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let grey = stage.material(0.5, 0.0);
    let pixel = |index: u32| COLOUR * if index == 9 { 30.0 } else { 0.2 };
    stage.desc.sky = Sky::Map(SkyMap { width: 7, height: 5, pixels: (0..35).map(pixel).collect() });
    let mut quads = room(Vec3::splat(-1.0), Vec3::ONE, Chart::new, grey).to_vec();
    quads.remove(1);
    let scene = stage.with(&quads)?;
    for sampling in [Sampling::Cosine, MIXTURES[0]] {
        let (map, _) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(sampling), 0)?;
        check_colour(checks, &format!("by {sampling}"), &map, 150.0);
    }
    Ok(())
}
