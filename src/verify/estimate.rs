//! Bakes, and what several randomisations of a bake tell.

use super::stage::{Chart, SIDE};
use crate::baker::{AimedBy, BakeSettings, Baker, Bounces, LightMap, Outcome, Sampling, Statistics, Stop};
use crate::error::{Error, ErrorKind, Result};
use crate::gpu::Gpu;
use crate::scene::{Resolution, Scene};
use std::ops::ControlFlow;

/// Independent randomisations behind a standard error.
pub(super) const SEEDS: u64 = 8;

/// Ways of sampling, all with the same means. Rays by importance alone find only what has texels of its own.
pub(super) const SAMPLINGS: [Sampling; 4] =
    [Sampling::Cosine, Sampling::Importance, Sampling::Mixture { cosine: 0.5 }, Sampling::Mixture { cosine: 0.1 }];
/// Those that aim some rays and send some by the cosine.
pub(super) const MIXTURES: [Sampling; 2] = [Sampling::Mixture { cosine: 0.5 }, Sampling::Mixture { cosine: 0.1 }];

/// How a test bakes.
#[derive(Debug, Clone, Copy)]
pub(super) struct How {
    /// Rays a texel.
    pub(super) samples: u32,
    pub(super) bounces: Bounces,
    pub(super) sampling: Sampling,
    pub(super) aimed_by: AimedBy,
    /// Side of the light map, texels.
    pub(super) side: u32,
}

impl How {
    /// Rays as the baker likes, in a light map of the usual side.
    pub(super) fn new(samples: u32, bounces: Bounces) -> Self {
        Self { samples, bounces, sampling: Sampling::Auto, aimed_by: AimedBy::default(), side: SIDE }
    }

    pub(super) fn by(self, sampling: Sampling) -> Self {
        Self { sampling, ..self }
    }

    pub(super) fn aimed(self, aimed_by: AimedBy) -> Self {
        Self { aimed_by, ..self }
    }

    pub(super) fn on(self, side: u32) -> Self {
        Self { side, ..self }
    }
}

pub(super) fn bake(gpu: &Gpu, scene: &Scene, how: How, seed: u64) -> Result<(LightMap, Statistics)> {
    let mut baker = begin(gpu, scene, how, seed)?;
    let map = go_on(&mut baker, how.samples)?;
    Ok((map, baker.statistics().clone()))
}

fn begin(gpu: &Gpu, scene: &Scene, how: How, seed: u64) -> Result<Baker> {
    let How { bounces, sampling, aimed_by, side, samples: _ } = how;
    let resolution = Resolution::Texels(side);
    let settings = BakeSettings { resolution, bounces, sampling, aimed_by, seed, ..Default::default() };
    let baker = Baker::new(gpu, scene, &settings)?;
    if !baker.atlas().shared {
        return Err(broken("the charts are not where the case put them".into()));
    }
    Ok(baker)
}

fn go_on(baker: &mut Baker, samples: u32) -> Result<LightMap> {
    let stop = Stop { samples: Some(samples), ..Stop::default() };
    let outcome = baker.bake(&stop, &mut |_| ControlFlow::Continue(()))?;
    if outcome != Outcome::Finished {
        return Err(broken(format!("the bake ended with {outcome:?}")));
    }
    let map = baker.read_back()?;
    match map.pixels.iter().position(|pixel| pixel.iter().any(|value| !value.is_finite())) {
        None => Ok(map),
        Some(texel) => Err(broken(format!("texel {texel} is {:?}", map.pixels[texel]))),
    }
}

/// Something that no case can go on with.
pub(super) fn broken(what: String) -> Error {
    Error::new(ErrorKind::Driver, what)
}

/// Irradiance of the texels that lie whole in a chart, row-major, red.
pub(super) fn irradiance(map: &LightMap, chart: Chart) -> Result<Vec<f64>> {
    let texel = |(texel, _): (usize, _)| match map.pixels[texel] {
        [red, _, _, 1.0] => Ok(f64::from(red)),
        pixel => Err(broken(format!("texel {texel} of the chart is not baked: {pixel:?}"))),
    };
    chart.texels().map(texel).collect()
}

