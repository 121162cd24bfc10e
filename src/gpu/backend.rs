//! What traces the rays.

use super::info::DeviceInfo;
use crate::error::{Error, ErrorKind, Result};

/// Which back end traces the rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The host-built hierarchy in storage buffers, walked by a GLSL function. Runs everywhere.
    Software,
    /// `VK_KHR_ray_query`.
    RayQuery,
}

impl Backend {
    /// The name that the command line and reports use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Software => "software",
            Self::RayQuery => "ray-query",
        }
    }
}

/// Which back end is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum BackendChoice {
    /// Ray queries where the device has them in hardware, else software. A CPU device's own ray query is several times
    /// slower than the software back end and is not chosen.
    #[default]
    Auto,
    /// Always software.
    Software,
    /// Always ray queries; an error on a device without them.
    RayQuery,
}

/// The back end that a device gets.
///
/// # Errors
/// `Unsupported` for ray queries on a device without them.
pub(crate) fn choose_backend(info: &DeviceInfo, choice: BackendChoice) -> Result<Backend> {
    match choice {
        BackendChoice::Software => Ok(Backend::Software),
        BackendChoice::Auto if info.ray_query && !info.is_cpu() => Ok(Backend::RayQuery),
        BackendChoice::Auto => Ok(Backend::Software),
        BackendChoice::RayQuery if info.ray_query => Ok(Backend::RayQuery),
        BackendChoice::RayQuery => Err(Error::new(
            ErrorKind::Unsupported,
            format!(
                "device '{}' ({}) has no ray query (VK_KHR_ray_query); use the back end 'software' or 'auto'",
                info.name, info.driver
            ),
        )),
    }
}
