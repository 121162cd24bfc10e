//! All bakes of a measurement, one after the other.

use super::figures::{At, Row, Sums, times};
use super::reference::{Light, Source};
use super::report::{Report, Variant, limits};
use crate::arguments::Converge;
use crate::noise::Reference;
use crate::progress::Bar;
use crate::values::Way;
use crate::{interrupt, load};
use lightoven::baker::{BakeSettings, Baker, Outcome, Progress, Stop};
use lightoven::gpu::Gpu;
use lightoven::io::exr::{Metadata, write_light_map};
use lightoven::scene::Scene;
use lightoven::{Error, ErrorKind, Result};
use std::ops::ControlFlow;
use std::time::Duration;

/// The bakes that are measured have seeds from 1 on.
const REFERENCE_SEED: u64 = 0;

/// What all bakes have in common.
pub(super) struct Bench<'a> {
    arguments: &'a Converge,
    scene: &'a Scene,
    /// One for each back end.
    gpus: &'a [&'a Gpu],
    bar: &'a Bar,
    /// When the light maps of a bake are looked at, in its own time.
    times: Vec<Duration>,
    /// Time of the bakes that are done.
    done: Duration,
    /// Time of all bakes.
    all: Duration,
}

/// A way of sampling on a device.
struct Task<'a> {
    way: Way,
    gpu: &'a Gpu,
    /// For each of the times.
    sums: Vec<Sums>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(arguments: &'a Converge, scene: &'a Scene, gpus: &'a [&'a Gpu], bar: &'a Bar) -> Self {
        let bakes = (arguments.sampling.len() * gpus.len()) as u32;
        let measured = arguments.time.saturating_mul(bakes.saturating_mul(arguments.seeds));
        let reference = if arguments.reference.is_some() { Duration::ZERO } else { arguments.reference_time() };
        let all = measured.saturating_add(reference);
        Self { arguments, scene, gpus, bar, times: times(arguments.time), done: Duration::ZERO, all }
    }

    /// `None` when it was interrupted before anything was measured. `light` is that of a reference from a file.
    pub(super) fn measure(&mut self, light: Option<Light>) -> Result<Option<Report>> {
        let Some(light) = light.map_or_else(|| self.bake_reference(), |light| Ok(Some(light)))? else {
            return Ok(None);
        };
        let (gpus, ways) = (self.gpus, &self.arguments.sampling);
        let task = |gpu, way| Task { way, gpu, sums: self.times.iter().map(|_| Sums::default()).collect() };
        let mut tasks: Vec<Task<'_>> = gpus.iter().flat_map(|gpu| ways.iter().map(|way| task(*gpu, *way))).collect();
        let mut reference = None;
        let interrupted = self.bake_all(&mut tasks, &light, &mut reference)?.is_break();
        let Some(reference) = reference else { return Ok(None) };
        // A time that the first pass of some bake took longer than is left out; an interruption leaves fewer bakes.
        let whole = |row: &Row| interrupted || row.seeds == self.arguments.seeds;
        let rows = |task: &Task<'_>| -> Vec<Row> {
            task.sums.iter().filter_map(|sums| sums.row(&reference)).filter(whole).collect()
        };
        let noise = light.source.relmse;
        let variant = |task: &Task<'_>| Variant::new(task.way.name(), task.gpu.backend().name(), rows(task), noise);
        let variants: Vec<Variant> = tasks.iter().map(variant).collect();
        if !interrupted && let Some(broken) = variants.iter().find(|variant| variant.rows.is_empty()) {
            return Err(self.nothing_counts(&format!("no texel is a finite number in all bakes by {}", broken.name())));
        }
        let info = gpus[0].info();
        Ok(Some(Report {
            scene: self.scene.name().to_owned(),
            device: info.name.clone(),
            driver: info.driver.clone(),
            resolution: light.size,
            texels: reference.texels(),
            seeds: self.arguments.seeds,
            limits: limits(&light.source, &variants),
            reference: light.source,
            variants,
            interrupted,
        }))
    }

    /// The seeds one after the other, so that what slows the machine down for a while slows all variants down.
    fn bake_all(
        &mut self,
        tasks: &mut [Task<'_>],
        light: &Light,
        reference: &mut Option<Reference>,
    ) -> Result<ControlFlow<()>> {
        for seed in 1..=self.arguments.seeds {
            for task in tasks.iter_mut() {
                if self.bake(task, seed, light, reference)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// One bake, looked at on the way. `reference` is made from the light at the first look.
    fn bake(
        &mut self,
        task: &mut Task<'_>,
        seed: u32,
        light: &Light,
        reference: &mut Option<Reference>,
    ) -> Result<ControlFlow<()>> {
        let name = format!("{} {seed}/{}", task.way.name(), self.arguments.seeds);
        let mut baker = self.baker(task.gpu, task.way, seed.into())?;
        let mut elapsed = Duration::ZERO;
        for (index, time) in self.times.iter().enumerate() {
            let stop = Stop { time: Some(*time), ..Stop::default() };
            let outcome = baker.bake_until(&stop, &mut |progress| {
                elapsed = progress.elapsed;
                self.watch(&name, progress, *time)
            })?;
            if outcome == Outcome::Interrupted {
                return Ok(ControlFlow::Break(()));
            }
            // The first pass took until the next look, or longer.
            if self.times.get(index + 1).is_some_and(|next| elapsed >= *next) {
                continue;
            }
            let statistics = baker.statistics();
            let (rays, samples_per_texel) = (statistics.rays, statistics.samples_per_texel);
            let pixels = baker.read_back()?.pixels;
            if reference.is_none() {
                *reference = light.reference(&pixels);
            }
            let Some(reference) = &*reference else {
                return Err(self.nothing_counts("no texel is covered, and lit in the reference"));
            };
            task.sums[index].add(reference, At { seconds: elapsed.as_secs_f64(), rays, samples_per_texel }, &pixels);
        }
        self.done += self.arguments.time;
        Ok(ControlFlow::Continue(()))
    }

    /// `None` when it was interrupted.
    fn bake_reference(&mut self) -> Result<Option<Light>> {
        let (gpu, way, time) = (self.gpus[0], Way::AUTO, self.arguments.reference_time());
        let mut baker = self.baker(gpu, way, REFERENCE_SEED)?;
        let mut elapsed = Duration::ZERO;
        let outcome = baker.bake(&Stop { time: Some(time), ..Stop::default() }, &mut |progress| {
            elapsed = progress.elapsed;
            self.watch("reference", progress, time)
        })?;
        if outcome == Outcome::Interrupted {
            return Ok(None);
        }
        self.done += time;
        let (light_map, statistics) = (baker.read_back()?, baker.statistics());
        let (samples_per_texel, estimated_error) = (statistics.samples_per_texel, statistics.estimated_error);
        if let Some(path) = &self.arguments.save_reference {
            let metadata = Metadata {
                scene: self.scene.name().to_owned(),
                seed: REFERENCE_SEED,
                samples: samples_per_texel,
                device: gpu.info().name.clone(),
                version: concat!("lightoven ", env!("CARGO_PKG_VERSION")).to_owned(),
            };
            write_light_map(path, &light_map, &metadata)?;
        }
        let source = Source {
            file: None,
            scale: 1.0,
            sampling: Some(way.name()),
            backend: Some(gpu.backend().name()),
            seed: Some(REFERENCE_SEED),
            seconds: Some(elapsed.as_secs_f64()),
            samples_per_texel: Some(samples_per_texel),
            estimated_error,
            relmse: estimated_error.map(|error| f64::from(error).powi(2)),
        };
        Ok(Some(Light { size: [light_map.width, light_map.height], pixels: light_map.pixels, source }))
    }

    fn baker(&self, gpu: &Gpu, Way { sampling, aimed_by }: Way, seed: u64) -> Result<Baker> {
        let (resolution, bounces) = (self.arguments.how.resolution(), self.arguments.bounces);
        let settings = BakeSettings { resolution, bounces, sampling, aimed_by, seed, ..BakeSettings::default() };
        let baker = Baker::new(gpu, self.scene, &settings)?;
        load::check_has_noise(&baker, self.scene)?;
        // Said once, however often it is traced.
        load::layout_warning(baker.atlas()).iter().for_each(|warning| tracing::warn!("{warning}"));
        Ok(baker)
    }

    /// `time` is what the progress is a part of, from the beginning of its bake on.
    fn watch(&self, name: &str, progress: &Progress, time: Duration) -> ControlFlow<()> {
        let part = |time: Duration| time.as_secs_f64() / self.all.as_secs_f64();
        self.bar.show_part(name.to_owned(), progress, part(self.done)..part(self.done + time));
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn nothing_counts(&self, why: &str) -> Error {
        let name = self.arguments.scene.display();
        Error::new(ErrorKind::InvalidScene, format!("cannot measure the error of '{name}': {why}"))
    }
}
