//! lightoven bakes light maps with Vulkan: stochastic rays from every texel of a light map, traced in compute shaders,
//! progressively refined: at a stretch, or within an engine's frames while objects and lights move
//! ([`baker::Mode::Frames`]).
//!
//! A scene is read or described, a [`baker::Baker`] made for it, and baked until it is good enough:
//!
//! ```no_run
//! use lightoven::Result;
//! use lightoven::baker::{BakeSettings, Baker, Stop};
//! use lightoven::headless::{Headless, HeadlessSettings};
//! use lightoven::io::gltf::{self, ReadSettings};
//! use std::ops::ControlFlow;
//! use std::path::Path;
//!
//! fn main() -> Result<()> {
//!     // An engine fills a `scene::SceneDesc` from its own data instead, and checks it with `scene::Scene::new`.
//!     let scene = gltf::read(Path::new("assets/cornell.gltf"), &ReadSettings::default())?;
//!     // A device of our own; `unsafe gpu::Gpu::from_raw` takes the engine's.
//!     let headless = Headless::new(&HeadlessSettings::default())?;
//!     let mut baker = Baker::new(headless.gpu(), &scene, &BakeSettings::default())?;
//!     let stop = Stop { samples: Some(1024), ..Stop::default() };
//!     baker.bake(&stop, &mut |progress| {
//!         println!("{:.0} %", 100.0 * progress.fraction);
//!         ControlFlow::Continue(())
//!     })?;
//!     let light_map = baker.read_back()?;
//!     println!("{} x {} texels", light_map.width, light_map.height);
//!     Ok(())
//! }
//! ```

mod adaptive;
pub mod baker;
pub mod bvh;
#[cfg(feature = "capi")]
pub mod capi;
mod clusters;
mod epochs;
mod error;
mod features;
pub mod gpu;
pub mod headless;
pub mod io;
mod pass;
mod sampling;
pub mod scene;
mod schedule;
mod temporal;
mod tracer;
pub mod verify;

/// Compiles the examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use error::{Error, ErrorKind, Result};
pub use features::Features;
pub use pass::Query;
pub use tracer::{LoadedRays, Tracer};
