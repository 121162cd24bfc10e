//! Extreme case 16: charts and texels that are no good are filled, counted or refused, and leave no black halo.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Bounces, LightMap, Sampling, Stop};
use crate::error::{ErrorKind, Result};
use crate::gpu::Gpu;
use crate::scene::{LightKind, Resolution, Scene, Texture, TextureUse, Wrap};
use crate::verify::estimate::{How, bake, irradiance};
use crate::verify::stage::{Chart, Facing, Quad, SIDE, Stage, level_square, room};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::f64::consts::PI;
use std::ops::ControlFlow;

pub(super) const CASES: [Case; 8] = [
    Case::extreme(16, "texels inside a wall", inside_a_wall),
    Case::extreme(16, "islands of a texel and less", islands),
    Case::extreme(16, "overlapping charts in a mesh", overlapping_charts),
    Case::extreme(16, "overlapping charts with textures", overlapping_textures),
    Case::extreme(16, "overlapping charts of instances", overlapping_instances),
    Case::extreme(16, "light-map coordinates outside the map", outside_the_map),
    Case::extreme(16, "triangles without area in the map", without_area_in_the_map),
    Case::extreme(16, "gutter between two charts", gutter),
];

/// A stage under a sky of radiance 1, and what every open surface then gets.
fn under_the_sky() -> Stage {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.sky(1.0);
    stage
}

/// Every pixel, those between the charts too.
fn check_no_halo(checks: &mut Checks, map: &LightMap) {
    let values = || map.pixels.iter().flat_map(|pixel| &pixel[..3]).map(|value| f64::from(*value));
    checks.relative("lowest value of all pixels", values().fold(f64::MAX, f64::min), PI, 1e-4);
    checks.relative("highest value of all pixels", values().fold(0.0, f64::max), PI, 1e-4);
}

/// A closed box stands in the floor, and shines as the sky does: all that the floor sees has radiance 1. What lies in the box
/// sees the walls' backs, which are black.
fn inside_a_wall(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = under_the_sky();
    let shining = stage.material(0.0, 1.0);
    let chart = Chart::large(0);
    let mut quads = vec![level_square(1.0, 0.0, Facing::Up, chart, 0)];
    let inward = room(Vec3::new(-0.25, -0.25, -0.1), Vec3::new(0.25, 0.25, 0.3), Chart::new, shining);
    quads.extend(inward.map(|wall| Quad { u: wall.v, v: wall.u, chart: None, ..wall }));
    let (map, statistics) = bake(gpu, &stage.with(&quads)?, How::new(64, Bounces::Auto), 0)?;
    // Half of a side of 28 texels.
    checks.within("texels that are given up", statistics.invalid_texels as f64, 14.0 * 14.0, 4.0 * 14.0);
    let told = statistics.warnings.iter().any(|warning| warning.contains("inside something"));
    checks.holds("a warning counts them", told);
    checks.count("texels on the floor", irradiance(&map, chart)?.len() as u64, 28 * 28);
    check_no_halo(checks, &map);
    Ok(())
}

/// A chart of exactly a texel, one of a fifth of one within a texel, and one of a fifth on a corner of four texels.
fn islands(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let whole = Chart::at([40, 10], 1).inset(0.01);
    let within = Chart::at([60, 10], 1).inset(0.4);
    let across = Chart::at([80, 10], 2).inset(0.9);
    let square = |index: u8, chart| {
        let level = level_square(1.0, 0.0, Facing::Up, chart, 0);
        Quad { corner: level.corner + Vec3::X * 2.0 * f32::from(index), ..level }
    };
    let stage = under_the_sky();
    let scene = stage.with(&[square(0, whole), square(1, within), square(2, across)])?;
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    checks.count("texels that take rays", statistics.texels, 6);
    for (chart, texels) in [(whole, 1), (within, 1), (across, 4)] {
        checks.count(
            format!("texels of an island of {} texels", chart.side()),
            irradiance(&map, chart)?.len() as u64,
            texels,
        );
    }
    check_no_halo(checks, &map);
    Ok(())
}

