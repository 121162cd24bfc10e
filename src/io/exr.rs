//! OpenEXR: light maps out, light maps and skies in.

use super::write_beside;
use crate::baker::LightMap;
use crate::error::{Error, ErrorKind, Result};
use crate::scene::{SkyMap, decode_srgb};
use exr::prelude as rs;
use exr::prelude::{ReadChannels, ReadLayers, WritableImage};
use glam::Vec3;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Most pixels of an image that is read: 4 GiB of memory. A damaged header could ask for far more.
const MAX_PIXELS: usize = 1 << 28;

/// What a light map says about its making: text attributes of the EXR, each named as its field with `lightoven:` before
/// it (`version` alone is reserved).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Metadata {
    /// Name of the scene.
    pub scene: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Mean number of samples that a texel took.
    pub samples: f64,
    /// Name of the device that baked it.
    pub device: String,
    /// What wrote it, and its version.
    pub version: String,
}

impl Metadata {
    fn attributes(&self) -> [(&'static str, String); 5] {
        [
            ("lightoven:scene", self.scene.clone()),
            ("lightoven:seed", self.seed.to_string()),
            ("lightoven:samples", self.samples.to_string()),
            ("lightoven:device", self.device.clone()),
            ("lightoven:version", self.version.clone()),
        ]
    }
}

/// Writes a light map: R, G, B and A as 32-bit floats, compressed without loss, with `metadata` as text attributes.
/// Written beside and renamed, see [`write_beside`].
///
/// # Errors
/// `Io`, naming the path; `InvalidSettings` where the map has no texels or a wrong number of them.
pub fn write_light_map(path: &Path, light_map: &LightMap, metadata: &Metadata) -> Result<()> {
    let LightMap { width, height, pixels } = light_map;
    let (columns, rows) = (*width as usize, *height as usize);
    if pixels.is_empty() || pixels.len() != columns * rows {
        let found = pixels.len();
        return Err(Error::settings(format!(
            "the light map is {width} x {height} with {found} texels; allowed is width x height of them, at least 1"
        )));
    }
    let channels = rs::SpecificChannels::rgba(|at: rs::Vec2<usize>| {
        let [r, g, b, a] = pixels[at.y() * columns + at.x()];
        (r, g, b, a)
    });
    let mut attributes =
        rs::LayerAttributes { software_name: Some(text(&metadata.version)), ..rs::LayerAttributes::default() };
    for (name, value) in metadata.attributes() {
        attributes.other.insert(text(name), rs::AttributeValue::Text(text(&value)));
    }
    let encoding = rs::Encoding {
        compression: rs::Compression::ZIP16,
        blocks: rs::Blocks::ScanLines,
        line_order: rs::LineOrder::Increasing,
    };
    let image = rs::Image::from_layer(rs::Layer::new((columns, rows), attributes, encoding, channels));
    write_beside(path, |file| {
        let mut buffered = BufWriter::new(file);
        image.write().to_buffered(&mut buffered).map_err(|error| failed("write", path, error))?;
        buffered.flush().map_err(|error| failed("write", path, error))
    })
}

/// Reads the first RGB layer: width, height, and RGBA `[pixel]`, row-major from the top. Channels of any type are
/// converted to f32; a missing A is 1. A data window smaller than the display window is what is read.
///
/// R, G and B come out linear. A header whose attribute `colorInteropID` is `srgb_rec709_display` says that they are
/// sRGB-encoded (Blender 5 saves bakes so when told to encode them for display): they are decoded, which a warning says.
///
/// # Errors
/// `Io`, naming the path: no such file, not an EXR, damaged, larger than 2^28 pixels, or without R, G and B.
pub fn read_image(path: &Path) -> Result<(u32, u32, Vec<[f32; 4]>)> {
    let encoding = check_header(path)?;
    let file = open(path)?;
    let image = rs::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![[0.0; 4]; size.area()]),
            |(columns, pixels): &mut (usize, Vec<[f32; 4]>), at, (r, g, b, a): (f32, f32, f32, f32)| {
                pixels[at.y() * *columns + at.x()] = [r, g, b, a];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(std::io::BufReader::new(file))
        .map_err(|error| failed("read", path, error))?;
    let size = image.layer_data.size;
    let mut pixels = image.layer_data.channel_data.pixels.1;
    encoding.decode(&mut pixels);
    // `check_header` keeps both far below 2^32.
    Ok((size.width() as u32, size.height() as u32, pixels))
}

/// What R, G and B hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ColourEncoding {
    Linear,
    /// IEC 61966-2-1.
    Srgb,
}

