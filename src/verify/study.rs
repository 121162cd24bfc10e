//! How the baker's answers depend on what is stiff or extreme: figures to look at, where [`super::cases`] only pass or fail.

use super::estimate::{How, bake, broken, mean_of};
use super::stage::{Chart, Facing, Quad, Stage, level_square, room};
use crate::baker::{Bounces, LightMap, Sampling};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::temporal::{Average, History, World};
use glam::{DAffine3, DVec3, Vec3};
use std::f64::consts::PI;
use std::time::Duration;

/// Albedos of the stiffness study.
pub const ALBEDOS: [f32; 6] = [0.5, 0.8, 0.9, 0.95, 0.99, 0.999];

/// A closed room whose walls all shine and reflect alike, baked with more and more bounces.
#[derive(Debug, Clone)]
pub struct Stiffness {
    /// Of the walls.
    pub albedo: f64,
    /// By bounces: 0, 1, 2, 4 ..
    pub rows: Vec<Bounced>,
    /// With [`Bounces::Auto`].
    pub automatic: Bounced,
}

/// A bake of so many bounces. Shares of the irradiance of the closed form.
#[derive(Debug, Clone, Copy)]
pub struct Bounced {
    /// Bounces; with [`Bounces::Auto`] as many as it made.
    pub bounces: u32,
    /// What is missing after them one by one: albedo^(bounces + 1).
    pub predicted: f64,
    /// What the bake says is missing, from how the change shrinks; `None` before the first bounce.
    pub told: Option<f64>,
    /// What is missing: the mean over all texels against the closed form.
    pub error: f64,
}

/// A bake against the same bake of the same scene in another unit or place.
#[derive(Debug, Clone, Copy)]
pub struct Deviation {
    /// Which unit or place.
    pub value: f64,
    /// Of the mean irradiance, relative.
    pub of_mean: f64,
    /// Root of the mean squared difference of a texel, relative to the mean.
    pub rms: f64,
}

/// A running average that old light leaves, in 32-bit floats as the shader has it.
#[derive(Debug, Clone, Copy)]
pub struct Decay {
    /// Frames a second.
    pub frames_per_s: f64,
    /// Until the threshold is reached, seconds.
    pub latency_s: f64,
    /// Share of the old light that should be left at the first frame at or after the latency.
    pub expected: f64,
    /// Share that is.
    pub left: f64,
}

/// Bakes the room with 0 to 512 bounces, and as many as it takes.
///
/// # Errors
/// As [`crate::baker::Baker::new`] and [`crate::baker::Baker::bake`].
pub fn stiffness(gpu: &Gpu, albedo: f32) -> Result<Stiffness> {
    let limits = std::iter::once(0).chain((0..10).map(|power| 1 << power));
    let rows = limits.map(|limit| furnace(gpu, albedo, Bounces::Limit(limit))).collect::<Result<_>>()?;
    let automatic = furnace(gpu, albedo, Bounces::Auto)?;
    Ok(Stiffness { albedo: f64::from(albedo), rows, automatic })
}

fn furnace(gpu: &Gpu, albedo: f32, bounces: Bounces) -> Result<Bounced> {
    let mut stage = Stage::new();
    let white = stage.material(albedo, 1.0);
    let walls = room(Vec3::ZERO, Vec3::ONE, |index| Chart::new(index).inset(0.01), white);
    let how = How::new(64, bounces).by(Sampling::Cosine);
    let (map, statistics) = bake(gpu, &stage.with(&walls)?, how, 0)?;
    let expected = PI / (1.0 - f64::from(albedo));
    let made = match bounces {
        Bounces::Limit(limit) => limit,
        // All epochs but the one that is kept.
        Bounces::Auto => statistics.epochs - 1,
    };
    let told = f64::from(statistics.bounces_missing);
    Ok(Bounced {
        bounces: made,
        predicted: f64::from(albedo).powf(f64::from(made) + 1.0),
        told: Some(told).filter(|told| told.is_finite()),
        error: 1.0 - mean_of(&baked(&map)?) / expected,
    })
}

/// Irradiance of all texels with light of their own, red.
fn baked(map: &LightMap) -> Result<Vec<f64>> {
    let values: Vec<f64> = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).map(|pixel| f64::from(pixel[0])).collect();
    if values.is_empty() { Err(broken("no texel is baked".into())) } else { Ok(values) }
}

