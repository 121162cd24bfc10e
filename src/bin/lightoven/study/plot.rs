//! What is missing over the number of bounces, as SVG.

use super::report::{RoomReport, Stiffness};
use crate::report::write_text;
use lightoven::{Error, ErrorKind, Result};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::path::Path;

const SIZE: (u32, u32) = (1000, 700);
const FONT: (&str, i32) = ("sans-serif", 15);
const TITLE: (&str, i32) = ("sans-serif", 18);
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
/// Less than this is rounding.
const LEAST: f64 = 1e-7;
const MOST_BOUNCES: f64 = 600.0;

/// Writes the plot.
pub(super) fn write(path: &Path, stiffness: &Stiffness) -> Result<()> {
    let failed = |why: String| Error::new(ErrorKind::Io, format!("cannot write '{}': {why}", path.display()));
    write_text(path, &draw(stiffness).map_err(|error| failed(error.to_string()))?)
}

fn draw(stiffness: &Stiffness) -> std::result::Result<String, Box<dyn std::error::Error>> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption(format!("a closed room whose walls shine, on {}", stiffness.device), TITLE)
            .margin(12)
            .x_label_area_size(46)
            .y_label_area_size(76)
            .build_cartesian_2d((0.9..MOST_BOUNCES).log_scale(), (LEAST..1.0).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("bounces + 1")
            .y_desc("share of the light that is missing")
            .label_style(FONT)
            .axis_desc_style(FONT)
            .x_label_formatter(&|value| format!("{value:.0}"))
            .y_label_formatter(&|value| format!("{value:.0e}"))
            .bold_line_style(BLACK.mix(0.12))
            .light_line_style(WHITE.mix(0.0))
            .draw()?;
        for (room, colour) in stiffness.rooms.iter().zip(COLOURS.into_iter().cycle()) {
            let predicted = curve(room);
            chart.draw_series(LineSeries::new(predicted, colour.stroke_width(1)))?;
            let points = |figure: fn(&super::report::Row) -> Option<f64>| {
                let place = move |row: &super::report::Row| Some((f64::from(row.bounces) + 1.0, figure(row)?));
                room.rows.iter().filter_map(place).filter(|(_, y)| *y > LEAST).collect::<Vec<_>>()
            };
            chart
                .draw_series(points(|row| Some(row.error)).into_iter().map(|at| Circle::new(at, 4, colour.filled())))?
                .label(format!("albedo {}", room.albedo as f32))
                .legend(move |(x, y)| Circle::new((x + 10, y), 4, colour.filled()));
            chart
                .draw_series(points(|row| row.told).into_iter().map(|at| Cross::new(at, 5, colour.stroke_width(1))))?;
        }
        let named = |name: &str| name.to_owned();
        chart
            .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
            .label(named("line: albedo to the power of bounces + 1"))
            .legend(|(x, y)| DashedPathElement::new([(x, y), (x + 20, y)], 20, 0, GREY.stroke_width(1)));
        chart
            .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
            .label(named("cross: what the bake says is missing"))
            .legend(|(x, y)| Cross::new((x + 10, y), 5, GREY.stroke_width(1)));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.4))
            .label_font(FONT)
            .draw()?;
        root.present()?;
    }
    Ok(text)
}

/// The prediction, as far as it is drawn.
fn curve(room: &RoomReport) -> Vec<(f64, f64)> {
    let places = (0..=200).map(|step| MOST_BOUNCES.powf(f64::from(step) / 200.0));
    places.map(|power| (power, room.albedo.powf(power))).filter(|(_, missing)| *missing > LEAST).collect()
}
