//! The algorithm within an engine's frames, as a list of passes: what changed is written, then direct light where it is
//! out of date, rays, and a light map, each as far as the frame's time goes.

mod aiming;
mod flight;
mod passes;
mod published;
mod renewal;
mod report;
mod settings;
mod settling;
mod sky_map;
mod timing;
mod world;

pub(super) use published::Shown;
pub use report::{FrameId, FrameReport, FrameTiming, MeasuredBy, Ran};
pub use settings::{Clock, FrameSettings, Learning, Timing};

use super::{Core, Sampling};
use crate::bvh::Bvh;
use crate::error::{Error, Result};
use crate::features::Features;
use crate::gpu::layout::{Push, SQUARE_GROUP};
use crate::gpu::{FrameCommands, FrameSubmitter, MARKS, Recorder, TimelinePoint, Timer};
use crate::scene::Scene;
use crate::schedule::{Extent, FrameScheduler, Needs, STAGES, Stage, TILE, Work, samples_per_texel};
use crate::temporal::{Average, History};
use aiming::Aiming;
use flight::Flight;
use passes::Passes;
use published::Published;
use settling::Settling;
use std::ops::Range;
use std::time::{Duration, Instant};
use timing::TIMED;
use world::{Changes, World};

/// Rays of a quantum, each of a stratum of its own.
const RAYS: u32 = 16;

/// A baker's state between frames.
pub(super) struct Frames {
    settings: FrameSettings,
    passes: Passes,
    aiming: Aiming,
    pub(super) world: World,
    average: Average,
    tiles: Vec<Tile>,
    settling: Settling,
    scheduler: FrameScheduler,
    flight: Flight,
    published: Published,
    timer: Option<Timer>,
    submitter: FrameSubmitter,
    way: Option<Way>,
    started: Instant,
    engine: EngineClock,
    /// Something has been recorded.
    begun: bool,
    /// Direct light is out of date.
    direct_due: bool,
    /// Which source map is read.
    source: usize,
    /// Samples before those of the sweep under way, for the random numbers.
    first_sample: u32,
    quanta: u32,
    sweeps: u64,
    used: [bool; STAGES],
    /// What writing changes takes.
    update_s: f64,
    /// When frames were last reported complete.
    reported_at: Option<Instant>,
    learning: Learning,
}

/// What is remembered of a tile.
#[derive(Debug, Clone, Copy, Default)]
struct Tile {
    history: History,
    visited_s: f64,
    /// Changes that had been when it was visited.
    changes: u64,
}

/// Time as the engine tells it: only how it goes forward counts.
#[derive(Debug, Clone, Copy, Default)]
struct EngineClock {
    told_s: Option<f64>,
    now_s: f64,
}

/// How the engine runs frames. One baker stays with one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Record,
    Submit,
}

impl Frames {
    pub(super) fn new(
        core: &mut Core,
        scene: &Scene,
        bvh: Bvh,
        settings: FrameSettings,
        sampling: Sampling,
    ) -> Result<Self> {
        let average = Average::new(settings.tolerable_latency, settings.decay_threshold)?;
        let passes = Passes::new(core)?;
        let [width, height] = core.maps.size;
        let max_albedo = scene.materials().iter().map(|material| material.albedo.max_element()).fold(0.0, f32::max);
        let max_albedo = f64::from(max_albedo);
        let aiming = Aiming::new(core, sampling, max_albedo, settings.frames_in_flight)?;
        let extent = Extent {
            texels: core.texels.count,
            lights: core.push.light_count,
            block_rows: height.div_ceil(SQUARE_GROUP),
            texels_per_block_row: width * SQUARE_GROUP,
            importance_parts: aiming.parts(),
            texels_per_importance_part: 2 * width * SQUARE_GROUP,
            fixed_quanta: settings.quanta,
        };
        let settling = Settling::new(&average, max_albedo);
        Ok(Self {
            settings,
            passes,
            aiming,
            world: World::new(&core.gpu, scene, bvh, core.features)?,
            average,
            tiles: vec![Tile::default(); extent.tiles() as usize],
            settling,
            scheduler: FrameScheduler::new(extent),
            flight: Flight::new(settings.frames_in_flight),
            published: Published::new(core.maps.light_map.len()),
            timer: Timer::new(&core.gpu, settings.frames_in_flight)?,
            submitter: FrameSubmitter::new(&core.gpu, settings.frames_in_flight)?,
            way: None,
            started: Instant::now(),
            engine: EngineClock::default(),
            begun: false,
            direct_due: core.features.contains(Features::LIGHTS),
            source: 0,
            first_sample: 0,
            quanta: 0,
            sweeps: 0,
            used: [false; STAGES],
            update_s: 0.0,
            reported_at: None,
            learning: Learning::default(),
        })
    }