/// The same room with a lamp and a plate in it: so large, so far from the origin, so bright.
fn furnished(scale: f64, offset: f64, radiance: f64) -> Result<Scene> {
    let mut stage = Stage::new();
    let [wall, lamp] = [(0.7, 0.0), (0.3, radiance as f32)].map(|(albedo, light)| stage.material(albedo, light));
    let mut quads = room(Vec3::new(-0.5, -0.5, 0.0), Vec3::new(0.5, 0.5, 1.0), Chart::new, wall).to_vec();
    quads.push(level_square(0.2, 0.9, Facing::Down, Chart::new(6), lamp));
    let plate = level_square(0.3, 0.4, Facing::Up, Chart::new(7), wall);
    quads.push(Quad { corner: plate.corner + Vec3::new(0.1, 0.15, 0.0), ..plate });
    let place = DAffine3 { translation: DVec3::splat(offset), ..DAffine3::from_scale(DVec3::splat(scale)) };
    stage.place(&quads, place);
    stage.build()
}

fn deviations(
    gpu: &Gpu,
    values: &[f64],
    scene: impl Fn(f64) -> Result<Scene>,
    unit: fn(f64) -> f64,
) -> Result<Vec<Deviation>> {
    // By the cosine, for which rays are aimed depends on every last bit.
    let how = How::new(256, Bounces::Limit(4)).by(Sampling::Cosine);
    let reference = baked(&bake(gpu, &furnished(1.0, 0.0, 1.0)?, how, 0)?.0)?;
    let mean = mean_of(&reference);
    let deviation = |value: &f64| {
        let found: Vec<f64> =
            baked(&bake(gpu, &scene(*value)?, how, 0)?.0)?.iter().map(|found| found / unit(*value)).collect();
        if found.len() != reference.len() {
            return Err(broken(format!("{} texels are baked, and {} of the reference", found.len(), reference.len())));
        }
        let squares: Vec<f64> = found.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).collect();
        let of_mean = mean_of(&found) / mean - 1.0;
        Ok(Deviation { value: *value, of_mean, rms: mean_of(&squares).sqrt() / mean })
    };
    values.iter().map(deviation).collect()
}

/// The same scene from a millionth of its size to a million times.
///
/// # Errors
/// As [`crate::baker::Baker::new`] and [`crate::baker::Baker::bake`].
pub fn scales(gpu: &Gpu) -> Result<Vec<Deviation>> {
    let values = [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6];
    deviations(gpu, &values, |scale| furnished(scale, 0.0, 1.0), |_| 1.0)
}

/// The same scene, one unit wide, up to a million units away from the origin along each axis.
///
/// # Errors
/// As [`crate::baker::Baker::new`] and [`crate::baker::Baker::bake`].
pub fn offsets(gpu: &Gpu) -> Result<Vec<Deviation>> {
    let values = [0.0, 1.0, 1e2, 1e4, 1e5, 1e6];
    deviations(gpu, &values, |offset| furnished(1.0, offset, 1.0), |_| 1.0)
}

/// The same scene with a lamp of a radiance from 1e-20 to 1e6; irradiance in units of that.
///
/// # Errors
/// As [`crate::baker::Baker::new`] and [`crate::baker::Baker::bake`].
pub fn radiances(gpu: &Gpu) -> Result<Vec<Deviation>> {
    let values = [1e-20, 1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6];
    deviations(gpu, &values, |radiance| furnished(1.0, 0.0, radiance), |radiance| f64::from(radiance as f32))
}

/// Light that is switched off: what is left of it at the latency, from 1 to 10,000 frames a second and from 1 ms to 60 s.
///
/// # Errors
/// None that these latencies bring.
pub fn decays() -> Result<Vec<Decay>> {
    let rates = [1.0, 30.0, 60.0, 1000.0, 10_000.0];
    let latencies = [0.001, 0.1, 0.5, 5.0, 60.0];
    let all = latencies.into_iter().flat_map(|latency| rates.into_iter().map(move |rate| (rate, latency)));
    all.map(|(rate, latency)| decay(rate, latency)).collect()
}

/// Share of old light that counts as none.
const THRESHOLD: f64 = 0.1;

fn decay(frames_per_s: f64, latency_s: f64) -> Result<Decay> {
    let average = Average::new(Duration::from_secs_f64(latency_s), THRESHOLD)?;
    let step_s = 1.0 / frames_per_s;
    let mut history = History::default();
    // Long enough for a full average.
    let full = (20.0 * latency_s * frames_per_s).ceil().max(2.0);
    (0..full as u64).for_each(|_| {
        history.visit(&average, step_s, 1, World::Changing);
    });
    let frames = (latency_s * frames_per_s * (1.0 - 1e-12)).ceil().max(1.0);
    let mut left = 1.0_f32;
    for _ in 0..frames as u64 {
        let weight = history.visit(&average, step_s, 1, World::Changing);
        // As glsl/bake.comp has it.
        left += (0.0 - left) / (weight as f32 + 1.0);
    }
    let expected = THRESHOLD.powf(frames * step_s / latency_s);
    Ok(Decay { frames_per_s, latency_s, expected, left: f64::from(left) })
}
