//! Every case of `lightoven::verify` on each back end, watched by the validation layers: `lightoven verify` is the other way
//! to run the same list.
//!
//! A device without ray queries has their half ignored, and says so, unless `LIGHTOVEN_REQUIRE=ray_query` asks for it.

use libtest_mimic::{Arguments, Failed, Trial};
use lightoven::gpu::BackendChoice;
use lightoven::headless::{Headless, HeadlessSettings, Validation};
use lightoven::verify::{self, Case, Verdict};
use lightoven::{Error, ErrorKind};
use std::process::ExitCode;

fn main() -> ExitCode {
    let back_ends = [("software", BackendChoice::Software), ("ray_query", BackendChoice::RayQuery)];
    let lacks_ray_query = lacks(BackendChoice::RayQuery);
    if let Some(error) = &lacks_ray_query {
        eprintln!("the ray_query half is ignored: {error}");
    }
    let trial = |(case, (name, backend)): (&'static Case, (&str, BackendChoice))| {
        let is_ignored = backend == BackendChoice::RayQuery && lacks_ray_query.is_some();
        Trial::test(format!("{} ({name})", case.name), move || run(case, backend)).with_ignored_flag(is_ignored)
    };
    let trials = verify::cases().flat_map(|case| back_ends.map(|backend| trial((case, backend)))).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn open(backend: BackendChoice) -> Result<Headless, Error> {
    Headless::new(&HeadlessSettings { backend, validation: Validation::On, ..HeadlessSettings::default() })
}

/// Why the device has none, where it need not.
fn lacks(backend: BackendChoice) -> Option<Error> {
    let is_required = std::env::var("LIGHTOVEN_REQUIRE").is_ok_and(|required| required == "ray_query");
    open(backend).err().filter(|error| error.kind() == ErrorKind::Unsupported && !is_required)
}

fn run(case: &Case, backend: BackendChoice) -> Result<(), Failed> {
    let headless = open(backend)?;
    let verdict = case.run(headless.gpu());
    let messages = headless.validation_messages();
    if verdict.passes() && messages.is_empty() {
        return Ok(());
    }
    Err(format!("{}{}", told(&verdict), messages.join("\n")).into())
}

/// What was found, a line each, and what it ended with.
fn told(verdict: &Verdict) -> String {
    let rows = verdict.rows.iter().map(|row| {
        let passes = if row.passes { "passes" } else { "FAILS" };
        format!("{passes}: {}: {} against {}, {:?}\n", row.what, row.measured, row.expected, row.comparison)
    });
    let error = verdict.error.iter().map(|error| format!("FAILS: {error}\n"));
    rows.chain(error).collect()
}