    pub(super) fn record(&mut self, core: &mut Core, commands: FrameCommands, budget: Duration) -> Result<FrameReport> {
        self.keep_to(Way::Record)?;
        let (frame, row) = self.flight.begin();
        match row {
            Some(row) if !budget.is_zero() => self.fill(core, commands, frame, row, budget),
            row => Ok(self.idle(core, frame, row.is_none())),
        }
    }

    pub(super) fn submit(
        &mut self,
        core: &mut Core,
        budget: Duration,
        wait: &[TimelinePoint],
        signal: &[TimelinePoint],
    ) -> Result<FrameReport> {
        self.keep_to(Way::Submit)?;
        let (frame, row) = self.flight.begin();
        match row {
            Some(row) if !budget.is_zero() => {
                let commands = self.submitter.begin(row as u32)?;
                let report = self.fill(core, commands, frame, row, budget)?;
                self.submitter.submit(Some(commands), wait, signal)?;
                Ok(report)
            }
            row => {
                // The engine waits for what is signalled, whether there was work or not.
                self.submitter.submit(None, wait, signal)?;
                Ok(self.idle(core, frame, row.is_none()))
            }
        }
    }

    fn keep_to(&mut self, way: Way) -> Result<()> {
        if *self.way.get_or_insert(way) == way {
            return Ok(());
        }
        Err(Error::settings("a baker's frames are either all recorded or all submitted; this one began the other way"))
    }

    fn idle(&self, core: &Core, frame: FrameId, held_up: bool) -> FrameReport {
        let sampling = core.statistics.sampling;
        FrameReport { frame, held_up, sampling, sweeps: self.sweeps, ..FrameReport::default() }
    }

    /// One frame's work.
    fn fill(
        &mut self,
        core: &mut Core,
        commands: FrameCommands,
        frame: FrameId,
        row: usize,
        budget: Duration,
    ) -> Result<FrameReport> {
        let now_s = self.now_s();
        let gpu = core.gpu.clone();
        let mut recorder = Recorder::frame(&gpu, commands);
        self.begin_timing(&recorder, row);
        let overhead_s = if self.world.has_changed() { self.update_s } else { 0.0 };
        let frames = [frame, self.flight.completed];
        let (changes, ran) = self.world.record(&mut recorder, &mut core.scene, &mut core.push, frames)?;
        self.note(changes, now_s);
        self.mark(&recorder, row, 1);
        let needs = Needs {
            direct: self.direct_due,
            importance: self.aiming.is_due(),
            importance_after: self.aiming.is_due_after(self.sweeps + 1),
            publish: self.published.begin(self.flight.completed).is_some(),
        };
        let mut works = std::mem::take(&mut self.flight.row(row).works);
        works.clear();
        works.extend_from_slice(self.scheduler.plan(budget, needs, overhead_s));
        let mut report = FrameReport { frame, ran, ..FrameReport::default() };
        let mut first_use = [false; STAGES];
        let last = works.len().saturating_sub(1);
        for (index, work) in works.iter().enumerate() {
            report.predicted += Duration::from_secs_f64(self.scheduler.predicted(work));
            first_use[work.stage as usize] |= !std::mem::replace(&mut self.used[work.stage as usize], true);
            self.run(core, &mut recorder, work, now_s, &mut report);
            if index == last || index + 1 < TIMED {
                self.mark(&recorder, row, (index + 2).min(MARKS - 1));
            }
        }
        self.finish_report(core, &mut report, now_s);
        let row = self.flight.row(row);
        (row.frame, row.works, row.first_use) = (Some(frame), works, first_use);
        (row.updated, row.recorded_at) = (!changes.is_empty(), Instant::now());
        Ok(report)
    }

    /// What follows from a change.
    fn note(&mut self, changes: Changes, now_s: f64) {
        // The first frame changes everything.
        if changes.is_empty() && std::mem::replace(&mut self.begun, true) {
            return;
        }
        self.begun = true;
        self.settling.changed(now_s, self.sweeps);
        self.aiming.changed(self.sweeps, changes.contains(Changes::SKY));
        self.direct_due |= self.passes.direct.is_some() && changes.intersects(Changes::PLACING | Changes::LIGHTS);
    }

    /// One dispatch of the plan.
    fn run(&mut self, core: &mut Core, recorder: &mut Recorder<'_>, work: &Work, now_s: f64, report: &mut FrameReport) {
        match work.stage {
            Stage::Direct => {
                if work.items.start == 0 {
                    self.direct_due = false;
                }
                if let Some(direct) = &self.passes.direct {
                    direct.record(recorder, &core.push, texels_of(core, &work.items));
                }
                report.dispatches += 1;
                report.ran |= Ran::DIRECT;
            }
            Stage::Importance => {
                self.aiming.record(core, recorder, work, self.source, self.sweeps);
                report.dispatches += 1;
                report.ran |= Ran::IMPORTANCE;
            }
            Stage::Gather => self.gather(core, recorder, work, now_s, report),
            Stage::Publish => self.publish(core, recorder, work, report),
        }
    }

