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

/// Decodes an image to 8-bit RGB, whatever it was. `json` is its description.
///
/// The declared media type is not looked at, the content is: exporters get it wrong.
pub(super) fn decode(image: &Image<'_>, json: &Json, document: &Views<'_>) -> Result<Texture> {
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
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_SIDE), Some(MAX_SIDE));
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(&bytes), format);
    reader.limits(limits);
    let decoded = reader.decode().map_err(fail)?.into_rgba8();
    let (width, height) = decoded.dimensions();
    Ok(Texture { name, width, height, pixels: decoded.pixels().map(|pixel| pixel.0).collect() })
}

/// Where an image's bytes may come from.
pub(super) struct Views<'a> {
    pub(super) views: Vec<gltf::buffer::View<'a>>,
    pub(super) buffers: &'a Buffers,
    pub(super) folder: &'a Path,
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
