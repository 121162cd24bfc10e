//! What comes over the boundary, checked as far as can be: NULL, alignment, sizes, counts, texts.

use super::status::{Failure, Outcome};
use glam::{DAffine3, DMat3, DVec3};
use std::ffi::{CStr, c_char};
use std::fmt::Display;
use std::mem::{MaybeUninit, size_of};
use std::ptr;

/// Most elements of a list.
const MOST: usize = u32::MAX as usize;

/// Sizes of structures are told below for pointers of 64 bits.
#[cfg(not(target_pointer_width = "64"))]
compile_error!("the feature 'capi' is for 64-bit targets");

/// A structure of the C interface.
///
/// # Safety
/// It is `repr(C)`, begins with its size as a `usize`, ends without padding, and any bytes are a valid value of it.
pub(super) unsafe trait Structure: Copy {
    /// Its name in C.
    const NAME: &'static str;
    /// Its sizes in all versions, oldest first. Members are added at the end, and a size here.
    const SIZES: &'static [usize];
}

/// Makes structures of the interface known as such, with their sizes in all versions.
macro_rules! structures {
    ($($name:ident = $sizes:expr),+ $(,)?) => {$(
        // SAFETY: every one is repr(C), of integers, floats, pointers and functions that may be NULL, its size first; the
        // newest size is that of its members.
        unsafe impl $crate::capi::arguments::Structure for $name {
            const NAME: &'static str = stringify!($name);
            const SIZES: &'static [usize] = &$sizes;
        }
        const _: () = {
            let sizes: &[usize] = &$sizes;
            assert!(sizes[sizes.len() - 1] == std::mem::size_of::<$name>());
        };
    )+};
}
pub(super) use structures;

fn check_pointer<T>(pointer: *const T, what: impl Display + Copy) -> Outcome {
    if pointer.is_null() {
        return Err(Failure::argument(format!("{what} is NULL")));
    }
    if !pointer.is_aligned() {
        let needed = align_of::<T>();
        return Err(Failure::argument(format!("{what} is at {pointer:p}, which is no multiple of {needed} bytes")));
    }
    Ok(())
}

/// The size that a structure begins with.
///
/// # Safety
/// `structure` is NULL or points to a `usize`.
unsafe fn size_at<T: Structure>(structure: *const T, what: impl Display + Copy) -> Outcome<usize> {
    check_pointer(structure, what)?;
    // SAFETY: it is not NULL, is aligned, and begins with its size by the caller's word.
    let size = unsafe { structure.cast::<usize>().read() };
    if T::SIZES.contains(&size) {
        return Ok(size);
    }
    let (name, known) = (T::NAME, T::SIZES.iter().map(usize::to_string).collect::<Vec<_>>().join(", "));
    Err(Failure::argument(format!("the size of {what}, a {name}, is {size}; this version of lightoven knows {known}")))
}

/// A structure as it comes over the boundary; members that its version does not have are zero.
///
/// # Safety
/// `structure` is NULL, or points to as many bytes as it says at its beginning.
pub(super) unsafe fn read<T: Structure>(structure: *const T, what: impl Display + Copy) -> Outcome<T> {
    // SAFETY: the caller's word, passed on.
    unsafe {
        let size = size_at(structure, what)?;
        read_sized(structure, size, what)
    }
}

/// As [`read`], of this size alone.
///
/// # Safety
/// As [`read`].
unsafe fn read_sized<T: Structure>(structure: *const T, expected: usize, what: impl Display + Copy) -> Outcome<T> {
    // SAFETY: the caller's word, passed on.
    let size = unsafe { size_at(structure, what)? };
    if size != expected {
        return Err(Failure::argument(format!("the size of {what} is {size}, and that of the first one {expected}")));
    }
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: `size` bytes are there by the caller's word, and fit; any bytes are valid by the trait's contract.
    unsafe {
        ptr::copy_nonoverlapping(structure.cast::<u8>(), value.as_mut_ptr().cast::<u8>(), size);
        Ok(value.assume_init())
    }
}

/// Fills a structure of the caller's, as far as its version goes; its size stays.
///
/// # Safety
/// As [`read`], and it may be written.
pub(super) unsafe fn write<T: Structure>(structure: *mut T, what: impl Display + Copy, value: &T) -> Outcome {
    // SAFETY: the caller's word, passed on.
    let size = unsafe { size_at(structure, what)? };
    let from = ptr::from_ref(value).cast::<u8>();
    let head = size_of::<usize>();
    // SAFETY: `size` bytes are there by the caller's word, and no more than the value has.
    unsafe { ptr::copy_nonoverlapping(from.add(head), structure.cast::<u8>().add(head), size - head) };
    Ok(())
}

