//! Changes inside a `.glb`'s chunks that keep its lengths right: else the container hides all behind it.

const MAGIC: &[u8; 4] = b"glTF";
/// Before the content of the first chunk: the file's header and the chunk's own.
const JSON_AT: usize = 20;
/// Before the content of the second chunk, from the end of the first.
const CHUNK_HEADER_BYTES: usize = 8;
/// One change in so many ignores the container.
const RAW: u32 = 8;

/// A `.glb`'s JSON and binary chunks; `None` where the file is no `.glb` or its lengths are wrong.
fn split(bytes: &[u8]) -> Option<(&[u8], Option<&[u8]>)> {
    if !bytes.starts_with(MAGIC) {
        return None;
    }
    let (json, rest) = bytes.get(JSON_AT..)?.split_at_checked(word(bytes, 12)?)?;
    match word(rest, 0) {
        None => Some((json, None)),
        Some(length) => Some((json, Some(rest.get(CHUNK_HEADER_BYTES..)?.get(..length)?))),
    }
}

fn word(bytes: &[u8], offset: usize) -> Option<usize> {
    let bytes = bytes.get(offset..)?.first_chunk()?;
    Some(u32::from_le_bytes(*bytes) as usize)
}

/// The JSON of a file, for all that the reader will make of it.
pub fn json(bytes: &[u8]) -> &[u8] {
    if !bytes.starts_with(MAGIC) {
        return bytes;
    }
    let chunk = word(bytes, 12).and_then(|length| bytes.get(JSON_AT..)?.get(..length));
    chunk.unwrap_or_default()
}

/// Changes one of the chunks by `change` (data, size, largest size; gives the new size). Returns the new size of it all.
pub fn mutate(
    data: &mut [u8],
    size: usize,
    max_size: usize,
    seed: u32,
    change: impl Fn(&mut [u8], usize, usize) -> usize,
) -> usize {
    let parts = split(&data[..size]).map(|(json, binary)| (json.to_vec(), binary.map(<[u8]>::to_vec)));
    let Some((mut json, mut binary)) = parts.filter(|_| !seed.is_multiple_of(RAW)) else {
        return change(data, size, max_size);
    };
    let part = match &mut binary {
        Some(binary) if seed / RAW % 4 == 0 => binary,
        _ => &mut json,
    };
    let old = part.len();
    let room = max_size.saturating_sub(size + 3);
    part.resize(old + room, 0);
    let new = change(part, old, old + room);
    part.truncate(new);
    let whole = join(json, binary);
    if whole.len() > max_size {
        return size;
    }
    data[..whole.len()].copy_from_slice(&whole);
    whole.len()
}

fn join(mut json: Vec<u8>, binary: Option<Vec<u8>>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut chunks = Vec::new();
    for (kind, content) in [(b"JSON", Some(json)), (b"BIN\0", binary)] {
        let Some(content) = content else { continue };
        chunks.extend((content.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(content);
    }
    let mut whole = MAGIC.to_vec();
    whole.extend([2, 12 + chunks.len() as u32].map(u32::to_le_bytes).concat());
    whole.extend(chunks);
    whole
}
