//! What every plan keeps to, whatever comes in.

use super::super::frame::{FrameScheduler, TILE};
use super::super::simulated::{Device, extent};
use super::super::work::{Extent, Needs, STAGES, Stage, Work};
use super::ALL;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::ops::Range;
use std::time::Duration;

/// The same cases in every run.
fn fixed(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(11), ..ProptestConfig::default() }
}

/// Follows the cycle and checks every rule that a single plan can break.
struct Checker {
    extent: Extent,
    stage: Stage,
    next: u32,
    quanta: u32,
    /// Work of each stage in the last frames that had any.
    last: [[u64; 2]; STAGES],
    ended: [u32; STAGES],
}

impl Checker {
    fn new(extent: Extent) -> Self {
        Self { extent, stage: Stage::Direct, next: 0, quanta: 0, last: [[0; 2]; STAGES], ended: [0; STAGES] }
    }

    fn plan(&mut self, works: &[Work], needs: Needs) -> Result<(), TestCaseError> {
        let mut items = [const { Vec::new() }; STAGES];
        let (mut done, mut first) = ([0; STAGES], [0; STAGES]);
        for work in works {
            self.work(work, needs)?;
            let index = work.stage as usize;
            if items[index].is_empty() {
                first[index] = self.size(work, work.items.start..work.items.start + 1);
            }
            items[index].extend(work.items.clone());
            done[index] += self.size(work, work.items.clone());
        }
        for (index, mut items) in items.into_iter().enumerate() {
            let count = items.len();
            items.sort_unstable();
            items.dedup();
            prop_assert_eq!(items.len(), count, "an item twice in a plan");
            let reach = (2 * self.last[index][0].max(self.last[index][1])).max(first[index]);
            prop_assert!(done[index] <= reach, "{} of {}", done[index], reach);
            if count > 0 {
                self.last[index] = [done[index], self.last[index][0]];
            }
        }
        Ok(())
    }

    /// Texels or blocks, times quanta.
    fn size(&self, work: &Work, items: Range<u32>) -> u64 {
        let texels = |item| match work.stage {
            Stage::Importance | Stage::Publish => 1,
            _ => u64::from(TILE.min(self.extent.texels - item * TILE)),
        };
        items.map(|item| texels(item) * u64::from(work.quanta)).sum()
    }

