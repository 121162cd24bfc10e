//! When a bake ends, and what it tells on the way and afterwards.

use crate::epochs::Epoch;
use crate::error::{Error, Result};
use crate::sampling::SamplingStatistics;
use std::time::{Duration, Instant};

/// When a bake ends: at whichever comes first. With nothing set it goes on until it is interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stop {
    /// Rays a texel, those of bounce epochs not counted; rounded up to a multiple of 64; 1 to [`Stop::MAX_SAMPLES`].
    pub samples: Option<u32>,
    /// Estimated relative error of the irradiance, the root of relMSE; more than 0.
    pub error: Option<f32>,
    /// Time from the call, bounce epochs included; more than 0. With [`super::Baker::bake_until`] that of all calls.
    pub time: Option<Duration>,
}

/// How a bake ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The stop was reached, or there is no ray to send: such a light map is whole at once, with 0 samples a texel.
    Finished,
    /// The progress callback broke it off.
    Interrupted,
}

/// What one call is of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stretch {
    /// All that the caller wants: time counts from the call.
    Whole,
    /// More is to come: time counts on.
    Part,
}

/// The time that counts for a stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock {
    started: Instant,
    before: Duration,
}

impl Clock {
    /// Runs from now on, and shows `before`.
    pub(super) fn starting_at(before: Duration) -> Self {
        Self { started: Instant::now(), before }
    }

    pub(super) fn elapsed(self) -> Duration {
        self.before + self.started.elapsed()
    }
}

/// What a bake is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Scene, hierarchy, g-buffer.
    Preparing,
    /// Finding out how light is reflected; these rays are not kept.
    Bounces,
    /// Collecting samples.
    Samples,
}

impl Phase {
    /// A word for a progress bar.
    pub fn name(self) -> &'static str {
        match self {
            Self::Preparing => "preparing",
            Self::Bounces => "bounces",
            Self::Samples => "samples",
        }
    }
}

/// How far a bake is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What it is doing.
    pub phase: Phase,
    /// Epochs finished.
    pub epoch: u32,
    /// Kept samples of a texel, in the mean.
    pub samples_per_texel: u64,
    /// Rays traced, bounce epochs included.
    pub rays: u64,
    /// Million rays a second of baking.
    pub mrays_per_s: f64,
    /// Time since the call, or that of all calls, as [`Stop::time`] counts.
    pub elapsed: Duration,
    /// Root of relMSE as the half buffers tell it; `None` before there are two halves, 0 where no rays are sent.
    pub estimated_error: Option<f32>,
    /// How far it is on the way to the stop, 0 to 1.
    pub fraction: f32,
    /// Time to the stop at the rate so far; `None` while it cannot be told.
    pub time_left: Option<Duration>,
}

/// Wall time by what it went into, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seconds {
    /// Building the hierarchy on the host.
    pub bvh: f64,
    /// Laying out the light map, uploading the scene, drawing the g-buffer and settling its texels.
    pub gbuffer: f64,
    /// Finding what rays can be aimed at: clusters of texels, and what shares a texel.
    pub aiming: f64,
    /// The first source map and light from analytic lights.
    pub direct: f64,
    /// Making what rays are aimed by.
    pub importance: f64,
    /// Gathering and making source maps.
    pub bake: f64,
    /// Resolving, for error estimates too, filling gutters and reading back.
    pub resolve: f64,
    /// Making pipelines, and what the driver compiles at their first use.
    pub compile: f64,
}

impl Seconds {
    /// What epochs take beside gathering.
    pub(super) fn beside_bake(&self) -> f64 {
        self.importance + self.resolve
    }
}

/// What a bake has done.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statistics {
    /// Texels that take rays.
    pub texels: u64,
    /// World area of the texels that take rays, square scene units. Each counts whole, also where its surface ends within
    /// it; 0 until a bake has begun, and where no rays are sent.
    pub area: f64,
    /// Texels on a surface that are inside something and are filled from their neighbours.
    pub invalid_texels: u64,
    /// Epochs finished.
    pub epochs: u32,
    /// Kept samples of a texel, in the mean.
    pub samples_per_texel: f64,
    /// Kept samples of the texels that have most; with [`super::ErrorEstimate::Adaptive`] others may have fewer.
    pub most_samples: f64,
    /// Rays traced by gathering, bounce epochs included, shadow rays of analytic lights not.
    pub rays: u64,
    /// `rays` over `seconds.bake`, in millions.
    pub mrays_per_s: f64,
    /// How rays were sent.
    pub sampling: SamplingStatistics,
    /// Root of relMSE as the half buffers tell it; `None` before there are two halves, 0 where no rays are sent.
    pub estimated_error: Option<f32>,
    /// Bound on what further bounces would add, relative to the mean radiance; infinite before two bounces are
    /// done; 0 before a bake has begun, and within frames.
    pub bounces_missing: f32,
    /// Wall time by what it went into.
    pub seconds: Seconds,
    /// What was noticed, one sentence each.
    pub warnings: Vec<String>,
}

