//! How cost grows, as JSON with stable names and as tables for people.

use super::super::figures::Spread;
use crate::fit::slope;
use serde::Serialize;
use std::fmt::Write as _;

/// The report of `bench --growth`. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(super) scene: String,
    pub(super) device: String,
    pub(super) driver: String,
    pub(super) backend: &'static str,
    /// Of a round, at most.
    pub(super) rays: u32,
    pub(super) rounds: u32,
    /// `null` where it was not asked for.
    pub(super) triangles: Option<Growth>,
    pub(super) texels: Option<Growth>,
    pub(super) seconds: Seconds,
}

#[derive(Debug, Serialize)]
pub(super) struct Seconds {
    /// The whole command.
    pub(super) total: f64,
}

/// Sizes with what each costs.
#[derive(Debug, Serialize)]
pub(super) struct Growth {
    rows: Vec<Row>,
    /// Exponents of what costs grow with, by least squares over the logarithms; `null` with fewer than two sizes.
    exponents: Vec<Exponent>,
}

#[derive(Debug, Serialize)]
struct Exponent {
    cost: &'static str,
    exponent: Option<f64>,
    /// Sizes that it was fitted to.
    rows: usize,
}

/// A size.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct Row {
    /// Of the hierarchy.
    pub(super) triangles: usize,
    /// Into how many parts each edge of the scene was cut.
    pub(super) subdivision: u32,
    /// Width and height of the light map, texels; `null` where it cannot be laid out.
    pub(super) resolution: Option<[u32; 2]>,
    /// Texels that take rays.
    pub(super) texels: Option<u64>,
    #[serde(flatten)]
    pub(super) costs: Costs,
    /// Why figures are missing.
    pub(super) failed: Option<String>,
}

/// `null` where it did not come so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct Costs {
    pub(super) node_bytes: Option<u64>,
    pub(super) bvh_seconds: Option<f64>,
    /// Of a baker with sampling `auto`.
    pub(super) set_up: SetUp,
    /// Nanoseconds a ray.
    pub(super) closest_ns: Option<Spread>,
    pub(super) occluded_ns: Option<Spread>,
    pub(super) gather_ns: Option<Spread>,
    /// The most that building the hierarchy and setting up the baker held, the scene's own included.
    pub(super) host_bytes: Option<u64>,
    /// That the baker holds.
    pub(super) device_bytes: Option<u64>,
}

/// Seconds, compilation left out.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct SetUp {
    pub(super) gbuffer_seconds: Option<f64>,
    pub(super) aiming_seconds: Option<f64>,
    /// The hierarchy's included.
    pub(super) total_seconds: Option<f64>,
}

/// What sizes are counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    Triangles,
    Texels,
}

/// A column: its heading, its name, a figure of it, and digits behind the point.
struct Column {
    heading: &'static str,
    name: &'static str,
    of: fn(&Costs) -> Option<f64>,
    /// Units of the column in one of the figure, for people.
    scale: f64,
    digits: usize,
}

const MIB: f64 = 1.0 / (1 << 20) as f64;

const COLUMNS: [Column; 9] = [
    Column::new("bvh s", "bvh_seconds", |costs| costs.bvh_seconds, 1.0, 3),
    Column::new("g-buffer s", "gbuffer_seconds", |costs| costs.set_up.gbuffer_seconds, 1.0, 3),
    Column::new("aiming s", "aiming_seconds", |costs| costs.set_up.aiming_seconds, 1.0, 3),
    Column::new("set-up s", "total_seconds", |costs| costs.set_up.total_seconds, 1.0, 3),
    Column::new("closest ns", "closest_ns", |costs| median(costs.closest_ns), 1.0, 1),
    Column::new("any ns", "occluded_ns", |costs| median(costs.occluded_ns), 1.0, 1),
    Column::new("gather ns", "gather_ns", |costs| median(costs.gather_ns), 1.0, 1),
    Column::new("host MiB", "host_bytes", |costs| costs.host_bytes.map(|bytes| bytes as f64), MIB, 1),
    Column::new("device MiB", "device_bytes", |costs| costs.device_bytes.map(|bytes| bytes as f64), MIB, 1),
];

impl Column {
    const fn new(
        heading: &'static str,
        name: &'static str,
        of: fn(&Costs) -> Option<f64>,
        scale: f64,
        digits: usize,
    ) -> Self {
        Self { heading, name, of, scale, digits }
    }
}

fn median(spread: Option<Spread>) -> Option<f64> {
    spread.map(|spread| spread.median)
}

