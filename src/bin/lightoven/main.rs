//! The command line tool: bakes a glTF scene to an EXR light map, says what it would do, compares light maps, and measures
//! the noise of ways of sampling, how the error falls as a bake goes on, and the speed of rays, and verifies devices.
//!
//! Exit codes: 0 done, 1 failed, 2 bad usage, 130 interrupted.

mod arguments;
mod bake;
mod bench;
mod compare;
mod converge;
mod device;
mod fit;
mod info;
mod interrupt;
mod load;
mod messages;
mod noise;
mod paths;
mod progress;
mod report;
mod study;
mod values;
mod variance;
mod verify;

use arguments::{Arguments, Command};
use clap::Parser;
use lightoven::{Error, ErrorKind};
use std::process::ExitCode;
use std::time::Instant;

/// How a subcommand ended that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ending {
    Done,
    Interrupted,
}

fn main() -> ExitCode {
    let start = Instant::now();
    messages::install();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    let result = match &arguments.command {
        Command::Bake(bake) => bake::run(bake, start),
        Command::Info(info) => info::run(info),
        Command::Compare(compare) => compare::run(compare),
        Command::Variance(variance) => variance::run(variance),
        Command::Converge(converge) => converge::run(converge),
        Command::Bench(bench) => bench::run(bench, start),
        Command::Verify(verify) => verify::run(verify, start),
        Command::Study(study) => study::run(study),
    };
    match result {
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
