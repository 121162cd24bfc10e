//! Ctrl-C, SIGTERM and SIGHUP: stop and keep what is there. That takes a slice and a write, so that a second one has
//! nothing to hurry; to leave in the middle of a driver's call or of a write would crash or leave a part of a file.

use crate::messages;
use lightoven::{Error, ErrorKind, Result};
use std::sync::atomic::{AtomicBool, Ordering};

/// What a shell expects of a command that an interrupt ended: 128 + SIGINT.
pub(crate) const EXIT_CODE: u8 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Takes over the signals.
pub(crate) fn install() -> Result<()> {
    install_saying("interrupted: writing what is there")
}

/// The same; `text` is said at the first one.
pub(crate) fn install_saying(text: &'static str) -> Result<()> {
    let handler = move || {
        if !REQUESTED.swap(true, Ordering::SeqCst) {
            messages::line(text);
        }
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Error::new(ErrorKind::Unsupported, "cannot listen for Ctrl-C").with_source(error))
}

/// Whether the first one has come.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
