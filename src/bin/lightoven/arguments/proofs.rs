//! What can be asked for that proves something.

use super::DeviceArguments;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Verify that a device computes right
///
/// Bakes small scenes whose light is known in closed form, and stiff and extreme ones, and compares. Ends with 1 where
/// anything is not as it must be.
#[derive(Debug, Args)]
pub(crate) struct Verify {
    /// Only cases whose subject and name hold this, as in "closed form 4" or "sphere"; may be given more than once
    #[arg(long, value_name = "NAME")]
    pub(crate) only: Vec<String>,
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
    /// Write the figures as JSON too
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Study how answers depend on what is stiff or extreme
#[derive(Debug, Args)]
pub(crate) struct Study {
    /// What is studied
    #[arg(value_enum, value_name = "stiffness|precision")]
    pub(crate) study: StudyArgument,
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
    /// With stiffness: draw what is missing over the number of bounces as SVG
    #[arg(long, value_name = "P.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the figures as JSON too
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
}

/// What is studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum StudyArgument {
    /// A closed room of albedos up to .999: what so many bounces miss, and what the bake says of it
    Stiffness,
    /// The same scene large, small, far away, bright and dim; and running averages of many rates and latencies
    Precision,
}
