//! What can be asked for.

use crate::values::{self, Budgets};
use clap::{Parser, ValueEnum};
use lightoven::gpu::BackendChoice;
use serde::Serialize;
use std::path::PathBuf;

/// Measures what baking inside a frame costs a small engine that embeds lightoven
///
/// Frames with raster alone, with baking alone and with both follow each other at random: first for each budget, then
/// once more at the middle one to see how far both overlap. Ctrl-C stops early and writes what is there.
#[derive(Debug, Parser)]
#[command(name = "frame_bench", version)]
pub(crate) struct Arguments {
    /// The scene: .gltf or .glb
    pub(crate) scene: PathBuf,
    /// Measured frames of each case and budget
    #[arg(long, value_name = "N", default_value = "300", value_parser = values::frames, allow_negative_numbers = true)]
    pub(crate) frames: u32,
    /// Frames with baking and raster before each budget's measured ones
    #[arg(long, value_name = "N", default_value = "60", value_parser = values::warm_up, allow_negative_numbers = true)]
    pub(crate) warm_up: u32,
    /// Times that baking may take a frame, milliseconds
    #[arg(long, value_name = "A,B,...", default_value = "2,4,8,16", value_parser = values::budgets, allow_hyphen_values = true)]
    pub(crate) budget_ms: Budgets,
    /// Side of the light map in texels
    #[arg(long, value_name = "N", default_value = "256", value_parser = values::resolution, allow_negative_numbers = true)]
    pub(crate) resolution: u32,
    /// Width of the picture in pixels
    #[arg(long, value_name = "N", default_value = "640", value_parser = values::side, allow_negative_numbers = true)]
    pub(crate) width: u32,
    /// Height of the picture in pixels
    #[arg(long, value_name = "N", default_value = "360", value_parser = values::side, allow_negative_numbers = true)]
    pub(crate) height: u32,
    /// How baking is put on the device
    #[arg(long, value_enum, default_value = "record")]
    pub(crate) mode: Mode,
    /// Which way rays are traced
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendArgument,
    /// The device: its index or a part of its name; `lightoven info` lists them
    #[arg(long, value_name = "INDEX|NAME")]
    pub(crate) device: Option<String>,
    /// Write the figures as JSON
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write a plot of frame times and bake times
    #[arg(long, value_name = "P.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Write a row for each frame
    #[arg(long, value_name = "F.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Write the picture of the last frame with baking and raster
    #[arg(long, value_name = "S.png")]
    pub(crate) screenshot: Option<PathBuf>,
    /// Seed of the order of cases, of the rays and of the statistics
    #[arg(long, value_name = "N", default_value = "0", value_parser = values::seed, allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Print warnings and errors only
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// How baking is put on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Mode {
    /// Recorded into the frame's own command buffer, before the raster passes
    Record,
    /// Submitted by the library, to a compute queue where the device has another one
    Submit,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum BackendArgument {
    /// Chosen for the device
    Auto,
    /// Traversal in the shader; runs everywhere
    Software,
    /// The device's own ray query
    RayQuery,
}

impl Arguments {
    pub(crate) fn backend(&self) -> BackendChoice {
        match self.backend {
            BackendArgument::Auto => BackendChoice::Auto,
            BackendArgument::Software => BackendChoice::Software,
            BackendArgument::RayQuery => BackendChoice::RayQuery,
        }
    }
}