impl Stop {
    /// Largest number of samples a texel: beyond it their number is no longer exact in the f32 that counts them.
    pub const MAX_SAMPLES: u32 = 1 << 30;

    /// [`Stop::check`], and that the error is known where the bake is to end by it.
    pub(super) fn check_for(&self, tells_error: bool) -> Result<()> {
        self.check()?;
        if self.error.is_none() || tells_error {
            return Ok(());
        }
        Err(Error::settings(
            "the bake is to end by its error, and no error estimate was asked for; allowed are one that is told and an adaptive one",
        ))
    }

    pub(super) fn check(&self) -> Result<()> {
        if let Some(samples) = self.samples.filter(|samples| !(1..=Self::MAX_SAMPLES).contains(samples)) {
            let most = Self::MAX_SAMPLES;
            return Err(Error::settings(format!("the number of samples is {samples}; allowed is 1 to {most}")));
        }
        if let Some(error) = self.error.filter(|error| !(*error > 0.0)) {
            return Err(Error::settings(format!("the error to reach is {error}; allowed is more than 0")));
        }
        if self.time == Some(Duration::ZERO) {
            return Err(Error::settings("the time is 0; allowed is more than 0"));
        }
        Ok(())
    }

    /// Kept quanta after which the samples are enough.
    pub(super) fn quanta(&self, samples_per_quantum: u32) -> u32 {
        self.samples.unwrap_or(Self::MAX_SAMPLES).div_ceil(samples_per_quantum)
    }

    pub(super) fn reached(&self, statistics: &Statistics, elapsed: Duration) -> bool {
        statistics.most_samples >= f64::from(self.samples.unwrap_or(Self::MAX_SAMPLES))
            || self.time.is_some_and(|time| elapsed >= time)
            || self.error.is_some_and(|target| statistics.estimated_error.is_some_and(|error| error <= target))
    }

    /// 0 to 1.
    fn fraction(&self, statistics: &Statistics, elapsed: Duration) -> f64 {
        let samples = self.samples.map_or(0.0, |samples| statistics.most_samples / f64::from(samples));
        let time = self.time.map_or(0.0, |time| elapsed.as_secs_f64() / time.as_secs_f64());
        // The error falls with the root of the samples.
        let toward = |(target, error): (f32, f32)| f64::from(target / error.max(f32::MIN_POSITIVE)).powi(2);
        let error = self.error.zip(statistics.estimated_error).map_or(0.0, toward);
        samples.max(time).max(error).min(1.0)
    }
}

impl Statistics {
    /// Keeps a warning, once.
    pub(super) fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            tracing::warn!("{warning}");
            self.warnings.push(warning);
        }
    }

    /// Of a bake without rays, which is done at once.
    pub(super) fn progress_at_end(&mut self, stop: &Stop, elapsed: Duration) -> Progress {
        let progress = self.progress(Epoch::Keep { quanta: 0 }, stop, elapsed);
        Progress { fraction: 1.0, time_left: Some(Duration::ZERO), ..progress }
    }

    pub(super) fn progress(&mut self, epoch: Epoch, stop: &Stop, elapsed: Duration) -> Progress {
        self.mrays_per_s = self.rays as f64 / self.seconds.bake.max(1e-9) / 1e6;
        let fraction = stop.fraction(self, elapsed);
        let left = elapsed.as_secs_f64() * (1.0 - fraction) / fraction;
        Progress {
            phase: if matches!(epoch, Epoch::Bounce(_)) { Phase::Bounces } else { Phase::Samples },
            epoch: self.epochs,
            samples_per_texel: self.samples_per_texel as u64,
            rays: self.rays,
            mrays_per_s: self.mrays_per_s,
            elapsed,
            estimated_error: self.estimated_error,
            fraction: fraction as f32,
            time_left: Duration::try_from_secs_f64(left).ok().filter(|_| fraction > 0.01),
        }
    }
}
