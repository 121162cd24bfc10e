//! The frame benchmark: a small engine that embeds the library as any other would, and measures what that costs it.
//!
//! Exit codes: 0 done, 1 failed, 2 bad usage, 130 interrupted.

mod arguments;
mod baking;
mod bench;
mod brightness;
mod csv;
mod engine;
mod frames;
mod motion;
mod picture;
mod place;
mod plot;
mod progress;
mod random;
mod report;
mod row;
mod statistics;
mod table;
mod values;
mod world;

// What both binaries say and refuse alike.
#[path = "../lightoven/interrupt.rs"]
mod interrupt;
#[path = "../lightoven/messages.rs"]
mod messages;
#[path = "../lightoven/paths.rs"]
mod paths;

use arguments::Arguments;
use clap::Parser;
use lightoven::{Error, ErrorKind};
use std::process::ExitCode;

/// How a run ended that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ending {
    Done,
    Interrupted,
}

fn main() -> ExitCode {
    messages::install();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    match bench::run(&arguments) {
        Ok(Ending::Done) => ExitCode::SUCCESS,
        Ok(Ending::Interrupted) => ExitCode::from(interrupt::EXIT_CODE),
        Err(error) => failure(&error),
    }
}

/// Help and version are no failure and go to stdout; all else that the parser says is bad usage.
fn usage(error: &clap::Error) -> ExitCode {
    // With its stream closed there is nobody left to tell.
    let _ = error.print();
    if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
}

fn failure(error: &Error) -> ExitCode {
    messages::error(error);
    match error.kind() {
        ErrorKind::InvalidSettings => ExitCode::from(2),
        _ => ExitCode::FAILURE,
    }
}
