//! What is said of a study: as JSON with stable names, and as tables for people.

use lightoven::baker::Bounces;
use lightoven::gpu::Gpu;
use lightoven::verify::study::{Bounced, Decay, Deviation, Stiffness as Room};
use serde::Serialize;
use std::fmt::Write as _;

/// The report of a study. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
#[serde(tag = "study", rename_all = "lowercase")]
pub(super) enum Report {
    Stiffness(Stiffness),
    Precision(Precision),
}

#[derive(Debug, Serialize)]
pub(super) struct Stiffness {
    pub(super) device: String,
    backend: &'static str,
    pub(super) rooms: Vec<RoomReport>,
}

/// A closed room of one albedo. Shares of the irradiance of the closed form.
#[derive(Debug, Serialize)]
pub(super) struct RoomReport {
    pub(super) albedo: f64,
    pub(super) rows: Vec<Row>,
    automatic: Row,
    /// Bounces one by one after which as little is missing as is promised.
    one_by_one: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Row {
    pub(super) bounces: u32,
    /// albedo^(bounces + 1)
    pub(super) predicted: f64,
    pub(super) error: f64,
    /// What the bake said; `null` where it could not know.
    pub(super) told: Option<f64>,
}

#[derive(Debug, Serialize)]
pub(super) struct Precision {
    device: String,
    backend: &'static str,
    scale: Vec<DeviationReport>,
    offset: Vec<DeviationReport>,
    radiance: Vec<DeviationReport>,
    decay: Vec<DecayReport>,
}

/// Against the same bake at scale 1, offset 0 and radiance 1; relative to the mean irradiance.
#[derive(Debug, Serialize)]
struct DeviationReport {
    value: f64,
    mean: f64,
    rms: f64,
}

#[derive(Debug, Serialize)]
struct DecayReport {
    frames_per_s: f64,
    latency_s: f64,
    expected: f64,
    left: f64,
}

impl Row {
    fn new(bounced: &Bounced) -> Self {
        let Bounced { bounces, predicted, told, error } = *bounced;
        Self { bounces, predicted, error, told }
    }
}

impl Stiffness {
    pub(super) fn new(gpu: &Gpu, rooms: &[Room]) -> Self {
        let room = |room: &Room| RoomReport {
            albedo: room.albedo,
            rows: room.rows.iter().map(Row::new).collect(),
            automatic: Row::new(&room.automatic),
            one_by_one: (Bounces::TOLERANCE.ln() / room.albedo.ln() - 1.0).ceil(),
        };
        Self { device: gpu.info().name.clone(), backend: gpu.backend().name(), rooms: rooms.iter().map(room).collect() }
    }

    fn text(&self) -> String {
        let mut text = "what is missing of the closed form, and what the bake says is missing\n".to_owned();
        let _ =
            writeln!(text, "{:>8} {:>8} {:>12} {:>12} {:>12}", "albedo", "bounces", "albedo^(n+1)", "missing", "said");
        for room in &self.rooms {
            room.rows.iter().for_each(|row| text += &row.line(room.albedo, &row.bounces.to_string()));
        }
        let _ = writeln!(text, "automatic bounces: {:.0e} may be missing", Bounces::TOLERANCE);
        let _ =
            writeln!(text, "{:>8} {:>8} {:>12} {:>12} {:>12}", "albedo", "bounces", "one by one", "missing", "said");
        for RoomReport { albedo, automatic: Row { bounces, error, told, .. }, one_by_one, .. } in &self.rooms {
            let _ = writeln!(text, "{albedo:>8.3} {bounces:>8} {one_by_one:>12} {error:>12.2e} {:>12}", share(*told));
        }
        text
    }
}

impl Row {
    fn line(&self, albedo: f64, bounces: &str) -> String {
        let Self { predicted, error, told, .. } = self;
        format!("{albedo:>8.3} {bounces:>8} {predicted:>12.3e} {error:>12.3e} {:>12}\n", share(*told))
    }
}

fn share(value: Option<f64>) -> String {
    value.map_or("-".into(), |value| format!("{value:.2e}"))
}

impl Precision {
    pub(super) fn new(gpu: &Gpu, studies: &[(&str, Vec<Deviation>)], decays: &[Decay]) -> Self {
        let of = |wanted: &str| {
            let rows = studies.iter().filter(|(name, _)| *name == wanted).flat_map(|(_, rows)| rows);
            rows.map(|row| DeviationReport { value: row.value, mean: row.of_mean, rms: row.rms }).collect()
        };
        let decay = |decay: &Decay| {
            let Decay { frames_per_s, latency_s, expected, left } = *decay;
            DecayReport { frames_per_s, latency_s, expected, left }
        };
        Self {
            device: gpu.info().name.clone(),
            backend: gpu.backend().name(),
            scale: of("scale"),
            offset: of("offset"),
            radiance: of("radiance"),
            decay: decays.iter().map(decay).collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = "relative difference from the same bake at scale 1, offset 0, radiance 1\n".to_owned();
        for (name, rows) in [("scale", &self.scale), ("offset", &self.offset), ("radiance", &self.radiance)] {
            let _ = writeln!(text, "{name:>10} {:>12} {:>12}", "of the mean", "rms");
            for DeviationReport { value, mean, rms } in rows {
                let _ = writeln!(text, "{value:>10.0e} {mean:>12.1e} {rms:>12.1e}");
            }
        }
        text += "light that is switched off: what is left at the latency, in 32-bit floats\n";
        let _ = writeln!(
            text,
            "{:>10} {:>10} {:>12} {:>12} {:>12}",
            "latency s", "frames/s", "expected", "left", "relative"
        );
        for DecayReport { frames_per_s, latency_s, expected, left } in &self.decay {
            // What is lost beside 1 in 32-bit floats is none.
            let relative = if *expected > 1e-6 { format!("{:.1e}", left / expected - 1.0) } else { "-".into() };
            let _ = writeln!(text, "{latency_s:>10} {frames_per_s:>10} {expected:>12.4e} {left:>12.4e} {relative:>12}");
        }
        text
    }
}

impl Report {
    pub(super) fn text(&self) -> String {
        match self {
            Self::Stiffness(stiffness) => stiffness.text(),
            Self::Precision(precision) => precision.text(),
        }
    }
}
