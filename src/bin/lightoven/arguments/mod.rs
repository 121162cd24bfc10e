//! What can be asked for.

mod proofs;

pub(crate) use proofs::{Study, StudyArgument, Verify};

use crate::values::{self, Way};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::Vec3;
use lightoven::baker::{Bounces, ErrorEstimate, Stop};
use lightoven::gpu::BackendChoice;
use lightoven::headless::{HeadlessSettings, Validation};
use lightoven::io::gltf::SidednessChoice;
use lightoven::scene::Resolution;
use lightoven::{Error, ErrorKind, Result};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Duration;

/// Bakes light maps with Vulkan
#[derive(Debug, Parser)]
#[command(name = "lightoven", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Bake a glTF scene to an EXR light map
    Bake(Bake),
    /// Show devices and limits and, for a scene, what a bake would do
    Info(Info),
    /// Measure how far light map A is from a reference B
    Compare(Compare),
    /// Measure how noisy each way of sampling is
    Variance(Variance),
    /// Measure how the error falls as a bake goes on
    Converge(Converge),
    /// Measure rays a second of each back end and of obvhs on the CPU
    Bench(Bench),
    /// Verify that a device computes right
    Verify(Verify),
    /// Study how answers depend on what is stiff or extreme
    Study(Study),
}

/// Bake a glTF scene to an EXR light map
///
/// Samples until the first of --samples, --time and --error is reached; without any of them, until an error of 0.02 or
/// for 10 minutes. Ctrl-C stops early and writes what is there; a second one ends at once.
#[derive(Debug, Args)]
pub(crate) struct Bake {
    /// The scene: .gltf or .glb
    pub(crate) scene: PathBuf,
    /// The light map: R, G, B irradiance, A coverage, 32-bit floats
    #[arg(short, long, value_name = "OUT.exr")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) how: SceneArguments,
    /// Stop after this many samples a texel
    #[arg(long, value_name = "N", value_parser = values::samples, allow_negative_numbers = true)]
    samples: Option<u32>,
    /// Stop after this time of baking: 30s, 1.5m, 2h, 500ms; a number alone is seconds
    #[arg(long, value_name = "TIME", value_parser = values::duration, allow_hyphen_values = true)]
    time: Option<Duration>,
    /// Stop at this estimated relative error, over 0 and up to 1
    #[arg(long, value_name = "E", value_parser = values::error, allow_hyphen_values = true)]
    error: Option<f32>,
    /// How often light is reflected between surfaces: auto, or 0 to 16384
    #[arg(long, value_name = "auto|N", default_value = "auto", value_parser = values::bounces, allow_negative_numbers = true)]
    pub(crate) bounces: Bounces,
    /// Which way rays are sent: auto, cosine, importance, or mixture=A with the cosine's share A, 0.1 to 1
    #[arg(long, value_name = "auto|cosine|importance|mixture[=A][:power|distance|visibility]", default_value = "auto", value_parser = values::way, allow_hyphen_values = true)]
    pub(crate) sampling: Way,
    /// Give every texel the same rays, also where the bake ends by its error and some have converged before others
    #[arg(long)]
    no_adaptive: bool,
    /// Seed of the random numbers: the same seed on the same device gives the same light map for --samples
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::seed, allow_negative_numbers = true)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
    /// Write figures about the bake as JSON
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
    /// Write an 8-bit sRGB picture of the light map, the 99th percentile of its luminance near white
    #[arg(long, value_name = "P.png")]
    pub(crate) preview: Option<PathBuf>,
    /// Print warnings and errors only
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// What decides how a scene is read and how large its light map is.
#[derive(Debug, Args)]
pub(crate) struct SceneArguments {
    /// Side of the light map in texels, 1 to 16384 [default: 512]
    #[arg(long, value_name = "N", value_parser = values::resolution, allow_negative_numbers = true)]
    resolution: Option<u32>,
    /// Texels for one scene unit of length, instead of --resolution
    #[arg(long, value_name = "X", value_parser = values::texels_per_unit, allow_hyphen_values = true, conflicts_with = "resolution")]
    texels_per_unit: Option<f32>,
    /// Radiance of the sky: three numbers, or an equirectangular EXR, y up
    #[arg(long, value_name = "R,G,B|FILE.exr", value_parser = values::sky, allow_hyphen_values = true)]
    pub(crate) sky: Option<SkyArgument>,
    /// Let every surface answer on both sides, as Blender does
    #[arg(long)]
    double_sided: bool,
}

