//! `lightoven variance`: how noisy one ray is, by each way of sampling.

use crate::arguments::Variance;
use crate::noise::{Noise, Reference, Sums};
use crate::progress::{Bar, Visibility};
use crate::report::write_json;
use crate::values::Way;
use crate::{Ending, device, interrupt, load, messages, paths};
use lightoven::baker::{BakeSettings, Baker, LightMap, Outcome, Statistics, Stop};
use lightoven::gpu::Gpu;
use lightoven::scene::Scene;
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;
use std::fmt::Write as _;
use std::ops::ControlFlow;

/// The bakes that are measured have seeds from 1 on.
const REFERENCE_SEED: u64 = 0;

/// Bakes a reference and all the others, says how they differ.
pub(crate) fn run(arguments: &Variance) -> Result<Ending> {
    let inputs = load::files(&arguments.scene, &arguments.how);
    paths::check(&inputs, &[("--report", arguments.report.as_ref())])?;
    interrupt::install_saying("interrupted: stopping")?;
    let bar = Bar::new(Visibility::Shown);
    bar.say("loading");
    let scene = load::scene(&arguments.scene, &arguments.how)?;
    bar.say("preparing");
    let headless = device::open(&arguments.device)?;
    let mut bench = Bench { arguments, scene: &scene, gpu: headless.gpu(), bar: &bar, done: 0.0 };
    let measured = bench.measure()?;
    device::fail_on_validation(&headless)?;
    drop(bar);
    let Some(report) = measured else {
        messages::line("interrupted before all bakes were done: there are no figures, and nothing is written");
        return Ok(Ending::Interrupted);
    };
    messages::stdout(&report.text())?;
    if let Some(path) = &arguments.report {
        write_json(path, &report)?;
    }
    Ok(Ending::Done)
}

/// What all bakes have in common.
struct Bench<'a> {
    arguments: &'a Variance,
    scene: &'a Scene,
    gpu: &'a Gpu,
    bar: &'a Bar,
    /// Samples a texel of the bakes that are done.
    done: f64,
}

/// Which bake of all.
struct Task {
    name: String,
    way: Way,
    seed: u64,
    samples: u32,
}

struct Baked {
    light_map: LightMap,
    statistics: Statistics,
}

