//! Samplers.

use super::{Gpu, vulkan_error};
use crate::error::Result;
use ash::vk;

/// A trilinear sampler.
pub(crate) struct Sampler {
    gpu: Gpu,
    pub(super) handle: vk::Sampler,
}

impl Sampler {
    /// `wrap`: beyond the edge, horizontally and vertically.
    pub(crate) fn new(gpu: &Gpu, wrap: [vk::SamplerAddressMode; 2]) -> Result<Self> {
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .mipmap_mode(vk::SamplerMipmapMode::LINEAR)
            .address_mode_u(wrap[0])
            .address_mode_v(wrap[1])
            .max_lod(vk::LOD_CLAMP_NONE);
        // SAFETY: the description is complete and asks for no feature.
        let handle = unsafe { gpu.device().create_sampler(&info, None) }
            .map_err(|result| vulkan_error("create a sampler", result))?;
        Ok(Self { gpu: gpu.clone(), handle })
    }
}

impl Drop for Sampler {
    fn drop(&mut self) {
        // SAFETY: whoever recorded with it has waited for the device before dropping it.
        unsafe { self.gpu.device().destroy_sampler(self.handle, None) };
    }
}