impl ColourEncoding {
    /// As the header says by an identifier of the Color Interop Forum; without one an EXR is linear.
    fn of(header: &exr::meta::header::Header, path: &Path) -> Self {
        let name = text("colorInteropID");
        let attributes = [&header.own_attributes.other, &header.shared_attributes.other];
        let Some(value) = attributes.into_iter().find_map(|other| other.get(&name)) else { return Self::Linear };
        let identifier = match value {
            rs::AttributeValue::Text(value) => value.to_string(),
            _ => "not a text".into(),
        };
        let path = path.display();
        match identifier.as_str() {
            "lin_rec709_scene" | "data" => Self::Linear,
            "srgb_rec709_display" => {
                tracing::warn!("'{path}' is sRGB-encoded, as its colorInteropID {identifier} says: it is decoded");
                Self::Srgb
            }
            _ => {
                tracing::warn!("the colorInteropID of '{path}', {identifier}, is not known: it is read as linear");
                Self::Linear
            }
        }
    }

    /// Makes R, G and B linear; what is below 0 is mirrored, as extended sRGB has it.
    fn decode(self, pixels: &mut [[f32; 4]]) {
        if self == Self::Srgb {
            for channel in pixels.iter_mut().flat_map(|pixel| &mut pixel[..3]) {
                *channel = decode_srgb(channel.abs()).copysign(*channel);
            }
        }
    }
}

/// Reads an equirectangular sky. Its values are checked when it is made a scene's sky.
///
/// # Errors
/// As [`read_image`].
pub fn read_sky(path: &Path) -> Result<SkyMap> {
    let (width, height, pixels) = read_image(path)?;
    Ok(SkyMap { width, height, pixels: pixels.into_iter().map(|[r, g, b, _]| Vec3::new(r, g, b)).collect() })
}

/// Rejects what the reader would allocate without a limit, or describe without the names that matter. Tells how the
/// layer that is read is encoded.
fn check_header(path: &Path) -> Result<ColourEncoding> {
    let file = std::io::BufReader::new(open(path)?);
    let meta = exr::meta::MetaData::read_from_buffered(file, false).map_err(|error| failed("read", path, error))?;
    let unusable = |why: String| Err(Error::new(ErrorKind::Io, format!("cannot read '{}': {why}", path.display())));
    if let Some(header) = meta.headers.iter().find(|header| header.layer_size.area() > MAX_PIXELS) {
        let (width, height) = (header.layer_size.width(), header.layer_size.height());
        return unusable(format!("it is {width} x {height}; allowed is at most {MAX_PIXELS} pixels"));
    }
    let has =
        |header: &exr::meta::header::Header, name: &str| header.channels.find_index_of_channel(&text(name)).is_some();
    if let Some(header) = meta.headers.iter().find(|header| ["R", "G", "B"].iter().all(|name| has(header, name))) {
        return Ok(ColourEncoding::of(header, path));
    }
    let names: Vec<String> =
        meta.headers.iter().flat_map(|header| &header.channels.list).map(|channel| channel.name.to_string()).collect();
    unusable(format!("it has the channels {}; needed are R, G and B", names.join(", ")))
}

fn open(path: &Path) -> Result<File> {
    File::open(path).map_err(|error| failed("open", path, error))
}

fn failed(what: &str, path: &Path, error: impl std::error::Error + Send + Sync + 'static) -> Error {
    Error::new(ErrorKind::Io, format!("cannot {what} '{}'", path.display())).with_source(error)
}

