//! Extreme case 17: scenes with next to nothing in them.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Bounces, FrameSettings, LightMap, Mode, Outcome, Sampling, Slice, Stop};
use crate::error::{ErrorKind, Result};
use crate::features::Features;
use crate::gpu::Gpu;
use crate::scene::{LightKind, Resolution, Scene, SceneDesc, Sidedness};
use crate::verify::estimate::{How, bake};
use crate::verify::stage::{Chart, Facing, SIDE, Stage, level_square};
use glam::{DAffine3, DVec3};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::Duration;

pub(super) const CASES: [Case; 5] = [
    Case::extreme(17, "scene with nothing to bake", nothing),
    Case::extreme(17, "one triangle under the sky", one_triangle),
    Case::extreme(17, "one triangle without any light", no_light),
    Case::extreme(17, "analytic light that nothing reflects", nothing_to_gather),
    Case::extreme(17, "analytic light alone, broken off", broken_off),
];

/// One triangle of one instance, seen from both sides.
fn triangle() -> Stage {
    let mut stage = Stage::new();
    stage.material(0.0, 0.0);
    stage.desc.materials[0].sidedness = Sidedness::Double;
    stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(0).inset(0.01), 0)], DAffine3::IDENTITY);
    stage.desc.meshes[0].parts[0].indices.truncate(3);
    stage
}

/// An empty light map, and a warning that says so; within frames, where nothing could ever come of it, an error.
fn nothing(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let mut without_instances = triangle();
    without_instances.desc.instances.clear();
    let mut without_triangles = triangle();
    without_triangles.desc.meshes[0].parts.clear();
    let mut without_charts = triangle();
    without_charts.desc.meshes[0].parts[0].light_map_uvs = None;
    for (what, desc) in [
        ("an empty scene", SceneDesc { name: "stage".into(), ..SceneDesc::default() }),
        ("no instance", without_instances.desc),
        ("no triangle", without_triangles.desc),
        ("no light-map coordinates", without_charts.desc),
    ] {
        let scene = Scene::new(desc)?;
        let mut baker = Baker::new(gpu, &scene, &settings)?;
        let outcome = baker.bake(&Stop::default(), &mut |_| ControlFlow::Continue(()))?;
        checks.holds(format!("{what}: the bake is done"), outcome == Outcome::Finished);
        let map = baker.read_back()?;
        let is_empty = map.pixels.len() == (SIDE * SIDE) as usize && map.pixels.iter().all(|pixel| *pixel == [0.0; 4]);
        checks.holds(format!("{what}: its light map is empty"), is_empty);
        let told = matches!(&baker.statistics().warnings[..], [one] if one.contains("nothing to bake in 'stage'"));
        checks.holds(format!("{what}: a warning says so"), told);
        let pipelines = gpu.objects().pipelines;
        checks.count(format!("{what}: pipelines"), pipelines.values().map(|count| *count as u64).sum(), 0);
        let mode = Mode::Frames(FrameSettings::default());
        let frames = Baker::new(&gpu.as_of_an_engine()?, &scene, &BakeSettings { mode, ..settings.clone() });
        checks.refused(what, &frames, ErrorKind::InvalidScene, &["nothing to bake in 'stage'"]);
    }
    Ok(())
}

fn one_triangle(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut stage = triangle();
    stage.sky(1.0);
    for sampling in [Sampling::Auto, Sampling::Cosine] {
        let scene = Scene::new(stage.desc.clone())?;
        let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto).by(sampling), 0)?;
        let baked = || map.pixels.iter().filter(|pixel| pixel[3] == 1.0);
        checks.count(format!("texels by {sampling}"), baked().count() as u64, statistics.texels);
        // Those that its long side crosses count as well.
        checks.within("half of the chart's texels", statistics.texels as f64, 14.0 * 29.0, 28.0);
        let values = || baked().flat_map(|pixel| &pixel[..3]).map(|value| f64::from(*value));
        checks.relative(format!("lowest irradiance by {sampling}"), values().fold(f64::MAX, f64::min), PI, 1e-4);
        checks.relative(format!("highest irradiance by {sampling}"), values().fold(0.0, f64::max), PI, 1e-4);
    }
    Ok(())
}

/// Black to the bit, and done at once: nothing is built.
fn no_light(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = triangle().build()?;
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    let baked = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).count();
    checks.count("texels", baked as u64, statistics.texels);
    checks.within("half of the chart's texels", statistics.texels as f64, 14.0 * 29.0, 28.0);
    let lit = map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count();
    checks.count("pixels that are not black", lit as u64, 0);
    checks.count("rays", statistics.rays, 0);
    checks.holds("its error is 0", statistics.estimated_error == Some(0.0));
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let baker = Baker::new(gpu, &scene, &settings)?;
    checks.count("features that it is built with", baker.features().bits().into(), 0);
    let pipelines = gpu.objects().pipelines;
    checks.count("pipelines", pipelines.values().map(|count| *count as u64).sum(), 0);
    Ok(())
}

