//! How fast old light leaves a light map while the world changes. Pure: elapsed times go in, weights come out.
//!
//! Host side in f64: in f32, `1 - decay` is off by 8e-4 at a latency of 60 s and 1,000 frames a second.

use crate::error::{Error, Result};
use std::time::Duration;

/// How fast old light leaves a running average.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Average {
    /// Infinite: never decays.
    latency_s: f64,
    ln_threshold: f64,
}

/// Whether light may differ from that of a tile's last visit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum World {
    /// It is the same: all samples count alike.
    Still,
    /// It is not: old samples decay.
    Changing,
}

/// What a tile's average holds; one a tile.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct History {
    /// Never more than the tile has been given, whatever the pattern of visits.
    quanta: f64,
    /// Sum of the decayed weights of all visits, of which a full average holds 1.
    mass: f64,
    /// Whether the last visit let old samples decay.
    decaying: bool,
}

/// Bound of what a history weighs, so that f32 holds it; as good as infinite.
const MOST_WEIGHT_QUANTA: f64 = 1e30;

/// Power of the age with which old light leaves once `exp` of its negative is left, a hundredth. Of n samples since the
/// change 2 / power - 1 / power^2 count, two in five; a power of 2.3 would keep two in three, and old light for longer.
const FADING_POWER: f64 = 4.6;

impl Average {
    /// After `tolerable_latency` the old light's share is `decay_threshold`. `ZERO`: no history; `MAX`: the plain mean.
    ///
    /// # Errors
    /// `InvalidSettings` where the threshold is not between 0 and 1, both excluded.
    pub(crate) fn new(tolerable_latency: Duration, decay_threshold: f64) -> Result<Self> {
        if !(decay_threshold > 0.0 && decay_threshold < 1.0) {
            let allowed = "allowed is what lies between 0 and 1, both excluded";
            return Err(Error::settings(format!("decay threshold {decay_threshold}: {allowed}")));
        }
        let never = tolerable_latency == Duration::MAX;
        let latency_s = if never { f64::INFINITY } else { tolerable_latency.as_secs_f64() };
        Ok(Self { latency_s, ln_threshold: decay_threshold.ln() })
    }

    /// What holds this long after the last change. Old light leaves as the latency has it, until little is left; then the
    /// average's memory grows with the age, so that its noise falls almost as that of a plain mean, and what is left goes on
    /// leaving, as a power of the age: light of ten thousand times the new is below a hundredth of it after 16 latencies.
    pub(crate) fn after(&self, age_s: f64) -> Self {
        if self.latency_s == 0.0 || !(age_s > 0.0) {
            return *self;
        }
        Self { latency_s: self.latency_s.max(age_s * -self.ln_threshold / FADING_POWER), ..*self }
    }

    /// Age at which of the light before the last change `share` (below a hundredth) is left; 0 where it never leaves.
    pub(crate) fn age_of(&self, share: f64) -> f64 {
        let constant_s = FADING_POWER * self.latency_s / -self.ln_threshold;
        let age_s = constant_s * ((-share.ln() - FADING_POWER) / FADING_POWER).exp();
        if age_s.is_finite() { age_s } else { 0.0 }
    }

    /// Share of the old average that is left after `dt_s` seconds; negative times and NaN count as 0.
    pub(crate) fn decay(&self, dt_s: f64) -> f64 {
        self.exponent(dt_s).exp()
    }

    /// Weight of what is new after `dt_s` seconds, without the cancellation of `1 - decay`; in `[0, 1]`.
    pub(crate) fn weight(&self, dt_s: f64) -> f64 {
        (-self.exponent(dt_s).exp_m1()).clamp(0.0, 1.0)
    }

    /// `ln(threshold) * dt / latency`, at most 0.
    fn exponent(&self, dt_s: f64) -> f64 {
        if self.latency_s == 0.0 {
            f64::NEG_INFINITY
        } else if self.latency_s.is_infinite() || !(dt_s > 0.0) {
            0.0
        } else {
            self.ln_threshold * (dt_s / self.latency_s)
        }
    }
}

impl History {
    /// Adds `quanta` (at least 1) new quanta of samples, `dt_s` seconds after this tile's last visit. Returns what the
    /// history weighs against them, in quanta: r. The shader merges the k-th new quantum (from 1) with weight
    /// 1 / (r + k), so that all of them weigh the same and the old average keeps r / (r + quanta).
    pub(crate) fn visit(&mut self, average: &Average, dt_s: f64, quanta: u32, world: World) -> f64 {
        let new = f64::from(quanta.max(1));
        let weight = average.weight(dt_s);
        let mut mass = self.mass;
        let kept = if world == World::Still || weight == 0.0 {
            self.decaying &= world == World::Changing;
            self.quanta
        } else {
            if !self.decaying {
                // A history longer than the latency holds is cut to that; without this 1e6 still samples never leave.
                mass = mass.max((self.quanta * weight / new).min(1.0));
            }
            self.decaying = true;
            (new * (average.decay(dt_s) * mass / weight)).min(MOST_WEIGHT_QUANTA)
        };
        // An average that has been kept for longer than the latency is full, however few its samples. What went before the
        // first visit does not count.
        self.mass = if self.quanta == 0.0 { 0.0 } else { (average.decay(dt_s) * mass + weight).min(1.0) };
        self.decaying &= self.quanta > 0.0;
        // A visit soon after another weighs little against the history, which does not make the history longer.
        self.quanta = (kept.min(self.quanta) + new).min(MOST_WEIGHT_QUANTA);
        kept
    }

    /// Quanta that the average is worth after the last visit.
    #[cfg(test)]
    fn quanta(&self) -> f64 {
        self.quanta
    }
}

#[cfg(test)]
mod tests;
