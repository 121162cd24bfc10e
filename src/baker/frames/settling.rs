//! How long old light leaves after a change. Pure.

use crate::temporal::{Average, World};

/// What is left of old light when the running average becomes a plain mean: below what 32 bits tell of the new, even where
/// it was a hundred times as strong.
const LEFT: f64 = 1e-9;
/// Sweeps that a chain of bounces is waited for, at most: an albedo of .98.
const MOST_SWEEPS: f64 = 1000.0;

/// Since when the scene has been still.
#[derive(Debug, Clone)]
pub(super) struct Settling {
    /// Time from a change until what it replaced has left the average.
    horizon_s: f64,
    /// Sweeps from a change until what it replaced has left the bounces.
    sweeps: u64,
    changed_at_s: f64,
    changed_at_sweep: u64,
    changes: u64,
}

impl Settling {
    /// `max_albedo`: of all texels; each bounce takes a sweep.
    pub(super) fn new(average: &Average, max_albedo: f64) -> Self {
        let sweeps = if max_albedo > 0.0 { (LEFT.ln() / max_albedo.ln()).clamp(1.0, MOST_SWEEPS) } else { 1.0 };
        let sweeps = sweeps.ceil() as u64;
        Self { horizon_s: average.age_of(LEFT), sweeps, changed_at_s: 0.0, changed_at_sweep: 0, changes: 0 }
    }

    /// For other albedos and latencies, with what has been.
    pub(super) fn after(self, before: &Self) -> Self {
        Self { horizon_s: self.horizon_s, sweeps: self.sweeps, ..before.clone() }
    }

    /// Something has changed.
    pub(super) fn changed(&mut self, now_s: f64, sweep: u64) {
        (self.changed_at_s, self.changed_at_sweep) = (now_s, sweep);
        self.changes += 1;
    }

    /// How often something has changed.
    pub(super) fn changes(&self) -> u64 {
        self.changes
    }

    /// What holds for a tile that was last visited at a time, when so much had changed. A tile that has not been visited
    /// since the last change holds old light alone, however long ago that was.
    pub(super) fn of_tile(&self, average: &Average, visited_s: f64, changes: u64, world: World) -> (Average, World) {
        if changes == self.changes {
            (average.after(visited_s - self.changed_at_s), world)
        } else {
            (*average, World::Changing)
        }
    }

    pub(super) fn world(&self, now_s: f64, sweep: u64) -> World {
        let leaving = now_s - self.changed_at_s < self.horizon_s || sweep < self.changed_at_sweep + self.sweeps;
        if leaving { World::Changing } else { World::Still }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_world_is_still_when_old_light_and_its_bounces_are_gone() {
        let average = |latency| Average::new(latency, 0.1).expect("is allowed");
        let mut settling = Settling::new(&average(Duration::from_millis(500)), 0.8);
        settling.changed(10.0, 100);
        // A billionth is left after 33 s; .8^93.
        assert_eq!(settling.world(42.0, 300), World::Changing);
        assert_eq!(settling.world(45.0, 192), World::Changing);
        assert_eq!(settling.world(45.0, 193), World::Still);
        // A tile that has been visited since, and one that has not.
        let base = average(Duration::from_millis(500));
        assert_eq!(settling.of_tile(&base, 14.0, 1, World::Still), (base.after(4.0), World::Still));
        assert_eq!(settling.of_tile(&base, 9.0, 0, World::Still), (base, World::Changing));
        let mut never = Settling::new(&average(Duration::MAX), 0.0);
        never.changed(1.0, 0);
        assert_eq!(never.world(1.0, 1), World::Still);
    }
}
