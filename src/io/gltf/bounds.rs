//! Buffers and views into them; every offset is checked in 64 bits before it is used.

use super::resource::read_uri;
use crate::error::{Error, Result};
use gltf::Document;
use gltf::buffer::{Source, View};
use std::path::Path;
use std::slice::ChunksExact;

/// The bytes of a document's buffers.
pub(super) struct Buffers {
    data: Vec<Vec<u8>>,
}

impl Buffers {
    /// Reads all buffers, in the document's order; `binary` is a `.glb`'s own.
    pub(super) fn load(document: &Document, binary: Option<Vec<u8>>, folder: Option<&Path>) -> Result<Self> {
        let mut binary = binary;
        let mut data = Vec::with_capacity(document.buffers().len());
        for buffer in document.buffers() {
            let index = buffer.index();
            let mut bytes = match buffer.source() {
                Source::Uri(uri) => read_uri(uri, folder, || format!("buffer {index}"))?,
                Source::Bin => binary.take().ok_or_else(|| {
                    Error::scene(format!("buffer {index} has no URI, and there is no GLB binary chunk left for it"))
                })?,
            };
            let (found, expected) = (bytes.len(), buffer.length());
            if found < expected {
                return Err(Error::scene(format!(
                    "buffer {index}{} has {found} bytes; its byteLength is {expected}",
                    located(&buffer.source())
                )));
            }
            bytes.truncate(expected);
            data.push(bytes);
        }
        Ok(Self { data })
    }

    /// The bytes of a view.
    pub(super) fn view(&self, view: &View<'_>) -> Result<&[u8]> {
        let buffer = view.buffer().index();
        let (offset, length) = (view.offset(), view.length());
        let bytes = self.data.get(buffer).map_or(&[][..], Vec::as_slice);
        offset.checked_add(length).and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
            Error::scene(format!(
                "buffer view {} is {length} bytes at offset {offset} of buffer {buffer}, which has {}",
                view.index(),
                bytes.len()
            ))
        })
    }

    /// `count` elements of `size` bytes from `offset` into a view on, as far apart as the view says.
    pub(super) fn elements(&self, view: &View<'_>, layout: Layout, what: impl Fn() -> String) -> Result<Elements<'_>> {
        let bytes = self.view(view)?;
        let Layout { offset, count, size } = layout;
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return Err(Error::scene(format!(
                "{}: the stride of buffer view {} is {stride} bytes; its elements have {size}",
                what(),
                view.index()
            )));
        }
        let span = (count as u64).checked_sub(1).and_then(|steps| steps.checked_mul(stride as u64));
        let end = span.and_then(|span| span.checked_add(offset as u64)?.checked_add(size as u64));
        match end {
            Some(end) if end <= bytes.len() as u64 => {
                Ok(Elements { bytes: &bytes[offset..end as usize], stride, size })
            }
            _ => Err(Error::scene(format!(
                "{}: {count} elements of {size} bytes, {stride} apart, from offset {offset} on end outside buffer view \
                 {}, which has {} bytes",
                what(),
                view.index(),
                bytes.len()
            ))),
        }
    }
}

/// Where elements lie in a view.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    /// Bytes before the first element.
    pub(super) offset: usize,
    /// At least 1.
    pub(super) count: usize,
    /// Bytes of an element.
    pub(super) size: usize,
}

/// Elements that lie within their view.
pub(super) struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    /// The bytes of each element.
    pub(super) fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let size = self.size;
        // The last element may be shorter than the stride.
        let whole: ChunksExact<'a, u8> = self.bytes.chunks_exact(self.stride);
        let last = Some(whole.remainder()).filter(|rest| rest.len() >= size);
        whole.chain(last).map(move |element| &element[..size])
    }
}

fn located(source: &Source<'_>) -> String {
    match source {
        Source::Uri(uri) if !uri.starts_with("data:") => format!(" ('{uri}')"),
        _ => String::new(),
    }
}
