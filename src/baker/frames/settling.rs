//! How long old light leaves after a change. Pure.

use crate::temporal::World;

/// What is left of old light when the running average may become a plain mean again.
const LEFT: f64 = 1e-3;
/// Sweeps that a bounce chain is waited for, at most: an albedo of .993.
const MOST_SWEEPS: f64 = 1000.0;

/// Since when the scene has been still.
#[derive(Debug, Clone)]
pub(super) struct Settling {
    /// Time from a change until what it replaced has left the average.
    horizon_s: f64,
    /// Sweeps from a change until what it replaced has left the bounces.
    sweeps: u64,
    still_from_s: f64,
    still_from_sweep: u64,
}

impl Settling {
    /// `max_albedo`: of all texels; each bounce takes a sweep.
    pub(super) fn new(latency_s: f64, threshold: f64, max_albedo: f64) -> Self {
        let sweeps = if max_albedo > 0.0 { (LEFT.ln() / max_albedo.ln()).clamp(1.0, MOST_SWEEPS) } else { 1.0 };
        // Light that never leaves is not waited for.
        let horizon_s = latency_s * LEFT.ln() / threshold.ln();
        let horizon_s = if horizon_s.is_finite() { horizon_s } else { 0.0 };
        Self { horizon_s, sweeps: sweeps.ceil() as u64, still_from_s: 0.0, still_from_sweep: 0 }
    }

    /// Something has changed.
    pub(super) fn changed(&mut self, now_s: f64, sweep: u64) {
        self.still_from_s = now_s + self.horizon_s;
        self.still_from_sweep = sweep + self.sweeps;
    }

    pub(super) fn world(&self, now_s: f64, sweep: u64) -> World {
        if now_s < self.still_from_s || sweep < self.still_from_sweep { World::Changing } else { World::Still }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_world_is_still_when_old_light_and_its_bounces_are_gone() {
        let mut settling = Settling::new(0.5, 0.1, 0.8);
        settling.changed(10.0, 100);
        // Three latencies leave .1^3; 31 bounces .8^31.
        assert_eq!(settling.world(11.4, 200), World::Changing);
        assert_eq!(settling.world(12.0, 130), World::Changing);
        assert_eq!(settling.world(11.6, 131), World::Still);
        let mut never = Settling::new(f64::INFINITY, 0.1, 0.0);
        never.changed(1.0, 0);
        assert_eq!(never.world(1.0, 1), World::Still);
    }
}
