//! What is drawn to, and how the passes hand it to each other.

use super::memory::{Image, ImageDesc};
use super::pipeline::{COLOUR_FORMAT, DEPTH_FORMAT};
use super::{Device, failed};
use ash::vk;
use lightoven::Result;
use std::rc::Rc;

/// Side of the shadow map.
pub(super) const SHADOW_SIZE: u32 = 1024;

/// Colour, depth and shadow map. All are in the layout GENERAL while they are used.
pub(super) struct Targets {
    pub(super) colour: Image,
    pub(super) depth: Image,
    pub(super) shadow: Image,
    pub(super) shadow_sampler: Sampler,
}

pub(super) struct Sampler(Rc<Device>, pub(super) vk::Sampler);

impl Targets {
    pub(super) fn new(device: &Rc<Device>, size: [u32; 2]) -> Result<Self> {
        use vk::ImageUsageFlags as Usage;
        let image =
            |name, size, format, aspect, usage| Image::new(device, &ImageDesc { name, size, format, aspect, usage });
        let (colour, depth) = (vk::ImageAspectFlags::COLOR, vk::ImageAspectFlags::DEPTH);
        let attachment = Usage::DEPTH_STENCIL_ATTACHMENT;
        let info = vk::SamplerCreateInfo::default()
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .compare_enable(true)
            .compare_op(vk::CompareOp::LESS_OR_EQUAL);
        // SAFETY: the description is complete.
        let sampler = unsafe { device.functions.create_sampler(&info, None) }.map_err(failed("create a sampler"))?;
        let shadow_sampler = Sampler(device.clone(), sampler);
        Ok(Self {
            colour: image("colour", size, COLOUR_FORMAT, colour, Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC)?,
            depth: image("depth", size, DEPTH_FORMAT, depth, attachment)?,
            shadow: image("shadow map", [SHADOW_SIZE; 2], DEPTH_FORMAT, depth, attachment | Usage::SAMPLED)?,
            shadow_sampler,
        })
    }
}

impl Drop for Sampler {
    fn drop(&mut self) {
        // SAFETY: every frame is waited for, so the device is done with it.
        unsafe { self.0.functions.destroy_sampler(self.1, None) };
    }
}

/// What an image was used for, or is next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Access {
    pub(super) stage: vk::PipelineStageFlags2,
    pub(super) access: vk::AccessFlags2,
}

impl Access {
    pub(super) const COLOUR: Self = Self {
        stage: vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
        access: vk::AccessFlags2::COLOR_ATTACHMENT_WRITE,
    };
    pub(super) const DEPTH: Self = Self {
        stage: vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw()
                | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
        ),
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
                | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
        ),
    };
    pub(super) const SAMPLED: Self =
        Self { stage: vk::PipelineStageFlags2::FRAGMENT_SHADER, access: vk::AccessFlags2::SHADER_SAMPLED_READ };
    pub(super) const COPIED: Self =
        Self { stage: vk::PipelineStageFlags2::COPY, access: vk::AccessFlags2::TRANSFER_READ };
}

/// A barrier on the image; from `None` its contents are not kept.
pub(super) fn barrier(image: &Image, from: Option<Access>, to: Access) -> vk::ImageMemoryBarrier2<'static> {
    let old = if from.is_some() { vk::ImageLayout::GENERAL } else { vk::ImageLayout::UNDEFINED };
    // The frame before was waited for, so what is not kept has nobody left to wait for; the bake least of all.
    let from = from.unwrap_or(Access { stage: to.stage, access: vk::AccessFlags2::NONE });
    vk::ImageMemoryBarrier2::default()
        .src_stage_mask(from.stage)
        .src_access_mask(from.access)
        .dst_stage_mask(to.stage)
        .dst_access_mask(to.access)
        .old_layout(old)
        .new_layout(vk::ImageLayout::GENERAL)
        .image(image.handle())
        .subresource_range(image.range())
}
