//! The progress bar.

use crate::messages;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lightoven::baker::Progress;
use std::borrow::Cow;
use std::io::IsTerminal;
use std::ops::Range;
use std::time::Duration;

/// Steps that a bar has: more than columns on any terminal.
const STEPS: u64 = 1000;

/// Whether progress is to be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Visibility {
    /// On stderr, where that is a terminal.
    Shown,
    Hidden,
}

/// A progress bar on stderr; removed when it is dropped.
pub(crate) struct Bar {
    bar: ProgressBar,
}

impl Bar {
    pub(crate) fn new(visibility: Visibility) -> Self {
        let target = match visibility {
            Visibility::Shown if std::io::stderr().is_terminal() => ProgressDrawTarget::stderr(),
            _ => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(Some(STEPS), target);
        if let Ok(style) = ProgressStyle::with_template("{prefix:9} [{bar:30}] {percent:>3} %  {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        messages::attach(&bar);
        Self { bar }
    }

    /// Says what is being done while there are no figures yet.
    pub(crate) fn say(&self, what: impl Into<Cow<'static, str>>) {
        self.bar.set_prefix(what);
        self.bar.tick();
    }

    pub(crate) fn show(&self, progress: &Progress) {
        self.draw(progress.phase.name().to_owned(), progress, 0.0..1.0);
    }

    /// The progress of one bake of several; `part` is what it is of all work, within 0 and 1.
    pub(crate) fn show_part(&self, name: String, progress: &Progress, part: Range<f64>) {
        // The time left is that of one bake.
        self.draw(name, &Progress { time_left: None, ..*progress }, part);
    }

    fn draw(&self, prefix: String, progress: &Progress, part: Range<f64>) {
        let done = part.start + (part.end - part.start) * f64::from(progress.fraction.clamp(0.0, 1.0));
        self.bar.set_prefix(prefix);
        self.bar.set_message(figures(progress));
        self.bar.set_position((done * STEPS as f64) as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Pass, samples, rays per second, error and time left, as far as they are known.
fn figures(progress: &Progress) -> String {
    let mut parts = vec![
        format!("pass {}", progress.epoch),
        format!("{} samples", progress.samples_per_texel),
        format!("{:.2} Mrays/s", progress.mrays_per_s),
    ];
    parts.extend(progress.estimated_error.map(|error| format!("error {:.2} %", 100.0 * error)));
    parts.extend(progress.time_left.map(|time| format!("{} left", clock(time))));
    parts.join(", ")
}

/// `0:41`, `12:05`, `1:02:03`.
fn clock(time: Duration) -> String {
    let seconds = time.as_secs();
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    match hours {
        0 => format!("{minutes}:{seconds:02}"),
        _ => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_on_a_clock() {
        let read = |seconds| clock(Duration::from_secs(seconds));
        assert_eq!([read(41), read(725), read(3723)], ["0:41", "12:05", "1:02:03"]);
    }
}
