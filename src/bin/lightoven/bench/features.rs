//! `lightoven bench --features`: what each thing that the scene does not need would cost if it were there all the same.

use super::figures::Spread;
use crate::arguments::Bench;
use crate::progress::Bar;
use crate::{device, interrupt};
use lightoven::baker::{BakeSettings, Baker, ErrorEstimate, Stop, estimate_memory};
use lightoven::gpu::Gpu;
use lightoven::scene::Scene;
use lightoven::{Error, ErrorKind, Features, Result};
use serde::Serialize;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Instant;

/// Rays a texel of a pass, as a bake's quanta have.
const PASS_RAYS: u32 = 64;

/// The report of `bench --features`. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    scene: String,
    device: String,
    driver: String,
    backend: &'static str,
    /// Texels that take rays.
    texels: u64,
    rounds: u32,
    /// Which way rays are sent.
    sampling: String,
    /// The first is without any, the last with all.
    rows: Vec<Row>,
    seconds: Seconds,
}

#[derive(Debug, Serialize)]
struct Seconds {
    /// The whole command.
    total: f64,
}

/// A bake with what it does not need.
#[derive(Debug, Serialize)]
struct Row {
    /// What was switched on: names of features, in capitals.
    switched_on: Vec<String>,
    /// Millions.
    mrays_per_s: Spread,
    /// Of a pass of 64 rays a texel, milliseconds.
    pass_ms: Spread,
    /// Time over that without any, round by round.
    time_ratio: Spread,
    /// Device memory that the bake holds, bytes, and one without any.
    bytes: u64,
    least_bytes: u64,
    /// Setting the bake up: layout, upload, g-buffer, and finding what rays can be aimed at; without compiling.
    set_up_seconds: f64,
    /// Making the pipelines and using each of them once, seconds: next to nothing where the driver has kept them.
    compile_seconds: f64,
    /// SPIR-V of the pipelines, bytes.
    spirv_bytes: u64,
}

/// A bake that goes on round by round.
struct Subject {
    switched_on: Features,
    baker: Baker,
    set_up_seconds: f64,
    alone: Alone,
    /// Seconds and rays of each round.
    rounds: Vec<(f64, u64)>,
}

/// What a bake takes that is alone on its device.
#[derive(Debug, Clone, Copy, Default)]
struct Alone {
    bytes: u64,
    compile_seconds: f64,
    spirv_bytes: u64,
}

/// Nothing that the scene is not known to need.
fn settings(arguments: &Bench, unneeded: Features) -> BakeSettings {
    let resolution = arguments.how.resolution();
    BakeSettings {
        resolution,
        sampling: arguments.sampling.sampling,
        aimed_by: arguments.sampling.aimed_by,
        error: ErrorEstimate::None,
        unneeded,
        ..BakeSettings::default()
    }
}

impl Subject {
    fn new(gpu: &Gpu, arguments: &Bench, scene: &Scene, switched_on: Features) -> Result<Self> {
        let settings = settings(arguments, switched_on);
        let (baker, rounds) = (Baker::new(gpu, scene, &settings)?, Vec::new());
        let seconds = baker.statistics().seconds;
        let set_up_seconds = seconds.gbuffer + seconds.aiming;
        let mut subject = Self { switched_on, baker, set_up_seconds, alone: Alone::default(), rounds };
        // Past the bounces, and what compiles at its first use.
        subject.round(1)?;
        subject.rounds.clear();
        let compile_seconds = subject.baker.statistics().seconds.compile;
        let (bytes, spirv_bytes) = (gpu.allocated_bytes(), gpu.objects().spirv_bytes);
        subject.alone = Alone { bytes, compile_seconds, spirv_bytes };
        Ok(subject)
    }

    /// Goes on until there are so many passes.
    fn round(&mut self, passes: u32) -> Result<()> {
        let told = |baker: &Baker| (baker.statistics().seconds.bake, baker.statistics().rays);
        let before = told(&self.baker);
        let stop = Stop { samples: Some(passes * PASS_RAYS), ..Stop::default() };
        self.baker.bake(&stop, &mut |_| ControlFlow::Continue(()))?;
        let after = told(&self.baker);
        self.rounds.push((after.0 - before.0, after.1 - before.1));
        Ok(())
    }

    fn row(&self, least: &Self) -> Option<Row> {
        let ns = |(seconds, rays): &(f64, u64)| seconds / (*rays as f64).max(1.0);
        let rays_of_pass = self.baker.statistics().texels as f64 * f64::from(PASS_RAYS);
        let of = |figure: &dyn Fn(f64) -> f64| Spread::of(self.rounds.iter().map(|round| figure(ns(round))));
        let ratios = self.rounds.iter().zip(&least.rounds).map(|(one, other)| ns(one) / ns(other).max(1e-15));
        Some(Row {
            switched_on: self.switched_on.iter_names().map(|(name, _)| name.to_owned()).collect(),
            mrays_per_s: of(&|seconds| 1e-6 / seconds.max(1e-15))?,
            pass_ms: of(&|seconds| 1e3 * seconds * rays_of_pass)?,
            time_ratio: Spread::of(ratios)?,
            bytes: self.alone.bytes,
            least_bytes: least.alone.bytes,
            set_up_seconds: self.set_up_seconds,
            compile_seconds: self.alone.compile_seconds,
            spirv_bytes: self.alone.spirv_bytes,
        })
    }
}

