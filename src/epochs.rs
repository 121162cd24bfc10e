//! Which epoch comes next in a static bake. Pure: the source map's mean radiance goes in, the next epoch comes out.
//!
//! First the bounces converge, an epoch each, on few rays that are the SAME in every epoch: the operator that they
//! sample is then one fixed matrix, the source follows its Neumann series without noise between epochs, and its change
//! falls by a steady factor that tells what is still missing. Rays that are aimed go through this twice: a pilot is aimed at
//! what emits, and its light tells what the rays of the second stage are aimed at. Then samples are kept, in epochs that
//! double.

use crate::error::{Error, ErrorKind, Result};

/// How many times light is reflected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Bounces {
    /// Until what is missing is below a ten-thousandth of the mean radiance, or, with albedos above .995, as little as 32-bit
    /// floats tell.
    #[default]
    Auto,
    /// This many times, up to [`Bounces::MAX_LIMIT`], and no fewer where the last of them add nothing: each costs a pass over
    /// the light map. 0: lights, sky and emission alone.
    Limit(u32),
}

impl Bounces {
    /// Missing bounces below this share of the mean radiance are not worth an epoch: [`Bounces::Auto`] ends there. Samples are
    /// kept from sources from here on, so that this is the bias of the result (a closed furnace of albedo .5: 3e-4 with
    /// 1e-3 here).
    pub const TOLERANCE: f64 = 1e-4;

    /// Most bounces of a limit. Of the largest albedo, .999, as much of a closed room's light is then missing as 32-bit floats
    /// round (.999^16384 = 2^-23.6), and [`Bounces::Auto`], which needs 9,206 there, never reaches it.
    pub const MAX_LIMIT: u32 = 1 << 14;

    /// # Errors
    /// `InvalidSettings` for a limit outside its range.
    pub(crate) fn check(self) -> Result<()> {
        let most = Self::MAX_LIMIT;
        match self {
            Self::Limit(limit) if limit > most => Err(Error::settings(format!(
                "the bounces are limited to {limit}; allowed is a limit of 0 to {most}, or none"
            ))),
            _ => Ok(()),
        }
    }
}

/// What to do next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Epoch {
    /// Light goes once along the few rays of this stage, which are not kept.
    Bounce(Stage),
    /// This many quanta, kept.
    Keep { quanta: u32 },
}

/// Bounces that go along the same rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Tells what to aim at.
    Pilot,
    /// Makes the source that the first samples read.
    Last,
}

/// The state of a static bake.
#[derive(Debug, Clone)]
pub(crate) struct Epochs {
    bounces: Bounces,
    max_albedo: f64,
    stage: Stage,
    /// Bounces before this stage.
    before: u32,
    /// Mean radiance of the source after each bounce of the stage, the first entry before any.
    radiance: Vec<f64>,
    /// Mean radiance of the source without any bounce.
    emitted: f64,
    /// Most mean radiance before and after the first bounce of all.
    lit: f64,
    /// By how much the change shrank from bounce to bounce in the stage before, whose rays are much like these.
    slowest: f64,
    /// Estimate of what bounces are missing, relative to the mean radiance.
    missing: f64,
    /// Latest bounces whose change may be all rounding.
    rounded: usize,
    kept: u32,
}

/// What a bounce's sums of 32-bit floats may round, relative: with albedo .999 in a closed room 2.7e-4 of the light stays
/// missing, half of what this makes of it. Bounces end where the change is a quarter of this.
const ROUNDING: f64 = 8.0 / (1 << 24) as f64;
/// They also end where the change is below [`ROUNDING`] this often in a row.
const MOST_ROUNDED: usize = 2048;
/// What may be missing after the pilot, whose noise is more than that.
const PILOT_TOLERANCE: f64 = 0.02;
/// Bounces of a pilot at most: other rays in each of them are no series that converges.
const MOST_PILOT_BOUNCES: u32 = 16;
/// Epochs over which the shrinking of the change is measured.
const WINDOW: usize = 16;
/// Kept quanta of one epoch are not doubled beyond this, so that the first sample of a quantum stays below 2^31.
const MOST_QUANTA: u32 = 1 << 20;
/// Light of more than so many times what a closed room of the largest albedo would hold is none of the scene's.
const MOST_BOUNCED: f64 = 4.0;
/// Epochs in a row in which the change may grow before that counts as divergence.
const GROWING: usize = 3;

impl Epochs {
    /// `first`: the stage to begin with; `radiance`: mean of the source map with no bounce in it yet.
    pub(crate) fn new(bounces: Bounces, first: Stage, max_albedo: f64, radiance: f64) -> Self {
        Self {
            bounces,
            max_albedo,
            stage: first,
            before: 0,
            radiance: vec![radiance],
            emitted: radiance,
            lit: radiance,
            slowest: 0.0,
            missing: f64::INFINITY,
            rounded: 0,
            kept: 0,
        }
    }

    /// The next epoch.
    pub(crate) fn next(&mut self) -> Epoch {
        if self.stage == Stage::Pilot && self.is_pilot_done() {
            let changes = self.changes();
            self.slowest = if changes.len() > 1 { self.ratio(&changes) } else { 0.0 };
            self.stage = Stage::Last;
            self.begin_stage();
            if self.restarts() {
                self.before = 0;
                self.radiance = vec![self.emitted];
            }
        }
        if self.needs_bounce() {
            return Epoch::Bounce(self.stage);
        }
        // Doubling: the last epoch, whose source is the best, holds half of all samples.
        let quanta = self.kept.clamp(1, MOST_QUANTA);
        self.kept += quanta;
        Epoch::Keep { quanta }
    }

