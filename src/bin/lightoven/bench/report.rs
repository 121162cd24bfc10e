//! What is said when all rounds are done: as JSON with stable names, and as a table for people.

use super::figures::{Agreement, Each, Speeds, Spread};
use crate::arguments::OrderArgument;
use serde::Serialize;
use std::fmt::Write as _;

/// The report of a benchmark. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) scene: String,
    pub(crate) triangles: usize,
    pub(crate) instances: usize,
    pub(crate) device: String,
    pub(crate) driver: String,
    pub(crate) cpu: CpuReport,
    /// Of a round, for each query.
    pub(crate) rays: usize,
    pub(crate) rounds: u32,
    pub(crate) order: OrderArgument,
    /// Medians, million rays a second; `null` where there is no such back end, or it was not asked for.
    closest: Each<Option<f64>>,
    occluded: Each<Option<f64>>,
    /// Medians of the rounds' ratios, of closest hits.
    software_to_cpu: Option<f64>,
    software_to_ray_query: Option<f64>,
    spread: Spreads,
    pub(crate) agreement: Agreement,
    pub(crate) gather: Gather,
    pub(crate) seconds: Seconds,
}

/// The same with least and most, million rays a second, and ratios.
#[derive(Debug, Serialize)]
pub(crate) struct Spreads {
    pub(crate) closest: Speeds,
    pub(crate) occluded: Speeds,
}

/// How obvhs traced.
#[derive(Debug, Serialize)]
pub(crate) struct CpuReport {
    /// Which of its hierarchies was the fastest.
    pub(crate) hierarchy: &'static str,
    pub(crate) threads: usize,
    /// Instruction sets that the tool was compiled for.
    pub(crate) target_features: Vec<&'static str>,
}

/// A pass of a bake over the whole light map, by the cosine.
#[derive(Debug, Serialize)]
pub(crate) struct Gather {
    pub(crate) backend: &'static str,
    /// Width and height in texels.
    pub(crate) resolution: [u32; 2],
    /// Texels that take rays.
    pub(crate) texels: u32,
    pub(crate) rays_per_texel: u32,
    pub(crate) milliseconds: Option<Spread>,
    pub(crate) mrays_per_s: Option<Spread>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Seconds {
    /// Building the hierarchy on the host, on all cores.
    pub(crate) bvh: f64,
    /// The whole command.
    pub(crate) total: f64,
}

/// What a report is about, beside speeds.
pub(crate) struct Subject {
    pub(crate) scene: String,
    pub(crate) triangles: usize,
    pub(crate) instances: usize,
    pub(crate) order: OrderArgument,
    pub(crate) device: String,
    pub(crate) driver: String,
    pub(crate) cpu: CpuReport,
}

impl Gather {
    /// Gives it its figures.
    pub(crate) fn timed(mut self, seconds: &[f64]) -> Self {
        let millions = f64::from(self.texels) * f64::from(self.rays_per_texel) * 1e-6;
        self.milliseconds = Spread::of(seconds.iter().map(|seconds| 1e3 * seconds));
        self.mrays_per_s = Spread::of(seconds.iter().map(|seconds| millions / seconds.max(1e-9)));
        self
    }
}

impl Report {
    pub(crate) fn new(
        subject: Subject,
        rays: usize,
        rounds: u32,
        spread: Spreads,
        agreement: Agreement,
        gather: Gather,
        seconds: Seconds,
    ) -> Self {
        let Subject { scene, triangles, instances, order, device, driver, cpu } = subject;
        let median = |spread: Option<Spread>| spread.map(|spread| spread.median);
        Self {
            scene,
            triangles,
            instances,
            device,
            driver,
            cpu,
            rays,
            rounds,
            order,
            closest: spread.closest.medians(),
            occluded: spread.occluded.medians(),
            software_to_cpu: median(spread.closest.software_to_cpu),
            software_to_ray_query: median(spread.closest.software_to_ray_query),
            spread,
            agreement,
            gather,
            seconds,
        }
    }

    /// A few lines for people; each ends in a line break.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        let CpuReport { hierarchy, threads, target_features } = &self.cpu;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "scene    {}, {} triangles in {} instances", self.scene, self.triangles, self.instances);
        let _ = writeln!(text, "device   {}, {}", self.device, self.driver);
        let _ = writeln!(text, "obvhs    {hierarchy}, {threads} threads, compiled for {}", target_features.join(" "));
        let order = match self.order {
            OrderArgument::Bake => "the order of a bake",
            OrderArgument::Random => "random order",
        };
        let _ = writeln!(text, "rays     {} from the light map's texels in {order}, {} rounds", self.rays, self.rounds);
        let _ = writeln!(text, "{:<24}    median     least      most", "Mrays/s");
        for (query, speeds) in [("closest hit", &self.spread.closest), ("any hit", &self.spread.occluded)] {
            let Each { software, ray_query, cpu } = speeds.mrays_per_s;
            for (who, spread) in [("software", software), ("ray-query", ray_query), ("obvhs", cpu)] {
                line(&mut text, &format!("{query}, {who}"), spread, 2);
            }
        }
        let _ = writeln!(text, "software over the other");
        for (query, speeds) in [("closest hit", &self.spread.closest), ("any hit", &self.spread.occluded)] {
            line(&mut text, &format!("{query}, obvhs"), speeds.software_to_cpu, 3);
            line(&mut text, &format!("{query}, ray-query"), speeds.software_to_ray_query, 3);
        }
        let Gather { backend, resolution: [width, height], texels, rays_per_texel, milliseconds, mrays_per_s } =
            &self.gather;
        let _ = writeln!(
            text,
            "a pass of {rays_per_texel} rays for each of {texels} texels of {width} x {height}, {backend}"
        );
        line(&mut text, "milliseconds", *milliseconds, 1);
        line(&mut text, "Mrays/s", *mrays_per_s, 2);
        text
    }
}

fn line(text: &mut String, name: &str, spread: Option<Spread>, digits: usize) {
    if let Some(Spread { least, median, most }) = spread {
        let _ = writeln!(text, "  {name:<22}{median:>10.digits$}{least:>10.digits$}{most:>10.digits$}");
    }
}