/// For charts that are not where the case put them.
fn baker_of(gpu: &Gpu, scene: &Scene) -> Result<Baker> {
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, scene, &settings)?;
    let stop = Stop { samples: Some(64), ..Stop::default() };
    baker.bake(&stop, &mut |_| ControlFlow::Continue(()))?;
    Ok(baker)
}

/// In the sun, and turned away from it.
fn lit_and_dark(chart: Chart) -> [Quad; 2] {
    [level_square(1.0, 0.0, Facing::Up, chart, 0), level_square(1.0, -3.0, Facing::Down, chart, 0)]
}

/// Between a chart in the sun and one that is turned away each texel has the light of the nearer one.
fn gutter(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const FIRST: u32 = 46;
    const LAST: u32 = 51;
    let charts = [40, 52].map(|column| Chart::at([column, 10], 6).inset(0.01));
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: Vec3::NEG_Z });
    let [lit, dark] = [lit_and_dark(charts[0])[0], lit_and_dark(charts[1])[1]];
    let (map, _) = bake(gpu, &stage.with(&[lit, dark])?, How::new(64, Bounces::Auto), 0)?;
    for column in FIRST..=LAST {
        let light = if 2 * column < FIRST + LAST { 1.0 } else { 0.0 };
        let texels = (10..16).map(|row| map.pixels[(row * SIDE + column) as usize]);
        let wrong = texels.filter(|pixel| (pixel[1] - light).abs() > 1e-5 || pixel[3] != 0.0).count();
        checks.count(format!("texels of column {column} without the nearer light"), wrong as u64, 0);
    }
    Ok(())
}

/// They are counted, and each texel has the light of one of the surfaces: no mixture of them, and no sum.
fn overlapping_charts(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let chart = Chart::large(0);
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: Vec3::NEG_Z });
    let mut baker = baker_of(gpu, &stage.with(&lit_and_dark(chart))?)?;
    checks.holds("the charts stay where they are", baker.atlas().shared);
    checks.count("texels that are counted", baker.atlas().overlapping_texels as u64, 28 * 28);
    let values = irradiance(&baker.read_back()?, chart)?;
    let of_one = values.iter().filter(|value| value.abs() < 1e-5 || (*value - 1.0).abs() < 1e-5).count();
    checks.count("texels with the light of one surface", of_one as u64, 28 * 28);
    Ok(())
}

/// The mesh's last triangle has the texel, with a white texture on one of them as without.
fn overlapping_textures(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (chart, mut plain) = (Chart::large(0), None);
    for textured in [None, Some(0), Some(1)] {
        let mut stage = Stage::new();
        let [first, last] = [1.0, 2.0].map(|emission| stage.material(0.0, emission));
        let pixels = vec![[255; 4]];
        stage.desc.textures.push(Texture { name: "white".into(), width: 1, height: 1, pixels });
        if let Some(material) = textured {
            let white = TextureUse { texture: 0, wrap: [Wrap::Repeat; 2] };
            stage.desc.materials[material].emission_texture = Some(white);
        }
        // Each before a screen, which tells which of the two shines there.
        let beside = |material, x: f32| {
            let quad = level_square(1.0, 0.0, Facing::Up, chart, material);
            Quad { corner: quad.corner + Vec3::X * x, ..quad }
        };
        let screen = level_square(1.0, 1.0, Facing::Down, Chart::new(0), first);
        let screen = Quad { material: stage.material(0.0, 0.0), ..screen };
        let scene = stage.with(&[beside(first, 4.0), beside(last, 0.0), screen])?;
        let how = How::new(64, Bounces::Limit(0)).by(Sampling::Cosine);
        let lit = irradiance(&bake(gpu, &scene, how, 0)?.0, Chart::new(0))?;
        let mean = lit.iter().sum::<f64>() / lit.len() as f64;
        // A form factor of .1998249, closed form 4; of the first there would be half.
        checks.relative(format!("light of the last, a texture on {textured:?}"), mean, 2.0 * PI * 0.199_824_9, 0.1);
        let plain = plain.get_or_insert_with(|| lit.clone());
        checks.holds(format!("and to the bit, a texture on {textured:?}"), *plain == lit);
    }
    Ok(())
}

