//! relMSE over the time of baking, as SVG.

use super::report::{Floor, Report, Variant};
use crate::report::write_text;
use lightoven::{Error, ErrorKind, Result};
use plotters::coord::Shift;
use plotters::coord::combinators::{LogCoord, WithKeyPoints};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::ops::Range;
use std::path::Path;

const SIZE: (u32, u32) = (1000, 700);
const FONT: (&str, i32) = ("sans-serif", 15);
const TITLE: (&str, i32) = ("sans-serif", 18);
/// Share of both axes that the legend may take.
const LEGEND: f64 = 0.4;

/// Colours that are told apart with any eyes (Okabe and Ito), without the yellow, which is pale on white.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
const GREY: RGBColor = RGBColor(110, 110, 110);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a> =
    ChartContext<'a, SVGBackend<'a>, Cartesian2d<WithKeyPoints<LogCoord<f64>>, WithKeyPoints<LogCoord<f64>>>>;
type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;

/// Writes the plot.
pub(super) fn write(path: &Path, report: &Report) -> Result<()> {
    let failed = |why: String| Error::new(ErrorKind::Io, format!("cannot write '{}': {why}", path.display()));
    write_text(path, &draw(report).map_err(|error| failed(error.to_string()))?)
}

fn draw(report: &Report) -> std::result::Result<String, Box<dyn std::error::Error>> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        draw_on(&root, report)?;
        root.present()?;
    }
    Ok(text)
}

fn draw_on(area: &Area<'_>, report: &Report) -> Drawn {
    let (times, errors) = ranges(report);
    let [width, height] = report.resolution;
    let mut chart = ChartBuilder::on(area)
        .caption(format!("{}, {width} x {height}, on {}", report.scene, report.device), TITLE)
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(76)
        .build_cartesian_2d(axis(&times), axis(&errors))?;
    chart
        .configure_mesh()
        .x_desc("seconds of baking")
        .y_desc("relMSE against the reference")
        .label_style(FONT)
        .axis_desc_style(FONT)
        .x_label_formatter(&|value| label(*value))
        .y_label_formatter(&|value| label(*value))
        .bold_line_style(BLACK.mix(0.12))
        .light_line_style(WHITE.mix(0.0))
        .draw()?;
    minus_one(&mut chart, report, &times, &errors)?;
    if let Some(noise) = report.reference.relmse.filter(|noise| *noise > 0.0) {
        dashed(
            &mut chart,
            [(times.start, noise), (times.end, noise)],
            GREY.to_rgba(),
            2,
            "the reference's own noise".into(),
        )?;
    }
    for (variant, colour) in report.variants.iter().zip(COLOURS.into_iter().cycle()) {
        line(&mut chart, variant, colour)?;
        floor(&mut chart, variant, colour, &times)?;
    }
    chart
        .configure_series_labels()
        .position(legend_corner(report, &times, &errors))
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.4))
        .label_font(FONT)
        .draw()?;
    Ok(())
}

/// What the error would do as the inverse of the time, through the last point that the first variant's slope is fitted to.
fn minus_one(chart: &mut Chart<'_>, report: &Report, times: &Range<f64>, errors: &Range<f64>) -> Drawn {
    let row = report.variants.iter().find_map(Variant::last_fitted);
    let Some(product) = row.map(|row| row.relmse * row.seconds).filter(|product| *product > 0.0) else { return Ok(()) };
    let (first, last) = (times.start.max(product / errors.end), times.end.min(product / errors.start));
    dashed(chart, [(first, product / first), (last, product / last)], GREY.to_rgba(), 8, "slope -1".into())
}

fn line(chart: &mut Chart<'_>, variant: &Variant, colour: RGBColor) -> Drawn {
    let points: Vec<(f64, f64)> = points(variant).collect();
    let slope = variant.slope.map_or(String::new(), |slope| format!(": slope {slope:.2}"));
    chart
        .draw_series(LineSeries::new(points.clone(), colour.stroke_width(2)))?
        .label(format!("{}{slope}", variant.name()))
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
    chart.draw_series(points.into_iter().map(|point| Circle::new(point, 4, colour.filled())))?;
    Ok(())
}

fn floor(chart: &mut Chart<'_>, variant: &Variant, colour: RGBColor, times: &Range<f64>) -> Drawn {
    let (height, what, colour) = match variant.floor() {
        Some(Floor::At(height)) => (height, "bias floor", colour.to_rgba()),
        Some(Floor::Below(height)) if height > 0.0 => (height, "the bias floor is below", colour.mix(0.5)),
        _ => return Ok(()),
    };
    dashed(chart, [(times.start, height), (times.end, height)], colour, 5, format!("{}: {what}", variant.name()))
}

fn dashed(chart: &mut Chart<'_>, ends: [(f64, f64); 2], colour: RGBAColor, dash: i32, label: String) -> Drawn {
    let style = colour.stroke_width(2);
    chart
        .draw_series(DashedLineSeries::new(ends, dash, dash, style))?
        .label(label)
        .legend(move |(x, y)| DashedPathElement::new([(x, y), (x + 20, y)], dash, dash, style));
    Ok(())
}

