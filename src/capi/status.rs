//! Statuses, the text of the last error, and the boundary that no panic crosses.

use crate::error::{Error, ErrorKind};
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a call ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum LightovenStatus {
    /// As it should.
    Ok = 0,
    /// The device, driver or file lacks something that was asked for.
    Unsupported = -1,
    /// Device memory ran out, or host memory that a driver asks for, or a buffer is over the device's limit. Where the process
    /// itself gets no memory any more it is ended, as Rust has it.
    OutOfMemory = -2,
    /// The device was lost; everything on it is gone.
    DeviceLost = -3,
    /// The scene cannot be baked as it is.
    InvalidScene = -4,
    /// A setting is outside what is allowed.
    InvalidSettings = -5,
    /// A file could not be read or written.
    Io = -6,
    /// The driver failed in a way that none of the others describe.
    Driver = -7,
    /// The call itself is wrong: a NULL, a handle, a structure's size or a count.
    InvalidArgument = -8,
    /// The handle is in use: by another thread, by the call that this one is made from, or by what was made from it.
    InUse = -9,
    /// A fault of lightoven itself; the text says where. What the call worked on can only be destroyed.
    Internal = -10,
}

impl From<ErrorKind> for LightovenStatus {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::Unsupported => Self::Unsupported,
            ErrorKind::OutOfMemory => Self::OutOfMemory,
            ErrorKind::DeviceLost => Self::DeviceLost,
            ErrorKind::InvalidScene => Self::InvalidScene,
            ErrorKind::InvalidSettings => Self::InvalidSettings,
            ErrorKind::Io => Self::Io,
            ErrorKind::Driver => Self::Driver,
        }
    }
}

/// What went wrong in a call.
#[derive(Debug)]
pub(super) struct Failure {
    status: LightovenStatus,
    text: String,
}

/// What a call comes to, before it becomes a status.
pub(super) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    pub(super) fn argument(text: impl Into<String>) -> Self {
        Self { status: LightovenStatus::InvalidArgument, text: text.into() }
    }

    pub(super) fn in_use(text: impl Into<String>) -> Self {
        Self { status: LightovenStatus::InUse, text: text.into() }
    }

    pub(super) fn internal(text: impl Into<String>) -> Self {
        Self { status: LightovenStatus::Internal, text: text.into() }
    }

    fn of_panic(panic: &(dyn Any + Send)) -> Self {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no text");
        Self::internal(format!("a fault of lightoven: {text}"))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self { status: error.kind().into(), text: error.to_string() }
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

/// Runs a call's work; a panic ends here, and becomes a status like any other failure.
pub(super) fn guard(work: impl FnOnce() -> Outcome) -> LightovenStatus {
    let outcome = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(Failure::of_panic(&*panic)));
    let Err(Failure { status, text }) = outcome else { return LightovenStatus::Ok };
    let text: Vec<u8> = text.into_bytes().into_iter().filter(|byte| *byte != 0).collect();
    // A thread that is ending has no text any more.
    let _ = LAST.try_with(|last| last.replace(CString::new(text).unwrap_or_default()));
    status
}

/// What the last call of this thread that failed has to say: the thing, its value, what is allowed. UTF-8, ended by a NUL,
/// valid until the next call of this thread that fails, or until the thread ends; empty before the first. Never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_last_error() -> *const c_char {
    LAST.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// A status's name, as in the header without its prefix; "UNKNOWN" for what is none. Never NULL, valid for ever.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_status_name(status: i32) -> *const c_char {
    const NAMES: [&CStr; 11] = [
        c"OK",
        c"UNSUPPORTED",
        c"OUT_OF_MEMORY",
        c"DEVICE_LOST",
        c"INVALID_SCENE",
        c"INVALID_SETTINGS",
        c"IO",
        c"DRIVER",
        c"INVALID_ARGUMENT",
        c"IN_USE",
        c"INTERNAL",
    ];
    let index = status.checked_neg().and_then(|status| usize::try_from(status).ok());
    index.and_then(|index| NAMES.get(index)).unwrap_or(&c"UNKNOWN").as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last_error() -> String {
        // SAFETY: it is never NULL, and ends with a NUL.
        unsafe { CStr::from_ptr(lightoven_last_error()) }.to_string_lossy().into_owned()
    }

    #[test]
    fn a_panic_becomes_a_status() {
        assert_eq!(guard(|| panic!("number {}", 7)), LightovenStatus::Internal);
        assert_eq!(last_error(), "a fault of lightoven: number 7");
        assert_eq!(guard(|| Ok(())), LightovenStatus::Ok);
        assert_eq!(last_error(), "a fault of lightoven: number 7");
    }

    #[test]
    fn each_thread_has_its_own_text() {
        assert_eq!(guard(|| Err(Failure::argument("mine\0 alone"))), LightovenStatus::InvalidArgument);
        std::thread::spawn(|| assert_eq!(last_error(), "")).join().expect("is as it should be");
        assert_eq!(last_error(), "mine alone");
    }

    #[test]
    fn statuses_have_names() {
        for (status, name) in [(0, c"OK"), (-9, c"IN_USE"), (-10, c"INTERNAL"), (-11, c"UNKNOWN"), (1, c"UNKNOWN")] {
            // SAFETY: it is never NULL, and ends with a NUL.
            assert_eq!(unsafe { CStr::from_ptr(lightoven_status_name(status)) }, name);
        }
        // SAFETY: as above.
        unsafe { assert_eq!(CStr::from_ptr(lightoven_status_name(i32::MIN)), c"UNKNOWN") };
    }
}