    /// Whether the source map is made anew from what has been kept: not where the number of bounces is limited.
    pub(crate) fn updates_source(&self) -> bool {
        self.bounces == Bounces::Auto && self.max_albedo > 0.0
    }

    /// Whether the last stage begins without any bounce, and not where the pilot has ended: where their number is limited,
    /// for the pilot's light is for aiming only.
    pub(crate) fn restarts(&self) -> bool {
        matches!(self.bounces, Bounces::Limit(_))
    }

    /// What the last of a limited number of bounces finds is aimed at nowhere.
    fn is_pilot_done(&self) -> bool {
        let (done, limit) = (self.done_in_stage(), self.limit());
        self.bounces_done() + 1 >= limit || done >= MOST_PILOT_BOUNCES || done >= 2 && self.missing <= PILOT_TOLERANCE
    }

    fn limit(&self) -> u32 {
        match self.bounces {
            Bounces::Limit(limit) => limit,
            Bounces::Auto => u32::MAX,
        }
    }

    fn needs_bounce(&self) -> bool {
        match self.bounces {
            _ if self.max_albedo == 0.0 || self.kept > 0 => false,
            Bounces::Limit(limit) => self.bounces_done() < limit,
            Bounces::Auto => {
                self.done_in_stage() < 2 || self.missing > Bounces::TOLERANCE && self.rounded < MOST_ROUNDED
            }
        }
    }

    fn done_in_stage(&self) -> u32 {
        self.radiance.len() as u32 - 1
    }

    /// Whether the next bounce is the first along its rays.
    pub(crate) fn rays_are_new(&self) -> bool {
        self.radiance.len() == 1
    }

    /// The source map's mean radiance after a bounce.
    ///
    /// # Errors
    /// `InvalidScene` where the change has grown for three epochs: the scene gives back more light than it gets.
    pub(crate) fn bounced(&mut self, radiance: f64) -> Result<()> {
        self.radiance.push(radiance);
        if self.bounces_done() == 1 {
            self.lit = self.lit.max(radiance);
        }
        let changes = self.changes();
        let last = changes[changes.len() - 1];
        let ratio = self.ratio(&changes);
        // A change on its way from rise to fall is small by chance.
        let before = changes.len().checked_sub(2).map_or(0.0, |before| changes[before]);
        let change = last.max(before * ratio);
        let least = ROUNDING * radiance;
        self.rounded = if change <= least { self.rounded + 1 } else { 0 };
        if change <= 0.25 * least {
            self.rounded = MOST_ROUNDED;
        }
        self.missing = if radiance > 0.0 { change.max(least) * ratio / (1.0 - ratio) / radiance } else { 0.0 };
        if !radiance.is_finite() {
            return Err(too_bright());
        }
        if self.growing() >= GROWING && radiance > self.lit * 1e6 {
            return Err(Error::new(
                ErrorKind::InvalidScene,
                format!("light grows with every bounce: mean radiance {radiance:e} after {}", self.bounces_done()),
            ));
        }
        Ok(())
    }

    /// Of the mean radiance, from bounce to bounce.
    fn changes(&self) -> Vec<f64> {
        self.radiance.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect()
    }

    /// Bounces in a row, up to the last, in which the change has grown.
    fn growing(&self) -> usize {
        self.changes().windows(2).rev().take_while(|pair| pair[1] > pair[0] * (1.0 + 1e-6)).count()
    }

    /// By how much the change shrinks from epoch to epoch: over several epochs, for a single step near the end is rounding
    /// noise, and the slowest of the latest, for a first bounce that finds little light must not look converged.
    fn ratio(&self, changes: &[f64]) -> f64 {
        let last = changes.len() - 1;
        if last == 0 {
            return self.max_albedo;
        }
        let over_window = |end: usize| {
            let span = end.min(WINDOW);
            let before = changes[end - span];
            if before > 0.0 { (changes[end] / before).powf(1.0 / span as f64) } else { 0.0 }
        };
        let slowest = (last.saturating_sub(WINDOW).max(1)..=last).map(over_window).fold(self.slowest, f64::max);
        slowest.min(self.max_albedo)
    }

    /// Whether the change has grown for three bounces, or there is much more light than all bounces together can bring: more
    /// comes back than was there.
    pub(crate) fn grows(&self) -> bool {
        let most = MOST_BOUNCED * self.lit / (1.0 - self.max_albedo);
        if self.lit > 0.0 && self.radiance.last().is_some_and(|radiance| *radiance > most) {
            return true;
        }
        self.growing() >= GROWING
    }

    /// From here on rays are other ones, and how much light there is and how fast the change shrinks is to be found anew.
    pub(crate) fn start_over(&mut self) {
        self.begin_stage();
        self.missing = f64::INFINITY;
        self.lit = self.radiance[0];
    }

    fn begin_stage(&mut self) {
        let last = self.radiance.len() - 1;
        self.before += last as u32;
        self.radiance.drain(..last);
        self.rounded = 0;
    }

    /// Bounces in the source map so far, those of kept epochs not counted.
    pub(crate) fn bounces_done(&self) -> u32 {
        self.before + self.done_in_stage()
    }

    /// What bounces are missing, relative to the mean radiance; infinite before it is known.
    pub(crate) fn missing(&self) -> f64 {
        if self.max_albedo == 0.0 { 0.0 } else { self.missing }
    }
}

/// What no 32-bit float holds.
pub(crate) fn too_bright() -> Error {
    let context = "the scene's radiance is more than a 32-bit float holds: its lights or its extent are too large";
    Error::new(ErrorKind::InvalidScene, context)
}

#[cfg(test)]
mod tests;
