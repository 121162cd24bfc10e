//! Frame times over frames, and how bake times spread around their budgets, as SVG.

use crate::row::{Case, Phase, Row};
use lightoven::io::write_beside;
use lightoven::{Error, ErrorKind, Result};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::io::Write as _;
use std::path::Path;
use std::time::Duration;

const SIZE: (u32, u32) = (1200, 900);
const FONT: (&str, i32) = ("sans-serif", 15);
const TITLE: (&str, i32) = ("sans-serif", 20);
const BINS: usize = 120;

/// Colours that are told apart with any eyes (Okabe and Ito), without the yellow, which is pale on white.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;

/// Writes the plot of all measured frames but first uses.
pub(crate) fn write(path: &Path, rows: &[Row]) -> Result<()> {
    let failed = |why: String| Error::new(ErrorKind::Io, format!("cannot write '{}': {why}", path.display()));
    let text = draw(rows).map_err(|error| failed(error.to_string()))?;
    write_beside(path, |file| file.write_all(text.as_bytes()).map_err(|error| failed(error.to_string())))
}

fn draw(rows: &[Row]) -> std::result::Result<String, Box<dyn std::error::Error>> {
    let rows: Vec<&Row> = rows.iter().filter(|row| row.phase != Phase::WarmUp && !row.first_use).collect();
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let (upper, lower) = root.split_vertically(SIZE.1 / 2);
        frame_times(&upper, &rows)?;
        bake_times(&lower, &rows)?;
        root.present()?;
    }
    Ok(text)
}

/// The upper panel.
fn frame_times(area: &Area<'_>, rows: &[&Row]) -> Drawn {
    let top = top_of(rows);
    let mut chart = ChartBuilder::on(area)
        .caption("Frame time", TITLE)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..rows.len().max(1) as f64, 0.0..top)?;
    chart
        .configure_mesh()
        .x_desc("measured frame, in the order they ran; the last range measures the overlap")
        .y_desc("milliseconds; what is above is at the edge")
        .label_style(FONT)
        .light_line_style(WHITE.mix(0.0))
        .x_label_formatter(&|x| format!("{x:.0}"))
        .draw()?;
    for (case, colour) in Case::ALL.into_iter().zip(COLOURS) {
        let points = rows.iter().enumerate().filter(|(_, row)| row.case == case);
        let points = points.map(|(index, row)| (index as f64, row.frame_ms.min(top)));
        let label = match case {
            Case::Raster => "raster alone",
            Case::Bake => "bake alone",
            Case::Both => "both",
        };
        chart
            .draw_series(points.map(|point| Circle::new(point, 2, colour.mix(0.6).filled())))?
            .label(label)
            .legend(move |(x, y)| Circle::new((x + 10, y), 4, colour.filled()));
    }
    for (index, (range, budget)) in ranges(rows).into_iter().enumerate() {
        let line = [(range.start as f64, ms(budget)), (range.end as f64, ms(budget))];
        let drawn = chart.draw_series(LineSeries::new(line, BLACK.stroke_width(2)))?;
        if index == 0 {
            drawn
                .label("budget for baking")
                .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], BLACK.stroke_width(2)));
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK)
        .label_font(FONT)
        .draw()?;
    Ok(())
}

/// The lower panel: steps over bins, and each budget as a line.
fn bake_times(area: &Area<'_>, rows: &[&Row]) -> Drawn {
    let mut budgets: Vec<Duration> = rows.iter().map(|row| row.budget).collect();
    budgets.sort_unstable();
    budgets.dedup();
    let of = |budget: Duration| -> Vec<f64> {
        let of_budget = rows.iter().filter(|row| row.phase == Phase::Budget && row.budget == budget);
        of_budget.filter_map(|row| row.bake_ms).filter(|time| *time > 0.0).collect()
    };
    let high = 1.5 * budgets.last().map_or(1.0, |budget| ms(*budget));
    let counts: Vec<(Duration, Vec<usize>)> =
        budgets.iter().map(|budget| (*budget, histogram(&of(*budget), high))).collect();
    let top = counts.iter().flat_map(|(_, counts)| counts).max().copied().unwrap_or(0).max(1) as f64 * 1.1;
    let mut chart = ChartBuilder::on(area)
        .caption("Bake time by budget", TITLE)
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..high, 0.0..top)?;
    chart
        .configure_mesh()
        .x_desc("milliseconds on the device, the last bin for all above; a dotted line is the budget")
        .y_desc("frames")
        .label_style(FONT)
        .light_line_style(WHITE.mix(0.0))
        .y_label_formatter(&|y| format!("{y:.0}"))
        .draw()?;
    for (index, (budget, counts)) in counts.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        chart
            .draw_series(LineSeries::new(steps(counts, high), colour.stroke_width(2)))?
            .label(format!("{} ms", ms(*budget)))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        let line = [(ms(*budget), 0.0), (ms(*budget), top)];
        chart.draw_series(DashedLineSeries::new(line, 2, 4, colour.stroke_width(2)))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK)
        .label_font(FONT)
        .draw()?;
    Ok(())
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Above all budgets and all but the longest half percent of frames.
fn top_of(rows: &[&Row]) -> f64 {
    let mut times: Vec<f64> = rows.iter().map(|row| row.frame_ms).collect();
    times.sort_unstable_by(f64::total_cmp);
    let long = times.get(times.len().saturating_sub(1) * 995 / 1000).copied().unwrap_or(1.0);
    rows.iter().map(|row| ms(row.budget)).fold(long, f64::max) * 1.4
}

/// Ranges of frames of one budget and phase.
fn ranges(rows: &[&Row]) -> Vec<(std::ops::Range<usize>, Duration)> {
    let mut ranges = Vec::new();
    let mut start = 0;
    for range in rows.chunk_by(|a, b| (a.phase, a.budget) == (b.phase, b.budget)) {
        ranges.push((start..start + range.len(), range[0].budget));
        start += range.len();
    }
    ranges
}

/// Counts in bins of one width from 0 to `high`; what is above is in the last.
fn histogram(times: &[f64], high: f64) -> Vec<usize> {
    let mut counts = vec![0; BINS];
    for time in times {
        counts[((time / high * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    counts
}

/// The outline of the bins.
fn steps(counts: &[usize], high: f64) -> Vec<(f64, f64)> {
    let edge = |bin: usize| high * bin as f64 / BINS as f64;
    let step = |(bin, count): (usize, &usize)| [(edge(bin), *count as f64), (edge(bin + 1), *count as f64)];
    counts.iter().enumerate().flat_map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_is_counted_once() {
        let counts = histogram(&[0.0, 1e-4, 2.0, 9.99, 50.0], 10.0);
        assert_eq!((counts[0], counts[BINS - 1], counts.iter().sum::<usize>()), (2, 2, 5));
        assert_eq!(steps(&counts, 10.0).len(), 2 * BINS);
    }

    #[test]
    fn a_plot_of_nothing_is_a_plot() {
        assert!(draw(&[]).expect("can be drawn").ends_with("</svg>\n"));
    }
}
