//! Extreme cases 1 and 2: rooms that give back nearly all light, and materials that would give back more.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Bounces, LightMap, Outcome, Statistics, Stop};
use crate::epochs::{Epochs, Stage as BounceStage};
use crate::error::{ErrorKind, Result};
use crate::gpu::Gpu;
use crate::scene::{MAX_ALBEDO, Resolution, Scene, Texture, TextureUse, Wrap};
use crate::verify::estimate::{How, bake, mean_of};
use crate::verify::stage::{Chart, Stage, room};
use glam::Vec3;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::Duration;

pub(super) const CASES: [Case; 6] = [
    Case::extreme(1, "furnace of albedo .999", converges),
    Case::extreme(1, "furnace of albedo .999, few bounces", few_bounces),
    Case::extreme(1, "furnace of albedo .999, cut short", cut_short),
    Case::extreme(2, "albedo that is none", no_albedo),
    Case::extreme(2, "albedo below 0", negative_albedo),
    Case::extreme(2, "light that grows", growing_light),
];

const ALBEDO: f64 = MAX_ALBEDO as f64;
/// Thousands of bounces: the map is as small as it can be.
const SIDE: u32 = 8;

fn chart(index: u32) -> Chart {
    Chart::at([index % 3 * 3, index / 3 * 3], 1).on(SIDE).inset(0.01)
}

/// A closed room of this albedo whose walls shine.
fn furnace(albedo: f32) -> Stage {
    let mut stage = Stage::new();
    let white = stage.material(albedo, 1.0);
    stage.desc.materials[white].name = "white".into();
    stage.place(&room(Vec3::ZERO, Vec3::ONE, chart, white), glam::DAffine3::IDENTITY);
    stage
}

/// Over the walls, in units of a single bounce's.
fn radiosity(map: &LightMap) -> f64 {
    let baked = map.pixels.iter().filter(|pixel| pixel[3] == 1.0);
    mean_of(&baked.map(|pixel| f64::from(pixel[0]) / PI).collect::<Vec<_>>())
}

/// What all bounces after the first `count` add to these, as a share of these.
fn missing_after(count: f64) -> f64 {
    let left = ALBEDO.powf(count + 1.0);
    left / (1.0 - left)
}

/// In thousands of bounces, until what is left is what 32-bit floats round, a thousandfold. It is not done before: no more is
/// missing than it says.
fn converges(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let (map, statistics) = bake(gpu, &furnace(MAX_ALBEDO).build()?, How::new(64, Bounces::Auto).on(SIDE), 0)?;
    let (found, wanted) = (radiosity(&map), 1.0 / (1.0 - ALBEDO));
    checks.relative("irradiance", found, wanted, 1e-3);
    let told = f64::from(statistics.bounces_missing);
    checks.at_least("share of the light that is said to be missing", told, wanted / found - 1.0);
    checks.at_most("the same, and not far more", told, 1e-3);
    Ok(())
}

/// As many bounces as were asked for, and no more, and a bound on what they leave out that is one, and is near.
fn few_bounces(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    for bounces in [3, 30, 300] {
        let how = How::new(64, Bounces::Limit(bounces)).on(SIDE);
        let (map, statistics) = bake(gpu, &furnace(MAX_ALBEDO).build()?, how, 0)?;
        let expected = (1.0 - ALBEDO.powi(bounces as i32 + 1)) / (1.0 - ALBEDO);
        checks.relative(format!("irradiance of {bounces} bounces"), radiosity(&map), expected, 1e-4);
        check_bound(checks, &format!("after {bounces} bounces"), &statistics, bounces.into());
    }
    Ok(())
}

fn check_bound(checks: &mut Checks, what: &str, statistics: &Statistics, bounces: f64) {
    let (told, missing) = (f64::from(statistics.bounces_missing), missing_after(bounces));
    checks.at_least(format!("share of the light that is said to be missing {what}"), told, 0.999 * missing);
    checks.at_most(format!("the same {what}, and not far more"), told, 1.5 * missing);
}

/// Epochs.
const EARLY: u32 = 100;