/// What a bake runs on.
#[derive(Debug, Args)]
pub(crate) struct DeviceArguments {
    /// Which way rays are traced
    #[arg(long, value_enum, default_value = "auto")]
    backend: BackendArgument,
    /// The device: its index or a part of its name; `lightoven info` lists them
    #[arg(long, value_name = "INDEX|NAME")]
    device: Option<String>,
}

/// Show devices and limits and, for a scene, what a bake would do
#[derive(Debug, Args)]
pub(crate) struct Info {
    /// A scene: .gltf or .glb
    pub(crate) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) how: SceneArguments,
}

/// Measure how far light map A is from a reference B
///
/// Over texels with A > 0.5 in both and a luminance (Rec. 709) in B of more than 1 % of its mean; ratios by brightness
/// too, in decades of B's mean. A file that says that it is sRGB-encoded (colorInteropID) is decoded.
#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// The light map to judge
    pub(crate) a: PathBuf,
    /// The reference
    pub(crate) b: PathBuf,
    /// Multiply B by this first; 3.14159265 for a reference that holds irradiance / pi
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = values::scale, allow_hyphen_values = true)]
    pub(crate) scale_b: f64,
    /// Write the figures as JSON too
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Measure how noisy each way of sampling is
///
/// Bakes a reference, then each way of sampling with seeds from 1 on, and tells the variance a ray: the mean squared
/// difference from the reference, times the samples a texel. Over texels with A > 0.5 and a luminance (Rec. 709) in the
/// reference of more than 1 % of its mean.
#[derive(Debug, Args)]
pub(crate) struct Variance {
    /// The scene: .gltf or .glb
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) how: SceneArguments,
    /// Ways of sampling, as `lightoven bake` takes them; the others are compared with the first
    #[arg(long, value_name = "A,B,..", default_value = "cosine,auto", value_delimiter = ',', value_parser = values::way, allow_hyphen_values = true)]
    pub(crate) sampling: Vec<Way>,
    /// Samples a texel of each bake, rounded up to a multiple of 64
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = values::few_samples, allow_negative_numbers = true)]
    pub(crate) samples: u32,
    /// Bakes for each way of sampling, with seeds 1 to K
    #[arg(long, value_name = "K", default_value_t = 16, value_parser = values::seeds, allow_negative_numbers = true)]
    pub(crate) seeds: u32,
    /// Samples a texel of the reference
    #[arg(long, value_name = "M", default_value_t = 16384, value_parser = values::samples, allow_negative_numbers = true)]
    pub(crate) reference_samples: u32,
    /// How often light is reflected between surfaces: auto, or 0 to 16384
    #[arg(long, value_name = "auto|N", default_value = "auto", value_parser = values::bounces, allow_negative_numbers = true)]
    pub(crate) bounces: Bounces,
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
    /// Write the figures as JSON too
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Measure how the error falls as a bake goes on
///
/// Bakes every way of sampling on every back end with seeds from 1 on, and compares the light map with a reference after
/// an eighth of a second of baking and at every doubling up to --time. The clock counts what `lightoven bake --time`
/// counts, and stands still while the light map is read and compared. Over texels with A > 0.5 and a luminance (Rec. 709)
/// in the reference of more than 1 % of its mean. Ctrl-C writes what was measured until then.
#[derive(Debug, Args)]
pub(crate) struct Converge {
    /// The scene: .gltf or .glb
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) how: SceneArguments,
    /// The reference, a light map of the same size and layout; decoded where it says that it is sRGB-encoded
    #[arg(long, value_name = "REF.exr", conflicts_with_all = ["reference_time", "save_reference"])]
    pub(crate) reference: Option<PathBuf>,
    /// Multiply the reference by this first; 3.14159265 for one that holds irradiance / pi
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = values::scale, allow_hyphen_values = true, requires = "reference")]
    pub(crate) scale_reference: f64,
    /// Bake the reference for this time, by sampling auto with seed 0 [default: 4 times --time]
    #[arg(long, value_name = "TIME", value_parser = values::duration, allow_hyphen_values = true)]
    reference_time: Option<Duration>,
    /// Write the reference that was baked
    #[arg(long, value_name = "REF.exr")]
    pub(crate) save_reference: Option<PathBuf>,
    /// The longest time of each bake: 30s, 1.5m, 2h, 500ms; a number alone is seconds
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = values::duration, allow_hyphen_values = true)]
    pub(crate) time: Duration,
    /// Ways of sampling, as `lightoven bake` takes them
    #[arg(long, value_name = "A,B,..", default_value = "cosine,auto", value_delimiter = ',', value_parser = values::way, allow_hyphen_values = true)]
    pub(crate) sampling: Vec<Way>,
    /// Bakes for each of them, with seeds 1 to K
    #[arg(long, value_name = "K", default_value_t = 4, value_parser = values::seeds, allow_negative_numbers = true)]
    pub(crate) seeds: u32,
    /// How often light is reflected between surfaces: auto, or 0 to 16384
    #[arg(long, value_name = "auto|N", default_value = "auto", value_parser = values::bounces, allow_negative_numbers = true)]
    pub(crate) bounces: Bounces,
    /// Which ways rays are traced
    #[arg(long, value_enum, value_name = "A,B,..", default_value = "auto", value_delimiter = ',')]
    backend: Vec<BackendArgument>,
    /// The device: its index or a part of its name; `lightoven info` lists them
    #[arg(long, value_name = "INDEX|NAME")]
    device: Option<String>,
    /// Write a row for every time of every way as CSV
    #[arg(long, value_name = "F.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Draw relMSE over time as SVG, both axes logarithmic
    #[arg(long, value_name = "P.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Write the figures as JSON too
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Measure rays a second of each back end and of obvhs on the CPU
///
/// All trace the same rays, which start from the light map's texels with directions by the cosine, in turn, round by round.
/// obvhs traces on all cores, by the fastest of its own hierarchies over all triangles in world space. Last in each round
/// comes a pass of a bake over the light map, of 32 rays a texel.
#[derive(Debug, Args)]
pub(crate) struct Bench {
    /// The scene: .gltf or .glb
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) how: SceneArguments,
    /// Rays of a round, for closest hits and again for any hit
    #[arg(long, value_name = "N", default_value_t = 1 << 21, value_parser = values::bench_rays, allow_negative_numbers = true)]
    pub(crate) rays: u32,
    /// Rounds
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = values::rounds, allow_negative_numbers = true)]
    pub(crate) rounds: u32,
    /// Order of the rays
    #[arg(long, value_enum, value_name = "bake|random", default_value_t = OrderArgument::Bake, conflicts_with = "growth")]
    pub(crate) order: OrderArgument,
    /// Measure instead how cost grows, by the back end that a bake takes: time and memory of sizes each four times the last
    #[arg(long, value_enum, value_name = "triangles|texels|both")]
    pub(crate) growth: Option<GrowthArgument>,
    /// Measure instead what each thing that the scene does not need would cost if it were there
    #[arg(long, conflicts_with_all = ["growth", "order"])]
    pub(crate) features: bool,
    /// With --features: which way rays are sent, as `lightoven bake` takes it; what it needs is in all rows
    #[arg(long, value_name = "WAY", default_value = "cosine", value_parser = values::way, allow_hyphen_values = true, requires = "features")]
    pub(crate) sampling: Way,
    /// With --growth: most triangles that the scene is subdivided into, about, from 1024 on
    #[arg(long, value_name = "N", default_value_t = 1 << 22, value_parser = values::most_triangles, allow_negative_numbers = true, requires = "growth")]
    pub(crate) most_triangles: u32,
    /// With --growth: longest side of a light map in texels, from 128 on
    #[arg(long, value_name = "SIDE", default_value_t = 4096, value_parser = values::most_texels, allow_negative_numbers = true, requires = "growth")]
    pub(crate) most_texels: u32,
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
    /// Write the figures as JSON too
    #[arg(long, value_name = "R.json")]
    pub(crate) report: Option<PathBuf>,
}

