//! `lightoven verify`: whether a device computes right.

mod report;

use crate::arguments::Verify;
use crate::progress::{Bar, Visibility};
use crate::report::write_json;
use crate::{Ending, device, interrupt, messages, paths};
use lightoven::verify::{self, Case};
use lightoven::{Error, ErrorKind, Result};
use report::{CaseReport, Report};
use std::time::Instant;

/// Runs the cases in turn, and says of each what it found.
pub(crate) fn run(arguments: &Verify, start: Instant) -> Result<Ending> {
    let cases = selected(&arguments.only)?;
    paths::check(&[], &[("--report", arguments.report.as_ref())])?;
    interrupt::install_saying("interrupted: stopping after this case")?;
    let bar = Bar::new(Visibility::Shown);
    let mut headless = device::open(&arguments.device)?;
    let mut report = Report::new(headless.gpu());
    messages::stdout(&report.head())?;
    for case in &cases {
        if interrupt::requested() {
            break;
        }
        bar.say(case.name);
        let verdict = case.run(headless.gpu());
        let found = CaseReport::new(case, &verdict, &headless.validation_messages());
        messages::stdout(&found.text())?;
        let is_spoilt = verdict.error.is_some() || !found.validation.is_empty();
        report.cases.push(found);
        if is_spoilt {
            // What a lost device, or one that broke a rule, says of the next case is not that case's.
            match device::open(&arguments.device) {
                Ok(opened) => headless = opened,
                Err(error) => {
                    messages::error(&error);
                    break;
                }
            }
        }
    }
    drop(bar);
    report.seconds = start.elapsed().as_secs_f64();
    messages::stdout(&report.tail())?;
    if report.cases.len() < cases.len() && interrupt::requested() {
        messages::line("interrupted before all cases were done: nothing is written");
        return Ok(Ending::Interrupted);
    }
    if let Some(path) = &arguments.report {
        write_json(path, &report)?;
    }
    match report.failed() {
        0 => Ok(Ending::Done),
        failed if report.cases.len() < cases.len() => {
            let context =
                format!("{failed} cases failed, and after {} the device did not open again", report.cases.len());
            Err(Error::new(ErrorKind::DeviceLost, context))
        }
        failed => Err(Error::new(ErrorKind::Driver, format!("{failed} of {} cases failed", cases.len()))),
    }
}

/// Cases whose subject and name, as in "closed form 4 parallel unit squares", hold one of these; all for none.
fn selected(only: &[String]) -> Result<Vec<&'static Case>> {
    let title = |case: &Case| format!("{} {}", case.subject, case.name).to_lowercase();
    let is_meant = |case: &&Case| only.is_empty() || only.iter().any(|name| holds(&title(case), name));
    for name in only {
        if !verify::cases().any(|case| holds(&title(case), name)) {
            return Err(Error::new(
                ErrorKind::InvalidSettings,
                format!(
                    "--only '{name}': no case has this in its name; allowed is a part of: {}",
                    verify::cases().map(title).collect::<Vec<_>>().join(", ")
                ),
            ));
        }
    }
    Ok(verify::cases().filter(is_meant).collect())
}

/// Whether a title has this in it, in capitals or not. A number is meant whole: "closed form 1" is not "closed form 12".
fn holds(title: &str, name: &str) -> bool {
    let name = name.to_lowercase();
    let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let cuts_number = |start: usize, end: usize| {
        is_digit(name.chars().last()) && is_digit(title[end..].chars().next())
            || is_digit(name.chars().next()) && is_digit(title[..start].chars().last())
    };
    !name.is_empty() && title.match_indices(&name).any(|(start, _)| !cuts_number(start, start + name.len()))
}

#[cfg(test)]
mod tests {
    use super::holds;

    #[test]
    fn numbers_are_meant_whole() {
        let title = "closed form 12 spot light";
        assert!(
            holds(title, "Closed Form 12") && holds(title, "spot") && holds(title, "form 12 s") && holds(title, "12")
        );
        assert!(!holds(title, "closed form 1") && !holds(title, "2") && !holds(title, "sun") && !holds(title, ""));
    }
}
