//! Plans what a frame does of an endless cycle: direct light and what rays are aimed by where they are out of
//! date, a sweep of gathering over all tiles, a map published, and again. A stage goes on where the last plan stopped.
//!
//! Predictions are fed forward, so that measurements that come frames late do not make the plans swing.

use super::cost::Cost;
use super::tile_cost::TileCosts;
use super::work::{Extent, Needs, STAGES, Stage, Work};
use std::time::Duration;

/// Texels of the list in a tile, which is the least that is dispatched; the last tile may have fewer.
pub(crate) const TILE: u32 = 256;
/// Rays that a texel traces in a quantum.
const RAYS: f64 = 16.0;
/// Share of the budget that is planned for. Simulated with 10 % of noise a dispatch and 10 % a measurement: the 95th
/// percentile of the frames is 1.03 of the budget and one item at most, and at least .81 of the budget is used.
const TARGET: f64 = 0.9;
/// No dispatch is predicted to be longer, nor longer than half the budget: the engine's own work waits behind it.
const MOST_DISPATCH_S: f64 = 4e-3;
/// Quanta of a visit: at 1,024 rays an invocation, loops stay far below what older drivers cut.
const MOST_QUANTA: f64 = 64.0;
/// After so many frames whose budget is too small there is an item nevertheless.
const MOST_WAIT: u32 = 64;
/// A frame's work of a stage is at most this many times that of the last frames.
const GROWTH: f64 = 2.0;
/// Sweeps of one quantum in a frame's time from which on whole sweeps fill it well enough: of fewer a tenth is lost.
const IN_STEP: f64 = 12.0;
/// Share of the time that whole sweeps may be expected to take: one that does not fit leaves the next frame a rest.
const STEP_SLACK: f64 = 0.95;
/// Gathering gets at least this share of a cycle when its quanta are chosen.
const LEAST_GATHER: f64 = 0.5;
/// Dispatches of a plan for which there is memory from the start.
const USUAL_WORKS: usize = 64;
/// A cautious guess before anything is measured: 1 Mray/s, and a texel published in the time of a ray.
const GUESS_S: f64 = 1e-6;

#[derive(Debug, Clone)]
struct StageState {
    cost: Cost,
    /// Work of the last two frames that had any; of two, for a stage often ends with a small rest.
    last: [f64; 2],
}

impl StageState {
    fn new(unit: f64) -> Self {
        Self { cost: Cost::new(unit, GUESS_S), last: [0.0; 2] }
    }

    /// Work that a frame may have.
    fn reach(&self) -> f64 {
        GROWTH * self.last[0].max(self.last[1])
    }
}

/// Whole sweeps with which a frame that has time for many is filled: each frame then shows what it has gathered itself.
/// `None`: sweeps go on over the frames' borders, and a map may be a frame old.
fn in_step(sweeps: f64) -> Option<f64> {
    (sweeps >= IN_STEP).then_some((STEP_SLACK * sweeps).floor())
}

/// What the plan that is being made holds, by stage.
#[derive(Debug, Default)]
struct Round {
    begun: [bool; STAGES],
    items: [u32; STAGES],
    work: [f64; STAGES],
    /// A sweep has ended.
    ended_sweep: bool,
}

/// Plans frames. Memory is kept from plan to plan.
#[derive(Debug, Clone)]
pub(crate) struct FrameScheduler {
    extent: Extent,
    tiles: TileCosts,
    stages: [StageState; STAGES],
    stage: Stage,
    /// The stage's next item; 0: whether it is done at all is still open.
    next: u32,
    quanta: u32,
    /// Time that earlier frames left, less than an item takes.
    credit_s: f64,
    waited_frames: u32,
    /// The last plan began with a sweep instead of a map.
    publish_put_off: bool,
    /// A map without texels has been published.
    empty_published: bool,
    works: Vec<Work>,
    /// Predictions of a frame's dispatches while its time is divided.
    shares_s: Vec<f64>,
}

