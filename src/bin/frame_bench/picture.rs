//! The screenshot as a file.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use lightoven::io::write_beside;
use lightoven::{Error, ErrorKind, Result};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a PNG; `pixels` are four bytes each, row-major from the top, sRGB-encoded. Alpha is left out.
pub(crate) fn write(path: &Path, [width, height]: [u32; 2], pixels: &[u8]) -> Result<()> {
    let colours: Vec<u8> = pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let context = || format!("cannot write '{}'", path.display());
    write_beside(path, |file| {
        let mut buffered = BufWriter::new(file);
        PngEncoder::new(&mut buffered)
            .write_image(&colours, width, height, ExtendedColorType::Rgb8)
            .map_err(|error| Error::new(ErrorKind::Io, context()).with_source(error))?;
        buffered.flush().map_err(|error| Error::new(ErrorKind::Io, context()).with_source(error))
    })
}