    /// Rays of some tiles, and the outgoing radiance that follows: for the next sweep, whatever is left of this one.
    fn gather(
        &mut self,
        core: &mut Core,
        recorder: &mut Recorder<'_>,
        work: &Work,
        now_s: f64,
        report: &mut FrameReport,
    ) {
        if work.items.start == 0 {
            self.first_sample = self.first_sample.wrapping_add(self.quanta * RAYS);
            self.quanta = work.quanta;
            self.aiming.begin_sweep(core, self.sweeps, RAYS);
        }
        let world = self.settling.world(now_s, self.sweeps);
        let push = self.aiming.push(Push { first_sample: self.first_sample, ..core.push }, RAYS);
        let mut first = work.items.start;
        let mut history = None;
        // Tiles that were last visited together weigh their history alike, and go in one dispatch.
        for item in work.items.clone() {
            let tile = &mut self.tiles[item as usize];
            let (average, world) = self.settling.of_tile(&self.average, tile.visited_s, tile.changes, world);
            let weight = tile.history.visit(&average, now_s - tile.visited_s, work.quanta, world) as f32;
            (tile.visited_s, tile.changes) = (now_s, self.settling.changes());
            if let Some(history) = history.replace(weight).filter(|history| *history != weight) {
                let texels = texels_of(core, &(first..item));
                let push = Push { history, ..push };
                self.passes.bake.record(recorder, &push, self.source, texels, 0..work.quanta);
                report.dispatches += 1;
                first = item;
            }
        }
        let texels = texels_of(core, &work.items);
        let push = Push { history: history.unwrap_or_default(), ..push };
        let last = texels_of(core, &(first..work.items.end));
        self.passes.bake.record(recorder, &push, self.source, last, 0..work.quanta);
        self.passes.source.record(recorder, &push, 1 - self.source, texels.clone());
        let quanta = u64::from(texels.end - texels.start) * u64::from(work.quanta);
        core.statistics.sampling.count(RAYS, [push.source_rays, push.sky_rays], quanta);
        report.rays += quanta * u64::from(RAYS);
        report.dispatches += 2;
        report.ran |= Ran::BAKE | Ran::SOURCE;
        if work.ends_stage {
            self.source = 1 - self.source;
            self.sweeps += 1;
            self.aiming.end_sweep(self.sweeps);
        }
    }

    fn publish(&mut self, core: &Core, recorder: &mut Recorder<'_>, work: &Work, report: &mut FrameReport) {
        let Some(map) = self.published.begin(self.flight.completed) else { return };
        let rows = work.items.start * SQUARE_GROUP..(work.items.end * SQUARE_GROUP).min(core.maps.size[1]);
        self.passes.publish.record(recorder, &core.push, map, rows);
        report.dispatches += 1;
        report.ran |= Ran::PUBLISH;
        if work.ends_stage {
            let recorded = self.way == Some(Way::Record);
            // What is submitted is made visible by its semaphores, and its queue may know no drawing.
            if recorded {
                recorder.publish();
            }
            self.published.finish(report.frame, self.sweeps, recorded);
        }
    }

    fn finish_report(&self, core: &mut Core, report: &mut FrameReport, now_s: f64) {
        let texels = u64::from(core.texels.count);
        report.samples_per_texel = report.rays as f64 / texels.max(1) as f64;
        report.sweeps = self.sweeps;
        report.decaying = self.settling.world(now_s, self.sweeps) == crate::temporal::World::Changing;
        report.one_unit = Duration::from_secs_f64(self.scheduler.unit_s());
        report.sampling = core.statistics.sampling;
        core.statistics.rays += report.rays;
        core.statistics.epochs = u32::try_from(self.sweeps).unwrap_or(u32::MAX);
        core.statistics.samples_per_texel += report.samples_per_texel;
    }

    /// The newest finished light map.
    pub(super) fn light_map(&self) -> Shown {
        self.published.current()
    }

    pub(super) fn set_learning(&mut self, learning: Learning) {
        if learning == Learning::Held {
            self.scheduler.calm();
        }
        self.learning = learning;
    }

    pub(super) fn set_time(&mut self, now: Duration) {
        let now_s = now.as_secs_f64();
        let elapsed_s = now_s - self.engine.told_s.replace(now_s).unwrap_or(now_s);
        self.engine.now_s += elapsed_s.max(0.0);
    }

    fn now_s(&self) -> f64 {
        match self.settings.clock {
            Clock::Wall => self.started.elapsed().as_secs_f64(),
            Clock::Engine => self.engine.now_s,
        }
    }

    pub(super) fn samples_per_texel(&self, core: &Core, budget: Duration) -> f64 {
        let texels = u64::from(core.texels.count);
        samples_per_texel(self.scheduler.rays_per_second(), budget.as_secs_f64(), texels)
    }
}

fn texels_of(core: &Core, tiles: &Range<u32>) -> Range<u32> {
    tiles.start * TILE..(tiles.end * TILE).min(core.texels.count)
}