impl FrameScheduler {
    pub(crate) fn new(extent: Extent) -> Self {
        let tile = f64::from(TILE);
        let row_units = [extent.texels_per_importance_part, extent.texels_per_block_row].map(f64::from);
        let units = [tile * f64::from(extent.lights.max(1)), row_units[0], tile * RAYS, row_units[1]];
        Self {
            extent,
            tiles: TileCosts::new(extent.texels),
            stages: units.map(StageState::new),
            stage: Stage::Direct,
            next: 0,
            quanta: 1,
            credit_s: 0.0,
            waited_frames: 0,
            publish_put_off: false,
            empty_published: false,
            works: Vec::with_capacity(USUAL_WORKS),
            shares_s: Vec::with_capacity(USUAL_WORKS),
        }
    }

    /// What the next frame does, in order. `overhead_s`: what the frame takes beside its dispatches.
    pub(crate) fn plan(&mut self, budget: Duration, needs: Needs, overhead_s: f64) -> &[Work] {
        self.works.clear();
        if budget.is_zero() {
            return &self.works;
        }
        let budget_s = budget.as_secs_f64();
        let target_s = (TARGET * budget_s - overhead_s.max(0.0)).max(0.0);
        let most_s = MOST_DISPATCH_S.min(0.5 * budget_s);
        self.credit_s += target_s;
        let mut round = Round::default();
        self.fall_in_step(target_s, most_s, needs);
        let goes_on = loop {
            if !self.enter(needs, &round) {
                break false;
            }
            if self.stage == Stage::Gather && self.next == 0 {
                let sweeps = self.sweeps_of_a_frame(target_s, most_s, needs);
                // A sweep has ended in this plan: the next one waits for the next frame, if it then fits into that.
                if round.items[Stage::Gather as usize] > 0 && in_step(sweeps).is_some() {
                    break false;
                }
                self.quanta = self.choose_quanta(sweeps, most_s);
            }
            let Some(work) = self.cut(most_s, &round) else { break true };
            self.take(work, &mut round);
        };
        self.end_plan(goes_on, &round);
        &self.works
    }

    /// A map that would be published before a sweep which this frame has time for is published after it. Once only: where
    /// the sweep takes longer after all, the map comes first.
    fn fall_in_step(&mut self, target_s: f64, most_s: f64, needs: Needs) {
        let late = self.stage == Stage::Publish && self.next == 0;
        let skip = late && !self.publish_put_off && in_step(self.sweeps_of_a_frame(target_s, most_s, needs)).is_some();
        if skip {
            self.leave();
        }
        self.publish_put_off = skip;
    }

    /// Goes on to the next stage that has work. False: the plan has been once around, or there is nothing to do.
    fn enter(&mut self, needs: Needs, round: &Round) -> bool {
        let swept = round.items[Stage::Gather as usize] >= self.extent.tiles();
        for _ in 0..=STAGES {
            let (stage, index) = (self.stage, self.stage as usize);
            let wanted = match stage {
                Stage::Direct => needs.direct && !round.begun[index],
                Stage::Importance => {
                    let due = if round.ended_sweep { needs.importance_after } else { needs.importance };
                    due && !round.begun[index] && self.extent.texels > 0
                }
                Stage::Gather => true,
                Stage::Publish => needs.publish && !self.empty_published,
            };
            let over = match stage {
                // The next plan decides about these, by what its frame needs.
                Stage::Direct | Stage::Importance => {
                    swept && self.extent.texels > 0 || wanted && round.items[index] > 0
                }
                Stage::Gather => swept && self.extent.texels > 0,
                Stage::Publish => wanted && round.items[index] > 0,
            };
            if self.next > 0 {
                return !(stage == Stage::Gather && over);
            } else if over {
                return false;
            } else if wanted && self.extent.items(stage) > 0 {
                return true;
            }
            self.leave();
        }
        false
    }

    fn leave(&mut self) {
        self.next = 0;
        self.stage = match self.stage {
            Stage::Direct => Stage::Importance,
            Stage::Importance => Stage::Gather,
            Stage::Gather => Stage::Publish,
            Stage::Publish => Stage::Direct,
        };
    }

