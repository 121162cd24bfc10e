//! Case 23: whichever way rays are sent, the mean of every surface is the same.

use super::{Case, Checks};
use crate::baker::{AimedBy, Bounces, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::{Scene, Sidedness, Sky, SkyMap, Texture, TextureUse, Wrap};
use crate::verify::estimate::{Estimate, How, MIXTURES, SEEDS, bake, mean};
use crate::verify::stage::{Chart, Facing, Quad, Stage, level_square};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

pub(super) const CASES: [Case; 3] = [
    Case::closed_form(23, "means of emitters' light", emitted),
    Case::closed_form(23, "means of reflected light", reflected_too),
    Case::closed_form(23, "means of emitters' and a sky's light", emitted_and_of_a_sky),
];

/// Columns and rows of a texture whose left half is bright and whose right half is nearly black, and of each colour.
const PIXELS: u32 = 12;

fn textures(stage: &mut Stage) {
    let pixel = |i: u32| if i % PIXELS < PIXELS / 2 { [255, 255, 255, 255] } else { [60, 20, 90, 255] };
    let pixels = (0..PIXELS * PIXELS).map(pixel).collect();
    stage.desc.textures.push(Texture { name: "halves".into(), width: PIXELS, height: PIXELS, pixels });
}

/// Charts of the regions that are compared; some end within their texels.
fn charts() -> [Chart; 10] {
    let mut index = 0;
    [0.01, 0.0, 0.01, 0.01, 0.01, 0.37, -0.3, 0.01, 0.01, 0.2].map(|inset| {
        index += 1;
        Chart::new(index - 1).inset(inset)
    })
}

/// Emitters of different sizes over a floor, a blocker between, plates that reflect, some of them in instances that are
/// stretched and mirrored. Nothing touches: beside a bright surface the variance of aimed rays has no bound.
fn scene(sky: Sky) -> Result<Scene> {
    let mut stage = Stage::new();
    stage.desc.sky = sky;
    textures(&mut stage);
    let halves = Some(TextureUse { texture: 0, wrap: [Wrap::ClampToEdge; 2] });
    let [floor, small, wide, side, grey, bright] =
        [(0.6, 0.0), (0.0, 25.0), (0.2, 1.5), (0.4, 6.0), (0.3, 0.0), (0.5, 0.0)]
            .map(|(albedo, emission)| stage.material(albedo, emission));
    stage.desc.materials[floor].albedo_texture = halves;
    stage.desc.materials[wide].emission_texture = halves;
    stage.desc.materials[side].emission = Vec3::new(2.0, 6.0, 12.0);
    stage.desc.materials[grey].sidedness = Sidedness::Double;
    let chart = charts();
    let plate = |corner, u, v, chart, material| Quad { corner, u, v, chart: Some(chart), material };
    let quads = [
        level_square(4.0, 0.0, Facing::Up, chart[0], floor),
        level_square(0.2, 1.5, Facing::Down, chart[1], small),
        plate(Vec3::new(-2.0, -1.0, 2.5), Vec3::new(0.0, 2.0, 0.3), Vec3::new(1.5, 0.0, 0.7), chart[2], wide),
        plate(Vec3::new(2.3, -0.5, 0.4), Vec3::Z * 0.5, Vec3::Y * 0.5, chart[3], side),
        level_square(0.8, 0.7, Facing::Up, chart[4], grey),
        plate(Vec3::new(-2.2, -1.0, 0.3), Vec3::Y * 2.0, Vec3::Z * 1.2, chart[5], bright),
        plate(Vec3::new(-1.0, 2.2, 0.3), Vec3::X * 2.0, Vec3::Z * 1.2, chart[6], bright),
    ];
    stage.place(&quads, DAffine3::IDENTITY);
    let turn = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.3, 1.0));
    let stretch = DMat3::from_diagonal(DVec3::new(0.6, 1.4, 3.0));
    let mirror = DMat3::from_diagonal(DVec3::new(-0.7, 0.9, 1.0));
    // One that shines, stretched, and one that reflects, mirrored, before a neighbour of theirs.
    let lamp = level_square(0.5, 0.0, Facing::Down, chart[7], side);
    stage.place(&[lamp], DAffine3 { matrix3: turn * stretch, translation: DVec3::new(1.2, 1.2, 1.8) });
    let [left, right] = [(-0.6, chart[8]), (0.6, chart[9])]
        .map(|(x, chart)| plate(Vec3::new(x, 0.0, 0.0), Vec3::X, Vec3::new(0.2, 0.8, 0.1), chart, bright));
    stage.place(&[left, right], DAffine3 { matrix3: turn * mirror, translation: DVec3::new(0.9, -1.4, 0.5) });
    stage.build()
}

