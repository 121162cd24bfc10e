//! A picture of a light map, for the eye.

use super::{luminance, write_beside};
use crate::baker::LightMap;
use crate::error::{Error, ErrorKind, Result};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Linear value that the 99th percentile of luminance is shown at: sRGB 243 of 255, so that the brightest texels of a
/// lamp's surroundings are white and what lies below keeps its contrast.
const BRIGHT: f64 = 0.9;

/// Writes an 8-bit sRGB PNG of a light map. Every texel is multiplied by one factor, chosen so that the 99th percentile
/// of the covered texels' luminance (Rec. 709) is shown at 0.9 linear; what exceeds 1 is white, or its channel full.
/// A black map stays black. Written beside and renamed, see [`write_beside`].
///
/// # Errors
/// `Io`, naming the path.
pub fn write_preview(path: &Path, light_map: &LightMap) -> Result<()> {
    let LightMap { width, height, pixels } = light_map;
    let exposure = exposure(pixels);
    let bytes: Vec<u8> =
        pixels.iter().flat_map(|[r, g, b, _]| [r, g, b].map(|c| encode(f64::from(*c) * exposure))).collect();
    let context = || format!("cannot write '{}'", path.display());
    write_beside(path, |file| {
        let mut buffered = BufWriter::new(file);
        let encoder = PngEncoder::new(&mut buffered);
        encoder
            .write_image(&bytes, *width, *height, ExtendedColorType::Rgb8)
            .map_err(|error| Error::new(ErrorKind::Io, context()).with_source(error))?;
        buffered.flush().map_err(|error| Error::io(context(), error))
    })
}

/// The factor that brings the 99th percentile of luminance to [`BRIGHT`]; 1 for a black map.
fn exposure(pixels: &[[f32; 4]]) -> f64 {
    let covered = pixels.iter().filter(|pixel| pixel[3] > 0.5);
    let mut values: Vec<f64> = covered.map(|pixel| luminance(*pixel)).filter(|l| l.is_finite()).collect();
    if values.is_empty() {
        return 1.0;
    }
    let index = (values.len() - 1) * 99 / 100;
    let (_, percentile, _) = values.select_nth_unstable_by(index, f64::total_cmp);
    if *percentile > 0.0 { BRIGHT / *percentile } else { 1.0 }
}

/// Linear to 8-bit sRGB (IEC 61966-2-1); what is not a number is black.
fn encode(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_99th_percentile_is_near_white() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("preview.png");
        let grey = |c: f32| [c, c, c, 1.0];
        let mut pixels: Vec<[f32; 4]> = (0..200).map(|i| grey(1e-3 * i as f32)).collect();
        pixels[0] = [1e6, 1e6, 1e6, 0.0];
        pixels[1] = [f32::NAN, 0.0, 0.0, 1.0];
        write_preview(&path, &LightMap { width: 20, height: 10, pixels }).expect("can be written");
        let png = image::open(&path).expect("is an image").to_rgb8();
        assert_eq!(png.dimensions(), (20, 10));
        assert_eq!(png.get_pixel(0, 0).0, [255; 3], "a gutter texel is clipped and does not count");
        assert_eq!(png.get_pixel(1, 0).0, [0; 3]);
        assert_eq!(png.get_pixel(17, 9).0, [243; 3]);
    }

    #[test]
    fn a_black_map_stays_black() {
        assert_eq!(exposure(&[[0.0, 0.0, 0.0, 1.0]; 4]), 1.0);
        assert_eq!(exposure(&[]), 1.0);
        assert_eq!((encode(0.0), encode(1.0), encode(0.5), encode(f64::NAN)), (0, 255, 188, 0));
    }
}