    /// Sweeps of one quantum, or as many as are wanted, that a frame has time for beside the other stages.
    fn sweeps_of_a_frame(&self, target_s: f64, most_s: f64, needs: Needs) -> f64 {
        let direct_s = if needs.direct { self.stage_s(Stage::Direct, most_s) } else { 0.0 };
        let importance_s = if needs.importance { self.stage_s(Stage::Importance, most_s) } else { 0.0 };
        let publish_s = if needs.publish { self.stage_s(Stage::Publish, most_s) } else { 0.0 };
        let available_s = (target_s - direct_s - importance_s - publish_s).max(LEAST_GATHER * target_s);
        let cost = &self.stages[Stage::Gather as usize].cost;
        let sweep_s = RAYS * f64::from(self.extent.texels) * cost.per_work_s();
        let quanta = f64::from(self.extent.fixed_quanta.unwrap_or(1));
        (available_s - (available_s / most_s).ceil() * cost.fixed_s()).max(0.0) / (sweep_s * quanta)
    }

    /// Quanta with which a sweep fills a frame.
    fn choose_quanta(&self, sweeps: f64, most_s: f64) -> u32 {
        if let Some(quanta) = self.extent.fixed_quanta {
            return quanta.max(1);
        }
        let whole = in_step(sweeps);
        let wanted = whole.unwrap_or(sweeps.ceil());
        let gather = &self.stages[Stage::Gather as usize];
        let (fixed_s, per_work_s) = (gather.cost.fixed_s(), gather.cost.per_work_s());
        // A tile is not cut: it has to fit into a dispatch, and into what a frame may grow to.
        let tile_work = RAYS * f64::from(self.tiles.texels(0));
        let fitting = ((most_s - fixed_s) / (tile_work * self.tiles.largest() * per_work_s)).floor();
        // Whole sweeps stay whole while they grow again after a spike.
        let least_work = if whole.is_some() { RAYS * f64::from(self.extent.texels) } else { tile_work };
        let reached = (gather.reach() / least_work).floor();
        wanted.min(fitting).min(reached).clamp(1.0, MOST_QUANTA) as u32
    }

    /// Predicted seconds of a whole stage, at one quantum.
    fn stage_s(&self, stage: Stage, most_s: f64) -> f64 {
        let cost = &self.stages[stage as usize].cost;
        let work = match stage {
            Stage::Importance | Stage::Publish => f64::from(self.extent.items(stage)) * self.work(stage, 0, 1),
            Stage::Direct => f64::from(self.extent.texels) * f64::from(self.extent.lights.max(1)),
            Stage::Gather => f64::from(self.extent.texels) * RAYS,
        };
        let work_s = work * cost.per_work_s();
        work_s + (work_s / most_s).ceil() * cost.fixed_s()
    }

    /// The next dispatch: as many items as fit; `None`: not one does.
    fn cut(&self, most_s: f64, round: &Round) -> Option<Work> {
        let (stage, index) = (self.stage, self.stage as usize);
        let state = &self.stages[index];
        let quanta = if stage == Stage::Gather { self.quanta } else { 1 };
        let count = self.extent.items(stage);
        let end = match stage {
            Stage::Importance | Stage::Publish => count,
            // No tile twice in a plan.
            _ => count.min(self.next + (count - round.items[index].min(count))),
        };
        let forced = self.works.is_empty() && self.waited_frames + 1 >= MOST_WAIT;
        let (mut stop, mut work, mut weighted) = (self.next, 0.0, 0.0);
        while stop < end {
            work += self.work(stage, stop, quanta);
            weighted += self.weighted(stage, stop, quanta);
            let took_s = state.cost.predicted(weighted);
            let first = stop == self.next;
            let in_time = took_s <= self.credit_s && (first || took_s <= most_s);
            let in_reach = round.work[index] + work <= state.reach() || first && round.items[index] == 0;
            if !(in_time && in_reach || first && forced) {
                break;
            }
            stop += 1;
        }
        (stop > self.next).then_some(Work { stage, items: self.next..stop, quanta, ends_stage: stop == count })
    }

    fn take(&mut self, work: Work, round: &mut Round) {
        let index = work.stage as usize;
        self.credit_s = (self.credit_s - self.predicted(&work)).max(0.0);
        round.begun[index] |= work.items.start == 0;
        round.items[index] += work.items.len() as u32;
        round.work[index] += work.items.clone().map(|item| self.work(work.stage, item, work.quanta)).sum::<f64>();
        self.next = work.items.end;
        if work.ends_stage {
            round.ended_sweep |= work.stage == Stage::Gather;
            self.empty_published |= work.stage == Stage::Publish && self.extent.texels == 0;
            self.leave();
        }
        self.works.push(work);
    }