/// As [`write`]; nothing where the caller wants none.
///
/// # Safety
/// As [`write`].
pub(super) unsafe fn write_wanted<T: Structure>(structure: *mut T, what: impl Display + Copy, value: &T) -> Outcome {
    // SAFETY: the caller's word, passed on.
    if structure.is_null() { Ok(()) } else { unsafe { write(structure, what, value) } }
}

/// That there is room for what a call gives back.
pub(super) fn check_result<T>(result: *mut T, what: impl Display + Copy) -> Outcome {
    check_pointer(result, what)
}

fn check_count(count: usize, bytes_each: usize, what: impl Display + Copy) -> Outcome {
    let fits = count.checked_mul(bytes_each).is_some_and(|bytes| isize::try_from(bytes).is_ok());
    if fits && count <= MOST {
        return Ok(());
    }
    Err(Failure::argument(format!("the number of {what} is {count}; allowed is at most {MOST}")))
}

/// A list of numbers; empty for a count of 0, whatever the pointer.
///
/// # Safety
/// `first` is NULL or points to `count` numbers that stay as they are while the slice lives. Any bytes are a valid `T`.
pub(super) unsafe fn slice<'a, T: Copy>(first: *const T, count: usize, what: impl Display + Copy) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_pointer(first, format_args!("the list of {what}"))?;
    check_count(count, size_of::<T>(), what)?;
    // SAFETY: not NULL, aligned, of a size that fits, and there by the caller's word.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

/// A list of `N` numbers each, such as corners; `None` for NULL.
///
/// # Safety
/// As [`slice`], of `N * count` numbers.
pub(super) unsafe fn tuples<'a, const N: usize>(
    first: *const f32,
    count: usize,
    what: impl Display + Copy,
) -> Outcome<Option<&'a [[f32; N]]>> {
    if first.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's word, passed on; arrays of floats lie as floats do.
    unsafe { slice(first.cast::<[f32; N]>(), count, what) }.map(Some)
}

/// A list of structures, each converted as it is read. All of it has one version.
///
/// # Safety
/// `first` is NULL or points to `count` structures, each as [`read`] asks for.
pub(super) unsafe fn each<T: Structure>(
    first: *const T,
    count: usize,
    what: impl Display + Copy,
    mut convert: impl FnMut(usize, T) -> Outcome,
) -> Outcome {
    if count == 0 {
        return Ok(());
    }
    // SAFETY: the caller's word, passed on.
    let stride = unsafe { size_at(first, format_args!("the list of {what}"))? };
    check_count(count, stride, what)?;
    for index in 0..count {
        // SAFETY: the structures lie one after the other, by the caller's word.
        let element = unsafe { first.byte_add(index * stride) };
        // SAFETY: as above; one of another version is refused.
        let value = unsafe { read_sized(element, stride, format_args!("{what} {index}"))? };
        convert(index, value)?;
    }
    Ok(())
}

/// The one of a list that an index stands for. `owner` has the list, of what is called `kind`.
pub(super) fn one_of<'a, T>(list: &'a [T], index: u32, kind: &str, owner: &str) -> Outcome<&'a T> {
    let count = list.len();
    let missing = || Failure::argument(format!("there is no {kind} {index}: the {owner} has {count}"));
    list.get(index as usize).ok_or_else(missing)
}

/// A text; empty for NULL.
///
/// # Safety
/// `text` is NULL or ends with a NUL.
pub(super) unsafe fn text(text: *const c_char, what: impl Display + Copy) -> Outcome<String> {
    if text.is_null() {
        return Ok(String::new());
    }
    // SAFETY: ended by a NUL by the caller's word.
    let text = unsafe { CStr::from_ptr(text) };
    let utf8 = text.to_str().map_err(|_| Failure::argument(format!("{what} is not UTF-8: {text:?}")))?;
    Ok(utf8.to_owned())
}

/// A text that has to be there.
///
/// # Safety
/// As [`text`].
pub(super) unsafe fn required_text(value: *const c_char, what: impl Display + Copy) -> Outcome<String> {
    check_pointer(value, what)?;
    // SAFETY: the caller's word, passed on.
    unsafe { text(value, what) }
}

/// Gives a text to the caller, cut short where it has no room for all, and always ended by a NUL; `length`, where it is
/// wanted, tells how long all of it is, without the NUL.
///
/// # Safety
/// `buffer` has room for `capacity` bytes, or is NULL; `length` may be written, or is NULL.
pub(super) unsafe fn give_text(text: &str, buffer: *mut c_char, capacity: usize, length: *mut usize) -> Outcome {
    if buffer.is_null() && length.is_null() {
        return Err(Failure::argument("both the buffer and the length are NULL: nothing can be given"));
    }
    if !length.is_null() {
        check_pointer(length, "the length")?;
        // SAFETY: it may be written by the caller's word.
        unsafe { length.write(text.len()) };
    }
    if buffer.is_null() || capacity == 0 {
        return Ok(());
    }
    let most = text.len().min(capacity - 1);
    let end = (0..=most).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    // SAFETY: `end` and one byte fit into the capacity.
    unsafe {
        ptr::copy_nonoverlapping(text.as_ptr(), buffer.cast::<u8>(), end);
        buffer.add(end).write(0);
    }
    Ok(())
}

