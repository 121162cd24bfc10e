//! `lightoven bench`: rays a second of each back end and of obvhs on the CPU, side by side; how cost
//! grows; and what leaving things out saves.

mod cpu;
mod features;
mod figures;
pub(crate) mod growth;
mod report;

use crate::arguments::{Bench, OrderArgument};
use crate::progress::{Bar, Visibility};
use crate::report::write_json;
use crate::{Ending, device, interrupt, load, messages, paths};
use cpu::{Cpu, Distance};
use figures::{Agreement, Each, Found, Rounds, Speeds};
use lightoven::baker::{GatherBench, SentRays};
use lightoven::bvh::Bvh;
use lightoven::gpu::{Backend, BackendChoice};
use lightoven::headless::Headless;
use lightoven::scene::{Atlas, Scene};
use lightoven::{LoadedRays, Query, Result, Tracer};
use report::{CpuReport, Gather, Report, Seconds, Spreads, Subject};
use serde::Serialize;
use std::time::Instant;

/// Rays a texel of the gathering pass: those of "Interactive Light Mapping with PowerVR Ray Tracing".
const GATHER_RAYS: u32 = 32;

/// Measures, and says how fast.
pub(crate) fn run(arguments: &Bench, start: Instant) -> Result<Ending> {
    let inputs = load::files(&arguments.scene, &arguments.how);
    paths::check(&inputs, &[("--report", arguments.report.as_ref())])?;
    interrupt::install_saying("interrupted: stopping")?;
    let bar = Bar::new(Visibility::Shown);
    bar.say("loading");
    let scene = load::scene(&arguments.scene, &arguments.how)?;
    bar.say("preparing");
    if let Some(growth) = arguments.growth {
        let measured = growth::measure(arguments, growth, &scene, &bar, start)?;
        drop(bar);
        return tell(arguments, measured, growth::Report::text);
    }
    if arguments.features {
        let measured = features::measure(arguments, &scene, &bar, start)?;
        drop(bar);
        return tell(arguments, measured, features::Report::text);
    }
    let devices = devices(arguments)?;
    let mut measured = measure(arguments, &scene, &devices, &bar)?;
    devices.iter().try_for_each(device::fail_on_validation)?;
    drop(bar);
    if let Some(report) = &mut measured {
        report.seconds.total = start.elapsed().as_secs_f64();
    }
    tell(arguments, measured, Report::text)
}

/// Prints and writes what was measured; there is nothing when it was interrupted.
fn tell<R: Serialize>(arguments: &Bench, measured: Option<R>, text: impl Fn(&R) -> String) -> Result<Ending> {
    let Some(report) = measured else {
        messages::line("interrupted before all rounds were done: there are no figures, and nothing is written");
        return Ok(Ending::Interrupted);
    };
    messages::stdout(&text(&report))?;
    if let Some(path) = &arguments.report {
        write_json(path, &report)?;
    }
    Ok(Ending::Done)
}

/// The device with the back end that a bake would take, and again with the other one where it is to be compared.
fn devices(arguments: &Bench) -> Result<Vec<Headless>> {
    let mut devices = vec![device::open(&arguments.device)?];
    let (backend, has_ray_query) = (devices[0].gpu().backend(), devices[0].gpu().info().ray_query);
    let other = match backend {
        Backend::Software => BackendChoice::RayQuery,
        Backend::RayQuery => BackendChoice::Software,
    };
    if has_ray_query && arguments.device.backend() == BackendChoice::Auto {
        devices.push(device::open_with(&arguments.device, other)?);
    }
    Ok(devices)
}

/// A scene on a device, with the rays.
struct OnDevice {
    tracer: Tracer,
    rays: LoadedRays,
}

/// All that trace.
struct Contest<'a> {
    software: Option<OnDevice>,
    ray_query: Option<OnDevice>,
    cpu: Cpu,
    sent: &'a SentRays,
    /// What the CPU found last.
    found: Vec<Distance>,
}

