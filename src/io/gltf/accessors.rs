//! Numbers out of accessors.

use super::bounds::{Buffers, Layout};
use crate::error::{Error, Result};
use gltf::Accessor;
use gltf::accessor::sparse::{IndexType, Sparse};
use gltf::accessor::{DataType, Dimensions};

/// Numbers read from one file at most, over all accessors and each use: a small file that says otherwise is a trap.
const MAX_NUMBERS: usize = 1 << 28;

/// Reads accessors and counts what it has read.
pub(super) struct Accessors<'a> {
    buffers: &'a Buffers,
    read: usize,
}

impl<'a> Accessors<'a> {
    /// A reader that has already read `read` numbers.
    pub(super) fn new(buffers: &'a Buffers, read: usize) -> Self {
        Self { buffers, read }
    }

    /// Numbers read so far.
    pub(super) fn read(&self) -> usize {
        self.read
    }

    /// Vectors of `N` components as floats, integers as KHR_mesh_quantization has them. `role` says what they are.
    pub(super) fn vectors<const N: usize>(&mut self, accessor: &Accessor<'_>, role: &str) -> Result<Vec<[f32; N]>> {
        let expected = if N == 2 { Dimensions::Vec2 } else { Dimensions::Vec3 };
        if accessor.dimensions() != expected || accessor.data_type() == DataType::U32 {
            let allowed = format!("{expected:?} of any type but U32");
            return Err(unexpected(accessor, role, &allowed));
        }
        let (kind, normalized) = (accessor.data_type(), accessor.normalized());
        self.elements(accessor, role, [0.0; N], |bytes| {
            let mut components = bytes.chunks_exact(kind.size());
            std::array::from_fn(|_| components.next().map_or(0.0, |bytes| component(bytes, kind, normalized)))
        })
    }

    /// Vertex indices of any of the three types.
    pub(super) fn indices(&mut self, accessor: &Accessor<'_>, role: &str) -> Result<Vec<u32>> {
        let is_index = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
        if accessor.dimensions() != Dimensions::Scalar || !is_index {
            return Err(unexpected(accessor, role, "Scalar of U8, U16 or U32"));
        }
        self.elements(accessor, role, 0, unsigned)
    }

    /// All elements, the sparse ones in place; without a view the rest is `zero`.
    fn elements<T: Copy>(
        &mut self,
        accessor: &Accessor<'_>,
        role: &str,
        zero: T,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>> {
        let what = || format!("accessor {} ({role})", accessor.index());
        let (count, size) = (accessor.count(), accessor.size());
        if count == 0 {
            return Err(Error::scene(format!("{}: its count is 0; allowed is at least 1", what())));
        }
        let numbers = count.checked_mul(accessor.dimensions().multiplicity());
        self.read = match numbers.and_then(|numbers| self.read.checked_add(numbers)) {
            Some(read) if read <= MAX_NUMBERS => read,
            _ => {
                return Err(Error::scene(format!(
                    "{}: with its {count} elements the file has more numbers than the {MAX_NUMBERS} allowed",
                    what()
                )));
            }
        };
        let mut values = match accessor.view() {
            Some(view) => {
                let layout = Layout { offset: accessor.offset(), count, size };
                self.buffers.elements(&view, layout, what)?.iter().map(&decode).collect()
            }
            None => vec![zero; count],
        };
        if let Some(sparse) = accessor.sparse() {
            self.replace(&sparse, size, &mut values, what, decode)?;
        }
        Ok(values)
    }

    /// Puts a sparse accessor's values in place.
    fn replace<T>(
        &self,
        sparse: &Sparse<'_>,
        size: usize,
        values: &mut [T],
        what: impl Fn() -> String,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<()> {
        let (count, total) = (sparse.count(), values.len());
        if count == 0 || count > total {
            return Err(Error::scene(format!("{}: has {count} sparse elements; allowed is 1 to {total}", what())));
        }
        let (indices, replacements) = (sparse.indices(), sparse.values());
        let index_size = match indices.index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let index_layout = Layout { offset: indices.offset(), count, size: index_size };
        let value_layout = Layout { offset: replacements.offset(), count, size };
        let indices = self.buffers.elements(&indices.view(), index_layout, &what)?;
        let replacements = self.buffers.elements(&replacements.view(), value_layout, &what)?;
        for (index, replacement) in indices.iter().map(unsigned).zip(replacements.iter()) {
            let slot = values.get_mut(index as usize);
            let out_of_range =
                || Error::scene(format!("{}: sparse index {index} is out of range; it has {total}", what()));
            *slot.ok_or_else(out_of_range)? = decode(replacement);
        }
        Ok(())
    }
}

fn unexpected(accessor: &Accessor<'_>, role: &str, allowed: &str) -> Error {
    let (dimensions, kind) = (accessor.dimensions(), accessor.data_type());
    Error::scene(format!("accessor {} ({role}) is {dimensions:?} of {kind:?}; allowed is {allowed}", accessor.index()))
}

/// A little-endian integer of 1, 2 or 4 bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// A component as a float; normalised integers as glTF 2.0, section 3.11, has them.
fn component(bytes: &[u8], kind: DataType, normalized: bool) -> f32 {
    let bits = unsigned(bytes);
    let (value, largest) = match kind {
        DataType::I8 => (f32::from(bits as u8 as i8), 127.0),
        DataType::U8 => (f32::from(bits as u8), 255.0),
        DataType::I16 => (f32::from(bits as u16 as i16), 32767.0),
        DataType::U16 => (f32::from(bits as u16), 65535.0),
        DataType::U32 => (bits as f32, u32::MAX as f32),
        DataType::F32 => return f32::from_bits(bits),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
