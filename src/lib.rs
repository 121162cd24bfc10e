//! lightoven bakes light maps with Vulkan: stochastic rays from every texel of a light map, traced in compute shaders,
//! progressively refined.

pub mod bvh;
mod error;
pub mod io;
pub mod scene;

pub use error::{Error, ErrorKind, Result};
