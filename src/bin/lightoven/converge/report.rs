//! What was measured: a table for people, CSV, and JSON.

use super::figures::{ABOVE_FLOOR, Row, falling};
use super::reference::Source;
use crate::fit::slope;
use serde::Serialize;
use std::fmt::Write as _;

/// A floor below so many times the reference's own noise may be all of that.
const OF_THE_REFERENCE: f64 = 2.0;

/// The report of a measurement. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) scene: String,
    pub(super) device: String,
    pub(super) driver: String,
    /// Width and height in texels.
    pub(super) resolution: [u32; 2],
    /// Texels that count.
    pub(super) texels: usize,
    /// Bakes of each variant that were asked for.
    pub(super) seeds: u32,
    pub(super) reference: Source,
    pub(super) variants: Vec<Variant>,
    /// What the reference does not allow to tell, one sentence each.
    pub(super) limits: Vec<String>,
    /// Whether it was stopped early.
    pub(super) interrupted: bool,
}

/// A way of sampling on a back end.
#[derive(Debug, Serialize)]
pub(super) struct Variant {
    pub(super) sampling: String,
    pub(super) backend: &'static str,
    /// Of ln relMSE over ln seconds, down to 4 times the floor or the reference's own noise; `null` below two such rows.
    pub(super) slope: Option<f64>,
    /// The same over the kept samples: without the bounces, which come first and make the other steeper.
    pub(super) slope_over_samples: Option<f64>,
    /// Rows that it is fitted to: those with kept samples only.
    pub(super) fitted_rows: usize,
    /// The relMSE that stays: the last row's bias^2, the reference's own noise included; `null` with one bake.
    pub(super) floor: Option<f64>,
    /// The last row's bias_noise^2: a floor below it is not told from none.
    pub(super) floor_noise: Option<f64>,
    /// Seconds of the first row that is not 4 times above the reference's own noise; `null` where there is none.
    pub(super) reference_limits_from: Option<f64>,
    pub(super) rows: Vec<Row>,
}

impl Variant {
    /// `noise`: the reference's own, as a relMSE, where it is known.
    pub(super) fn new(sampling: String, backend: &'static str, rows: Vec<Row>, noise: Option<f64>) -> Self {
        let squared = |value: Option<f64>| value.map(|value| value * value);
        let last = rows.last();
        let floor = squared(last.and_then(|row| row.bias));
        let floor_noise = squared(last.and_then(|row| row.bias_noise));
        let noise = noise.unwrap_or_default();
        let rows_above = falling(&rows, floor.unwrap_or_default().max(noise));
        let slope_over =
            |x: fn(&Row) -> f64| slope(&rows_above.iter().map(|row| (x(row), row.relmse)).collect::<Vec<(f64, f64)>>());
        let limits = |row: &&Row| row.relmse < ABOVE_FLOOR * noise;
        Self {
            sampling,
            backend,
            slope: slope_over(|row| row.seconds),
            slope_over_samples: slope_over(|row| row.samples_per_texel),
            fitted_rows: rows_above.len(),
            floor,
            floor_noise,
            reference_limits_from: rows.iter().find(limits).map(|row| row.seconds),
            rows,
        }
    }

    /// The row where what a slope is fitted to ends, or the last one where there is no such.
    pub(super) fn last_fitted(&self) -> Option<&Row> {
        let kept = self.rows.iter().filter(|row| row.samples_per_texel > 0.0);
        kept.take(self.fitted_rows).last().or(self.rows.last())
    }

    pub(super) fn name(&self) -> String {
        format!("{}, {}", self.sampling, self.backend)
    }

    /// The floor where it is told from noise, else what it is below.
    pub(super) fn floor(&self) -> Option<Floor> {
        let (floor, noise) = self.floor.zip(self.floor_noise)?;
        Some(if floor > noise { Floor::At(floor) } else { Floor::Below(noise) })
    }

    fn summary(&self, noise: Option<f64>) -> String {
        let slope = match self.slope {
            Some(slope) => {
                let samples =
                    self.slope_over_samples.map_or(String::new(), |slope| format!(" ({slope:.2} over samples)"));
                format!("slope {slope:.2}{samples} in {} rows", self.fitted_rows)
            }
            None => "no slope: too few rows with kept samples and well above what stays".into(),
        };
        let floor = match self.floor() {
            None => "floor not known: one bake".into(),
            Some(Floor::Below(noise)) => format!("no floor found, it is below {noise:.2e}"),
            Some(Floor::At(floor)) if noise.is_some_and(|noise| floor < OF_THE_REFERENCE * noise) => {
                format!("floor {floor:.2e}, which may be the reference's own noise")
            }
            Some(Floor::At(floor)) => format!("floor {floor:.2e}"),
        };
        format!("{}: {slope}, {floor}", self.name())
    }

