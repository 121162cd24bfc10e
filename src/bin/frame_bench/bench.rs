//! The measurement, from the arguments to the outputs.

use crate::Ending;
use crate::arguments::Arguments;
use crate::engine::{Device, DeviceSettings, Validation};
use crate::frames::Frames;
use crate::progress::{Bar, Visibility};
use crate::random::Random;
use crate::report::Report;
use crate::row::{Case, Phase, Row};
use crate::world::World;
use crate::{csv, interrupt, messages, paths, picture, plot, table};
use lightoven::scene::Resolution;
use lightoven::{Error, ErrorKind, Result};
use std::time::Duration;

/// Measures and writes.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    check_paths(arguments)?;
    interrupt::install()?;
    let bar = Bar::new(if arguments.quiet { Visibility::Hidden } else { Visibility::Shown });
    bar.say("loading");
    let world = World::read(&arguments.scene, Resolution::Texels(arguments.resolution))?;
    bar.say("preparing");
    let device = Device::new(&device_settings(arguments))?;
    let mut frames = Frames::new(device, world, arguments)?;

    let measured = measure(&mut frames, arguments, &bar)?;
    fail_on_validation(&frames)?;
    let interrupted = interrupt::requested();
    if measured.rows.iter().all(|row| row.phase == Phase::WarmUp) {
        messages::line("interrupted before anything was measured: nothing is written");
        return Ok(Ending::Interrupted);
    }
    let setting = frames.setting();
    let report = Report::new(setting, arguments, &measured.rows, interrupted);
    bar.say("writing");
    let written = write(arguments, &report, &measured)?;
    drop(bar);
    if !arguments.quiet {
        messages::stdout(&format!("{}\n{written}", table::text(&report)))?;
    }
    Ok(if interrupted { Ending::Interrupted } else { Ending::Done })
}

/// All frames, and the picture of the last one with raster and baking.
struct Measured {
    rows: Vec<Row>,
    picture: Option<([u32; 2], Vec<u8>)>,
}

/// A frame that is to be run.
type Planned = (Phase, Case, Duration);

fn measure(frames: &mut Frames, arguments: &Arguments, bar: &Bar) -> Result<Measured> {
    let plan = plan(arguments);
    bar.set_total(plan.len() as u64);
    let last_both = plan.iter().rposition(|(_, case, _)| *case == Case::Both);
    let mut measured = Measured { rows: Vec::with_capacity(plan.len()), picture: None };
    for (index, (phase, case, budget)) in plan.into_iter().enumerate() {
        let stopping = interrupt::requested();
        // An early stop still owes the picture: one frame more makes it.
        let case = if stopping { Case::Both } else { case };
        let row = frames.run(phase, case, budget)?;
        bar.say(phase.name());
        bar.step(format!("{} ms: frame {:.1} ms", budget.as_secs_f64() * 1e3, row.frame_ms));
        if arguments.screenshot.is_some() && (stopping || Some(index) == last_both) {
            measured.picture = Some(frames.screenshot()?);
        }
        if stopping {
            break;
        }
        measured.rows.push(row);
    }
    Ok(measured)
}

/// All frames: for each budget a warm-up, then the cases at random; last the overlap, at the middle budget.
fn plan(arguments: &Arguments) -> Vec<Planned> {
    let budgets = &arguments.budget_ms.0;
    let mut sorted = budgets.clone();
    sorted.sort_unstable();
    let middle = sorted[(sorted.len() - 1) / 2];
    let ranges = budgets.iter().map(|budget| (Phase::Budget, *budget)).chain([(Phase::Overlap, middle)]);
    let mut random = Random::new(arguments.seed);
    let mut plan = Vec::new();
    for (phase, budget) in ranges {
        plan.extend((0..arguments.warm_up).map(|_| (Phase::WarmUp, Case::Both, budget)));
        let mut cases: Vec<Case> = (0..arguments.frames).flat_map(|_| Case::ALL).collect();
        random.shuffle(&mut cases);
        plan.extend(cases.into_iter().map(|case| (phase, case, budget)));
    }
    plan
}

fn device_settings(arguments: &Arguments) -> DeviceSettings {
    let wanted = std::env::var_os("LIGHTOVEN_VALIDATION").is_some_and(|value| value == "1");
    DeviceSettings {
        device: arguments.device.clone(),
        backend: arguments.backend(),
        validation: if wanted { Validation::On } else { Validation::Off },
    }
}

/// Frames that broke Vulkan's rules prove nothing.
fn fail_on_validation(frames: &Frames) -> Result<()> {
    match &frames.validation_messages()[..] {
        [] => Ok(()),
        [first, rest @ ..] => {
            let context = format!("the validation layer has {} messages, the first: {first}", rest.len() + 1);
            Err(Error::new(ErrorKind::Driver, context))
        }
    }
}

/// Writes what was asked for and says what, a line each.
fn write(arguments: &Arguments, report: &Report, measured: &Measured) -> Result<String> {
    let mut written = Vec::new();
    if let Some(path) = &arguments.report {
        report.write(path)?;
        written.push(path);
    }
    if let Some(path) = &arguments.plot {
        plot::write(path, &measured.rows)?;
        written.push(path);
    }
    if let Some(path) = &arguments.csv {
        csv::write(path, &measured.rows)?;
        written.push(path);
    }
    if let (Some(path), Some((size, pixels))) = (&arguments.screenshot, &measured.picture) {
        picture::write(path, *size, pixels)?;
        written.push(path);
    }
    Ok(written.iter().map(|path| format!("wrote    {}\n", path.display())).collect())
}

/// Refuses, before anything takes time, outputs that cannot be written, or that would replace each other or the scene.
fn check_paths(arguments: &Arguments) -> Result<()> {
    let outputs = [
        ("--report", arguments.report.as_ref()),
        ("--plot", arguments.plot.as_ref()),
        ("--csv", arguments.csv.as_ref()),
        ("--screenshot", arguments.screenshot.as_ref()),
    ];
    paths::check(&[("the scene", Some(&arguments.scene))], &outputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[test]
    fn every_budget_has_its_frames_of_each_case_and_the_middle_one_the_overlap() {
        let arguments =
            Arguments::parse_from(["frame_bench", "s", "--frames", "5", "--warm-up", "2", "--budget-ms", "8,2,4"]);
        let plan = plan(&arguments);
        assert_eq!(plan.len(), 4 * (2 + 15));
        let count = |wanted: Planned| plan.iter().filter(|planned| **planned == wanted).count();
        for budget in [8, 2, 4].map(Duration::from_millis) {
            assert!(Case::ALL.iter().all(|case| count((Phase::Budget, *case, budget)) == 5));
        }
        assert!(Case::ALL.iter().all(|case| count((Phase::Overlap, *case, Duration::from_millis(4))) == 5));
        assert_eq!(count((Phase::WarmUp, Case::Both, Duration::from_millis(4))), 4);
    }
}
