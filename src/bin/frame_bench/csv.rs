//! A row for each frame.

use crate::row::Row;
use lightoven::io::write_beside;
use lightoven::{Error, ErrorKind, Result};
use std::io::Write as _;
use std::path::Path;

/// Writes all frames, those of the warm-up too.
pub(crate) fn write(path: &Path, rows: &[Row]) -> Result<()> {
    write_beside(path, |file| {
        file.write_all(text(rows).as_bytes())
            .map_err(|error| Error::new(ErrorKind::Io, format!("cannot write '{}'", path.display())).with_source(error))
    })
}

fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "index,budget_ms,case,frame_ms,bake_ms,rays,ran,phase,raster_ms,samples_per_texel,first_use,predicted_ms,one_unit_ms\n",
    );
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6}"));
    for (index, row) in rows.iter().enumerate() {
        let fields = [
            index.to_string(),
            format!("{}", row.budget.as_secs_f64() * 1e3),
            row.case.name().into(),
            format!("{:.6}", row.frame_ms),
            number(row.bake_ms),
            row.rays.to_string(),
            quoted(&row.ran),
            row.phase.name().into(),
            number(row.raster_ms),
            format!("{:.6}", row.samples_per_texel),
            u8::from(row.first_use).to_string(),
            number(Some(row.predicted_ms)),
            number(Some(row.one_unit_ms)),
        ];
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}

/// A field in quotes where it has something that would end it (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::{Case, Phase};
    use std::time::Duration;

    #[test]
    fn a_frame_is_a_row() {
        let row = Row {
            phase: Phase::Budget,
            budget: Duration::from_micros(2500),
            case: Case::Both,
            frame_ms: 1.5,
            raster_ms: None,
            bake_ms: Some(0.25),
            predicted_ms: 0.5,
            one_unit_ms: 0.125,
            rays: 640,
            samples_per_texel: 0.5,
            ran: "A, B".into(),
            first_use: true,
        };
        let text = text(&[row]);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[1], "0,2.5,both,1.500000,0.250000,640,\"A, B\",budget,,0.500000,1,0.500000,0.125000");
        assert_eq!(lines[0].split(',').count(), 13);
    }
}