    fn limit(&self, noise: Option<f64>) -> Option<String> {
        let (seconds, noise) = self.reference_limits_from.zip(noise)?;
        let name = self.name();
        Some(format!(
            "{name}: from {seconds:.2} s on the relMSE is less than {ABOVE_FLOOR} times the reference's own, {noise:.2e}: the \
             reference is the limit"
        ))
    }
}

/// What an error falls to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Floor {
    At(f64),
    /// It is not told from noise.
    Below(f64),
}

/// What the reference does not allow to tell.
pub(super) fn limits(source: &Source, variants: &[Variant]) -> Vec<String> {
    let unknown = match (&source.file, source.relmse) {
        (Some(file), _) => Some(format!("the noise of '{file}' itself is not known: a floor may be its own")),
        (None, None) => Some("the reference's own error is not known: it has too few samples".into()),
        _ => None,
    };
    unknown.into_iter().chain(variants.iter().filter_map(|variant| variant.limit(source.relmse))).collect()
}

/// A column of the tables: its name in the CSV, its heading for people, and its value for each of them.
struct Column {
    name: &'static str,
    heading: &'static str,
    value: fn(&Row) -> Option<f64>,
    shown: fn(f64) -> String,
}

const fn column(
    name: &'static str,
    heading: &'static str,
    value: fn(&Row) -> Option<f64>,
    shown: fn(f64) -> String,
) -> Column {
    Column { name, heading, value, shown }
}

const COLUMNS: [Column; 11] = [
    column("seconds", "seconds", |row| Some(row.seconds), |value| format!("{value:.3}")),
    column("rays", "10^6 rays", |row| Some(row.rays as f64), |value| format!("{:.3}", value * 1e-6)),
    column("samples_per_texel", "samples", |row| Some(row.samples_per_texel), |value| format!("{value:.0}")),
    column("seeds", "seeds", |row| Some(row.seeds.into()), |value| format!("{value}")),
    column("rmse", "RMSE", |row| Some(row.rmse), scientific),
    column("relmse", "relMSE", |row| Some(row.relmse), scientific),
    column("median", "median", |row| Some(row.median), percent),
    column("p95", "95th", |row| Some(row.p95), percent),
    column("bias", "bias", |row| row.bias, percent),
    column("bias_noise", "its noise", |row| row.bias_noise, percent),
    column("efficiency", "1/(relMSE s)", |row| row.efficiency, scientific),
];

fn scientific(value: f64) -> String {
    format!("{value:.3e}")
}

fn percent(value: f64) -> String {
    format!("{:.3} %", 100.0 * value)
}

