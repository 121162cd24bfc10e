//! Bakes, and what several randomisations of a bake tell.

use crate::stage::{Chart, SIDE};
use lightoven::baker::{AimedBy, BakeSettings, Baker, Bounces, LightMap, Outcome, Sampling, Statistics, Stop};
use lightoven::gpu::Gpu;
use lightoven::scene::{Resolution, Scene};
use std::ops::ControlFlow;

/// Independent randomisations behind a standard error.
pub(crate) const SEEDS: u64 = 8;

/// Ways of sampling, all with the same means. Rays by importance alone find only what has texels of its own.
pub(crate) const SAMPLINGS: [Sampling; 4] =
    [Sampling::Cosine, Sampling::Importance, Sampling::Mixture { cosine: 0.5 }, Sampling::Mixture { cosine: 0.1 }];
/// Those that aim some rays and send some by the cosine.
pub(crate) const MIXTURES: [Sampling; 2] = [Sampling::Mixture { cosine: 0.5 }, Sampling::Mixture { cosine: 0.1 }];

/// How a test bakes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct How {
    /// Rays a texel.
    pub(crate) samples: u32,
    pub(crate) bounces: Bounces,
    pub(crate) sampling: Sampling,
    pub(crate) aimed_by: AimedBy,
    /// Side of the light map, texels.
    pub(crate) side: u32,
}

impl How {
    /// Rays as the baker likes, in a light map of the usual side.
    pub(crate) fn new(samples: u32, bounces: Bounces) -> Self {
        Self { samples, bounces, sampling: Sampling::Auto, aimed_by: AimedBy::default(), side: SIDE }
    }

    pub(crate) fn by(self, sampling: Sampling) -> Self {
        Self { sampling, ..self }
    }

    pub(crate) fn aimed(self, aimed_by: AimedBy) -> Self {
        Self { aimed_by, ..self }
    }

    pub(crate) fn on(self, side: u32) -> Self {
        Self { side, ..self }
    }
}

pub(crate) fn bake(gpu: &Gpu, scene: &Scene, how: How, seed: u64) -> (LightMap, Statistics) {
    let mut baker = begin(gpu, scene, how, seed);
    let map = go_on(&mut baker, how.samples);
    (map, baker.statistics().clone())
}

fn begin(gpu: &Gpu, scene: &Scene, how: How, seed: u64) -> Baker {
    let How { bounces, sampling, aimed_by, side, samples: _ } = how;
    let resolution = Resolution::Texels(side);
    let settings = BakeSettings { resolution, bounces, sampling, aimed_by, seed, ..Default::default() };
    let baker = Baker::new(gpu, scene, &settings).unwrap();
    assert!(baker.atlas().shared, "the charts are where the test put them");
    baker
}

fn go_on(baker: &mut Baker, samples: u32) -> LightMap {
    let stop = Stop { samples: Some(samples), ..Stop::default() };
    let outcome = baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome, Outcome::Finished);
    let map = baker.read_back().unwrap();
    assert!(map.pixels.iter().flatten().all(|value| value.is_finite()));
    map
}

/// Irradiance of the texels that lie whole in a chart, row-major, red.
pub(crate) fn irradiance(map: &LightMap, chart: Chart) -> Vec<f64> {
    let texel = |(texel, _)| {
        let [red, _, _, alpha]: [f32; 4] = map.pixels[texel];
        assert_eq!(alpha, 1.0, "texel {texel} is not baked");
        f64::from(red)
    };
    chart.texels().map(texel).collect()
}

pub(crate) fn mean(map: &LightMap, chart: Chart) -> f64 {
    mean_of(&irradiance(map, chart))
}

pub(crate) fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// A figure over [`SEEDS`] randomisations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate {
    pub(crate) mean: f64,
    pub(crate) standard_error: f64,
}

