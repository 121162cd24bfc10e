//! Every case of `lightoven::verify` on each back end, watched by the validation layers: `lightoven verify` is the other way
//! to run the same list.
//!
//! A device without ray queries skips their half, unless `LIGHTOVEN_REQUIRE=ray_query` asks for it.

use libtest_mimic::{Arguments, Failed, Trial};
use lightoven::ErrorKind;
use lightoven::gpu::BackendChoice;
use lightoven::headless::{Headless, HeadlessSettings, Validation};
use lightoven::verify::{self, Case, Verdict};
use std::process::ExitCode;

fn main() -> ExitCode {
    let back_ends = [("software", BackendChoice::Software), ("ray_query", BackendChoice::RayQuery)];
    let trial = |(case, (name, backend)): (&'static Case, (&str, BackendChoice))| {
        Trial::test(format!("{} ({name})", case.name), move || run(case, backend))
    };
    let trials = verify::cases().flat_map(|case| back_ends.map(|backend| trial((case, backend)))).collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn run(case: &Case, backend: BackendChoice) -> Result<(), Failed> {
    let settings = HeadlessSettings { backend, validation: Validation::On, ..HeadlessSettings::default() };
    let headless = match Headless::new(&settings) {
        Err(error) if backend == BackendChoice::RayQuery && error.kind() == ErrorKind::Unsupported => {
            let required = std::env::var("LIGHTOVEN_REQUIRE").is_ok_and(|required| required == "ray_query");
            return if required { Err(format!("ray query is required: {error}").into()) } else { Ok(()) };
        }
        headless => headless?,
    };
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