impl Report {
    /// For people.
    pub(super) fn text(&self) -> String {
        let ([width, height], noise) = (self.resolution, self.reference.relmse);
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "scene      {}", self.scene);
        let _ = writeln!(text, "device     {}", self.device);
        let _ = writeln!(text, "map        {width} x {height}, {} texels count", self.texels);
        let _ = writeln!(text, "reference  {}", self.reference.text());
        let _ = writeln!(text, "bakes      {} of each", self.seeds);
        for variant in &self.variants {
            let _ = writeln!(text, "\n{}", variant.summary(noise));
            let line = |cell: &dyn Fn(&Column) -> String| {
                COLUMNS.iter().map(|column| format!("{:>13}", cell(column))).collect::<String>()
            };
            let _ = writeln!(text, "{}", line(&|column| column.heading.into()));
            for row in &variant.rows {
                let shown = |column: &Column| (column.value)(row).map_or("-".into(), column.shown);
                let _ = writeln!(text, "{}", line(&shown));
            }
            let not_finite = variant.rows.iter().map(|row| row.not_finite).max().unwrap_or_default();
            if not_finite > 0 {
                let _ = writeln!(text, "not finite, left out: up to {not_finite} texels");
            }
        }
        for (index, limit) in self.limits.iter().enumerate() {
            let _ = writeln!(text, "{}limit      {limit}", if index == 0 { "\n" } else { "" });
        }
        text
    }

    /// A row for every time of every variant; a value that is not known is empty.
    pub(super) fn csv(&self) -> String {
        let header: Vec<&str> = ["sampling", "backend"].into_iter().chain(COLUMNS.map(|column| column.name)).collect();
        let mut text = header.join(",") + "\n";
        for variant in &self.variants {
            for row in &variant.rows {
                let value = |column: &Column| (column.value)(row).map_or(String::new(), |value| value.to_string());
                let fields = [variant.sampling.clone(), variant.backend.into()];
                let fields: Vec<String> = fields.into_iter().chain(COLUMNS.iter().map(value)).collect();
                text.push_str(&fields.join(","));
                text.push('\n');
            }
        }
        text
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn row(seconds: f64, relmse: f64, bias: Option<f64>) -> Row {
        Row {
            seconds,
            rays: 1000,
            samples_per_texel: 64.0,
            seeds: 4,
            rmse: relmse.sqrt(),
            relmse,
            median: 0.01,
            p95: 0.1,
            bias,
            bias_noise: bias.map(|_| 0.01),
            efficiency: Some(1.0 / (relmse * seconds)),
            not_finite: 0,
        }
    }

    pub(in super::super) fn baked() -> Source {
        Source {
            file: None,
            scale: 1.0,
            sampling: Some("auto".into()),
            backend: Some("software"),
            seed: Some(0),
            seconds: Some(30.0),
            samples_per_texel: Some(4096.0),
            estimated_error: Some(0.02),
            relmse: Some(4e-4),
        }
    }

    pub(in super::super) fn report(rows: Vec<Row>) -> Report {
        let reference = baked();
        let variants = vec![Variant::new("auto".into(), "software", rows, reference.relmse)];
        Report {
            scene: "box".into(),
            device: "a device".into(),
            driver: "a driver".into(),
            resolution: [32, 16],
            texels: 300,
            seeds: 4,
            limits: limits(&reference, &variants),
            reference,
            variants,
            interrupted: false,
        }
    }

    #[test]
    fn a_slope_goes_down_to_what_stays() {
        let rows = [(1.0, 0.4), (2.0, 0.2), (4.0, 0.1), (8.0, 0.095)];
        let found = report(rows.map(|(seconds, relmse)| row(seconds, relmse, Some(0.15))).into());
        let variant = &found.variants[0];
        // The floor is 0.0225, four times that 0.09.
        assert_eq!((variant.fitted_rows, variant.reference_limits_from), (4, None));
        let rows = [(1.0, 0.4), (2.0, 0.2), (4.0, 0.1), (8.0, 0.08)];
        let found = report(rows.map(|(seconds, relmse)| row(seconds, relmse, Some(0.15))).into());
        let variant = &found.variants[0];
        assert!(variant.slope.is_some_and(|slope| (slope + 1.0).abs() < 1e-9), "{variant:?}");
        // All have the same samples.
        assert_eq!((variant.fitted_rows, variant.slope_over_samples), (3, None));
        assert!(found.text().contains("slope -1.00 in 3 rows, floor 2.25e-2\n"), "{}", found.text());
        assert!(found.limits.is_empty());
    }

    #[test]
    fn a_reference_that_is_the_limit_is_told() {
        let found = report(vec![row(1.0, 0.01, Some(0.025)), row(2.0, 0.0015, Some(0.025))]);
        assert_eq!(found.variants[0].reference_limits_from, Some(2.0));
        let text = found.text();
        for part in ["no slope", "may be the reference's own noise", "from 2.00 s on", "the reference is the limit"] {
            assert!(text.contains(part), "'{part}' is missing in {text}");
        }
        let file = Source { file: Some("r.exr".into()), relmse: None, ..baked() };
        assert!(limits(&file, &found.variants)[0].contains("'r.exr' itself is not known"));
        let short = Source { relmse: None, estimated_error: None, ..baked() };
        assert!(limits(&short, &found.variants)[0].contains("too few samples"));
    }

    #[test]
    fn floors_are_told_from_noise() {
        let floor = |bias: Option<f64>| report(vec![row(1.0, 0.1, bias)]).variants[0].floor();
        assert_eq!(floor(None), None);
        assert_eq!(floor(Some(0.02)), Some(Floor::At(0.02 * 0.02)));
        assert_eq!(floor(Some(0.005)), Some(Floor::Below(0.01 * 0.01)));
    }

    #[test]
    fn rows_are_lines() {
        let text = report(vec![row(0.5, 0.25, Some(0.5)), row(1.0, 0.125, None)]).csv();
        let expected = "sampling,backend,seconds,rays,samples_per_texel,seeds,rmse,relmse,median,p95,bias,bias_noise,\
                        efficiency\n\
                        auto,software,0.5,1000,64,4,0.5,0.25,0.01,0.1,0.5,0.01,8\n\
                        auto,software,1,1000,64,4,0.3535533905932738,0.125,0.01,0.1,,,8\n";
        assert_eq!(text, expected);
    }
}