/// A sky as it is asked for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum SkyArgument {
    Constant(Vec3),
    File(PathBuf),
}

/// In which order rays are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum OrderArgument {
    /// That of a bake's work: neighbouring rays start close together and go about the same way
    Bake,
    /// None: neighbouring rays have nothing in common
    Random,
}

/// With what cost grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum GrowthArgument {
    /// Every triangle of the scene is cut into equal ones
    Triangles,
    /// The light map becomes larger
    Texels,
    /// The one and then the other
    Both,
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

impl Bake {
    /// Whether texels that have converged stop taking rays: only an estimated error tells which.
    pub(crate) fn error_estimate(&self) -> ErrorEstimate {
        match self.stop().error {
            Some(_) if !self.no_adaptive => ErrorEstimate::Adaptive,
            _ => ErrorEstimate::Told,
        }
    }

    pub(crate) fn stop(&self) -> Stop {
        match (self.samples, self.error, self.time) {
            (None, None, None) => Stop { samples: None, error: Some(0.02), time: Some(Duration::from_secs(600)) },
            (samples, error, time) => Stop { samples, error, time },
        }
    }
}

impl Converge {
    pub(crate) fn reference_time(&self) -> Duration {
        self.reference_time.unwrap_or_else(|| self.time.saturating_mul(4))
    }