impl Growth {
    pub(super) fn new(axis: Axis, rows: Vec<Row>) -> Self {
        let exponent = |column: &Column| {
            let point = |row: &Row| {
                let (size, cost) = (axis.size(row)?, (column.of)(&row.costs)?);
                (size > 0.0 && cost > 0.0).then_some((size, cost))
            };
            let points: Vec<(f64, f64)> = rows.iter().filter_map(point).collect();
            Exponent { cost: column.name, exponent: slope(&points), rows: points.len() }
        };
        Self { exponents: COLUMNS.iter().map(exponent).collect(), rows }
    }

    /// Each line ends in a line break.
    fn text(&self, axis: Axis) -> String {
        let mut text = format!("{:>10}{:>11}", "triangles", "texels");
        text.extend(COLUMNS.iter().map(|column| format!("{:>12}", column.heading)));
        text.push('\n');
        for row in &self.rows {
            let texels = row.texels.map_or_else(|| whole(row), |texels| texels.to_string());
            // Writing to a string cannot fail.
            let _ = write!(text, "{:>10}{texels:>11}", row.triangles);
            for Column { of, scale, digits, .. } in &COLUMNS {
                let figure = of(&row.costs).map_or("-".into(), |figure| format!("{:.digits$}", figure * scale));
                let _ = write!(text, "{figure:>12}");
            }
            text.push('\n');
            if let Some(why) = &row.failed {
                let _ = writeln!(text, "{:>10} {why}", "");
            }
        }
        for (Column { heading, .. }, Exponent { exponent, rows, .. }) in COLUMNS.iter().zip(&self.exponents) {
            if let Some(exponent) = exponent {
                let _ = writeln!(text, "{heading:<10} grow as {}^{exponent:.2}, from {rows} sizes", axis.name());
            }
        }
        text
    }
}

impl Axis {
    fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Texels => "texels",
        }
    }

    fn size(self, row: &Row) -> Option<f64> {
        match self {
            Self::Triangles => Some(row.triangles as f64),
            Self::Texels => row.texels.map(|texels| texels as f64),
        }
    }
}

/// Where it is not known how many texels take rays.
fn whole(row: &Row) -> String {
    row.resolution.map_or("-".into(), |[width, height]| format!("{width}x{height}"))
}

impl Report {
    /// Each line ends in a line break.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "scene    {}", self.scene);
        let _ = writeln!(text, "device   {}, {}, {} back end", self.device, self.driver, self.backend);
        let _ = writeln!(text, "rays     {} of a round at most, {} rounds: medians", self.rays, self.rounds);
        for (axis, growth) in [(Axis::Triangles, &self.triangles), (Axis::Texels, &self.texels)] {
            if let Some(growth) = growth {
                let _ = write!(text, "\nwith the {}\n{}", axis.name(), growth.text(axis));
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(triangles: usize, texels: Option<u64>) -> Row {
        let costs = Costs {
            bvh_seconds: Some(1e-6 * triangles as f64),
            device_bytes: texels.map(|texels| 1024 * texels),
            host_bytes: Some(0),
            ..Costs::default()
        };
        let failed = texels.is_none().then(|| "too large".into());
        Row { triangles, subdivision: 1, resolution: Some([64, 64]), texels, costs, failed }
    }

    #[test]
    fn exponents_are_of_what_was_measured() {
        let growth = Growth::new(Axis::Triangles, vec![row(1000, Some(10)), row(4000, Some(10)), row(16000, None)]);
        let exponent = |name| {
            let found = growth.exponents.iter().find(|exponent| exponent.cost == name).expect("has a column");
            (found.exponent.map(|value| (value * 1e6).round() * 1e-6), found.rows)
        };
        assert_eq!((exponent("bvh_seconds"), exponent("device_bytes")), ((Some(1.0), 3), (Some(0.0), 2)));
        assert_eq!((exponent("closest_ns"), exponent("host_bytes")), ((None, 0), (None, 0)));
        let text = growth.text(Axis::Triangles);
        for part in ["too large", "64x64", "bvh s      grow as triangles^1.00, from 3 sizes"] {
            assert!(text.contains(part), "'{part}' is missing in {text}");
        }
        assert!(!text.contains("closest ns grow"), "{text}");
        let growth = Growth::new(Axis::Texels, vec![row(9, Some(10)), row(9, Some(1000))]);
        assert!(growth.text(Axis::Texels).contains("device MiB grow as texels^1.00, from 2 sizes"));
    }
}