/// That a member without a meaning is 0, so that it may have one some day.
pub(super) fn check_reserved(reserved: u32, what: impl Display + Copy) -> Outcome {
    match reserved {
        0 => Ok(()),
        other => Err(Failure::argument(format!("the member 'reserved' of {what} is {other}; allowed is 0"))),
    }
}

/// The value that a number stands for, in the order of the header's constants.
pub(super) fn choose<T: Copy>(number: u32, what: impl Display + Copy, values: &[T]) -> Outcome<T> {
    let last = values.len() - 1;
    let chosen = values.get(number as usize).copied();
    chosen.ok_or_else(|| Failure::argument(format!("{what} is {number}; allowed is 0 to {last}")))
}

/// A list of names.
///
/// # Safety
/// `first` is NULL or points to `count` texts, each NULL or ended by a NUL, that stay as they are while the list lives.
pub(super) unsafe fn names<'a>(
    first: *const *const c_char,
    count: usize,
    what: impl Display + Copy,
) -> Outcome<Vec<&'a CStr>> {
    // SAFETY: the caller's word, passed on.
    let pointers = unsafe { slice(first, count, what)? };
    let name = |(index, pointer): (usize, &*const c_char)| {
        check_pointer(*pointer, format_args!("number {index} of the {what}"))?;
        // SAFETY: not NULL, and ended by a NUL by the caller's word.
        Ok(unsafe { CStr::from_ptr(*pointer) })
    };
    pointers.iter().enumerate().map(name).collect()
}

/// Three rows of four, as `VkTransformMatrixKHR` has them.
///
/// # Safety
/// `rows` is NULL or points to 12 numbers.
pub(super) unsafe fn transform(rows: *const f64) -> Outcome<DAffine3> {
    check_pointer(rows, "the transform")?;
    // SAFETY: 12 numbers are there by the caller's word.
    let rows = unsafe { rows.cast::<[[f64; 4]; 3]>().read() };
    let column = |index: usize| DVec3::from_array(rows.map(|row| row[index]));
    Ok(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, Copy, PartialEq)]
    #[repr(C)]
    struct Grown {
        struct_size: usize,
        first: u64,
        added: u64,
    }

    structures!(Grown = [16, 24]);

    const NEW: Grown = Grown { struct_size: 24, first: 1, added: 2 };

    #[test]
    fn older_structures_are_taken_and_filled_as_far_as_they_go() {
        let old: [usize; 3] = [16, 5, 77];
        // SAFETY: there are as many numbers as the first one says.
        let taken = unsafe { read(old.as_ptr().cast::<Grown>(), "it") }.expect("is known");
        assert_eq!(taken, Grown { struct_size: 16, first: 5, added: 0 });
        let mut filled = old;
        // SAFETY: as above.
        unsafe { write(filled.as_mut_ptr().cast::<Grown>(), "it", &NEW) }.expect("is known");
        assert_eq!(filled, [16, 1, 77]);
        for odd in [0, 8, 15, 17, 23, 25, usize::MAX] {
            let odd = [odd, 0, 0];
            // SAFETY: nothing but the size is read of one that is refused.
            assert!(unsafe { read(odd.as_ptr().cast::<Grown>(), "it") }.is_err());
        }
    }

    #[test]
    fn lists_have_one_version() {
        let values = |list: &[usize], count| {
            let mut found = Vec::new();
            // SAFETY: there are so many, each of the size that it says, or refused.
            let outcome = unsafe {
                each(list.as_ptr().cast::<Grown>(), count, "one", |_, value| {
                    found.push((value.first, value.added));
                    Ok(())
                })
            };
            outcome.map(|()| found).map_err(|failure| failure.to_string())
        };
        assert_eq!(values(&[16, 1, 16, 2], 2), Ok(vec![(1, 0), (2, 0)]));
        assert_eq!(values(&[24, 1, 3, 24, 2, 4], 2), Ok(vec![(1, 3), (2, 4)]));
        let mixed = values(&[16, 1, 24, 2, 4], 2).expect_err("must be refused");
        assert!(mixed.contains("the size of one 1 is 24, and that of the first one 16"), "{mixed}");
    }

    #[test]
    fn texts_are_cut_between_characters() {
        let mut buffer: [c_char; 4] = [1; 4];
        let mut length = 0;
        // SAFETY: there is so much room.
        unsafe { give_text("a\u{e9}\u{e9}", buffer.as_mut_ptr(), 4, &raw mut length) }.expect("has room");
        assert_eq!((buffer.map(|byte| byte as u8), length), ([b'a', 0xc3, 0xa9, 0], 5));
    }
}