/// `None` when it was interrupted.
fn measure(arguments: &Bench, scene: &Scene, devices: &[Headless], bar: &Bar) -> Result<Option<Report>> {
    let resolution = arguments.how.resolution();
    let started = Instant::now();
    let bvh = Bvh::build(scene, &Atlas::new(scene, resolution)?)?;
    let seconds = Seconds { bvh: started.elapsed().as_secs_f64(), total: 0.0 };
    let gpu = devices[0].gpu();
    let mut bench = GatherBench::new(gpu, scene, &bvh, resolution)?;
    let mut sent = bench.rays(arguments.rays as usize)?;
    if arguments.order == OrderArgument::Random {
        shuffle(&mut sent);
    }
    let mut contest = Contest::new(scene, &bvh, devices, &sent)?;

    bar.say("warming up");
    bench.gather(GATHER_RAYS)?;
    let agreement = contest.agreement(scene)?;
    bar.say("measuring");
    let (mut closest, mut occluded, mut gathered) = (Rounds::new(), Rounds::new(), Vec::new());
    for _ in 0..arguments.rounds {
        if interrupt::requested() {
            return Ok(None);
        }
        closest.push(contest.round(Query::Closest)?);
        occluded.push(contest.round(Query::Occluded)?);
        gathered.push(bench.gather(GATHER_RAYS)?.as_secs_f64());
    }
    let rays = sent.rays.len();
    let spread = Spreads { closest: Speeds::new(rays, &closest), occluded: Speeds::new(rays, &occluded) };
    let gather = Gather {
        backend: gpu.backend().name(),
        resolution: bench.size(),
        texels: bench.texels(),
        rays_per_texel: GATHER_RAYS,
        milliseconds: None,
        mrays_per_s: None,
    };
    let subject = Subject {
        scene: scene.name().to_owned(),
        triangles: scene.triangle_count(),
        instances: scene.instances().len(),
        order: arguments.order,
        device: gpu.info().name.clone(),
        driver: gpu.info().driver.clone(),
        cpu: CpuReport {
            hierarchy: contest.cpu.name,
            threads: contest.cpu.threads,
            target_features: cpu::target_features(),
        },
    };
    Ok(Some(Report::new(subject, rays, arguments.rounds, spread, agreement, gather.timed(&gathered), seconds)))
}

/// The same order in every run.
fn shuffle(sent: &mut SentRays) {
    let mut pairs: Vec<_> = sent.rays.drain(..).zip(sent.skip.drain(..)).collect();
    fastrand::Rng::with_seed(0).shuffle(&mut pairs);
    (sent.rays, sent.skip) = pairs.into_iter().unzip();
}

impl<'a> Contest<'a> {
    fn new(scene: &Scene, bvh: &Bvh, devices: &[Headless], sent: &'a SentRays) -> Result<Self> {
        let on_device = |backend| {
            let device = devices.iter().find(|device| device.gpu().backend() == backend);
            device.map(|device| OnDevice::new(device, scene, bvh, sent)).transpose()
        };
        Ok(Self {
            software: on_device(Backend::Software)?,
            ray_query: on_device(Backend::RayQuery)?,
            cpu: Cpu::fastest(scene, bvh.centre, &sent.rays),
            sent,
            found: vec![0.0; sent.rays.len()],
        })
    }

    /// Seconds that each takes, in turn.
    fn round(&mut self, query: Query) -> Result<Each<Option<f64>>> {
        let time = |traced: &mut Option<OnDevice>| {
            traced.as_mut().map(|traced| Ok(traced.tracer.time(&traced.rays, query)?.as_secs_f64())).transpose()
        };
        let software = time(&mut self.software)?;
        let cpu = self.cpu.trace(&self.sent.rays, query, &mut self.found).as_secs_f64();
        Ok(Each { software, ray_query: time(&mut self.ray_query)?, cpu: Some(cpu) })
    }

    /// Traces once, which warms all up, and compares what is found.
    fn agreement(&mut self, scene: &Scene) -> Result<Agreement> {
        self.round(Query::Occluded)?;
        let occluded = self.found()?.map(|found| {
            let hits = |found: Vec<Distance>| found.iter().map(|distance| distance.is_finite()).collect();
            found.map(hits).unwrap_or_default()
        });
        self.round(Query::Closest)?;
        let closest = self.found()?;
        let both = |closest: Option<Vec<Distance>>, occluded| closest.map(|closest| Found { closest, occluded });
        let found = Each {
            software: both(closest.software, occluded.software),
            ray_query: both(closest.ray_query, occluded.ray_query),
            cpu: both(closest.cpu, occluded.cpu),
        };
        Agreement::new(&found, scene.bounds().map_or(0.0, |(lo, hi)| (hi - lo).length()))
    }

    /// What each found last, `[ray]`.
    fn found(&mut self) -> Result<Each<Option<Vec<Distance>>>> {
        let distances = |traced: &mut Option<OnDevice>| {
            let Some(OnDevice { tracer, rays }) = traced else { return Ok(None) };
            let hits = tracer.answers(rays)?;
            Ok(Some(hits.iter().map(|hit| hit.map_or(f32::INFINITY, |hit| hit.t)).collect()))
        };
        Ok(Each {
            software: distances(&mut self.software)?,
            ray_query: distances(&mut self.ray_query)?,
            cpu: Some(self.found.clone()),
        })
    }
}

impl OnDevice {
    fn new(device: &Headless, scene: &Scene, bvh: &Bvh, sent: &SentRays) -> Result<Self> {
        let mut tracer = Tracer::new(device.gpu(), scene, bvh)?;
        let rays = tracer.load(&sent.rays, &sent.skip)?;
        Ok(Self { tracer, rays })
    }
}
