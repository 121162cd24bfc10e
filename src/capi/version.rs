//! Which version this is.

use std::ffi::{CStr, c_char};

/// The version of the header.
pub const LIGHTOVEN_VERSION_MAJOR: u32 = 0;
/// The version of the header.
pub const LIGHTOVEN_VERSION_MINOR: u32 = 1;
/// The version of the header.
pub const LIGHTOVEN_VERSION_PATCH: u32 = 0;

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => panic!("a version has no NUL within"),
};

/// The version of the library, as "major.minor.patch"; compare it with the header's. Valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_version() -> *const c_char {
    VERSION.as_ptr()
}
