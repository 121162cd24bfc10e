//! How to bake.

use super::frames::FrameSettings;
use super::needs::check_unneeded;
use crate::epochs::Bounces;
use crate::error::{Error, Result};
use crate::features::Features;
use crate::sampling::{AimedBy, Sampling};
use crate::scene::Resolution;
use crate::schedule::Slice;

/// How to bake.
#[derive(Debug, Clone, PartialEq)]
pub struct BakeSettings {
    /// How large the light map is.
    pub resolution: Resolution,
    /// How many times light is reflected.
    pub bounces: Bounces,
    /// Which way rays are sent.
    pub sampling: Sampling,
    /// Where aimed rays go.
    pub aimed_by: AimedBy,
    /// What is told of the error of a static bake. [`Mode::Frames`] tells nothing.
    pub error: ErrorEstimate,
    /// Another seed gives other noise.
    pub seed: u64,
    /// How long one submission of a static bake may take.
    pub slice: Slice,
    /// Whether the scene stays as it is.
    pub mode: Mode,
    /// Switched on although the scene does not need it, to measure what leaving it out saves: some of
    /// [`Features::LEFT_OUT_AT_WILL`], and with [`Mode::Frames`] nothing. Default: none.
    pub unneeded: Features,
}

/// What is told of the error of a static bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ErrorEstimate {
    /// Nothing: samples are not kept in halves, and a bake cannot end by its error.
    None,
    /// Its estimate, from the difference of two halves. All texels take the same rays. The default.
    #[default]
    Told,
    /// The same, and where the bake has an error to reach ([`super::Stop::error`]), texels that have converged stop taking rays:
    /// they then have fewer than [`super::Stop::samples`].
    Adaptive,
}

/// Whether the scene stays as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Mode {
    /// It stays: [`super::Baker::bake`] goes on until the light map is good enough. The default.
    #[default]
    Still,
    /// It changes: [`super::Baker::record`] or [`super::Baker::submit`] work within an engine's frames, on an engine's device
    /// ([`crate::gpu::Gpu::from_raw`]). Light is reflected without limit: bounces other than [`Bounces::Auto`] are refused.
    Frames(FrameSettings),
}

impl BakeSettings {
    /// What is looked at without a device; the resolution is by the layout of the light map.
    ///
    /// # Errors
    /// `InvalidSettings` for what is outside its range.
    pub(super) fn check(&self) -> Result<()> {
        self.sampling.check()?;
        self.bounces.check()?;
        check_unneeded(self)?;
        let Mode::Frames(frames) = self.mode else { return Ok(()) };
        frames.check()?;
        match self.bounces {
            Bounces::Auto => Ok(()),
            Bounces::Limit(limit) => {
                Err(Error::settings(format!("the bounces are limited to {limit}; allowed within frames is no limit")))
            }
        }
    }
}

impl Default for BakeSettings {
    /// 512 texels a side, all bounces, sampling as it pays, the same rays for every texel, seed 0, slices of 50 ms, a scene that
    /// stays as it is.
    fn default() -> Self {
        Self {
            resolution: Resolution::Texels(512),
            bounces: Bounces::Auto,
            sampling: Sampling::Auto,
            aimed_by: AimedBy::default(),
            error: ErrorEstimate::default(),
            seed: 0,
            slice: Slice::default(),
            mode: Mode::Still,
            unneeded: Features::empty(),
        }
    }
}
