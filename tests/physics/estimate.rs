//! Bakes, and what several randomisations of a bake tell.

use crate::stage::{Chart, SIDE};
use lightoven::baker::{BakeSettings, Baker, Bounces, LightMap, Outcome, Statistics, Stop};
use lightoven::gpu::Gpu;
use lightoven::scene::{Resolution, Scene};
use std::ops::ControlFlow;

/// Independent randomisations behind a standard error.
pub(crate) const SEEDS: u64 = 8;

/// Bakes this many rays a texel.
pub(crate) fn bake(gpu: &Gpu, scene: &Scene, samples: u32, bounces: Bounces, seed: u64) -> (LightMap, Statistics) {
    let resolution = Resolution::Texels(SIDE);
    let mut baker = Baker::new(gpu, scene, &BakeSettings { resolution, bounces, seed, ..Default::default() }).unwrap();
    assert!(baker.atlas().shared, "the charts are where the test put them");
    let stop = Stop { samples: Some(samples), ..Stop::default() };
    let outcome = baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome, Outcome::Finished);
    let map = baker.read_back().unwrap();
    assert!(map.pixels.iter().flatten().all(|value| value.is_finite()));
    (map, baker.statistics().clone())
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

fn mean_of(values: &[f64]) -> f64 {
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
    pub(crate) fn of(
        gpu: &Gpu,
        scene: &Scene,
        samples: u32,
        bounces: Bounces,
        figure: impl Fn(&LightMap) -> f64,
    ) -> Self {
        let figures: Vec<f64> = (0..SEEDS).map(|seed| figure(&bake(gpu, scene, samples, bounces, seed).0)).collect();
        let mean = mean_of(&figures);
        let squares = figures.iter().map(|figure| (figure - mean).powi(2)).sum::<f64>();
        let runs = SEEDS as f64;
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
