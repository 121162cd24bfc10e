//! lightoven bakes light maps with Vulkan: stochastic rays from every texel of a light map, traced in compute shaders,
//! progressively refined.

pub mod baker;
pub mod bvh;
mod epochs;
mod error;
mod features;
pub mod gpu;
pub mod headless;
pub mod io;
mod pass;
pub mod scene;
mod schedule;
mod tracer;

pub use error::{Error, ErrorKind, Result};
pub use features::Features;
pub use tracer::Tracer;
