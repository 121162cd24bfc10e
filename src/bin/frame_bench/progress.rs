//! The progress bar.

use crate::messages;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Whether progress is to be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Visibility {
    /// On stderr, where that is a terminal.
    Shown,
    Hidden,
}

/// A progress bar over frames, on stderr where that is a terminal; removed when it is dropped.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    pub(crate) fn new(visibility: Visibility) -> Self {
        let shown = visibility == Visibility::Shown && std::io::stderr().is_terminal();
        let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{prefix:9} [{bar:30}] {pos} of {len} frames  {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        messages::attach(&bar);
        Self(bar)
    }

    /// Says what is being done.
    pub(crate) fn say(&self, what: &'static str) {
        self.0.set_prefix(what);
        self.0.tick();
    }

    pub(crate) fn set_total(&self, frames: u64) {
        self.0.set_length(frames);
    }

    /// One frame more.
    pub(crate) fn step(&self, message: String) {
        self.0.set_message(message);
        self.0.inc(1);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
