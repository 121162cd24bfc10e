//! Encoded images to textures.

use super::bounds::Buffers;
use super::names;
use super::resource::read_uri;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::Texture;
use gltf::Image;
use gltf::json::image::Image as Json;
use image::{ImageReader, Limits};
use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

/// Largest side of an image, in pixels.
const MAX_SIDE: u32 = 16384;

/// Bytes that decoding one image may take: 16384 x 16384 pixels of 4 x 16 bits.
const MAX_DECODED_BYTES: u64 = 1 << 31;

/// Pixels of all images of a file at most: 4 GiB of textures. A small file that shows one picture a thousand times is a
/// trap.
const MAX_PIXELS: u64 = 1 << 30;

/// Pixels in a byte of an image at most: deflate makes 1,032 bytes of one, each of eight pixels where they are black or
/// white. What has more is cut off, and memory for it would be taken for nothing.
const MAX_PIXELS_PER_BYTE: u64 = 1 << 14;

/// Decodes an image to 8-bit RGB, whatever it was. `json` is its description, `pixels` counts those of all images.
///
/// The declared media type is not looked at, the content is: exporters get it wrong.
pub(super) fn decode(image: &Image<'_>, json: &Json, document: &Views<'_>, pixels: &mut u64) -> Result<Texture> {
    let name = names::of_image(image, json.uri.as_deref());
    let what = || format!("image {} ('{}')", image.index(), name.escape_debug());
    let bytes = encoded(json, document, what)?;
    let fail = |error: image::ImageError| {
        let kind = match error {
            image::ImageError::Unsupported(_) => ErrorKind::Unsupported,
            _ => ErrorKind::InvalidScene,
        };
        Error::new(kind, format!("decode {}", what())).with_source(error)
    };
    let Ok(format) = image::guess_format(&bytes) else {
        let context = format!("{} is in an unknown format; allowed are PNG and JPEG", what());
        return Err(Error::new(ErrorKind::Unsupported, context));
    };
    let size = ImageReader::with_format(Cursor::new(&bytes), format).into_dimensions().map_err(fail)?;
    check_size(size, bytes.len(), pixels).map_err(|wrong| Error::scene(format!("{} {wrong}", what())))?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_SIDE), Some(MAX_SIDE));
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(&bytes), format);
    reader.limits(limits);
    let decoded = reader.decode().map_err(fail)?.into_rgba8();
    let (width, height) = decoded.dimensions();
    Ok(Texture { name, width, height, pixels: decoded.pixels().map(|pixel| pixel.0).collect() })
}

/// Counts an image's pixels before there is memory for them; `Err`: what is wrong with their number.
fn check_size((width, height): (u32, u32), bytes: usize, pixels: &mut u64) -> Result<(), String> {
    let own = u64::from(width) * u64::from(height);
    if own > MAX_PIXELS_PER_BYTE.saturating_mul(bytes as u64) {
        return Err(format!("is {width} x {height} pixels; its {bytes} bytes cannot hold as many"));
    }
    *pixels = pixels.saturating_add(own);
    if *pixels > MAX_PIXELS {
        return Err(format!("is {width} x {height} pixels; with it the file has more than the {MAX_PIXELS} allowed"));
    }
    Ok(())
}

/// Where an image's bytes may come from.
pub(super) struct Views<'a> {
    pub(super) views: Vec<gltf::buffer::View<'a>>,
    pub(super) buffers: &'a Buffers,
    pub(super) folder: Option<&'a Path>,
}

/// The crate's own accessor panics where an image has neither a view with a media type nor a URI.
fn encoded<'a>(json: &Json, document: &Views<'a>, what: impl Fn() -> String) -> Result<Cow<'a, [u8]>> {
    match (&json.buffer_view, &json.uri) {
        (Some(index), _) => {
            let view = document.views.get(index.value());
            let missing = || Error::scene(format!("{}: there is no buffer view {index}", what()));
            Ok(Cow::Borrowed(document.buffers.view(view.ok_or_else(missing)?)?))
        }
        (None, Some(uri)) => Ok(Cow::Owned(read_uri(uri, document.folder, what)?)),
        (None, None) => Err(Error::scene(format!("{} has neither a URI nor a buffer view", what()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_counted_over_all_images() {
        let mut pixels = 0;
        for _ in 0..4 {
            assert_eq!(check_size((MAX_SIDE, MAX_SIDE), 1 << 20, &mut pixels), Ok(()));
        }
        let error = check_size((1, 1), 70, &mut pixels).expect_err("is one too many");
        assert!(error.contains("1 x 1 pixels") && error.contains("1073741824"), "{error}");
    }

    #[test]
    fn no_image_has_more_pixels_than_its_bytes_can_hold() {
        // The densest there are: black, one bit a pixel, deflated 1,032 times.
        assert_eq!(check_size((MAX_SIDE, MAX_SIDE), 32_600, &mut 0), Ok(()));
        assert!(check_size((MAX_SIDE, MAX_SIDE), 64, &mut 0).is_err());
    }
}
