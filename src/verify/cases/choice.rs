//! How rays are sent where the baker chooses, and that what is asked for is done.

use super::{Case, Checks};
use crate::baker::{Bounces, Sampling, Statistics};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::verify::estimate::{How, bake, broken, mean};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square, room};
use glam::Vec3;

pub(super) const CASES: [Case; 6] = [
    Case::conduct("choice in a furnace", furnace),
    Case::conduct("choice in an evenly lit room", evenly_lit_room),
    Case::conduct("choice under a tiny lamp", tiny_lamp),
    Case::conduct("sampling as asked", as_asked),
    Case::conduct("aimed bounces do not grow", bounces_do_not_grow),
    Case::conduct("bounces by importance alone", importance_alone_bounces),
];

/// A room of this albedo whose walls, or only a tiny square below its ceiling, shine.
fn scene(walls: f32, lamp: f32) -> Result<Scene> {
    let mut stage = Stage::new();
    let (wall, lamp) = (stage.material(0.5, walls), stage.material(0.5, lamp));
    let walls = room(Vec3::ZERO, Vec3::ONE, Chart::new, wall);
    let square = level_square(0.02, 0.9, Facing::Down, Chart::new(6), lamp);
    let square = Quad { corner: square.corner + Vec3::new(0.4, 0.6, 0.0), ..square };
    stage.with(&[&walls[..], &[square]].concat())
}

fn statistics(gpu: &Gpu, scene: &Scene, sampling: Sampling) -> Result<Statistics> {
    Ok(bake(gpu, scene, How::new(512, Bounces::Auto).by(sampling), 0)?.1)
}

fn furnace(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let sampling = statistics(gpu, &scene(1.0, 1.0)?, Sampling::Auto)?.sampling;
    checks.count("aimed rays", sampling.source_rays, 0);
    checks.within("share of rays by the cosine", sampling.cosine_share.into(), 1.0, 0.0);
    let evenness = sampling.evenness.ok_or_else(|| broken("nothing is said of how even the light is".into()))?;
    checks.at_least("evenness", evenness.into(), 0.99);
    Ok(())
}

/// One wall shines as the others do not: that is uneven, but large, and once the bounces are known nothing is aimed.
fn evenly_lit_room(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.7, 0.0), stage.material(0.7, 1.0));
    let mut walls = room(Vec3::ZERO, Vec3::ONE, Chart::new, grey);
    walls[1].material = lamp;
    let statistics = statistics(gpu, &stage.with(&walls)?, Sampling::Auto)?;
    checks.within("share of rays by the cosine", statistics.sampling.cosine_share.into(), 1.0, 0.0);
    // Half of those of the two stages of bounces, 8 and 16 a texel, and of the first kept quantum, of 512.
    let most = (statistics.rays / 4 - 1) as f64;
    checks.at_most("aimed rays", statistics.sampling.source_rays as f64, most);
    Ok(())
}

/// The same light costs fewer rays: the error falls with their root.
fn tiny_lamp(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene(0.0, 1000.0)?;
    let auto = statistics(gpu, &scene, Sampling::Auto)?;
    let cosine = statistics(gpu, &scene, Sampling::Cosine)?;
    checks.at_least("share of aimed rays that are kept", auto.sampling.source_share.into(), 0.5);
    checks.at_least("aimed rays", auto.sampling.source_rays as f64, (auto.rays / 3 + 1) as f64);
    match (cosine.estimated_error, auto.estimated_error) {
        (Some(cosine), Some(auto)) => checks.at_least("error by the cosine over it", f64::from(cosine / auto), 3.0),
        _ => return Err(broken("no error is estimated".into())),
    }
    Ok(())
}

fn as_asked(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene(0.0, 1000.0)?;
    for (sampling, cosine_share) in [
        (Sampling::Cosine, 1.0),
        (Sampling::Importance, 0.0),
        (Sampling::Mixture { cosine: 0.5 }, 0.5),
        // Of 64 rays, and not fewer than were asked for, which bounds what a ray weighs.
        (Sampling::Mixture { cosine: 0.1 }, 7.0 / 64.0),
    ] {
        let shares = statistics(gpu, &scene, sampling)?.sampling;
        let said = [shares.cosine_share, shares.source_share] == [cosine_share, 1.0 - cosine_share];
        checks.holds(format!("shares of rays by {sampling}"), said);
        checks.holds(format!("no share for the sky by {sampling}"), shares.sky_share == 0.0);
        checks.count(format!("rays aimed at the sky by {sampling}"), shares.sky_rays, 0);
    }
    Ok(())
}

/// A lamp close under a ceiling: aimed rays of a bounce epoch, few and the same again and again, would give back more light
/// than they got.
fn bounces_do_not_grow(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    let (wall, lamp) = (stage.material(0.9, 0.0), stage.material(0.0, 100.0));
    let corner = Vec3::new(0.5, 0.5, 0.45);
    let square = Quad { corner, u: Vec3::Y * 0.1, v: Vec3::X * 0.1, chart: Some(Chart::new(15)), material: lamp };
    let mut quads = room(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5), Chart::new, wall).to_vec();
    quads.push(square);
    let scene = stage.with(&quads)?;
    for seed in 0..2 {
        let (_, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(Sampling::Importance), seed)?;
        checks.at_most(format!("light that is missing, seed {seed}"), statistics.bounces_missing.into(), 1e-3);
        checks.holds(format!("rays are aimed, seed {seed}"), statistics.sampling.source_rays > 0);
    }
    Ok(())
}

/// What bounces light is aimed at in its turn: rays by importance alone find the light of three bounces, and of all, that a
/// mixture finds. (They know no radiance of a texel but the aimed one, and on maps of few texels some of what is half hidden is
/// aimed at too seldom: that is the tolerance. Aimed along the first source alone, 4 % were missing.)
fn importance_alone_bounces(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene(0.0, 1000.0)?;
    let light = |bounces, sampling| -> Result<f64> {
        let (map, _) = bake(gpu, &scene, How::new(2048, bounces).by(sampling), 0)?;
        (0..5).map(|chart| mean(&map, Chart::new(chart))).sum()
    };
    for (bounces, what) in [(Bounces::Limit(3), "three bounces"), (Bounces::Auto, "all bounces")] {
        let mixture = light(bounces, Sampling::Mixture { cosine: 0.5 })?;
        checks.relative(format!("light of {what}"), light(bounces, Sampling::Importance)?, mixture, 0.015);
    }
    Ok(())
}
