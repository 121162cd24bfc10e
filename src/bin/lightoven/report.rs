//! What is said about a bake when it is done: as JSON with stable names, and in short for people.

use lightoven::baker::{Baker, Outcome, SamplingStatistics};
use lightoven::gpu::Gpu;
use lightoven::io::write_beside;
use lightoven::scene::Scene;
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// The report of a bake. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) scene: String,
    pub(crate) device: String,
    pub(crate) driver: String,
    pub(crate) backend: &'static str,
    /// Width and height in texels.
    pub(crate) resolution: [u32; 2],
    /// Texels that a surface covers.
    pub(crate) texels: u64,
    pub(crate) epochs: u32,
    /// Mean over the texels.
    pub(crate) samples_per_texel: f64,
    /// Of the texels that have most.
    pub(crate) most_samples: f64,
    pub(crate) rays: u64,
    /// `rays` over `seconds.bake`, in millions.
    pub(crate) mrays_per_s: f64,
    /// Relative; `null` where there are too few samples to tell.
    pub(crate) estimated_error: Option<f32>,
    pub(crate) sampling: Sampling,
    /// What the bake used: names of features, in capitals.
    pub(crate) features: Vec<&'static str>,
    pub(crate) left_out: Vec<LeftOut>,
    pub(crate) seconds: Seconds,
    pub(crate) warnings: Vec<String>,
    pub(crate) instances: Vec<Place>,
    pub(crate) seed: u64,
    pub(crate) interrupted: bool,
}

/// How rays were sent.
#[derive(Debug, Serialize)]
pub(crate) struct Sampling {
    /// Share of rays sent by the cosine at the end: the mixture's alpha.
    alpha: f32,
    /// Of all rays of the bake.
    shares: Shares,
    /// Share of aimed rays that saw what they were aimed at, lately; those that would begin under the surface count, and
    /// saw nothing. `null` where none was aimed.
    visible: Visible,
    /// 1: all surfaces shine alike; toward 0 the smaller the part that shines. `null` where no ray may be aimed.
    evenness: Option<f32>,
    /// What all surfaces shine: luminance times area. `null` where no ray may be aimed.
    power: Option<f64>,
    pyramids: u64,
}

#[derive(Debug, Serialize)]
struct Shares {
    cosine: f64,
    source: f64,
    sky: f64,
}

#[derive(Debug, Serialize)]
struct Visible {
    source: Option<f32>,
    sky: Option<f32>,
}

impl Sampling {
    fn summary(&self) -> String {
        let aimed = self.shares.source + self.shares.sky;
        let seen = [("the light map", self.visible.source), ("the sky", self.visible.sky)];
        let seen = seen.into_iter().filter_map(|(what, seen)| Some(format!("{:.1} % saw {what}", 100.0 * seen?)));
        let parts: Vec<String> = std::iter::once(format!("{:.0} % of them aimed", 100.0 * aimed)).chain(seen).collect();
        parts.join(", ")
    }

    fn new(statistics: &SamplingStatistics) -> Self {
        let rays = statistics.cosine_rays + statistics.source_rays + statistics.sky_rays;
        let share = |part: u64| part as f64 / rays.max(1) as f64;
        Self {
            alpha: statistics.cosine_share,
            shares: Shares {
                cosine: share(statistics.cosine_rays),
                source: share(statistics.source_rays),
                sky: share(statistics.sky_rays),
            },
            visible: Visible { source: statistics.source_seen, sky: statistics.sky_seen },
            evenness: statistics.evenness,
            power: statistics.power,
            pyramids: statistics.pyramids,
        }
    }
}

/// Where the time went, in seconds. Shader and JIT compilation counts as `compile` alone.
#[derive(Debug, Serialize)]
pub(crate) struct Seconds {
    load: f64,
    bvh: f64,
    gbuffer: f64,
    aiming: f64,
    direct: f64,
    importance: f64,
    bake: f64,
    resolve: f64,
    write: f64,
    compile: f64,
    /// The whole command, from its start.
    total: f64,
}

/// What the scene does not need.
#[derive(Debug, Serialize)]
pub(crate) struct LeftOut {
    what: &'static str,
    /// Of device memory, about; 0 where it saves time alone.
    bytes_saved: u64,
}