/// They get places of their own: half of all texels are lit.
fn overlapping_instances(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: Vec3::NEG_Z });
    for quad in lit_and_dark(Chart::large(0)) {
        stage.place(&[quad], DAffine3::IDENTITY);
    }
    let mut baker = baker_of(gpu, &stage.build()?)?;
    checks.holds("the charts are moved", !baker.atlas().shared);
    checks.count("texels that are counted", baker.atlas().overlapping_texels as u64, 0);
    let map = baker.read_back()?;
    let baked: Vec<f32> = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).map(|pixel| pixel[0]).collect();
    let [lit, dark] = [1.0, 0.0].map(|light: f32| baked.iter().filter(|value| (*value - light).abs() < 1e-5).count());
    checks.count("texels that are neither lit nor dark", (baked.len() - lit - dark) as u64, 0);
    checks.within("lit texels against dark ones", lit as f64, dark as f64, 0.0);
    checks.at_least("lit texels", lit as f64, 28.0 * 28.0);
    Ok(())
}

/// Refused by name, but for what is rounding.
fn outside_the_map(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let spoilt = |value: f32| {
        let mut stage = under_the_sky();
        let chart = Chart::at([0, 0], SIDE);
        stage.place(&[level_square(1.0, 0.0, Facing::Up, chart, 0)], DAffine3::IDENTITY);
        let uvs = stage.desc.meshes[0].parts[0].light_map_uvs.as_mut();
        uvs.into_iter().for_each(|uvs| uvs[2] = Vec2::splat(value));
        Scene::new(stage.desc)
    };
    for value in [1.001, 1.5, -0.001, -1e30, 1e30] {
        let words = ["mesh 'mesh 0'", "light-map coordinates of vertex 2", "[0, 1]"];
        checks.refused(format!("{value}"), &spoilt(value), ErrorKind::InvalidScene, &words);
    }
    let (map, statistics) = bake(gpu, &spoilt(1.000_05)?, How::new(64, Bounces::Auto), 0)?;
    checks.count("texels where 1.00005 is rounding", statistics.texels, u64::from(SIDE * SIDE));
    check_no_halo(checks, &map);
    Ok(())
}

/// It receives no light, and casts a shadow all the same.
fn without_area_in_the_map(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.light(LightKind::Directional { direction: Vec3::NEG_Z });
    let floors = [Chart::new(0), Chart::new(1)].map(|chart| chart.inset(0.01));
    let floor = level_square(1.0, 0.0, Facing::Up, floors[0], 0);
    let beside = level_square(1.0, 0.0, Facing::Up, floors[1], 0);
    stage.place(&[floor, Quad { corner: beside.corner + Vec3::X * 3.0, ..beside }], DAffine3::IDENTITY);
    let lid = level_square(2.0, 1.0, Facing::Down, Chart::new(2), 0);
    stage.place(&[lid], DAffine3::from_translation(DVec3::ZERO));
    if let Some(uvs) = &mut stage.desc.meshes[1].parts[0].light_map_uvs {
        let line = uvs[0];
        uvs.iter_mut().for_each(|uv| uv.y = line.y);
    }
    let scene = Scene::new(stage.desc)?;
    let words = ["'mesh 1'", "2 triangles without area in the light map"];
    let told = matches!(scene.warnings(), [one] if words.iter().all(|word| one.contains(word)));
    checks.holds("a warning names the mesh and counts them", told);
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    checks.count("texels that take rays", statistics.texels, 2 * 36);
    for (chart, what, light) in [(floors[0], "under it", 0.0), (floors[1], "beside it", 1.0)] {
        let values = irradiance(&map, chart)?;
        checks.within(
            format!("lowest irradiance {what}"),
            values.iter().copied().fold(f64::MAX, f64::min),
            light,
            1e-5,
        );
        checks.within(format!("highest irradiance {what}"), values.iter().copied().fold(0.0, f64::max), light, 1e-5);
    }
    Ok(())
}