    /// `goes_on`: there was more to do, but no time for it.
    fn end_plan(&mut self, goes_on: bool, round: &Round) {
        for (state, work) in self.stages.iter_mut().zip(round.work) {
            if work > 0.0 {
                state.last = [work, state.last[0]];
            }
        }
        self.waited_frames = if goes_on && self.works.is_empty() { self.waited_frames + 1 } else { 0 };
        // What is saved makes one item more at most: a frame without work must not make a later one long.
        let quanta = if self.stage == Stage::Gather { self.quanta } else { 1 };
        let item_s = self.stages[self.stage as usize].cost.predicted(self.weighted(self.stage, self.next, quanta));
        self.credit_s = if goes_on { self.credit_s.min(item_s) } else { 0.0 };
    }

    /// Rays or texels of an item.
    fn work(&self, stage: Stage, item: u32, quanta: u32) -> f64 {
        let texels = f64::from(self.tiles.texels(item));
        match stage {
            Stage::Direct => texels * f64::from(self.extent.lights.max(1)),
            Stage::Gather => texels * RAYS * f64::from(quanta),
            Stage::Importance => f64::from(self.extent.texels_per_importance_part.max(1)),
            Stage::Publish => f64::from(self.extent.texels_per_block_row.max(1)),
        }
    }

    /// An item's work by which its time is predicted.
    fn weighted(&self, stage: Stage, item: u32, quanta: u32) -> f64 {
        match stage {
            Stage::Gather => self.tiles.weighted(item) * RAYS * f64::from(quanta),
            _ => self.work(stage, item, quanta),
        }
    }

    fn weighted_work(&self, work: &Work) -> f64 {
        work.items.clone().map(|item| self.weighted(work.stage, item, work.quanta)).sum()
    }

    /// Seconds that a dispatch will take.
    pub(crate) fn predicted(&self, work: &Work) -> f64 {
        self.stages[work.stage as usize].cost.predicted(self.weighted_work(work))
    }

    /// Seconds that one item of gathering, one quantum each, takes on average: the least that is dispatched.
    pub(crate) fn unit_s(&self) -> f64 {
        self.stages[Stage::Gather as usize].cost.predicted(f64::from(TILE) * RAYS)
    }

    /// Forgets present spikes: for plans that are to stay as they are.
    pub(crate) fn calm(&mut self) {
        self.stages.iter_mut().for_each(|stage| stage.cost.calm());
    }

    /// What a dispatch took. The first use of a pipeline is ignored: it may hold the compilation.
    pub(crate) fn measured(&mut self, work: &Work, seconds: f64, first_use: bool) {
        if first_use {
            return;
        }
        let weighted = self.weighted_work(work);
        let cost = &mut self.stages[work.stage as usize].cost;
        if work.stage == Stage::Gather {
            self.tiles.measured(work.items.clone(), work.quanta, cost.work_s(seconds));
        }
        cost.measured(weighted, seconds);
        if work.stage == Stage::Gather && work.ends_stage {
            cost.rescale(self.tiles.end_sweep());
        }
    }

    /// What a whole frame took where its dispatches have no times of their own: divided as predicted.
    pub(crate) fn measured_frame(&mut self, works: &[Work], seconds: f64) {
        let mut shares_s = std::mem::take(&mut self.shares_s);
        shares_s.clear();
        shares_s.extend(works.iter().map(|work| self.predicted(work)));
        let total_s: f64 = shares_s.iter().sum();
        for (work, share_s) in works.iter().zip(&shares_s) {
            self.measured(work, seconds * share_s / total_s, false);
        }
        self.shares_s = shares_s;
    }

    /// Rays a second of gathering, as far as is known.
    pub(crate) fn rays_per_second(&self) -> f64 {
        1.0 / self.stages[Stage::Gather as usize].cost.per_work_s()
    }
}

/// Samples that each texel gets in a pass. The talk's own figures: 262 Mray/s for 32 ms are 32 at 512 x 512 texels.
pub(crate) fn samples_per_texel(rays_per_s: f64, time_s: f64, texels: u64) -> f64 {
    let samples = rays_per_s * time_s / texels as f64;
    if samples.is_finite() { samples.max(0.0) } else { 0.0 }
}