/// `[region]`: of what shines alone, which no texel's rays change.
fn direct(gpu: &Gpu, scene: &Scene, sampling: Sampling, aimed_by: AimedBy) -> Result<Vec<Estimate>> {
    let how = How::new(1 << 15, Bounces::Limit(0)).by(sampling).aimed(aimed_by);
    Estimate::each_direct(gpu, scene, how, &charts())
}

/// `[region]`, over seeds, for reflected light is of the same rays in all texels; and whether rays were sent as they should.
fn reflected(gpu: &Gpu, scene: &Scene, sampling: Sampling, aimed_by: AimedBy) -> Result<(Vec<Estimate>, bool)> {
    let samples = if sampling == Sampling::Importance { 1024 } else { 512 };
    let how = How::new(samples, Bounces::Auto).by(sampling).aimed(aimed_by);
    let mut sent_so = true;
    let of_seed = |seed| {
        let (map, statistics) = bake(gpu, scene, how, seed)?;
        let aimed = statistics.sampling.source_rays + statistics.sampling.sky_rays;
        sent_so &= (aimed > 0) == (sampling != Sampling::Cosine);
        sent_so &= (statistics.sampling.cosine_rays > 0) == (sampling != Sampling::Importance);
        charts().map(|chart| mean(&map, chart)).into_iter().collect()
    };
    let runs: Vec<Vec<f64>> = (0..SEEDS).map(of_seed).collect::<Result<_>>()?;
    let region = |region| Estimate::over(&runs.iter().map(|run| run[region]).collect::<Vec<_>>());
    Ok(((0..charts().len()).map(region).collect(), sent_so))
}

/// Every region by a way of sampling against the same by the cosine, where the worst is told. `resolution`: of a region's
/// mean.
fn check_same(checks: &mut Checks, what: &str, cosine: &[Estimate], aimed: &[Estimate], resolution: f64) {
    let error = |one: &Estimate, other: &Estimate| one.standard_error.hypot(other.standard_error);
    let greatest = |figure: &dyn Fn(&Estimate, &Estimate) -> f64| {
        // Of which what is no number is the greatest.
        let figures = cosine.iter().zip(aimed).map(|(one, other)| figure(one, other).abs());
        figures.max_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    let worst = greatest(&|one, other| (one.mean - other.mean) / error(one, other));
    let noise = greatest(&|one, other| 4.0 * error(one, other) / one.mean);
    checks.at_most(format!("{what}: sigmas that the worst region is off"), worst, 4.0);
    checks.at_most(format!("{what}: 4 sigma of the noisiest region's mean"), noise, resolution);
}

const AIMS: [(&str, AimedBy); 3] =
    [("power", AimedBy::Power), ("distance", AimedBy::Distance), ("visibility", AimedBy::Visibility)];

fn emitted(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene(Sky::Black)?;
    let cosine = direct(gpu, &scene, Sampling::Cosine, AimedBy::Power)?;
    for (name, aimed_by) in AIMS {
        for sampling in [MIXTURES[0], MIXTURES[1], Sampling::Importance] {
            let what = format!("{sampling}, aimed by {name}");
            check_same(checks, &what, &cosine, &direct(gpu, &scene, sampling, aimed_by)?, 0.2);
        }
    }
    Ok(())
}

fn reflected_too(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene(Sky::Black)?;
    let (cosine, none_aimed) = reflected(gpu, &scene, Sampling::Cosine, AimedBy::Power)?;
    checks.holds("by the cosine no ray is aimed", none_aimed);
    // All that reflects is aimed at, also what is beside the receiver: of aimed rays alone the variance is large.
    for (name, aimed_by) in AIMS {
        for (sampling, resolution) in [(MIXTURES[0], 0.2), (Sampling::Importance, 0.5)] {
            let what = format!("{sampling}, aimed by {name}");
            let (aimed, sent_so) = reflected(gpu, &scene, sampling, aimed_by)?;
            checks.holds(format!("{what}: rays are sent that way"), sent_so);
            check_same(checks, &what, &cosine, &aimed, resolution);
        }
    }
    Ok(())
}

/// 7 x 5 pixels: a dim upper half, and one pixel that is as bright as a sun behind clouds. Up is y.
fn sky() -> Sky {
    let pixel = |i: u32| match i {
        9 => Vec3::new(30.0, 25.0, 20.0),
        i if i < 21 => Vec3::new(0.2, 0.3, 0.5) * (1 + i % 3) as f32,
        _ => Vec3::ZERO,
    };
    Sky::Map(SkyMap { width: 7, height: 5, pixels: (0..35).map(pixel).collect() })
}

fn emitted_and_of_a_sky(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = scene(sky())?;
    let cosine = direct(gpu, &scene, Sampling::Cosine, AimedBy::Power)?;
    for sampling in MIXTURES {
        let aimed = direct(gpu, &scene, sampling, AimedBy::Visibility)?;
        check_same(checks, &sampling.to_string(), &cosine, &aimed, 0.05);
    }
    Ok(())
}
