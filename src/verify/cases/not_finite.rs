//! Extreme case 10: numbers that are none, and what is no finite number on the device.

use super::{Case, Checks};
use crate::baker::{Bounces, LightMap};
use crate::error::{ErrorKind, Result};
use crate::gpu::Gpu;
use crate::scene::{LightKind, Scene, SceneDesc, Sky, SkyMap};
use crate::verify::estimate::{How, bake, broken, irradiance};
use crate::verify::stage::{Chart, Facing, Stage, level_square};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::f64::consts::PI;

pub(super) const CASES: [Case; 3] = [
    Case::extreme(10, "numbers that are not finite", not_finite),
    Case::extreme(10, "sky that is not finite", sky),
    Case::extreme(10, "light on a surface", light_on_a_surface),
];

fn chart(index: u32) -> Chart {
    Chart::new(index).inset(0.01)
}

/// A floor in the sun, and a lamp above it.
fn stage() -> Stage {
    let mut stage = Stage::new();
    let (floor, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 1.0));
    stage.desc.materials[lamp].name = "glow".into();
    stage.light(LightKind::Directional { direction: Vec3::new(0.2, 0.1, -1.0) });
    stage.place(&[level_square(1.0, 0.0, Facing::Up, chart(0), floor)], DAffine3::IDENTITY);
    stage.place(&[level_square(1.0, 1.0, Facing::Down, chart(1), lamp)], DAffine3::IDENTITY);
    stage
}

fn baked(gpu: &Gpu, scene: &Scene) -> Result<LightMap> {
    Ok(bake(gpu, scene, How::new(64, Bounces::Auto), 0)?.0)
}

/// Puts a number where it does harm.
type Spoil = fn(&mut SceneDesc, f32);

/// What is refused wherever it stands, and what the refusal says.
const SPOILT: [(&str, Spoil); 13] = [
    ("mesh 'mesh 1', part 0: the position of vertex 2", |desc, value| desc.meshes[1].parts[0].positions[2].y = value),
    ("mesh 'mesh 1', part 0: the normal of vertex 0", |desc, value| {
        desc.meshes[1].parts[0].normals = Some(vec![Vec3::splat(value); 4]);
    }),
    ("mesh 'mesh 1', part 0: the light-map coordinates of vertex 0", |desc, value| {
        desc.meshes[1].parts[0].light_map_uvs = Some(vec![Vec2::new(0.5, value); 4]);
    }),
    ("mesh 'mesh 1', part 0: the albedo coordinates of vertex 0", |desc, value| {
        desc.meshes[1].parts[0].albedo_uvs = Some(vec![Vec2::new(value, 0.5); 4]);
    }),
    ("mesh 'mesh 1', part 0: the emission coordinates of vertex 0", |desc, value| {
        desc.meshes[1].parts[0].emission_uvs = Some(vec![Vec2::splat(value); 4]);
    }),
    ("the transform of instance 'instance 1'", |desc, value| desc.instances[1].transform.translation.z = value.into()),
    ("the transform of instance 'instance 1'", |desc, value| {
        desc.instances[1].transform.matrix3.x_axis.y = value.into()
    }),
    ("the emission of material 'glow'", |desc, value| desc.materials[1].emission.z = value),
    ("the intensity of light 'light'", |desc, value| desc.lights[0].intensity.x = value),
    ("the direction of light 'light'", |desc, value| {
        desc.lights[0].kind = LightKind::Directional { direction: Vec3::new(0.0, 0.0, value) };
    }),
    ("the position of light 'light'", |desc, value| {
        desc.lights[0].kind = LightKind::Point { position: DVec3::splat(value.into()), range: None };
    }),
    ("the cone of light 'light'", |desc, value| {
        let (position, direction, range) = (DVec3::Z, Vec3::NEG_Z, None);
        let kind = LightKind::Spot { position, direction, inner_angle: 0.1, outer_angle: value, range };
        desc.lights[0].kind = kind;
    }),
    ("the sky's radiance", |desc, value| desc.sky = Sky::Constant(Vec3::new(1.0, value, 1.0))),
];

/// Each is refused by name. What is named can be left out, and the rest bakes.
fn not_finite(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for (named, spoil) in SPOILT {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut desc = stage().desc;
            spoil(&mut desc, value);
            checks.refused(format!("{value} in {named}"), &Scene::new(desc), ErrorKind::InvalidScene, &[named]);
        }
    }
    let mut rest = stage();
    rest.desc.instances[1].transform.translation.z = f64::NAN;
    rest.desc.instances.truncate(1);
    let values = irradiance(&baked(gpu, &rest.build()?)?, chart(0))?;
    let sun = 1.0 / f64::from(Vec3::new(0.2, 0.1, -1.0).length());
    let worst = values.iter().map(|value| (value - sun).abs()).fold(0.0, f64::max);
    checks.at_most("the rest is in the sun, worst texel off by", worst, 1e-5);
    Ok(())
}

/// It is refused by its pixel, and the sky that was there stays.
fn sky(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut scene = stage().build()?;
    scene.set_sky(Sky::Constant(Vec3::ONE))?;
    let before = baked(gpu, &scene)?;
    for value in [f32::NAN, f32::INFINITY, -1.0] {
        let pixels = (0..6).map(|pixel| if pixel == 4 { Vec3::splat(value) } else { Vec3::ONE }).collect();
        let refused = scene.set_sky(Sky::Map(SkyMap { width: 3, height: 2, pixels }));
        let words = ["sky map", "column 1, row 1"];
        checks.refused(format!("{value} in a sky map"), &refused, ErrorKind::InvalidScene, &words);
    }
    checks.holds("the light of the sky that stays, to the bit", baked(gpu, &scene)? == before);
    Ok(())
}

/// A point light that lies on a surface, just above and just below it, and a lamp as bright as numbers get: what is no
/// number on the device counts as 0, and spoils nothing beside it. (A map with any such pixel ends the case.)
fn light_on_a_surface(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let floor = level_square(1.0, 0.0, Facing::Up, chart(0), 0);
    let beside = level_square(1.0, 0.0, Facing::Up, chart(1), 0);
    // The middle of a texel.
    let (_, share) = chart(0).texels().nth(14).ok_or_else(|| broken("the chart has no texel".into()))?;
    for (height, intensity) in [(0.0, 1.0), (1e-6, 1.0), (-1e-6, 1.0), (0.0, 1e30), (1e-6, 1e20), (1e-6, 3e38)] {
        let mut stage = Stage::new();
        stage.material(0.5, 0.0);
        let position = floor.point(share) + DVec3::Z * height;
        stage.light(LightKind::Point { position, range: None });
        stage.desc.lights[0].intensity = Vec3::splat(intensity);
        // A second floor far away, in a box of black walls that shine: its light is what it would be without the first.
        stage.material(0.0, 1.0);
        stage.place(&[floor], DAffine3::IDENTITY);
        let lid = level_square(1.5, 1e-3, Facing::Down, chart(2), 1);
        stage.place(&[beside, lid], DAffine3::from_translation(DVec3::X * 20.0));
        let (map, _) = bake(gpu, &stage.build()?, How::new(256, Bounces::Auto), 0)?;
        let what = format!("intensity {intensity:e} at {height:e}");
        let values = irradiance(&map, chart(1))?;
        let off = values.iter().map(|value| (value / PI - 1.0).abs()).fold(0.0, f64::max);
        checks.at_most(format!("{what}: light under a lid, worst texel off by"), off, 5e-2);
    }
    Ok(())
}
