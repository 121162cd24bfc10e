//! The outermost layer of a file: JSON alone, or GLB chunks.

use super::resource::read_file;
use crate::error::{Error, ErrorKind, Result};
use std::path::Path;

const MAGIC: &[u8; 4] = b"glTF";
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// What a file holds.
pub(super) struct Container {
    pub(super) json: Vec<u8>,
    /// A `.glb`'s own buffer.
    pub(super) binary: Option<Vec<u8>>,
}

/// Reads a file and takes its container apart.
pub(super) fn open(path: &Path) -> Result<Container> {
    take_apart(path, read_file(path, || "the scene".into())?)
}

/// Takes a file's container apart.
pub(super) fn take_apart(path: &Path, bytes: Vec<u8>) -> Result<Container> {
    if !bytes.starts_with(MAGIC) {
        return Ok(Container { json: bytes, binary: None });
    }
    split(&bytes).map_err(|(kind, what)| Error::new(kind, format!("'{}': {what}", path.display())))
}

/// GLB 2.0: a header, a JSON chunk, and maybe a binary chunk; further chunks are skipped, as the specification asks.
fn split(bytes: &[u8]) -> Result<Container, (ErrorKind, String)> {
    let invalid = |what: String| (ErrorKind::InvalidScene, what);
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(invalid(format!("truncated: {} bytes; a GLB header has {HEADER_BYTES}", bytes.len())));
    };
    if version != 2 {
        return Err((ErrorKind::Unsupported, format!("GLB version {version}; allowed is 2")));
    }
    if length < HEADER_BYTES {
        return Err(invalid(format!("the GLB header gives a length of {length} bytes; its own are {HEADER_BYTES}")));
    }
    let Some(mut chunks) = bytes.get(HEADER_BYTES..length) else {
        return Err(invalid(format!("truncated: {} bytes of the {length} that its GLB header gives", bytes.len())));
    };
    let (json, rest) = chunk(chunks, b"JSON").map_err(invalid)?;
    chunks = rest;
    let binary = if chunks.is_empty() { None } else { Some(chunk(chunks, b"BIN\0").map_err(invalid)?.0.to_vec()) };
    Ok(Container { json: json.to_vec(), binary })
}

/// The content of the chunk that `bytes` begins with, and what follows it.
fn chunk<'a>(bytes: &'a [u8], expected: &[u8; 4]) -> Result<(&'a [u8], &'a [u8]), String> {
    let name = || String::from_utf8_lossy(expected).trim_end_matches('\0').to_owned();
    let (Some(length), Some(found)) = (word(bytes, 0), bytes.get(4..CHUNK_HEADER_BYTES)) else {
        return Err(format!("truncated: {} bytes where the {} chunk should begin", bytes.len(), name()));
    };
    if found != expected {
        let found = String::from_utf8_lossy(found).escape_debug().to_string();
        return Err(format!("a GLB chunk of type '{found}' where '{}' is expected", name()));
    }
    let content = &bytes[CHUNK_HEADER_BYTES..];
    content.split_at_checked(length).ok_or_else(|| {
        format!("truncated: the {} chunk has {} bytes of the {length} that it gives", name(), content.len())
    })
}

/// The little-endian word at an offset.
fn word(bytes: &[u8], offset: usize) -> Option<usize> {
    let bytes = bytes.get(offset..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes) as usize)
}