impl Estimate {
    /// What `figure` is of a bake, over seeds.
    pub(crate) fn of(gpu: &Gpu, scene: &Scene, how: How, figure: impl Fn(&LightMap) -> f64) -> Self {
        let figures: Vec<f64> = (0..SEEDS).map(|seed| figure(&bake(gpu, scene, how, seed).0)).collect();
        Self::over(&figures)
    }

    /// The mean of a chart's irradiance where no light is reflected: the rays of texels, and those that a bake goes on with,
    /// then have nothing in common. [`SEEDS`] parts of ONE bake are the randomisations, and each texel's variance over
    /// them is known. (As many bakes took four times as long, for compiling the shaders is what takes time.)
    pub(crate) fn direct(gpu: &Gpu, scene: &Scene, how: How, chart: Chart) -> Self {
        Self::mean_of(&Self::of_texels(gpu, scene, how, &[chart])[0])
    }

    /// The same of each of several charts.
    pub(crate) fn each_direct(gpu: &Gpu, scene: &Scene, how: How, charts: &[Chart]) -> Vec<Self> {
        Self::of_texels(gpu, scene, how, charts).iter().map(|estimates| Self::mean_of(estimates)).collect()
    }

    /// `[chart][texel]`, over the parts of a bake.
    fn of_texels(gpu: &Gpu, scene: &Scene, how: How, charts: &[Chart]) -> Vec<Vec<Self>> {
        let part = how.samples / SEEDS as u32;
        assert_eq!(how.samples % (64 * SEEDS as u32), 0, "parts are whole quanta");
        let mut baker = begin(gpu, scene, how, 0);
        let maps: Vec<LightMap> = (1..=SEEDS as u32).map(|run| go_on(&mut baker, run * part)).collect();
        let of_chart = |chart: &Chart| {
            let means: Vec<Vec<f64>> = maps.iter().map(|map| irradiance(map, *chart)).collect();
            let sum = |run: usize, texel: usize| if run == 0 { 0.0 } else { means[run - 1][texel] * run as f64 };
            let of_texel = |texel| {
                let parts = (0..maps.len()).map(|run| sum(run + 1, texel) - sum(run, texel));
                Self::over(&parts.collect::<Vec<_>>())
            };
            (0..means[0].len()).map(of_texel).collect()
        };
        charts.iter().map(of_chart).collect()
    }

    /// Of independent ones, whose means may differ.
    pub(crate) fn mean_of(estimates: &[Self]) -> Self {
        let count = estimates.len() as f64;
        let mean = estimates.iter().map(|estimate| estimate.mean).sum::<f64>() / count;
        let squares = estimates.iter().map(|estimate| estimate.standard_error.powi(2)).sum::<f64>();
        Self { mean, standard_error: squares.sqrt() / count }
    }

    pub(crate) fn times(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, standard_error: self.standard_error * factor }
    }

    /// Over independent figures with the same mean.
    pub(crate) fn over(figures: &[f64]) -> Self {
        let (mean, runs) = (mean_of(figures), figures.len() as f64);
        assert!(figures.len() as u64 >= SEEDS);
        let squares = figures.iter().map(|figure| (figure - mean).powi(2)).sum::<f64>();
        Self { mean, standard_error: (squares / (runs * (runs - 1.0))).sqrt() }
    }

    /// Within 4 standard errors and `tolerance`, which is what the case allows beside noise.
    ///
    /// 4 standard errors are at most `resolution`: an estimate that tells nothing does not pass.
    pub(crate) fn assert_is(&self, what: &str, gpu: &Gpu, expected: f64, tolerance: f64, resolution: f64) {
        let Self { mean, standard_error } = *self;
        let error = mean - expected;
        println!(
            "{what}, {}: {mean:.7}, closed form {expected:.7}: off by {error:.2e}, standard error {standard_error:.2e}",
            gpu.backend().name()
        );
        assert!(4.0 * standard_error <= resolution, "{what}: a standard error of {standard_error:e} tells too little");
        assert!(error.abs() <= 4.0 * standard_error + tolerance, "{what}: {mean} is not {expected}");
    }
}
