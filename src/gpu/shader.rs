//! The compiled shaders that the build embeds.

use super::Backend;

/// A stage's SPIR-V, with a second module for the hardware back end where it traces rays.
pub(crate) struct Shader {
    pub(crate) name: &'static str,
    spirv: &'static [u8],
    ray_query: Option<&'static [u8]>,
}

impl Shader {
    /// The module for a back end, as words.
    pub(super) fn words(&self, backend: Backend) -> Vec<u32> {
        let bytes = match (backend, self.ray_query) {
            (Backend::RayQuery, Some(bytes)) => bytes,
            _ => self.spirv,
        };
        bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect()
    }
}

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
