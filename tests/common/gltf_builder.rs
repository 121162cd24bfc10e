//! Builds glTF documents in memory.

use serde_json::{Value, json};

/// A document that grows, and the one buffer that its views look into.
pub(crate) struct Builder {
    /// Everything but `buffers`.
    pub(crate) root: Value,
    /// The buffer, little-endian, views aligned to 4 bytes.
    pub(crate) binary: Vec<u8>,
}

impl Builder {
    pub(crate) fn new() -> Self {
        Self { root: json!({ "asset": { "version": "2.0" } }), binary: Vec::new() }
    }

    /// Appends to one of the document's lists and gives the position.
    pub(crate) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = &mut self.root[list];
        if list.is_null() {
            *list = json!([]);
        }
        let list = list.as_array_mut().expect("is a list");
        list.push(value);
        list.len() - 1
    }

    /// Appends bytes and a view of them.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// Appends vectors, their view and an accessor.
    pub(crate) fn vectors<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..N).map(|c| values.iter().map(|value| value[c]).reduce(pick).expect("has elements")).collect()
        };
        self.push(
            "accessors",
            json!({
                "bufferView": view, "componentType": 5126, "count": values.len(), "type": format!("VEC{N}"),
                "min": bound(f32::min), "max": bound(f32::max),
            }),
        )
    }

    /// Appends 16-bit indices, their view and an accessor.
    pub(crate) fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5123, "count": values.len(), "type": "SCALAR" }),
        )
    }

    /// The document with its buffer as a data URI.
    pub(crate) fn embedded(&self) -> String {
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.binary));
        let mut root = self.root.clone();
        root["buffers"] = json!([{ "byteLength": self.binary.len(), "uri": uri }]);
        let mut text = serde_json::to_string_pretty(&root).expect("is JSON");
        text.push('\n');
        text
    }
}

/// RFC 4648, with padding.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = (0..3).fold(0, |word, i| word << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        for digit in 0..4 {
            let value = word >> (18 - 6 * digit) & 63;
            text.push(if digit <= chunk.len() { char::from(DIGITS[value as usize]) } else { '=' });
        }
    }
    text
}

/// A PNG file of 8-bit RGB pixels.
pub(crate) fn png(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let image = image::RgbImage::from_fn(width, height, |x, y| image::Rgb(pixel(x, y)));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("fits into memory");
    bytes.into_inner()
}
