//! `lightoven study`: how answers depend on what is stiff or extreme.

mod plot;
mod report;

use crate::arguments::{Study, StudyArgument};
use crate::progress::{Bar, Visibility};
use crate::report::write_json;
use crate::{Ending, device, interrupt, messages, paths};
use lightoven::gpu::Gpu;
use lightoven::verify::study;
use lightoven::{Error, ErrorKind, Result};
use report::{Precision, Report, Stiffness};

/// Makes the study, and says what came out.
pub(crate) fn run(arguments: &Study) -> Result<Ending> {
    if arguments.plot.is_some() && arguments.study != StudyArgument::Stiffness {
        let context = "--plot: there is a plot of the study 'stiffness' only";
        return Err(Error::new(ErrorKind::InvalidSettings, context));
    }
    paths::check(&[], &[("--report", arguments.report.as_ref()), ("--plot", arguments.plot.as_ref())])?;
    interrupt::install_saying("interrupted: stopping")?;
    let bar = Bar::new(Visibility::Shown);
    let headless = device::open(&arguments.device)?;
    let measured = match arguments.study {
        StudyArgument::Stiffness => stiffness(headless.gpu(), &bar)?,
        StudyArgument::Precision => precision(headless.gpu(), &bar)?,
    };
    device::fail_on_validation(&headless)?;
    drop(bar);
    let Some(report) = measured else {
        messages::line("interrupted before all was measured: there are no figures, and nothing is written");
        return Ok(Ending::Interrupted);
    };
    messages::stdout(&report.text())?;
    if let (Some(path), Report::Stiffness(stiffness)) = (&arguments.plot, &report) {
        plot::write(path, stiffness)?;
    }
    if let Some(path) = &arguments.report {
        write_json(path, &report)?;
    }
    Ok(Ending::Done)
}

/// `None` when it was interrupted.
fn stiffness(gpu: &Gpu, bar: &Bar) -> Result<Option<Report>> {
    let mut albedos = Vec::new();
    for albedo in study::ALBEDOS {
        if interrupt::requested() {
            return Ok(None);
        }
        bar.say(format!("albedo {albedo}"));
        albedos.push(study::stiffness(gpu, albedo)?);
    }
    Ok(Some(Report::Stiffness(Stiffness::new(gpu, &albedos))))
}

/// Bakes the same scene in several ways.
type Measure = fn(&Gpu) -> Result<Vec<study::Deviation>>;

fn precision(gpu: &Gpu, bar: &Bar) -> Result<Option<Report>> {
    let mut studies = Vec::new();
    let all: [(&str, Measure); 3] =
        [("scale", study::scales), ("offset", study::offsets), ("radiance", study::radiances)];
    for (name, study) in all {
        if interrupt::requested() {
            return Ok(None);
        }
        bar.say(name);
        studies.push((name, study(gpu)?));
    }
    bar.say("decay");
    Ok(Some(Report::Precision(Precision::new(gpu, &studies, &study::decays()?))))
}
