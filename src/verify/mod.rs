//! Whether a device computes right: closed-form answers, and what must happen in stiff and extreme cases, through the whole
//! bake.
//!
//! ```no_run
//! # use lightoven::{Result, headless::{Headless, HeadlessSettings}, verify};
//! # fn main() -> Result<()> {
//! let headless = Headless::new(&HeadlessSettings::default())?;
//! for case in verify::cases() {
//!     let verdict = case.run(headless.gpu());
//!     println!("{}: {}", case.name, if verdict.passes() { "passes" } else { "FAILS" });
//! }
//! # Ok(())
//! # }
//! ```

mod cases;
mod checks;
mod estimate;
mod live;
mod random;
#[doc(hidden)]
pub mod stage;
pub mod study;

pub use checks::{Checks, Comparison, Row};

use crate::error::{Error, Result};
use crate::gpu::Gpu;
use std::fmt;
use std::time::{Duration, Instant};

/// Something that must be so on every device.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Group and name, as in "furnace half".
    pub name: &'static str,
    /// What is asked.
    pub subject: Subject,
    run: fn(&Gpu, &mut Checks) -> Result<()>,
}

/// What a case is about. The numbers are those of the tables in the README.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// There is a closed form of the answer.
    ClosedForm(u32),
    /// A stiff or extreme input.
    Extreme(u32),
    /// How the baker goes about it.
    Conduct,
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ClosedForm(number) => write!(f, "closed form {number}"),
            Self::Extreme(number) => write!(f, "extreme {number}"),
            Self::Conduct => f.write_str("conduct"),
        }
    }
}

/// What came of a case.
#[derive(Debug)]
pub struct Verdict {
    /// In the order in which they were found.
    pub rows: Vec<Row>,
    /// Why the case has no meaning on this device.
    pub skipped: Option<String>,
    /// What kept it from its end.
    pub error: Option<Error>,
    /// How long it took, compilation of shaders included.
    pub time: Duration,
}

impl Case {
    const fn closed_form(number: u32, name: &'static str, run: fn(&Gpu, &mut Checks) -> Result<()>) -> Self {
        Self { name, subject: Subject::ClosedForm(number), run }
    }

    const fn extreme(number: u32, name: &'static str, run: fn(&Gpu, &mut Checks) -> Result<()>) -> Self {
        Self { name, subject: Subject::Extreme(number), run }
    }

    const fn conduct(name: &'static str, run: fn(&Gpu, &mut Checks) -> Result<()>) -> Self {
        Self { name, subject: Subject::Conduct, run }
    }

    /// Runs it, which takes seconds and cannot be cancelled. Nobody else uses the queues of an engine's device meanwhile.
    pub fn run(&self, gpu: &Gpu) -> Verdict {
        let started = Instant::now();
        let mut checks = Checks::default();
        let error = (self.run)(gpu, &mut checks).err();
        let Checks { rows, skipped } = checks;
        Verdict { rows, skipped, error, time: started.elapsed() }
    }
}

impl Verdict {
    /// Whether everything is as it must be. A case that found nothing to compare does not pass, unless it says why.
    pub fn passes(&self) -> bool {
        let compared = !self.rows.is_empty() || self.skipped.is_some();
        self.error.is_none() && compared && self.rows.iter().all(|row| row.passes)
    }
}

/// All cases.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    cases::GROUPS.into_iter().flatten()
}