/// Where an instance lies: texel = light-map coordinate * scale + offset.
#[derive(Debug, Serialize)]
pub(crate) struct Place {
    name: String,
    scale: [f32; 2],
    offset: [f32; 2],
}

/// The parts of the time that the tool measures itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Measured {
    pub(crate) load: f64,
    pub(crate) write: f64,
    pub(crate) total: f64,
}

impl Report {
    pub(crate) fn new(
        scene: &Scene,
        gpu: &Gpu,
        baker: &Baker,
        outcome: Outcome,
        seed: u64,
        measured: Measured,
        warnings: Vec<String>,
    ) -> Self {
        let (info, statistics, atlas) = (gpu.info(), baker.statistics(), baker.atlas());
        let passes = &statistics.seconds;
        let places = scene.instances().iter().zip(&atlas.rects);
        let left_out = baker.memory_estimate(scene).left_out(scene, atlas);
        Self {
            scene: scene.name().to_owned(),
            device: info.name.clone(),
            driver: info.driver.clone(),
            backend: gpu.backend().name(),
            resolution: atlas.size.to_array(),
            texels: statistics.texels,
            epochs: statistics.epochs,
            samples_per_texel: statistics.samples_per_texel,
            most_samples: statistics.most_samples,
            rays: statistics.rays,
            mrays_per_s: statistics.mrays_per_s,
            estimated_error: statistics.estimated_error,
            sampling: Sampling::new(&statistics.sampling),
            features: baker.features().iter_names().map(|(name, _)| name).collect(),
            left_out: left_out.into_iter().map(|(what, bytes_saved)| LeftOut { what, bytes_saved }).collect(),
            seconds: Seconds {
                load: measured.load,
                bvh: passes.bvh,
                gbuffer: passes.gbuffer,
                aiming: passes.aiming,
                direct: passes.direct,
                importance: passes.importance,
                bake: passes.bake,
                resolve: passes.resolve,
                write: measured.write,
                compile: passes.compile,
                total: measured.total,
            },
            warnings,
            instances: places
                .map(|(instance, rect)| Place {
                    name: instance.name.clone(),
                    scale: rect.scale.to_array(),
                    offset: rect.offset.to_array(),
                })
                .collect(),
            seed,
            interrupted: outcome == Outcome::Interrupted,
        }
    }

    /// A few lines for people; each ends in a line break.
    pub(crate) fn summary(&self) -> String {
        let [width, height] = self.resolution;
        let mut text = String::new();
        let error = self.estimated_error.map_or("not known".into(), |error| format!("{:.2} %", 100.0 * error));
        let seconds = &self.seconds;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "scene    {}", self.scene);
        let _ = writeln!(text, "device   {}, {} back end", self.device, self.backend);
        let _ = writeln!(text, "map      {width} x {height}, {} texels", self.texels);
        let _ = writeln!(
            text,
            "samples  {:.1} a texel in {} epochs, estimated error {error}",
            self.samples_per_texel, self.epochs
        );
        let _ = match self.rays {
            0 => writeln!(text, "rays     none: there is no light for them to find"),
            rays => writeln!(
                text,
                "rays     {:.2} million, {:.2} Mrays/s, {}",
                rays as f64 * 1e-6,
                self.mrays_per_s,
                self.sampling.summary()
            ),
        };
        let _ = writeln!(
            text,
            "seconds  {:.2} in all: load {:.2}, bvh {:.2}, g-buffer {:.2}, direct {:.2}, importance {:.2}, bake {:.2}, resolve {:.2}, \
             write {:.2}, compile {:.2}",
            seconds.total,
            seconds.load,
            seconds.bvh,
            seconds.gbuffer + seconds.aiming,
            seconds.direct,
            seconds.importance,
            seconds.bake,
            seconds.resolve,
            seconds.write,
            seconds.compile
        );
        text
    }
}

/// Writes a report of any kind as JSON, beside and renamed.
pub(crate) fn write_json(path: &Path, report: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(report).map_err(|error| cannot_write(path, error.into()))?;
    write_text(path, &format!("{text}\n"))
}

/// Writes a text, beside and renamed.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    write_beside(path, |file| file.write_all(text.as_bytes()).map_err(|error| cannot_write(path, error.into())))
}

fn cannot_write(path: &Path, error: Box<dyn std::error::Error + Send + Sync>) -> Error {
    Error::new(ErrorKind::Io, format!("cannot write '{}'", path.display())).with_source(error)
}