impl Bench<'_> {
    /// `None` when it was interrupted.
    fn measure(&mut self) -> Result<Option<Report>> {
        let samples = self.arguments.reference_samples;
        let task = Task { name: "reference".into(), way: Way::AUTO, seed: REFERENCE_SEED, samples };
        let Some(Baked { light_map, statistics }) = self.bake(task)? else { return Ok(None) };
        let Some(reference) = Reference::new(&light_map.pixels) else {
            return Err(self.nothing_counts("no texel of the reference is lit"));
        };
        let mut rows: Vec<Row> = Vec::new();
        for way in &self.arguments.sampling {
            let Some(row) = self.row(*way, &reference, rows.first())? else { return Ok(None) };
            rows.push(row);
        }
        let samples = rows.first().map_or(0.0, |row| row.samples_per_texel);
        let info = self.gpu.info();
        Ok(Some(Report {
            scene: self.scene.name().to_owned(),
            device: info.name.clone(),
            driver: info.driver.clone(),
            backend: self.gpu.backend().name(),
            resolution: [light_map.width, light_map.height],
            texels: reference.texels(),
            seeds: self.arguments.seeds,
            reference: ReferenceReport {
                seed: REFERENCE_SEED,
                samples_per_texel: statistics.samples_per_texel,
                estimated_error: statistics.estimated_error,
                adds_mean_variance: statistics.estimated_error.map(|error| samples * f64::from(error).powi(2)),
            },
            samplings: rows,
        }))
    }

    /// All seeds of one way of sampling; `first` is the row to compare with, or none for that row itself.
    fn row(&mut self, way: Way, reference: &Reference, first: Option<&Row>) -> Result<Option<Row>> {
        let (name, seeds) = (way.name(), self.arguments.seeds);
        let (mut sums, mut samples, mut rays, mut seconds) = (Sums::new(reference), 0.0, 0, 0.0);
        for seed in 1..=seeds {
            let name = format!("{name} {seed}/{seeds}");
            let task = Task { name, way, seed: seed.into(), samples: self.arguments.samples };
            let Some(Baked { light_map, statistics }) = self.bake(task)? else { return Ok(None) };
            sums.add(&light_map.pixels);
            samples = statistics.samples_per_texel;
            rays += statistics.rays;
            seconds += statistics.seconds.bake;
        }
        let Some(noise) = sums.noise(samples) else {
            return Err(self.nothing_counts(&format!("no texel is a finite number in all bakes by {name}")));
        };
        let first_noise = first.map_or(&noise, |row| &row.noise);
        let ratio = |first: f64, this: f64| (this > 0.0).then_some(first / this);
        Ok(Some(Row {
            sampling: name,
            samples_per_texel: samples,
            mrays_per_s: rays as f64 / seconds.max(1e-9) / 1e6,
            mean_variance_ratio: ratio(first_noise.mean_variance, noise.mean_variance),
            median_sd_ratio: ratio(first_noise.median_sd, noise.median_sd),
            noise,
        }))
    }

    fn bake(&mut self, task: Task) -> Result<Option<Baked>> {
        let Variance { how, bounces, sampling, seeds, samples, reference_samples, .. } = self.arguments;
        let bakes = sampling.len() as f64 * f64::from(*seeds);
        let all = f64::from(*reference_samples) + bakes * f64::from(*samples);
        let part = self.done / all..(self.done + f64::from(task.samples)) / all;
        let settings = BakeSettings {
            resolution: how.resolution(),
            bounces: *bounces,
            sampling: task.way.sampling,
            aimed_by: task.way.aimed_by,
            seed: task.seed,
            ..BakeSettings::default()
        };
        let mut baker = Baker::new(self.gpu, self.scene, &settings)?;
        load::check_has_noise(&baker, self.scene)?;
        // Said once, however often it is traced.
        load::layout_warning(baker.atlas()).iter().for_each(|warning| tracing::warn!("{warning}"));
        let stop = Stop { samples: Some(task.samples), ..Stop::default() };
        let outcome = baker.bake(&stop, &mut |progress| {
            self.bar.show_part(task.name.clone(), progress, part.clone());
            if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if outcome == Outcome::Interrupted {
            return Ok(None);
        }
        self.done += f64::from(task.samples);
        let light_map = baker.read_back()?;
        Ok(Some(Baked { light_map, statistics: baker.statistics().clone() }))
    }

    fn nothing_counts(&self, why: &str) -> Error {
        let name = self.arguments.scene.display();
        Error::new(ErrorKind::InvalidScene, format!("cannot measure the variance of '{name}': {why}"))
    }
}

/// The report of a measurement. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    device: String,
    driver: String,
    backend: &'static str,
    /// Width and height in texels.
    resolution: [u32; 2],
    /// Texels that count.
    texels: usize,
    /// Bakes for each way of sampling.
    seeds: u32,
    reference: ReferenceReport,
    /// In the order that was asked for.
    samplings: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct ReferenceReport {
    seed: u64,
    samples_per_texel: f64,
    /// As that of a bake; `null` where there are too few samples to tell.
    estimated_error: Option<f32>,
    /// About what the reference's own noise adds to each `mean_variance`.
    adds_mean_variance: Option<f64>,
}

/// One way of sampling.
#[derive(Debug, Serialize)]
struct Row {
    sampling: String,
    /// Of each bake.
    samples_per_texel: f64,
    #[serde(flatten)]
    noise: Noise,
    /// Rays of all bakes, those of bounces included, over the time of baking, in millions.
    mrays_per_s: f64,
    /// The first row's `mean_variance` over this one's; `null` where that is 0.
    mean_variance_ratio: Option<f64>,
    /// The first row's `median_sd` over this one's; `null` where that is 0.
    median_sd_ratio: Option<f64>,
}

impl Report {
    /// A table for people.
    fn text(&self) -> String {
        let [width, height] = self.resolution;
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "scene      {}", self.scene);
        let _ = writeln!(text, "device     {}, {} back end", self.device, self.backend);
        let _ = writeln!(text, "map        {width} x {height}, {} texels count", self.texels);
        let _ = writeln!(text, "reference  {}", self.reference.text());
        let samples = self.samplings.first().map_or(0.0, |row| row.samples_per_texel);
        let _ = writeln!(text, "bakes      {} of {samples:.0} samples a texel for each way of sampling", self.seeds);
        let _ = writeln!(text, "relative, a ray:");
        let [mean, median] = ["first / mean", "first / median"];
        let _ = writeln!(
            text,
            "{:<13} mean variance   median SD      p90 SD    energy   Mrays/s  {mean}  {median}",
            "sampling"
        );
        for row in &self.samplings {
            let _ = writeln!(text, "{}", row.line());
        }
        for row in self.samplings.iter().filter(|row| row.noise.not_finite > 0) {
            let _ = writeln!(text, "not finite by {}, left out: {} texels", row.sampling, row.noise.not_finite);
        }
        text
    }
}

impl ReferenceReport {
    fn text(&self) -> String {
        let noise = match self.estimated_error.zip(self.adds_mean_variance) {
            Some((error, adds)) => {
                format!("estimated error {:.2} %, which adds some {adds:.3e} to each mean variance", 100.0 * error)
            }
            None => "its error is not known: it has too few samples".into(),
        };
        format!("{:.0} samples a texel, {noise}", self.samples_per_texel)
    }
}

impl Row {
    fn line(&self) -> String {
        let Noise { mean_variance, median_sd, p90_sd, energy_ratio, .. } = self.noise;
        let ratio = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.3}"));
        let [mean, median] = [self.mean_variance_ratio, self.median_sd_ratio].map(ratio);
        format!(
            "{:<13} {mean_variance:>13.4e} {median_sd:>11.4} {p90_sd:>11.4} {energy_ratio:>9.5} {:>9.2} {mean:>13} \
             {median:>15}",
            self.sampling, self.mrays_per_s
        )
    }
}