/// `None` when it was interrupted.
///
/// # Errors
/// `InvalidSettings` for a scene that needs everything; `InvalidScene` for one that can only be dark, or needs no rays.
pub(super) fn measure(arguments: &Bench, scene: &Scene, bar: &Bar, start: Instant) -> Result<Option<Report>> {
    if estimate_memory(scene, &settings(arguments, Features::empty()))?.1.is_dark {
        let context = format!("nothing shines in '{}', or nothing is lit: there is nothing to measure", scene.name());
        return Err(Error::new(ErrorKind::InvalidScene, context));
    }
    let device = device::open(&arguments.device)?;
    let gpu = device.gpu();
    let needed = Features::required(scene, &settings(arguments, Features::empty()));
    if !needed.contains(Features::GATHERING) {
        let context = format!("'{}' has no light that rays could find: there is nothing to measure", scene.name());
        return Err(Error::new(ErrorKind::InvalidScene, context));
    }
    let unneeded = Features::LEFT_OUT_AT_WILL.difference(needed);
    if unneeded.is_empty() {
        let context = "the scene needs all that could be left out: there is nothing to measure";
        return Err(Error::new(ErrorKind::InvalidSettings, context));
    }
    let each: Vec<_> = std::iter::once(Features::empty()).chain(unneeded.iter()).chain([unneeded]).collect();
    // Each alone on a device of its own first: bakers of one share their pipelines, and what it has compiled.
    let mut alone = Vec::new();
    for switched_on in &each {
        if interrupt::requested() {
            return Ok(None);
        }
        bar.say(format!("compiling {switched_on:?}"));
        let device = device::open(&arguments.device)?;
        alone.push(Subject::new(device.gpu(), arguments, scene, *switched_on)?.alone);
        device::fail_on_validation(&device)?;
    }
    // What the first bake on a device does for all.
    drop(Subject::new(gpu, arguments, scene, Features::empty())?);
    let mut subjects = Vec::new();
    for (switched_on, alone) in each.into_iter().zip(alone) {
        if interrupt::requested() {
            return Ok(None);
        }
        bar.say(format!("preparing {switched_on:?}"));
        subjects.push(Subject { alone, ..Subject::new(gpu, arguments, scene, switched_on)? });
    }
    // The same work in every round and for all: about as many rays as asked for.
    let texels = subjects[0].baker.statistics().texels;
    let passes = u64::from(arguments.rays).div_ceil((texels * u64::from(PASS_RAYS)).max(1)) as u32;
    for round in 0..arguments.rounds {
        bar.say(format!("round {} of {}", round + 1, arguments.rounds));
        for subject in &mut subjects {
            if interrupt::requested() {
                return Ok(None);
            }
            subject.round(1 + (round + 1) * passes)?;
        }
    }
    device::fail_on_validation(&device)?;
    let rows = subjects.iter().filter_map(|subject| subject.row(&subjects[0])).collect();
    Ok(Some(Report {
        scene: scene.name().to_owned(),
        device: gpu.info().name.clone(),
        driver: gpu.info().driver.clone(),
        backend: gpu.backend().name(),
        sampling: arguments.sampling.name(),
        texels,
        rounds: arguments.rounds,
        rows,
        seconds: Seconds { total: start.elapsed().as_secs_f64() },
    }))
}

impl Report {
    pub(super) fn text(&self) -> String {
        let Self { scene, device, driver, backend, sampling, texels, rounds, .. } = self;
        let mut text = format!(
            "scene    {scene}, {texels} texels\ndevice   {device}, {driver}, {backend}\nsampling {sampling}\nrounds   {rounds}; time and bytes are \
             those of a bake without any of it, and what is added, SPIR-V in KiB and compiling those of all its pipelines\n"
        );
        let mut line = |cells: [&str; 9]| {
            let [name, mrays, pass, ratio, spread, bytes, set_up, spirv, compile] = cells;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{name:<18}{mrays:>9}{pass:>10}{ratio:>9}  {spread:<16}{bytes:>9}{set_up:>10}{spirv:>8}{compile:>11}"
            );
        };
        line(["switched on", "Mrays/s", "pass ms", "time", "", "KiB", "set-up s", "SPIR-V", "compile s"]);
        for row in &self.rows {
            let name = match row.switched_on.as_slice() {
                [] => "none".to_owned(),
                [one] => one.to_lowercase(),
                _ => "all".to_owned(),
            };
            let percent = |ratio: f64| format!("{:+.1} %", 100.0 * (ratio - 1.0));
            let Spread { least, median, most } = row.time_ratio;
            let is_base = row.switched_on.is_empty();
            let (time, spread, kib) = if is_base {
                (String::new(), String::new(), (row.bytes / 1024).to_string())
            } else {
                let spread = format!("{} to {}", percent(least), percent(most));
                (percent(median), spread, format!("+{}", row.bytes.saturating_sub(row.least_bytes) / 1024))
            };
            line([
                &name,
                &format!("{:.2}", row.mrays_per_s.median),
                &format!("{:.1}", row.pass_ms.median),
                &time,
                &spread,
                &kib,
                &format!("{:.3}", row.set_up_seconds),
                &(row.spirv_bytes / 1024).to_string(),
                &format!("{:.2}", row.compile_seconds),
            ]);
        }
        text
    }
}
