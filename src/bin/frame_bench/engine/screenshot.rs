//! The picture that was drawn last, for the host.

use super::Device;
use super::commands::Commands;
use super::memory::{Buffer, Location};
use super::raster::Raster;
use super::targets::{Access, barrier};
use ash::vk;
use lightoven::Result;
use std::rc::Rc;

impl Raster {
    /// Copies the last picture: `[pixel]`, row-major from the top, sRGB-encoded, four bytes each.
    pub(crate) fn screenshot(&self, device: &Rc<Device>, commands: &mut Commands) -> Result<Vec<u8>> {
        let colour = &self.targets.colour;
        let [width, height] = colour.size;
        let size = 4 * u64::from(width) * u64::from(height);
        let target = Buffer::new(device, "screenshot", size, vk::BufferUsageFlags::TRANSFER_DST, Location::Host)?;
        commands.begin()?;
        let barriers = [barrier(colour, Some(Access::COLOUR), Access::COPIED)];
        let before = vk::DependencyInfo::default().image_memory_barriers(&barriers);
        let region = vk::BufferImageCopy::default()
            .image_subresource(
                vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1),
            )
            .image_extent(vk::Extent3D { width, height, depth: 1 });
        let for_host = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::COPY)
            .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::HOST)
            .dst_access_mask(vk::AccessFlags2::HOST_READ)];
        let after = vk::DependencyInfo::default().memory_barriers(&for_host);
        let functions = &device.functions;
        let general = vk::ImageLayout::GENERAL;
        // SAFETY: the command buffer is being recorded; a frame that drew left the image in GENERAL; the buffer holds
        // all of it.
        unsafe {
            functions.cmd_pipeline_barrier2(commands.buffer, &before);
            functions.cmd_copy_image_to_buffer(commands.buffer, colour.handle(), general, target.handle(), &[region]);
            functions.cmd_pipeline_barrier2(commands.buffer, &after);
        }
        commands.submit(None)?;
        commands.wait()?;
        target.access(|contents| contents[..size as usize].to_vec())
    }
}
