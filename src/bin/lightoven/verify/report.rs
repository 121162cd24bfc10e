//! What is said of the cases: a table for people, and JSON with stable names.

use lightoven::gpu::Gpu;
use lightoven::verify::{Case, Comparison, Row, Verdict};
use serde::Serialize;
use std::fmt::Write as _;

/// The report of a run. Its names are stable: others are only added.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    device: String,
    driver: String,
    backend: &'static str,
    pub(super) cases: Vec<CaseReport>,
    /// The whole command.
    pub(super) seconds: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct CaseReport {
    subject: String,
    name: &'static str,
    outcome: Outcome,
    rows: Vec<RowReport>,
    /// Why the case has no meaning here.
    skipped: Option<String>,
    error: Option<String>,
    /// What the validation layer said.
    pub(super) validation: Vec<String>,
    seconds: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Outcome {
    Pass,
    Fail,
    Skipped,
}

#[derive(Debug, Serialize)]
struct RowReport {
    what: String,
    /// `null` where it is no number.
    expected: Option<f64>,
    measured: Option<f64>,
    /// "estimate", "within", "relative", "at most", "at least", "holds".
    comparison: &'static str,
    /// Of an estimate.
    standard_error: Option<f64>,
    /// Allowed: of an estimate beside noise, of "relative" a share of `expected`.
    tolerance: Option<f64>,
    /// What four standard errors of an estimate may be: one that is not known well enough does not pass.
    resolution: Option<f64>,
    difference: String,
    bound: String,
    passes: bool,
}

impl Report {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let info = gpu.info();
        Self {
            device: info.name.clone(),
            driver: info.driver.clone(),
            backend: gpu.backend().name(),
            cases: Vec::new(),
            seconds: 0.0,
        }
    }

    pub(super) fn failed(&self) -> usize {
        self.count(Outcome::Fail)
    }

    fn count(&self, outcome: Outcome) -> usize {
        self.cases.iter().filter(|case| case.outcome == outcome).count()
    }

    pub(super) fn head(&self) -> String {
        let Self { device, driver, backend, .. } = self;
        let head = line("", ["expected", "measured", "difference"], "bound", "");
        format!("device   {device}, {driver}\nback end {backend}\n\n{head}")
    }

    pub(super) fn tail(&self) -> String {
        let [pass, fail, skipped] = [Outcome::Pass, Outcome::Fail, Outcome::Skipped].map(|outcome| self.count(outcome));
        let mut text = format!("\n{pass} cases passed, {fail} failed, {skipped} skipped, in {:.0} s\n", self.seconds);
        for case in self.cases.iter().filter(|case| case.outcome == Outcome::Fail) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "failed: {}, {}", case.subject, case.name);
        }
        text
    }
}

impl CaseReport {
    pub(super) fn new(case: &Case, verdict: &Verdict, validation: &[String]) -> Self {
        let outcome = match verdict {
            _ if !verdict.passes() || !validation.is_empty() => Outcome::Fail,
            Verdict { skipped: Some(_), .. } => Outcome::Skipped,
            _ => Outcome::Pass,
        };
        Self {
            subject: case.subject.to_string(),
            name: case.name,
            outcome,
            rows: verdict.rows.iter().map(RowReport::new).collect(),
            skipped: verdict.skipped.clone(),
            error: verdict.error.as_ref().map(crate::messages::causes),
            validation: validation.to_vec(),
            seconds: verdict.time.as_secs_f64(),
        }
    }

    /// The case's lines of the table.
    pub(super) fn text(&self) -> String {
        let outcome = match self.outcome {
            Outcome::Pass => "pass",
            Outcome::Fail => "FAIL",
            Outcome::Skipped => "skipped",
        };
        let mut text = format!("{}, {}: {outcome}, {:.2} s\n", self.subject, self.name, self.seconds);
        for row in &self.rows {
            let figure = |value: Option<f64>| match (value, row.comparison) {
                (Some(value), "holds") => if value == 1.0 { "yes" } else { "no" }.to_owned(),
                (value, _) => number(value),
            };
            let verdict = if row.passes { "pass" } else { "FAIL" };
            let figures = [&figure(row.expected), &figure(row.measured), &row.difference];
            text += &line(&row.what, figures.map(String::as_str), &row.bound, verdict);
        }
        let skipped = self.skipped.iter().map(|reason| format!("skipped: {reason}"));
        let others = self.error.iter().chain(&self.validation).map(|error| format!("error: {error}"));
        for told in skipped.chain(others) {
            let _ = writeln!(text, "  {told}");
        }
        text
    }
}

impl RowReport {
    fn new(row: &Row) -> Self {
        let Row { what, expected, measured, comparison, passes } = row;
        let apart = measured - expected;
        let (name, difference, bound) = match *comparison {
            Comparison::Estimate { standard_error, tolerance, resolution } => {
                let beside = if tolerance > 0.0 { format!(" + {tolerance:.1e}") } else { String::new() };
                // All rays may see the same.
                let is_noise = standard_error > 0.01 * tolerance;
                let difference =
                    if is_noise { format!("{:+.2} sigma", apart / standard_error) } else { format!("{apart:+.1e}") };
                let noise = if 4.0 * standard_error <= resolution { "" } else { ", too noisy" };
                ("estimate", difference, format!("4 sigma{beside}{noise}"))
            }
            Comparison::Within(bound) => ("within", format!("{apart:+.1e}"), format!("{bound:.1e}")),
            Comparison::Relative(bound) => {
                ("relative", format!("{:+.4} %", 100.0 * apart / expected), format!("{:.4} %", 100.0 * bound))
            }
            Comparison::AtMost => ("at most", String::new(), "at most".into()),
            Comparison::AtLeast => ("at least", String::new(), "at least".into()),
            Comparison::Holds => ("holds", String::new(), String::new()),
        };
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let (standard_error, tolerance, resolution) = match *comparison {
            Comparison::Estimate { standard_error, tolerance, resolution } => {
                (finite(standard_error), finite(tolerance), finite(resolution))
            }
            Comparison::Within(bound) | Comparison::Relative(bound) => (None, finite(bound), None),
            _ => (None, None, None),
        };
        Self {
            what: what.clone(),
            expected: finite(*expected),
            measured: finite(*measured),
            comparison: name,
            standard_error,
            tolerance,
            resolution,
            difference,
            bound,
            passes: *passes,
        }
    }
}

/// Seven significant digits at most.
fn number(value: Option<f64>) -> String {
    match value {
        None => "none".into(),
        Some(value) if value == value.trunc() && value.abs() < 1e7 => format!("{value}"),
        Some(value) if (1e-3..1e6).contains(&value.abs()) => {
            let digits = (6 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
            let text = format!("{value:.digits$}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        Some(value) => format!("{value:.4e}"),
    }
}

fn line(what: &str, [expected, measured, difference]: [&str; 3], bound: &str, verdict: &str) -> String {
    let line = format!("  {what:<46} {expected:>11} {measured:>11} {difference:>13}  {bound:<19} {verdict}");
    format!("{}\n", line.trim_end())
}