/// Where fewer points would be hidden: errors that fall leave both corners free.
fn legend_corner(report: &Report, times: &Range<f64>, errors: &Range<f64>) -> SeriesLabelPosition {
    // 0 to 1 along an axis.
    let place = |value: f64, range: &Range<f64>| (value / range.start).ln() / (range.end / range.start).ln();
    let places = || report.variants.iter().flat_map(points).map(|(x, y)| (place(x, times), place(y, errors)));
    let lower_left = places().filter(|(x, y)| *x < LEGEND && *y < LEGEND).count();
    let upper_right = places().filter(|(x, y)| *x > 1.0 - LEGEND && *y > 1.0 - LEGEND).count();
    if upper_right <= lower_left { SeriesLabelPosition::UpperRight } else { SeriesLabelPosition::LowerLeft }
}

/// What can be drawn on logarithmic axes.
fn points(variant: &Variant) -> impl Iterator<Item = (f64, f64)> {
    let points = variant.rows.iter().map(|row| (row.seconds, row.relmse));
    points.filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
}

/// Of both axes: all that is drawn, and some room around it.
fn ranges(report: &Report) -> (Range<f64>, Range<f64>) {
    let points: Vec<(f64, f64)> = report.variants.iter().flat_map(points).collect();
    let floors = report.variants.iter().filter_map(|variant| match variant.floor()? {
        Floor::At(height) | Floor::Below(height) => Some(height),
    });
    let heights = floors.chain(report.reference.relmse).filter(|height| *height > 0.0);
    let times = range(points.iter().map(|point| point.0), 1.3);
    (times, range(points.iter().map(|point| point.1).chain(heights), 2.0))
}

/// Of values over 0; something where there are none.
fn range(values: impl Iterator<Item = f64>, room: f64) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
    if low <= high { low / room..high * room } else { 0.1..10.0 }
}

/// Logarithmic, with marks of our own: plotters' own begin at the first power of ten.
fn axis(range: &Range<f64>) -> WithKeyPoints<LogCoord<f64>> {
    range.clone().log_scale().with_key_points(ticks(range))
}

/// 1, 2 and 5 times the powers of ten, or the powers alone where there are many.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let digits: &[f64] = if range.end / range.start > 1e3 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let powers = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let all = powers.flat_map(|power| digits.iter().map(move |digit| digit * 10.0_f64.powi(power)));
    all.filter(|value| range.contains(value)).collect()
}

/// Of such a mark.
fn label(value: f64) -> String {
    let power = (value.log10() + 1e-9).floor() as i32;
    let digit = (value / 10.0_f64.powi(power)).round();
    let places = usize::try_from(-power).unwrap_or_default();
    if (-2..=3).contains(&power) { format!("{value:.places$}") } else { format!("{digit}e{power}") }
}

#[cfg(test)]
mod tests {
    use super::super::report::tests::{report, row};
    use super::*;

    #[test]
    fn all_that_is_measured_is_in_the_plot() {
        let rows = [(0.125, 0.4), (0.5, 0.1), (2.0, 0.025)];
        let found = report(rows.map(|(seconds, relmse)| row(seconds, relmse, Some(0.05))).into());
        let text = draw(&found).expect("can be drawn");
        for label in [
            "box, 32 x 16, on a device",
            "seconds of baking",
            "relMSE against the reference",
            "auto, software: slope -1.00",
            "auto, software: bias floor",
            "slope -1\n",
            "the reference&apos;s own noise",
        ] {
            assert!(text.contains(label), "'{label}' is missing in {text}");
        }
        assert!(text.ends_with("</svg>\n"));
        assert_eq!(text.matches("<circle").count(), 3);
    }

    #[test]
    fn a_plot_of_little_is_a_plot() {
        for rows in [vec![], vec![row(1.0, 0.0, None)], vec![row(1.0, 0.5, None)]] {
            assert!(draw(&report(rows)).expect("can be drawn").ends_with("</svg>\n"));
        }
    }

    #[test]
    fn the_legend_goes_where_no_points_are() {
        let corner = |rows: &[(f64, f64)]| {
            let found = report(rows.iter().map(|(seconds, relmse)| row(*seconds, *relmse, None)).collect());
            legend_corner(&found, &(0.1..10.0), &(1e-4..1.0))
        };
        assert!(matches!(corner(&[(0.1, 1.0), (1.0, 1e-2), (10.0, 1e-4)]), SeriesLabelPosition::UpperRight));
        assert!(matches!(corner(&[(0.2, 1e-3), (10.0, 1e-4)]), SeriesLabelPosition::UpperRight));
        assert!(matches!(corner(&[(0.1, 1.0), (10.0, 0.5)]), SeriesLabelPosition::LowerLeft));
    }

    #[test]
    fn marks_begin_and_end_within_the_range() {
        let labels = |range: Range<f64>| ticks(&range).into_iter().map(label).collect::<Vec<_>>();
        assert_eq!(labels(0.109..3.0), ["0.2", "0.5", "1", "2"]);
        assert_eq!(labels(0.015..0.06), ["0.02", "0.05"]);
        assert_eq!(labels(2e-5..300.0), ["1e-4", "1e-3", "0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(3e3..7e5), ["5000", "1e4", "2e4", "5e4", "1e5", "2e5", "5e5"]);
    }
}
