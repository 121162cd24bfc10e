//! What is known of a frame.

use std::time::Duration;

/// What a frame does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Case {
    Raster,
    Bake,
    Both,
}

impl Case {
    pub(crate) const ALL: [Self; 3] = [Self::Raster, Self::Bake, Self::Both];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Raster => "raster",
            Self::Bake => "bake",
            Self::Both => "both",
        }
    }

    pub(crate) fn draws(self) -> bool {
        self != Self::Bake
    }

    pub(crate) fn bakes(self) -> bool {
        self != Self::Raster
    }
}

/// What a frame is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Not measured: pipelines are compiled and the library learns how fast the device is.
    WarmUp,
    /// Shows how a budget is kept.
    Budget,
    /// Shows how raster and baking overlap.
    Overlap,
}

impl Phase {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::WarmUp => "warm-up",
            Self::Budget => "budget",
            Self::Overlap => "overlap",
        }
    }
}

/// A frame. What did not happen in it is `None` or 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) phase: Phase,
    pub(crate) budget: Duration,
    pub(crate) case: Case,
    /// By the host's clock, from the beginning of recording until the device had finished.
    pub(crate) frame_ms: f64,
    /// The device's time for the raster passes.
    pub(crate) raster_ms: Option<f64>,
    /// The device's time for the library's passes, as the library measures it.
    pub(crate) bake_ms: Option<f64>,
    /// What the library expected that to be.
    pub(crate) predicted_ms: f64,
    /// What the library expected of the least work that it does.
    pub(crate) one_unit_ms: f64,
    pub(crate) rays: u64,
    pub(crate) samples_per_texel: f64,
    /// The library's passes.
    pub(crate) ran: String,
    /// A pipeline was used for the first time, which may have compiled it.
    pub(crate) first_use: bool,
}