    /// The device with each of the back ends.
    pub(crate) fn devices(&self) -> Vec<DeviceArguments> {
        self.backend.iter().map(|backend| DeviceArguments { backend: *backend, device: self.device.clone() }).collect()
    }
}

impl DeviceArguments {
    pub(crate) fn backend(&self) -> BackendChoice {
        match self.backend {
            BackendArgument::Auto => BackendChoice::Auto,
            BackendArgument::Software => BackendChoice::Software,
            BackendArgument::RayQuery => BackendChoice::RayQuery,
        }
    }

    pub(crate) fn settings(&self, validation: Validation) -> HeadlessSettings {
        let device = self.device.clone();
        HeadlessSettings { device, backend: self.backend(), validation, ..HeadlessSettings::default() }
    }
}

impl SceneArguments {
    pub(crate) fn resolution(&self) -> Resolution {
        match self.texels_per_unit {
            Some(density) => Resolution::PerUnit(density),
            None => Resolution::Texels(self.resolution.unwrap_or(512)),
        }
    }

    /// An error where a size of the light map was asked for.
    pub(crate) fn refuse_size(&self, why: &str) -> Result<()> {
        let resolution = self.resolution.map(|side| format!("--resolution {side}"));
        match resolution.or(self.texels_per_unit.map(|density| format!("--texels-per-unit {density}"))) {
            Some(option) => {
                let context = format!("{why}; {option} is allowed with --growth triangles and both");
                Err(Error::new(ErrorKind::InvalidSettings, context))
            }
            None => Ok(()),
        }
    }

    pub(crate) fn sidedness(&self) -> SidednessChoice {
        if self.double_sided { SidednessChoice::AllDouble } else { SidednessChoice::AsWritten }
    }
}
