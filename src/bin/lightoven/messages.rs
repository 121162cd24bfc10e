//! What is said on stdout and stderr. Nobody listening is no reason to fail, let alone to panic.

use indicatif::ProgressBar;
use lightoven::{Error, ErrorKind, Result};
use std::collections::HashSet;
use std::fmt;
use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields, MakeWriter};
use tracing_subscriber::registry::LookupSpan;

/// The bar that has to step aside while a line is printed.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Prints the warnings and errors that the library traces, each once.
pub(crate) fn install() {
    let subscriber = tracing_subscriber::fmt()
        .with_ansi(false)
        .event_format(Plain)
        .with_max_level(Level::WARN)
        .with_writer(Once::default())
        .finish();
    // Fails only where one is installed already, and nothing else does.
    let _ = tracing::subscriber::set_global_default(subscriber);
}

/// A line on stderr, above the progress bar.
pub(crate) fn line(text: &str) {
    write_line(format!("{text}\n").as_bytes());
}

/// An error with its causes, as `error: ...`.
pub(crate) fn error(error: &Error) {
    line(&format!("error: {}", causes(error)));
}

/// Text on stdout.
///
/// A reader that has closed its end (`lightoven info | head -1`) has all that it wants.
pub(crate) fn stdout(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::new(ErrorKind::Io, "cannot write to the standard output").with_source(error))
        }
        _ => Ok(()),
    }
}

/// Lets lines be printed above this bar.
pub(crate) fn attach(bar: &ProgressBar) {
    *lock(&BAR) = Some(bar.clone());
}

fn write_line(bytes: &[u8]) {
    let bar = lock(&BAR).clone();
    let write = || {
        let _ = io::stderr().lock().write_all(bytes);
    };
    match bar {
        Some(bar) => bar.suspend(write),
        None => write(),
    }
}

/// The error's text and that of every cause that it does not already include.
pub(crate) fn causes(error: &Error) -> String {
    let mut text = error.to_string();
    let mut cause = std::error::Error::source(error);
    while let Some(error) = cause {
        let next = error.to_string();
        if !text.contains(&next) {
            text = format!("{text}: {next}");
        }
        cause = error.source();
    }
    text
}

/// A panic while the lock was held leaves nothing half done here.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// `warning: text`, without time, target or colour.
struct Plain;

impl<S, N> FormatEvent<S, N> for Plain
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        let level = if *event.metadata().level() == Level::ERROR { "error" } else { "warning" };
        write!(writer, "{level}: ")?;
        context.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}

/// Prints an event that has not been printed before: what the library traces as it happens is listed again when it is
/// done, for the report.
#[derive(Default)]
struct Once {
    printed: Mutex<HashSet<Vec<u8>>>,
}

impl<'a> MakeWriter<'a> for Once {
    type Writer = &'a Self;

    fn make_writer(&'a self) -> Self::Writer {
        self
    }
}

impl Write for &Once {
    fn write(&mut self, event: &[u8]) -> io::Result<usize> {
        if lock(&self.printed).insert(event.to_vec()) {
            write_line(event);
        }
        Ok(event.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cause_is_said_once() {
        let root = Error::new(ErrorKind::Io, "root").with_source(io::Error::other("disk"));
        let error = Error::new(ErrorKind::Io, "top").with_source(root);
        assert_eq!(causes(&error), "top: root: disk");
        assert_eq!(causes(&Error::new(ErrorKind::Io, "alone")), "alone");
    }
}