    fn work(&mut self, work: &Work, needs: Needs) -> Result<(), TestCaseError> {
        prop_assert!(!work.items.is_empty());
        if self.next == 0 {
            let order = [Stage::Direct, Stage::Importance, Stage::Gather, Stage::Publish];
            let skipped = order.iter().cycle().skip(self.stage as usize).take_while(|stage| **stage != work.stage);
            // Gathering is never left out; what was begun at 0 was asked for.
            prop_assert!(!skipped.clone().any(|stage| *stage == Stage::Gather));
            prop_assert!(work.stage != Stage::Direct || needs.direct);
            prop_assert!(work.stage != Stage::Importance || needs.importance);
            prop_assert!(work.stage != Stage::Publish || needs.publish);
            (self.stage, self.quanta) = (work.stage, work.quanta);
        }
        prop_assert_eq!((work.stage, work.items.start, work.quanta), (self.stage, self.next, self.quanta));
        prop_assert!(work.items.end <= self.extent.items(work.stage));
        prop_assert_eq!(work.ends_stage, work.items.end == self.extent.items(work.stage));
        self.next = work.items.end;
        if work.ends_stage {
            self.next = 0;
            self.ended[work.stage as usize] += 1;
            self.stage = [Stage::Importance, Stage::Gather, Stage::Publish, Stage::Direct][work.stage as usize];
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(fixed(64))]

    #[test]
    fn every_plan_keeps_the_rules(
        tiles in 1_u32..200, rate in 5.5_f64..9.0, seed in any::<u64>(), late in 0_usize..3, timestamps in any::<bool>(),
        frames in prop::collection::vec((-6.0_f64..1.0, any::<[bool; 3]>(), 0.5_f64..3.0), 1..200),
        fixed_quanta in prop::option::of(1_u32..9),
    ) {
        let extent = Extent { fixed_quanta, ..extent(tiles) };
        let mut device = Device { random: seed, late, timestamps, ..Device::new(extent, 10_f64.powf(rate)) };
        let mut scheduler = FrameScheduler::new(extent);
        let mut checker = Checker::new(extent);
        for (budget, [direct, importance, publish], slowdown) in frames {
            let (budget_s, needs) = (10_f64.powf(budget), Needs { direct, importance, importance_after: importance, publish });
            device.slowdown = slowdown;
            let works = scheduler.clone().plan(Duration::from_secs_f64(budget_s), needs, 0.0).to_vec();
            for work in works.iter().filter(|work| work.items.len() > 1) {
                prop_assert!(scheduler.predicted(work) <= 1.000_001 * 4e-3_f64.min((budget_s + 1e-9) / 2.0));
            }
            checker.plan(&works, needs)?;
            prop_assert_eq!(device.frame(&mut scheduler, budget_s, needs).works, works);
        }
    }

    /// Also where no budget is enough, and where direct light is always out of date.
    #[test]
    fn nothing_starves(tiles in 1_u32..6, rate in 4.0_f64..9.0, budget in -9.0_f64..1.0, overhead_s in 0.0_f64..0.1) {
        let extent = extent(tiles);
        let mut device = Device::new(extent, 10_f64.powf(rate));
        let mut scheduler = FrameScheduler::new(extent);
        let mut checker = Checker::new(extent);
        for frame in 0..2 * 64 * (2 * tiles + extent.importance_parts + extent.block_rows) {
            let overhead_s = if frame % 2 == 0 { overhead_s } else { 0.0 };
            let works = scheduler.plan(Duration::from_secs_f64(10_f64.powf(budget)), ALL, overhead_s).to_vec();
            checker.plan(&works, ALL)?;
            for work in &works {
                let seconds = device.noisy(device.item_s(work, work.items.start) * work.items.len() as f64);
                scheduler.measured(work, seconds, false);
            }
        }
        prop_assert!(checker.ended.iter().all(|ended| *ended >= 2), "{:?}", checker.ended);
    }

    /// Clocks that lie and break, and any budgets: the rules hold, something is done in any 64 frames with a budget, and no
    /// plan is predicted to be longer than its budget by more than the item that was saved for, and the one that was due.
    #[test]
    fn hostile_clocks_stop_nothing(
        tiles in 0_u32..12, fixed_quanta in prop::option::of(1_u32..9),
        frames in prop::collection::vec((budget(), any::<[bool; 3]>(), seconds(), any::<[Clock; 4]>()), 64..300),
    ) {
        let extent = Extent { fixed_quanta, ..extent(tiles) };
        let device = Device::new(extent, 100e6);
        let mut scheduler = FrameScheduler::new(extent);
        let mut checker = Checker::new(extent);
        let (mut idle, mut saved_s, mut quanta) = (0, 0.0, fixed_quanta.unwrap_or(1));
        for (budget, [direct, importance, publish], overhead_s, clocks) in frames {
            let needs = Needs { direct, importance, importance_after: importance, publish };
            let before = scheduler.clone();
            let works = scheduler.plan(budget, needs, overhead_s).to_vec();
            checker.plan(&works, needs)?;
            idle = if works.is_empty() && !budget.is_zero() && tiles > 0 { idle + 1 } else { 0 };
            prop_assert!(idle < 64, "{idle} frames without work");
            let after_first_s: f64 = works.iter().skip(1).map(|work| before.predicted(work)).sum();
            prop_assert!(after_first_s <= 1.000_001 * (budget.as_secs_f64() + saved_s), "{after_first_s} s in {budget:?}");
            if budget.is_zero() {
                prop_assert!(works.is_empty());
            } else {
                let swept = works.iter().rfind(|work| work.stage == Stage::Gather);
                quanta = swept.map_or(quanta, |work| work.quanta);
                saved_s = longest_item_s(&before, extent, quanta).max(budget.as_secs_f64().min(4e-3));
            }
            for (work, clock) in works.iter().zip(clocks.iter().cycle()) {
                clock.measure(&device, &mut scheduler, work);
            }
            prop_assert!(scheduler.rays_per_second() > 0.0 && scheduler.rays_per_second().is_finite());
        }
    }

    /// Whatever a clock has said, honest times bring everything back: soon the budget is kept and used again.
    #[test]
    fn honest_clocks_are_believed_again(
        clocks in prop::collection::vec(any::<Clock>(), 1..40), whole_frames in any::<bool>(), fresh in any::<bool>(),
    ) {
        let budget_s = 4e-3;
        let mut device = Device { noise: 0.02, ..Device::new(extent(150), 20e6) };
        let mut scheduler = FrameScheduler::new(device.extent);
        if !fresh {
            (0..100).for_each(|_| drop(device.frame(&mut scheduler, budget_s, ALL)));
        }
        for clock in clocks {
            let works = scheduler.plan(Duration::from_secs_f64(budget_s), ALL, 0.0).to_vec();
            if whole_frames {
                scheduler.measured_frame(&works, clock.seconds(works.len() as f64 * 1e-3));
            } else {
                works.iter().for_each(|work| clock.measure(&device, &mut scheduler, work));
            }
        }
        let mut used: Vec<_> =
            (0..700).map(|_| device.frame(&mut scheduler, budget_s, ALL).seconds / budget_s).collect();
        let used = used.split_off(600);
        let mean = used.iter().sum::<f64>() / 100.0;
        prop_assert!((0.7..1.05).contains(&mean), "{mean} of the budget is used");
        prop_assert!(used.iter().all(|used| *used < 1.5), "{used:?}");
    }
}

/// What a device says that a dispatch took.
#[derive(Debug, Clone, Copy)]
enum Clock {
    /// The truth.
    Honest,
    /// So many times the truth.
    Off(f64),
    /// This, whatever it was.
    Says(f64),
    /// Nothing: the timestamp is lost.
    Lost,
}

impl Arbitrary for Clock {
    type Parameters = ();
    type Strategy = BoxedStrategy<Self>;

