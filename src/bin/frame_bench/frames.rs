//! Runs one frame after the other.

use crate::arguments::{Arguments, Mode};
use crate::baking::Baking;
use crate::engine::{Commands, Device, Look, Raster, Timeline};
use crate::report::Setting;
use crate::row::{Case, Phase, Row};
use crate::world::World;
use lightoven::Result;
use lightoven::baker::FrameReport;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// The engine, the library in it, and the scene that both have.
pub(crate) struct Frames {
    // Dropped first: waits for the device.
    commands: Commands,
    timeline: Timeline,
    raster: Raster,
    baking: Baking,
    device: Rc<Device>,
    world: World,
    mode: Mode,
    picture: [u32; 2],
    /// Frames so far.
    count: u64,
}

impl Frames {
    pub(crate) fn new(device: Rc<Device>, world: World, arguments: &Arguments) -> Result<Self> {
        let picture = [arguments.width, arguments.height];
        let baking = Baking::new(&device, &world, arguments)?;
        Ok(Self {
            commands: Commands::new(&device)?,
            timeline: Timeline::new(&device)?,
            raster: Raster::new(&device, &world.scene, baking.atlas(), picture)?,
            baking,
            device,
            world,
            mode: arguments.mode,
            picture,
            count: 0,
        })
    }

    /// Runs a frame and waits for it.
    pub(crate) fn run(&mut self, phase: Phase, case: Case, budget: Duration) -> Result<Row> {
        self.baking.set_phase(phase)?;
        let pose = self.world.motion.at(self.count);
        self.count += 1;
        let [width, height] = self.picture;
        let look = self.world.look(&pose, width as f32 / height as f32);
        self.raster.place(self.world.mover, &pose.mover)?;

        let started = Instant::now();
        if case.bakes() {
            self.baking.place(&self.world, &pose)?;
        }
        let report = match self.mode {
            Mode::Record => self.run_recorded(case, budget, &look)?,
            Mode::Submit => self.run_submitted(case, budget, &look)?,
        };
        let frame = started.elapsed();

        let taken = report.as_ref().map(|report| self.baking.complete(report)).transpose()?;
        let report = report.unwrap_or_default();
        Ok(Row {
            phase,
            budget,
            case,
            frame_ms: ms(frame),
            raster_ms: if case.draws() { self.raster.time().map(ms) } else { None },
            bake_ms: taken.map(|taken| ms(taken.bake)),
            predicted_ms: ms(report.predicted),
            one_unit_ms: ms(report.one_unit),
            rays: report.rays,
            samples_per_texel: report.samples_per_texel,
            ran: report.ran.names().collect::<Vec<_>>().join(", "),
            first_use: taken.is_some_and(|taken| taken.first_use),
        })
    }

    /// The bake in the frame's own commands, before what draws with the light map.
    fn run_recorded(&mut self, case: Case, budget: Duration, look: &Look) -> Result<Option<FrameReport>> {
        self.commands.begin()?;
        let given = if case.bakes() { Some(self.baking.record(&self.commands, budget)?) } else { None };
        if case.draws() {
            self.raster.draw(&self.commands, look, self.baking.light_map())?;
        }
        self.commands.submit(None)?;
        self.commands.wait()?;
        Ok(given)
    }

    /// The bake submitted first; raster does not wait for it and draws with the light map that was finished last.
    fn run_submitted(&mut self, case: Case, budget: Duration, look: &Look) -> Result<Option<FrameReport>> {
        let given = if case.bakes() { Some(self.baking.submit(&mut self.timeline, budget)?) } else { None };
        if case.draws() {
            self.commands.begin()?;
            self.raster.draw(&self.commands, look, self.baking.light_map())?;
            self.commands.submit(Some(&self.timeline))?;
            self.commands.wait()?;
        }
        if case.bakes() {
            self.timeline.wait()?;
        }
        Ok(given)
    }

    /// The picture that was drawn last: its size and its pixels as [`Raster::screenshot`] has them.
    pub(crate) fn screenshot(&mut self) -> Result<([u32; 2], Vec<u8>)> {
        Ok((self.picture, self.raster.screenshot(&self.device, &mut self.commands)?))
    }

    /// What the frames run on.
    pub(crate) fn setting(&self) -> Setting {
        self.baking.setting()
    }

    /// What the validation layers have said.
    pub(crate) fn validation_messages(&self) -> Vec<String> {
        self.device.validation_messages()
    }
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
