//! What comes over the boundary, checked as far as can be: NULL, alignment, sizes, counts, texts.

use super::status::{Failure, Outcome};
use glam::{DAffine3, DMat3, DVec3};
use std::ffi::{CStr, c_char};
use std::mem::{MaybeUninit, size_of};
use std::ptr;

/// Most elements of a list.
const MOST: usize = u32::MAX as usize;

/// A structure of the C interface.
///
/// # Safety
/// It is `repr(C)`, begins with its size as a `usize`, ends without padding, and any bytes are a valid value of it.
pub(super) unsafe trait Structure: Copy {
    /// Its name in C.
    const NAME: &'static str;
    /// Its size in the first version that had it. A member that is added goes to the end, and this then becomes the offset
    /// of the first one that was.
    const FIRST_SIZE: usize;
}

/// Makes structures of the interface known as such.
macro_rules! structures {
    ($($name:ident),+ $(,)?) => {$(
        // SAFETY: every one is repr(C), of integers, floats, pointers and functions that may be NULL, its size first.
        unsafe impl $crate::capi::arguments::Structure for $name {
            const NAME: &'static str = stringify!($name);
            const FIRST_SIZE: usize = std::mem::size_of::<Self>();
        }
    )+};
}
pub(super) use structures;

fn check_pointer<T>(pointer: *const T, what: &str) -> Outcome {
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
unsafe fn size_at<T: Structure>(structure: *const T, what: &str) -> Outcome<usize> {
    check_pointer(structure, what)?;
    // SAFETY: it is not NULL, is aligned, and begins with its size by the caller's word.
    let size = unsafe { structure.cast::<usize>().read() };
    let (first, newest) = (T::FIRST_SIZE, size_of::<T>());
    if (first..=newest).contains(&size) {
        return Ok(size);
    }
    let range = if first == newest { first.to_string() } else { format!("{first} to {newest}") };
    let name = T::NAME;
    Err(Failure::argument(format!("the size of {what}, a {name}, is {size}; this version of lightoven knows {range}")))
}

/// A structure as it comes over the boundary; members that its version does not have are zero.
///
/// # Safety
/// `structure` is NULL, or points to as many bytes as it says at its beginning.
pub(super) unsafe fn read<T: Structure>(structure: *const T, what: &str) -> Outcome<T> {
    // SAFETY: the caller's word, passed on.
    let size = unsafe { size_at(structure, what)? };
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
pub(super) unsafe fn write<T: Structure>(structure: *mut T, what: &str, value: &T) -> Outcome {
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
pub(super) unsafe fn write_wanted<T: Structure>(structure: *mut T, what: &str, value: &T) -> Outcome {
    // SAFETY: the caller's word, passed on.
    if structure.is_null() { Ok(()) } else { unsafe { write(structure, what, value) } }
}

/// That there is room for what a call gives back.
pub(super) fn check_result<T>(result: *mut T, what: &str) -> Outcome {
    check_pointer(result, what)
}

fn check_count(count: usize, bytes_each: usize, what: &str) -> Outcome {
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
pub(super) unsafe fn slice<'a, T: Copy>(first: *const T, count: usize, what: &str) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_pointer(first, &format!("the list of {what}"))?;
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
    what: &str,
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
    what: &str,
    mut convert: impl FnMut(usize, T) -> Outcome,
) -> Outcome {
    if count == 0 {
        return Ok(());
    }
    // SAFETY: the caller's word, passed on.
    let stride = unsafe { size_at(first, &format!("the list of {what}"))? };
    check_count(count, stride, what)?;
    for index in 0..count {
        // SAFETY: the structures lie one after the other, all of the first one's version.
        let element = unsafe { first.byte_add(index * stride) };
        // SAFETY: as above.
        let value = unsafe { read(element, &format!("{what} {index}"))? };
        convert(index, value)?;
    }
    Ok(())
}

/// A text; empty for NULL.
///
/// # Safety
/// `text` is NULL or ends with a NUL.
pub(super) unsafe fn text(text: *const c_char, what: &str) -> Outcome<String> {
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
pub(super) unsafe fn required_text(value: *const c_char, what: &str) -> Outcome<String> {
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

/// The value that a number stands for, in the order of the header's constants.
pub(super) fn choose<T: Copy>(number: u32, what: &str, values: &[T]) -> Outcome<T> {
    let last = values.len() - 1;
    let chosen = values.get(number as usize).copied();
    chosen.ok_or_else(|| Failure::argument(format!("{what} is {number}; allowed is 0 to {last}")))
}

/// A list of names.
///
/// # Safety
/// `first` is NULL or points to `count` texts, each NULL or ended by a NUL, that stay as they are while the list lives.
pub(super) unsafe fn names<'a>(first: *const *const c_char, count: usize, what: &str) -> Outcome<Vec<&'a CStr>> {
    // SAFETY: the caller's word, passed on.
    let pointers = unsafe { slice(first, count, what)? };
    let name = |(index, pointer): (usize, &*const c_char)| {
        check_pointer(*pointer, &format!("number {index} of the {what}"))?;
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