/// Interrupted, or out of time, it says what is missing, and is not done.
fn cut_short(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let scene = furnace(MAX_ALBEDO).build()?;
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let error = Stop { error: Some(0.5), ..Stop::default() };
    let time = Stop { time: Some(Duration::from_millis(1)), ..Stop::default() };
    for (what, stop, epochs) in [("interrupted", error, EARLY), ("out of time", time, u32::MAX)] {
        let mut baker = Baker::new(gpu, &scene, &settings)?;
        let outcome = baker.bake(&stop, &mut |progress| match progress.epoch < epochs {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        })?;
        checks.holds(format!("{what}: it is not done early"), (outcome == Outcome::Interrupted) == (epochs == EARLY));
        let statistics = baker.statistics();
        checks.count(format!("{what}: samples"), statistics.most_samples as u64, 0);
        let told = statistics.warnings.iter().any(|warning| warning.contains("the bounces have not converged"));
        checks.holds(format!("{what}: a warning says so"), told);
        if epochs == EARLY {
            // Each bounce makes an epoch, and the last is not gone through.
            check_bound(checks, what, statistics, statistics.epochs.into());
        }
    }
    Ok(())
}

/// Above the largest or no number: it counts as the largest, to the bit, and a warning names the material. A white texture
/// needs no warning: its factor of 1 is what a file says that says nothing.
fn no_albedo(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    let how = How::new(64, Bounces::Limit(20)).on(SIDE);
    let wanted = bake(gpu, &furnace(MAX_ALBEDO).build()?, how, 0)?.0;
    checks.relative("irradiance of .999", radiosity(&wanted), (1.0 - ALBEDO.powi(21)) / (1.0 - ALBEDO), 1e-4);
    for albedo in [1.0, 1.5, f32::INFINITY, f32::NAN] {
        let scene = Scene::new(furnace(albedo).desc)?;
        let warned = matches!(scene.warnings(), [one] if one.contains("albedo of material 'white'"));
        checks.holds(format!("{albedo}: one warning names the material"), warned);
        let kept = scene.materials()[0].albedo;
        checks.holds(format!("{albedo}: it is kept as .999"), kept == Vec3::splat(MAX_ALBEDO));
        checks.holds(format!("{albedo}: the light of .999"), bake(gpu, &scene, how, 0)?.0 == wanted);
    }
    let mut textured = furnace(1.0);
    let pixels = vec![[255; 4]];
    textured.desc.textures.push(Texture { name: "white".into(), width: 1, height: 1, pixels });
    textured.desc.materials[0].albedo_texture = Some(TextureUse { texture: 0, wrap: [Wrap::Repeat; 2] });
    let found = bake(gpu, &textured.build()?, how, 0)?.0;
    checks.relative("irradiance of a white texture", radiosity(&found), radiosity(&wanted), 1e-4);
    Ok(())
}

fn negative_albedo(_: &Gpu, checks: &mut Checks) -> Result<()> {
    for albedo in [-1e-3, f32::NEG_INFINITY] {
        let scene = Scene::new(furnace(albedo).desc);
        checks.refused(format!("{albedo}"), &scene, ErrorKind::InvalidScene, &["the albedo of material 'white'"]);
    }
    Ok(())
}

/// No scene that is let in does this, so that the epochs are told it: after three changes in a row that grow rays are no
/// longer aimed, and where that does not help the bake ends. Light of all bounces that the largest albedo has does neither.
fn growing_light(_: &Gpu, checks: &mut Checks) -> Result<()> {
    let mut epochs = Epochs::new(Bounces::Auto, BounceStage::Last, ALBEDO, 1.0);
    for radiance in [2.0, 4.0, 8.0, 16.0] {
        checks.holds(format!("it does not yet grow before {radiance}"), !epochs.grows());
        epochs.bounced(radiance)?;
    }
    checks.holds("it grows after three changes", epochs.grows());
    let grown = (5..40).try_for_each(|bounce| epochs.bounced(2_f64.powi(bounce)));
    checks.refused("growing on", &grown, ErrorKind::InvalidScene, &["light grows with every bounce"]);
    let (mut epochs, mut bright) = (Epochs::new(Bounces::Auto, BounceStage::Last, ALBEDO, 1.0), Ok(()));
    for radiance in [2.0, f64::INFINITY] {
        bright = epochs.bounced(radiance);
    }
    checks.refused("light beyond all numbers", &bright, ErrorKind::InvalidScene, &["more than a 32-bit float holds"]);
    let (mut epochs, mut radiance) = (Epochs::new(Bounces::Auto, BounceStage::Last, ALBEDO, 1.0), 1.0);
    for _ in 0..10_000 {
        radiance = 1.0 + ALBEDO * radiance;
        epochs.bounced(radiance)?;
    }
    checks.holds("a furnace of .999 does not grow", !epochs.grows());
    Ok(())
}
