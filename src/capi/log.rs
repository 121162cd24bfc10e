//! Warnings, to the engine's own log.

use super::status::{Failure, LightovenStatus, guard};
use crate::error::{Error, ErrorKind};
use std::cell::Cell;
use std::ffi::{CString, c_char, c_void};
use std::fmt::Write as _;
use std::sync::{OnceLock, PoisonError, RwLock};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};

/// How grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenLogLevel {
    /// Something could not be done.
    Error = 0,
    /// Something was left out, clamped or taken for something else.
    Warning = 1,
    /// What may be of interest.
    Info = 2,
}

/// Takes a message. `level`: a LightovenLogLevel. `text`: UTF-8, ended by a NUL, valid within the call. It may be called by any
/// thread that calls lightoven, by several at a time, and returns: no exception and no longjmp leaves it.
pub type LightovenLogCallback = Option<unsafe extern "C" fn(level: u32, text: *const c_char, user: *mut c_void)>;

/// What to call, and with what.
struct Receiver {
    callback: unsafe extern "C" fn(level: u32, text: *const c_char, user: *mut c_void),
    user: *mut c_void,
}

// SAFETY: who sets a receiver says that any thread may call it so.
unsafe impl Send for Receiver {}
// SAFETY: as above.
unsafe impl Sync for Receiver {}

static RECEIVER: RwLock<Option<Receiver>> = RwLock::new(None);
/// Whether messages come here; unset until they are asked for.
static INSTALLED: OnceLock<bool> = OnceLock::new();

thread_local! {
    static CALLING: Cell<bool> = const { Cell::new(false) };
}

/// Where messages go that lightoven has beside its errors; NULL: nowhere, as at the beginning. `user`: passed on. When the call
/// returns, the callback before is not called any more.
///
/// UNSUPPORTED where something else in the process takes the messages of its Rust code already; IN_USE from within a callback.
///
/// # Safety
/// `callback` may be called with `user` by any thread that calls lightoven, until another is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_set_log(callback: LightovenLogCallback, user: *mut c_void) -> LightovenStatus {
    guard(|| {
        if CALLING.get() {
            return Err(Failure::in_use("the log is in use by the callback that this call is made from"));
        }
        let install = || tracing::subscriber::set_global_default(Forward).is_ok();
        if callback.is_some() && !INSTALLED.get_or_init(install) {
            let text = "the messages go elsewhere already: another subscriber of tracing was set";
            return Err(Error::new(ErrorKind::Unsupported, text).into());
        }
        let receiver = callback.map(|callback| Receiver { callback, user });
        *RECEIVER.write().unwrap_or_else(PoisonError::into_inner) = receiver;
        Ok(())
    })
}

struct Forward;

impl Subscriber for Forward {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        // Other Rust code in the process has its own ways.
        *metadata.level() <= Level::INFO && metadata.target().starts_with("lightoven") && metadata.is_event()
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, event: &Event<'_>) {
        // What is said within a callback would wait for it.
        if CALLING.get() {
            return;
        }
        let receiver = RECEIVER.read().unwrap_or_else(PoisonError::into_inner);
        let Some(receiver) = &*receiver else { return };
        let level = match *event.metadata().level() {
            Level::ERROR => LightovenLogLevel::Error,
            Level::WARN => LightovenLogLevel::Warning,
            _ => LightovenLogLevel::Info,
        };
        let mut text = Text::default();
        event.record(&mut text);
        let text = CString::new(text.0.replace('\0', " ")).unwrap_or_default();
        CALLING.set(true);
        // SAFETY: by the word of who set it; the text lives as long as the call.
        unsafe { (receiver.callback)(level as u32, text.as_ptr(), receiver.user) };
        CALLING.set(false);
    }

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// The message, and the fields beside it.
#[derive(Default)]
struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        let between = if self.0.is_empty() { "" } else { " " };
        // A String takes all that is written.
        let _ = match field.name() {
            "message" => write!(self.0, "{between}{value:?}"),
            name => write!(self.0, "{between}{name}={value:?}"),
        };
    }
}
