//! Extreme case 17: scenes with next to nothing in them.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Bounces, Sampling};
use crate::error::{ErrorKind, Result};
use crate::features::Features;
use crate::gpu::Gpu;
use crate::scene::{Resolution, Scene, SceneDesc, Sidedness};
use crate::verify::estimate::{How, bake};
use crate::verify::stage::{Chart, Facing, SIDE, Stage, level_square};
use glam::DAffine3;
use std::f64::consts::PI;

pub(super) const CASES: [Case; 3] = [
    Case::extreme(17, "scene with nothing to bake", nothing),
    Case::extreme(17, "one triangle under the sky", one_triangle),
    Case::extreme(17, "one triangle without any light", no_light),
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

/// An error that says so.
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
        let baker = Baker::new(gpu, &Scene::new(desc)?, &settings);
        checks.refused(what, &baker, ErrorKind::InvalidScene, &["nothing to bake in 'stage'"]);
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

/// Black to the bit, and done at once; what such a scene does not need is not built.
fn no_light(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = triangle().build()?;
    let (map, statistics) = bake(gpu, &scene, How::new(64, Bounces::Auto), 0)?;
    let baked = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).count();
    checks.count("texels", baked as u64, statistics.texels);
    let lit = map.pixels.iter().filter(|pixel| pixel[..3] != [0.0; 3]).count();
    checks.count("pixels that are not black", lit as u64, 0);
    checks.holds("its estimated error is none", statistics.estimated_error.is_none_or(|error| error == 0.0));
    let settings =
        BakeSettings { resolution: Resolution::Texels(SIDE), sampling: Sampling::Cosine, ..BakeSettings::default() };
    let features = Baker::new(gpu, &scene, &settings)?.features();
    checks.count("features that it is built with", features.bits().into(), Features::empty().bits().into());
    Ok(())
}