/// A floor and a shade over it under a point light, and nothing else that shines.
fn under_a_point(albedo: f32) -> Result<Scene> {
    let mut stage = Stage::new();
    stage.material(albedo, 0.0);
    let floor = level_square(1.0, 0.0, Facing::Up, Chart::large(0).inset(0.01), 0);
    let shade = level_square(0.2, 0.3, Facing::Up, Chart::new(0).inset(0.01), 0);
    stage.place(&[floor, shade], DAffine3::IDENTITY);
    stage.light(LightKind::Point { position: DVec3::new(0.0, 0.1, 1.0), range: None });
    stage.build()
}

/// Texels on a surface of one that are others in the other.
fn differing(one: &LightMap, other: &LightMap) -> u64 {
    let bits = |map: &LightMap| map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>();
    // Gutters follow.
    bits(one).iter().zip(bits(other)).filter(|(one, other)| one[3] != 0 && **one != *other).count() as u64
}

/// No ray is sent where none could find light, and its light map is that of a bake that sends them.
fn nothing_to_gather(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for (what, albedo, bounces) in [
        ("no bounces", 0.5, Bounces::Limit(0)),
        ("black surfaces", 0.0, Bounces::Auto),
        ("both", 0.0, Bounces::Limit(0)),
    ] {
        let (scene, resolution) = (under_a_point(albedo)?, Resolution::Texels(SIDE));
        let settings = BakeSettings { resolution, bounces, ..BakeSettings::default() };
        let mut baker = Baker::new(gpu, &scene, &settings)?;
        // Nothing is left that could be broken off.
        let outcome = baker.bake(&Stop::default(), &mut |_| ControlFlow::Break(()))?;
        checks.holds(format!("{what}: the bake is done"), outcome == Outcome::Finished);
        let map = baker.read_back()?;
        checks.count(format!("{what}: rays"), baker.statistics().rays, 0);
        let needed = Features::LIGHTS | Features::SINGLE_SIDED;
        checks.count(format!("{what}: features"), baker.features().bits().into(), needed.bits().into());
        let by_error = Stop { error: Some(0.01), ..Stop::default() };
        let outcome = baker.bake(&by_error, &mut |_| ControlFlow::Continue(()))?;
        let is_exact = outcome == Outcome::Finished && baker.statistics().estimated_error == Some(0.0);
        checks.holds(format!("{what}: its error is 0"), is_exact);
        let lit = map.pixels.iter().filter(|pixel| pixel[3] == 1.0 && pixel[0] > 0.0).count();
        let dark = map.pixels.iter().filter(|pixel| pixel[3] == 1.0 && pixel[0] == 0.0).count();
        checks.holds(format!("{what}: texels in light and in shade"), lit > 300 && dark > 20);
        let settings = BakeSettings { unneeded: Features::GATHERING, sampling: Sampling::Cosine, ..settings };
        let mut baker = Baker::new(gpu, &scene, &settings)?;
        baker.bake(&Stop { samples: Some(64), ..Stop::default() }, &mut |_| ControlFlow::Continue(()))?;
        checks.holds(format!("{what}: with rays they are sent"), baker.statistics().rays > 0);
        let other = baker.read_back()?;
        checks.count(format!("{what}: pixels that differ from those with rays"), differing(&map, &other), 0);
    }
    Ok(())
}

/// Texels that have not been reached are filled like a gutter, and the bake can be gone on with.
fn broken_off(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = under_a_point(0.5)?;
    let settings = BakeSettings {
        resolution: Resolution::Texels(SIDE),
        bounces: Bounces::Limit(0),
        slice: Slice::Texels(64),
        ..BakeSettings::default()
    };
    let mut whole = Baker::new(gpu, &scene, &BakeSettings { slice: Slice::default(), ..settings.clone() })?;
    whole.bake(&Stop::default(), &mut |_| ControlFlow::Continue(()))?;
    let whole = whole.read_back()?;
    let mut baker = Baker::new(gpu, &scene, &settings)?;
    let outcome = baker.bake(&Stop::default(), &mut |_| ControlFlow::Break(()))?;
    checks.holds("it is broken off", outcome == Outcome::Interrupted);
    let (texels, missing) = (baker.statistics().texels, differing(&baker.read_back()?, &whole));
    checks.holds("some texels have their light, and some not", 0 < missing && missing < texels);
    let told = baker.statistics().warnings.iter().any(|warning| warning.contains("have not been reached"));
    checks.holds("a warning says so", told);
    let in_no_time = Stop { time: Some(Duration::from_nanos(1)), ..Stop::default() };
    let outcome = baker.bake(&in_no_time, &mut |_| ControlFlow::Continue(()))?;
    checks.holds("the time ends it", outcome == Outcome::Finished);
    checks.holds("and it goes on meanwhile", (1..missing).contains(&differing(&baker.read_back()?, &whole)));
    let outcome = baker.bake(&Stop::default(), &mut |_| ControlFlow::Continue(()))?;
    checks.holds("it is gone on with", outcome == Outcome::Finished);
    checks.count("pixels that differ from those of a bake in one go", differing(&baker.read_back()?, &whole), 0);
    Ok(())
}