pub(super) fn mean(map: &LightMap, chart: Chart) -> Result<f64> {
    Ok(mean_of(&irradiance(map, chart)?))
}

pub(super) fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A figure over [`SEEDS`] randomisations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    pub(super) mean: f64,
    pub(super) standard_error: f64,
}

impl Estimate {
    /// What `figure` is of a bake, over seeds.
    pub(super) fn of(gpu: &Gpu, scene: &Scene, how: How, figure: impl Fn(&LightMap) -> Result<f64>) -> Result<Self> {
        let figures: Result<Vec<f64>> = (0..SEEDS).map(|seed| figure(&bake(gpu, scene, how, seed)?.0)).collect();
        Ok(Self::over(&figures?))
    }

    /// The mean of a chart's irradiance where no light is reflected: the rays of texels, and those that a bake goes on with,
    /// then have nothing in common. [`SEEDS`] parts of ONE bake are the randomisations, and each texel's variance over
    /// them is known. (As many bakes took four times as long, for compiling the shaders is what takes time.)
    pub(super) fn direct(gpu: &Gpu, scene: &Scene, how: How, chart: Chart) -> Result<Self> {
        Ok(Self::mean_of(&Self::of_texels(gpu, scene, how, &[chart])?[0]))
    }

    /// The same of each of several charts.
    pub(super) fn each_direct(gpu: &Gpu, scene: &Scene, how: How, charts: &[Chart]) -> Result<Vec<Self>> {
        let estimates = Self::of_texels(gpu, scene, how, charts)?;
        Ok(estimates.iter().map(|estimates| Self::mean_of(estimates)).collect())
    }

    /// `[chart][texel]`, over the parts of a bake.
    fn of_texels(gpu: &Gpu, scene: &Scene, how: How, charts: &[Chart]) -> Result<Vec<Vec<Self>>> {
        let part = how.samples / SEEDS as u32;
        debug_assert_eq!(how.samples % (64 * SEEDS as u32), 0, "parts are whole quanta");
        let mut baker = begin(gpu, scene, how, 0)?;
        let maps: Result<Vec<LightMap>> = (1..=SEEDS as u32).map(|run| go_on(&mut baker, run * part)).collect();
        let maps = maps?;
        let of_chart = |chart: &Chart| {
            let means: Vec<Vec<f64>> = maps.iter().map(|map| irradiance(map, *chart)).collect::<Result<_>>()?;
            let sum = |run: usize, texel: usize| if run == 0 { 0.0 } else { means[run - 1][texel] * run as f64 };
            let of_texel = |texel| {
                let parts = (0..maps.len()).map(|run| sum(run + 1, texel) - sum(run, texel));
                Self::over(&parts.collect::<Vec<_>>())
            };
            Ok((0..means[0].len()).map(of_texel).collect())
        };
        charts.iter().map(of_chart).collect()
    }

    /// Of independent ones, whose means may differ.
    pub(super) fn mean_of(estimates: &[Self]) -> Self {
        let count = estimates.len() as f64;
        let mean = estimates.iter().map(|estimate| estimate.mean).sum::<f64>() / count;
        let squares = estimates.iter().map(|estimate| estimate.standard_error.powi(2)).sum::<f64>();
        Self { mean, standard_error: squares.sqrt() / count }
    }

    pub(super) fn times(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, standard_error: self.standard_error * factor }
    }

    /// Over independent figures with the same mean.
    pub(super) fn over(figures: &[f64]) -> Self {
        let (mean, runs) = (mean_of(figures), figures.len() as f64);
        let squares = figures.iter().map(|figure| (figure - mean).powi(2)).sum::<f64>();
        Self { mean, standard_error: (squares / (runs * (runs - 1.0))).sqrt() }
    }
}
