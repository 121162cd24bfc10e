//! What is said when it is done: as JSON with stable names. Others are only added.

use crate::arguments::{Arguments, Mode};
use crate::row::{Case, Phase, Row};
use crate::statistics::{Cases, Percentiles, mean, median};
use lightoven::io::write_beside;
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;
use std::io::Write as _;
use std::path::Path;
use std::time::Duration;

/// What the frames were run on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Setting {
    pub(crate) scene: String,
    pub(crate) device: String,
    pub(crate) driver: String,
    pub(crate) backend: &'static str,
    /// The queue that bakes are submitted to: "the engine's" or "another".
    pub(crate) bake_queue: &'static str,
    /// What tells bake times: "device" by its timestamps, or "host".
    pub(crate) bake_clock: &'static str,
    /// Width and height of the light map.
    pub(crate) resolution: [u32; 2],
    /// Texels that take rays.
    pub(crate) texels: u64,
}

/// All figures. Percentiles are of milliseconds, and `null` where there was no such frame. Frames in which a pipeline was
/// used for the first time are counted, and left out of all else.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Report {
    #[serde(flatten)]
    pub(crate) setting: Setting,
    pub(crate) mode: Mode,
    /// Width and height of the picture.
    pub(crate) picture: [u32; 2],
    pub(crate) seed: u64,
    pub(crate) warm_up_frames: usize,
    /// Of all frames, those of the warm-up too.
    pub(crate) jit_frames: usize,
    pub(crate) interrupted: bool,
    pub(crate) budgets: Vec<Budget>,
    pub(crate) overlap: Option<Overlap>,
}

/// How one budget was kept.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Budget {
    pub(crate) budget_ms: f64,
    /// Measured ones that baked, with raster and without.
    pub(crate) frames: usize,
    /// The device's time for the library's passes, of `frames`.
    pub(crate) bake_ms: Option<Percentiles>,
    /// The host's time for frames with baking and raster.
    pub(crate) frame_ms: Option<Percentiles>,
    /// The host's time for frames with raster alone.
    pub(crate) raster_only_ms: Option<Percentiles>,
    /// Mean bake time over the budget.
    #[serde(rename = "use")]
    pub(crate) used: Option<f64>,
    /// 95th percentile of the bake time over the budget.
    pub(crate) overshoot_p95: Option<f64>,
    /// Mean of `frames`.
    pub(crate) rays_per_frame: Option<f64>,
    /// Mean of `frames`.
    pub(crate) samples_per_texel_per_frame: Option<f64>,
    /// Mean of what the library expects of the least work that it does: below it a budget cannot be kept in every frame.
    pub(crate) one_unit_ms: Option<f64>,
}

/// How far raster and baking overlap. Times are medians of the host's, from frames of their own at one budget.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Overlap {
    /// See [`Cases::efficiency`].
    pub(crate) efficiency: f64,
    /// 2.5th percentile of its bootstrap.
    pub(crate) low: f64,
    /// 97.5th.
    pub(crate) high: f64,
    /// Median device time of the raster passes, from when the first may begin until the last has ended, with baking over
    /// without. `frame_slowdown` where the device has no timestamps.
    pub(crate) raster_slowdown: f64,
    /// Median frame with both over median frame with raster alone.
    pub(crate) frame_slowdown: f64,
    pub(crate) budget_ms: f64,
    pub(crate) frames: [usize; 3],
    pub(crate) raster_frame_ms: f64,
    pub(crate) bake_frame_ms: f64,
    pub(crate) both_frame_ms: f64,
    /// Mean rays of frames with baking alone and with both: about equal, or the times do not compare.
    pub(crate) rays_alone: f64,
    pub(crate) rays_both: f64,
}

impl Report {
    pub(crate) fn new(setting: Setting, arguments: &Arguments, rows: &[Row], interrupted: bool) -> Self {
        let budgets = arguments.budget_ms.0.iter().filter_map(|budget| Budget::new(*budget, rows));
        Self {
            setting,
            mode: arguments.mode,
            picture: [arguments.width, arguments.height],
            seed: arguments.seed,
            warm_up_frames: rows.iter().filter(|row| row.phase == Phase::WarmUp).count(),
            jit_frames: rows.iter().filter(|row| row.first_use).count(),
            interrupted,
            budgets: budgets.collect(),
            overlap: Overlap::new(rows, arguments.seed),
        }
    }

    /// Writes it as JSON, beside and renamed.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let failed = |error: Box<dyn std::error::Error + Send + Sync>| {
            Error::new(ErrorKind::Io, format!("cannot write '{}'", path.display())).with_source(error)
        };
        let text = serde_json::to_string_pretty(self).map_err(|error| failed(error.into()))?;
        write_beside(path, |file| writeln!(file, "{text}").map_err(|error| failed(error.into())))
    }
}

/// Measured frames of a phase and case.
fn measured(rows: &[Row], phase: Phase, case: Case) -> impl Iterator<Item = &Row> {
    rows.iter().filter(move |row| row.phase == phase && row.case == case && !row.first_use)
}

