//! `lightoven converge`: how the error falls as a bake goes on.

mod bench;
mod figures;
mod plot;
mod reference;
mod report;

use crate::arguments::Converge;
use crate::progress::{Bar, Visibility};
use crate::report::{write_json, write_text};
use crate::{Ending, device, interrupt, load, messages, paths};
use bench::Bench;
use lightoven::gpu::Gpu;
use lightoven::headless::Headless;
use lightoven::scene::Atlas;
use lightoven::{Error, ErrorKind, Result};
use reference::Light;
use report::Report;
use std::collections::HashSet;

/// Bakes a reference or reads one, then all variants with all seeds, and says how their error falls.
pub(crate) fn run(arguments: &Converge) -> Result<Ending> {
    check(arguments)?;
    interrupt::install_saying("interrupted: stopping")?;
    let bar = Bar::new(Visibility::Shown);
    bar.say("loading");
    let scene = load::scene(&arguments.scene, &arguments.how)?;
    let size = Atlas::new(&scene, arguments.how.resolution())?.size.to_array();
    let read = |path| Light::read(path, arguments.scale_reference, &arguments.scene, size);
    let light = arguments.reference.as_deref().map(read).transpose()?;
    bar.say("preparing");
    let devices = open(arguments)?;
    let gpus: Vec<&Gpu> = devices.iter().map(Headless::gpu).collect();
    let report = Bench::new(arguments, &scene, &gpus, &bar).measure(light)?;
    devices.iter().try_for_each(device::fail_on_validation)?;
    drop(bar);
    let Some(report) = report else {
        messages::line("interrupted before anything was measured: there are no figures to write");
        return Ok(Ending::Interrupted);
    };
    write(arguments, &report)?;
    messages::stdout(&report.text())?;
    if !report.interrupted {
        return Ok(Ending::Done);
    }
    messages::line("interrupted: the figures are those of what was measured until then");
    Ok(Ending::Interrupted)
}

/// Refuses, before anything takes time, what cannot be written, and what would be measured twice.
fn check(arguments: &Converge) -> Result<()> {
    let [scene, sky] = load::files(&arguments.scene, &arguments.how);
    let outputs = [
        ("--save-reference", arguments.save_reference.as_ref()),
        ("--csv", arguments.csv.as_ref()),
        ("--plot", arguments.plot.as_ref()),
        ("--report", arguments.report.as_ref()),
    ];
    paths::check(&[scene, sky, ("--reference", arguments.reference.as_ref())], &outputs)?;
    only_once("--sampling", arguments.sampling.iter().map(|way| way.name()))
}

fn only_once(option: &str, names: impl Iterator<Item = String>) -> Result<()> {
    let mut seen = HashSet::new();
    for name in names {
        if seen.contains(&name) {
            let context = format!("{option} has '{name}' more than once; allowed is once");
            return Err(Error::new(ErrorKind::InvalidSettings, context));
        }
        seen.insert(name);
    }
    Ok(())
}

/// A device for each back end.
fn open(arguments: &Converge) -> Result<Vec<Headless>> {
    let devices = arguments.devices().iter().map(device::open).collect::<Result<Vec<_>>>()?;
    only_once("--backend", devices.iter().map(|device| device.gpu().backend().name().to_owned()))?;
    Ok(devices)
}

fn write(arguments: &Converge, report: &Report) -> Result<()> {
    if let Some(path) = &arguments.report {
        write_json(path, report)?;
    }
    if let Some(path) = &arguments.csv {
        write_text(path, &report.csv())?;
    }
    match &arguments.plot {
        Some(path) => plot::write(path, report),
        None => Ok(()),
    }
}