/// UTF-8 as it is: the library's own conversion refuses what is not Latin-1.
fn text(text: &str) -> rs::Text {
    rs::Text::from_slice_unchecked(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light_map() -> LightMap {
        let (width, height) = (37, 21);
        let mut pixels: Vec<[f32; 4]> = (0..width * height)
            .map(|i| [i as f32 / 3.0, 1e-6 * i as f32, 1e9 / (i + 1) as f32, (i % 2) as f32])
            .collect();
        pixels[5] = [f32::MAX, f32::MIN_POSITIVE, -1.0, 0.5];
        LightMap { width, height, pixels }
    }

    fn write_channels<C>(path: &Path, channels: C)
    where
        C: for<'s> exr::image::write::channels::WritableChannels<'s>,
    {
        rs::Image::from_channels((2, 2), channels).write().to_file(path).expect("can be written");
    }

    #[test]
    fn a_light_map_comes_back_bit_by_bit_with_its_metadata() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("out.exr");
        let metadata = Metadata {
            scene: "Höhle 洞".into(),
            seed: u64::MAX,
            samples: 12.5,
            device: "a device".into(),
            version: "lightoven 0".into(),
        };
        write_light_map(&path, &light_map(), &metadata).expect("can be written");
        let (width, height, pixels) = read_image(&path).expect("can be read");
        assert_eq!((width, height), (37, 21));
        assert_eq!(pixels, light_map().pixels);
        let meta = exr::meta::MetaData::read_from_file(&path, true).expect("is a valid EXR");
        for (name, value) in metadata.attributes() {
            let found = &meta.headers[0].own_attributes.other[&text(name)];
            assert_eq!(*found, rs::AttributeValue::Text(text(&value)), "{name}");
        }
    }

    #[test]
    fn half_and_integer_channels_are_converted_and_a_missing_alpha_is_one() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("in.exr");
        write_channels(
            &path,
            rs::SpecificChannels::rgb(|at: rs::Vec2<usize>| (rs::f16::from_f32(0.5), at.x() as u32, 2.5_f32)),
        );
        let (_, _, pixels) = read_image(&path).expect("can be read");
        assert_eq!(pixels, [[0.5, 0.0, 2.5, 1.0], [0.5, 1.0, 2.5, 1.0], [0.5, 0.0, 2.5, 1.0], [0.5, 1.0, 2.5, 1.0]]);
        let sky = read_sky(&path).expect("can be read");
        assert_eq!((sky.width, sky.height, sky.pixels[1]), (2, 2, Vec3::new(0.5, 1.0, 2.5)));
    }

    /// Writes one pixel with this `colorInteropID` and reads it.
    fn read_identified(identifier: Option<&str>, pixel: [f32; 4]) -> [f32; 4] {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("in.exr");
        let [r, g, b, a] = pixel;
        let channels = rs::SpecificChannels::rgba(|_: rs::Vec2<usize>| (r, g, b, a));
        let mut image = rs::Image::from_channels((1, 1), channels);
        if let Some(identifier) = identifier {
            let value = rs::AttributeValue::Text(text(identifier));
            image.layer_data.attributes.other.insert(text("colorInteropID"), value);
        }
        image.write().to_file(&path).expect("can be written");
        read_image(&path).expect("can be read").2[0]
    }

    #[test]
    fn display_encoded_colours_are_decoded() {
        // IEC 61966-2-1: the linear part, a mid grey, white; above 1 the curve goes on; below 0 it is mirrored.
        let found = read_identified(Some("srgb_rec709_display"), [0.02, 0.5, 1.0, 0.5]);
        let expected = [0.02 / 12.92, 0.214_041_14, 1.0, 0.5];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} for {expected:?}");
        let found = read_identified(Some("srgb_rec709_display"), [2.0, -0.5, 0.0, 1.0]);
        let expected = [4.953_846, -0.214_041_14, 0.0, 1.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} for {expected:?}");
    }

    #[test]
    fn other_colours_are_as_they_are() {
        let pixel = [0.02, 0.5, 2.0, 0.5];
        for identifier in [None, Some("lin_rec709_scene"), Some("data"), Some("lin_ap1_scene"), Some("")] {
            assert_eq!(read_identified(identifier, pixel), pixel, "{identifier:?}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("in.exr");
        let message = || read_image(&path).expect_err("must fail").to_string();
        assert!(message().contains("in.exr"), "{}", message());
        std::fs::write(&path, "not an image").expect("can be written");
        assert!(message().contains("in.exr"), "{}", message());
        write_channels(&path, rs::SpecificChannels::build().with_channel("Y").with_pixel_fn(|_| (1.0_f32,)));
        assert!(message().contains("the channels Y; needed are R, G and B"), "{}", message());
        write_light_map(&path, &light_map(), &Metadata::default()).expect("can be written");
        let bytes = std::fs::read(&path).expect("is there");
        std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("can be written");
        assert!(message().contains("in.exr"), "{}", message());
    }

    #[test]
    fn a_map_of_a_wrong_size_is_rejected() {
        let folder = tempfile::tempdir().expect("has room");
        let path = folder.path().join("out.exr");
        let light_map = LightMap { width: 2, height: 2, pixels: vec![[0.0; 4]; 3] };
        let error = write_light_map(&path, &light_map, &Metadata::default()).expect_err("must fail");
        assert!(error.to_string().contains("2 x 2 with 3 texels"), "{error}");
        assert!(!path.exists());
    }
}