impl Budget {
    /// `None` where none of its frames was measured.
    fn new(budget: Duration, rows: &[Row]) -> Option<Self> {
        let of = |case| measured(rows, Phase::Budget, case).filter(move |row| row.budget == budget);
        let frame_ms = |case| of(case).map(|row| row.frame_ms).collect::<Vec<_>>();
        let baking: Vec<&Row> = of(Case::Bake).chain(of(Case::Both)).collect();
        if baking.is_empty() && of(Case::Raster).next().is_none() {
            return None;
        }
        let bake_ms: Vec<f64> = baking.iter().filter_map(|row| row.bake_ms).collect();
        let mean_of = |value: fn(&Row) -> f64| mean(&baking.iter().map(|row| value(row)).collect::<Vec<_>>());
        let budget_ms = budget.as_secs_f64() * 1e3;
        let percentiles = Percentiles::of(&bake_ms);
        Some(Self {
            budget_ms,
            frames: baking.len(),
            bake_ms: percentiles,
            frame_ms: Percentiles::of(&frame_ms(Case::Both)),
            raster_only_ms: Percentiles::of(&frame_ms(Case::Raster)),
            used: mean(&bake_ms).map(|mean| mean / budget_ms),
            overshoot_p95: percentiles.map(|percentiles| percentiles.p95 / budget_ms),
            rays_per_frame: mean_of(|row| row.rays as f64),
            samples_per_texel_per_frame: mean_of(|row| row.samples_per_texel),
            one_unit_ms: mean_of(|row| row.one_unit_ms),
        })
    }
}

/// Drawing and baking have to be this much alike for what they hide of each other to be told from noise.
const LEAST_SHARE: f64 = 0.05;

impl Overlap {
    /// `None` where a case has no frames, or next to nothing could be hidden.
    fn new(rows: &[Row], seed: u64) -> Option<Self> {
        let of = |case| measured(rows, Phase::Overlap, case);
        let [raster, bake, both] = Case::ALL.map(|case| of(case).map(|row| row.frame_ms).collect::<Vec<_>>());
        let frames = [raster.len(), bake.len(), both.len()];
        let (raster_frame_ms, bake_frame_ms, both_frame_ms) = (median(&raster)?, median(&bake)?, median(&both)?);
        if raster_frame_ms.min(bake_frame_ms) < LEAST_SHARE * raster_frame_ms.max(bake_frame_ms) {
            return None;
        }
        let raster_ms = |case| median(&of(case).filter_map(|row| row.raster_ms).collect::<Vec<_>>());
        let frame_slowdown = both_frame_ms / raster_frame_ms;
        let raster_slowdown = match (raster_ms(Case::Both), raster_ms(Case::Raster)) {
            (Some(both), Some(alone)) => both / alone,
            _ => frame_slowdown,
        };
        let efficiency = Cases { raster, bake, both }.efficiency(seed)?;
        let rays = |case| mean(&of(case).map(|row| row.rays as f64).collect::<Vec<_>>());
        Some(Self {
            efficiency: efficiency.efficiency,
            low: efficiency.low,
            high: efficiency.high,
            raster_slowdown,
            frame_slowdown,
            budget_ms: of(Case::Both).next()?.budget.as_secs_f64() * 1e3,
            frames,
            raster_frame_ms,
            bake_frame_ms,
            both_frame_ms,
            rays_alone: rays(Case::Bake)?,
            rays_both: rays(Case::Both)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(phase: Phase, case: Case, frame_ms: f64, first_use: bool) -> Row {
        Row {
            phase,
            budget: Duration::from_millis(4),
            case,
            frame_ms,
            raster_ms: case.draws().then_some(1.0),
            bake_ms: case.bakes().then_some(frame_ms - 1.0),
            predicted_ms: 0.0,
            one_unit_ms: 0.5,
            rays: 100,
            samples_per_texel: 0.5,
            ran: String::new(),
            first_use,
        }
    }

    #[test]
    fn first_uses_and_other_phases_do_not_count() {
        let rows = [
            row(Phase::WarmUp, Case::Both, 99.0, false),
            row(Phase::Budget, Case::Both, 99.0, true),
            row(Phase::Budget, Case::Both, 5.0, false),
            row(Phase::Budget, Case::Bake, 3.0, false),
            row(Phase::Budget, Case::Raster, 2.0, false),
        ];
        let budget = Budget::new(Duration::from_millis(4), &rows).expect("there are frames");
        assert_eq!((budget.frames, budget.rays_per_frame), (2, Some(100.0)));
        assert_eq!(budget.used, Some(0.75));
        assert_eq!(budget.frame_ms.map(|ms| ms.p99), Some(5.0));
        assert_eq!(budget.raster_only_ms.map(|ms| ms.p50), Some(2.0));
        assert_eq!(Budget::new(Duration::from_millis(2), &rows), None);
        assert_eq!(Overlap::new(&rows, 0), None);
    }

    #[test]
    fn frames_one_after_the_other_do_not_overlap() {
        let rows = Case::ALL.map(|case| row(Phase::Overlap, case, if case == Case::Both { 6.0 } else { 3.0 }, false));
        let overlap = Overlap::new(&rows, 0).expect("each case has a frame");
        assert_eq!((overlap.efficiency, overlap.low, overlap.high), (0.0, 0.0, 0.0));
        assert_eq!((overlap.raster_slowdown, overlap.frame_slowdown, overlap.budget_ms), (1.0, 2.0, 4.0));
        let json = serde_json::to_value(overlap).expect("is JSON");
        assert!(["efficiency", "low", "high", "raster_slowdown"].iter().all(|name| json[name].is_number()));
    }
}