    fn arbitrary_with((): ()) -> Self::Strategy {
        prop_oneof![
            4 => Just(Self::Honest),
            2 => prop_oneof![Just(10.0), Just(0.1), Just(1000.0), 0.2..5.0].prop_map(Self::Off),
            2 => seconds().prop_map(Self::Says),
            1 => Just(Self::Lost),
        ]
        .boxed()
    }
}

impl Clock {
    /// What it makes of the true time.
    fn seconds(self, exact_s: f64) -> f64 {
        match self {
            Self::Honest => exact_s,
            Self::Off(factor) => factor * exact_s,
            Self::Says(seconds) => seconds,
            Self::Lost => f64::NAN,
        }
    }

    fn measure(self, device: &Device, scheduler: &mut FrameScheduler, work: &Work) {
        let exact_s = device.fixed_s + work.items.clone().map(|item| device.item_s(work, item)).sum::<f64>();
        if !matches!(self, Self::Lost) {
            scheduler.measured(work, self.seconds(exact_s), false);
        }
    }
}

/// Times that are none, and any others.
fn seconds() -> impl Strategy<Value = f64> {
    let broken =
        [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 5e-324, 1e-9, 1e-3, 10.0, 3600.0, 1e6];
    prop_oneof![3 => prop::sample::select(broken.to_vec()), 1 => any::<u64>().prop_map(f64::from_bits)]
}

fn budget() -> impl Strategy<Value = Duration> {
    prop_oneof![
        1 => Just(Duration::ZERO),
        1 => Just(Duration::from_nanos(1)),
        1 => Just(Duration::MAX),
        8 => (-6.0_f64..0.0).prop_map(|exponent| Duration::from_secs_f64(10_f64.powf(exponent))),
    ]
}

/// The longest that is predicted of any single item.
fn longest_item_s(scheduler: &FrameScheduler, extent: Extent, quanta: u32) -> f64 {
    let of = |stage: Stage, quanta: u32| {
        let items = 0..extent.items(stage);
        let one = move |item| Work { stage, items: item..item + 1, quanta, ends_stage: false };
        items.map(|item| scheduler.predicted(&one(item))).fold(0.0, f64::max)
    };
    let stages = [Stage::Direct, Stage::Importance, Stage::Publish].map(|stage| of(stage, 1));
    stages.into_iter().chain([1, quanta].map(|quanta| of(Stage::Gather, quanta))).fold(0.0, f64::max)
}
