//! `lightoven bake`: a scene in, a light map out.

use crate::Ending;
use crate::arguments::Bake;
use crate::paths;
use crate::progress::{Bar, Visibility};
use crate::report::{Measured, Report, write_json};
use crate::{device, interrupt, load, messages};
use lightoven::baker::{BakeSettings, Baker, LightMap, Outcome};
use lightoven::headless::Headless;
use lightoven::io::exr::{Metadata, write_light_map};
use lightoven::io::preview;
use lightoven::scene::Scene;
use lightoven::{ErrorKind, Result};
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// About how often the light map is read back, so that a device that is lost does not take all of it along.
const KEPT_EVERY: Duration = Duration::from_secs(10);

/// Bakes; `start` is when the command began.
pub(crate) fn run(arguments: &Bake, start: Instant) -> Result<Ending> {
    check_paths(arguments)?;
    interrupt::install()?;
    let bar = Bar::new(if arguments.quiet { Visibility::Hidden } else { Visibility::Shown });

    bar.say("loading");
    let loading = Instant::now();
    let scene = load::scene(&arguments.scene, &arguments.how)?;
    let load = loading.elapsed().as_secs_f64();

    bar.say("preparing");
    let headless = device::open(&arguments.device)?;
    let settings = BakeSettings {
        resolution: arguments.how.resolution(),
        bounces: arguments.bounces,
        sampling: arguments.sampling.sampling,
        aimed_by: arguments.sampling.aimed_by,
        error: arguments.error_estimate(),
        seed: arguments.seed,
        ..BakeSettings::default()
    };
    let mut baker = Baker::new(headless.gpu(), &scene, &settings)?;
    let layout_warning = load::layout_warning(baker.atlas());
    layout_warning.iter().for_each(|warning| tracing::warn!("{warning}"));
    if interrupt::requested() {
        return Ok(nothing_written());
    }

    let mut kept = None;
    let baked = baker.bake_keeping(
        &arguments.stop(),
        KEPT_EVERY,
        &mut |progress| {
            bar.show(progress);
            if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
        &mut |light_map, statistics| kept = Some((light_map, statistics.samples_per_texel)),
    );
    let finished = baked.and_then(|outcome| Ok((outcome, baker.read_back()?)));
    let metadata = |samples| metadata(&scene, &headless, samples, arguments.seed);
    let (outcome, light_map) = match (finished, kept) {
        (Ok(finished), _) => finished,
        (Err(error), Some((light_map, samples))) if error.kind() == ErrorKind::DeviceLost => {
            // What cannot be written is said, and the device's error is that of the command.
            if let Err(error) = write_kept(arguments, &light_map, &metadata(samples)) {
                messages::error(&error);
            }
            return Err(error);
        }
        (Err(error), _) => return Err(error),
    };
    device::fail_on_validation(&headless)?;

    bar.say("writing");
    let writing = Instant::now();
    write_images(arguments, &light_map, &metadata(baker.statistics().samples_per_texel))?;
    let measured = Measured { load, write: writing.elapsed().as_secs_f64(), total: start.elapsed().as_secs_f64() };
    let warnings = warnings(&scene, layout_warning, &baker, &light_map);
    warnings.iter().for_each(|warning| tracing::warn!("{warning}"));
    let report = Report::new(&scene, headless.gpu(), &baker, outcome, arguments.seed, measured, warnings);
    if let Some(path) = &arguments.report {
        write_json(path, &report)?;
    }
    drop(bar);
    conclude(arguments, &report, baker.atlas().shared, outcome)
}

fn nothing_written() -> Ending {
    messages::line("interrupted before anything was baked: nothing is written");
    Ending::Interrupted
}

fn metadata(scene: &Scene, headless: &Headless, samples: f64, seed: u64) -> Metadata {
    Metadata {
        scene: scene.name().to_owned(),
        seed,
        samples,
        device: headless.gpu().info().name.clone(),
        version: concat!("lightoven ", env!("CARGO_PKG_VERSION")).to_owned(),
    }
}

fn write_images(arguments: &Bake, light_map: &LightMap, metadata: &Metadata) -> Result<()> {
    write_light_map(&arguments.output, light_map, metadata)?;
    match &arguments.preview {
        Some(path) => preview::write_preview(path, light_map),
        None => Ok(()),
    }
}

/// What was baked when the light map was last read back, before the device was lost.
fn write_kept(arguments: &Bake, light_map: &LightMap, metadata: &Metadata) -> Result<()> {
    write_images(arguments, light_map, metadata)?;
    let (path, samples) = (arguments.output.display(), metadata.samples);
    messages::line(&format!(
        "the device was lost: '{path}' holds what was baked until then, {samples:.1} samples a texel"
    ));
    Ok(())
}

fn warnings(scene: &Scene, layout: Option<String>, baker: &Baker, light_map: &LightMap) -> Vec<String> {
    let mut warnings = scene.warnings().to_vec();
    warnings.extend(layout);
    for warning in &baker.statistics().warnings {
        if !warnings.contains(warning) {
            warnings.push(warning.clone());
        }
    }
    let broken = light_map.pixels.iter().filter(|pixel| !pixel.iter().all(|c| c.is_finite())).count();
    if broken > 0 {
        warnings.push(format!("{broken} texels of the light map are not finite numbers"));
    }
    warnings
}

fn conclude(arguments: &Bake, report: &Report, shared: bool, outcome: Outcome) -> Result<Ending> {
    if outcome == Outcome::Interrupted {
        let (path, samples) = (arguments.output.display(), report.samples_per_texel);
        messages::line(&format!("interrupted: '{path}' holds what was baked until then, {samples:.1} samples a texel"));
    }
    if !arguments.quiet {
        let mut text = report.summary();
        let outputs = [Some(&arguments.output), arguments.preview.as_ref(), arguments.report.as_ref()];
        for path in outputs.into_iter().flatten() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "wrote    {}", path.display());
        }
        if !shared {
            let count = report.instances.len();
            let place = match &arguments.report {
                Some(path) => format!("in {}", path.display()),
                None => "written by --report".to_owned(),
            };
            let _ =
                writeln!(text, "packed   {count} instances, each into a rectangle of its own: {place}, \"instances\"");
        }
        messages::stdout(&text)?;
    }
    Ok(if outcome == Outcome::Interrupted { Ending::Interrupted } else { Ending::Done })
}

/// Refuses, before anything takes time, outputs that cannot be written, or that would replace each other or an input.
fn check_paths(arguments: &Bake) -> Result<()> {
    let outputs = [
        ("--output", Some(&arguments.output)),
        ("--preview", arguments.preview.as_ref()),
        ("--report", arguments.report.as_ref()),
    ];
    paths::check(&load::files(&arguments.scene, &arguments.how), &outputs)
}
