//! The same figures as the report's, for people.

use crate::report::{Budget, Overlap, Report};
use crate::statistics::Percentiles;
use std::fmt::Write as _;

/// Some lines; each ends in a line break.
pub(crate) fn text(report: &Report) -> String {
    let mut text = String::new();
    let setting = &report.setting;
    let ([width, height], [columns, rows]) = (report.picture, setting.resolution);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "scene    {}", setting.scene);
    let _ = writeln!(text, "device   {}, {}, {} back end", setting.device, setting.driver, setting.backend);
    let _ = writeln!(text, "picture  {width} x {height}, light map {columns} x {rows} with {} texels", setting.texels);
    let _ = writeln!(text, "left out {} frames that used a pipeline for the first time", report.jit_frames);
    let _ = writeln!(text);
    let _ = writeln!(
        text,
        "{:>9} {:>7}  {:^24}  {:^24}  {:^24}  {:>5} {:>9} {:>8} {:>10} {:>13}",
        "budget ms",
        "frames",
        "bake ms",
        "frame ms",
        "raster only ms",
        "use",
        "p95/budg.",
        "unit ms",
        "rays/frame",
        "samples/texel"
    );
    let triple = "     p50     p95     p99";
    let _ = writeln!(text, "{:17}  {triple:24}  {triple:24}  {triple:24}", "");
    for budget in &report.budgets {
        text.push_str(&budget_line(budget));
    }
    match &report.overlap {
        Some(overlap) => text.push_str(&overlap_lines(overlap)),
        None => {
            text.push_str("\noverlap  not measurable: one of the two takes next to no time, or frames are missing\n")
        }
    }
    text
}

fn budget_line(budget: &Budget) -> String {
    let triple = |percentiles: Option<Percentiles>| match percentiles {
        Some(Percentiles { p50, p95, p99 }) => format!("{p50:8.2}{p95:8.2}{p99:8.2}"),
        None => format!("{:>8}{:>8}{:>8}", "-", "-", "-"),
    };
    let number = |value: Option<f64>, decimals: usize| value.map_or("-".into(), |value| format!("{value:.decimals$}"));
    format!(
        "{:>9} {:>7}  {}  {}  {}  {:>5} {:>9} {:>8} {:>10} {:>13}\n",
        budget.budget_ms,
        budget.frames,
        triple(budget.bake_ms),
        triple(budget.frame_ms),
        triple(budget.raster_only_ms),
        number(budget.used, 2),
        number(budget.overshoot_p95, 2),
        number(budget.one_unit_ms, 2),
        number(budget.rays_per_frame, 0),
        number(budget.samples_per_texel_per_frame, 3),
    )
}

fn overlap_lines(overlap: &Overlap) -> String {
    let Overlap { efficiency, low, high, raster_slowdown, frame_slowdown, budget_ms, .. } = overlap;
    let Overlap { raster_frame_ms, bake_frame_ms, both_frame_ms, rays_alone, rays_both, .. } = overlap;
    format!(
        "\noverlap  {efficiency:.3}, 95 % in [{low:.3}, {high:.3}], at {budget_ms} ms: raster {raster_frame_ms:.2} ms, bake \
         {bake_frame_ms:.2} ms, both {both_frame_ms:.2} ms (medians)\n\
         rays     {rays_alone:.0} a frame alone, {rays_both:.0} with raster\n\
         slower   raster {raster_slowdown:.2} times, the frame {frame_slowdown:.2} times, beside baking\n"
    )
}
