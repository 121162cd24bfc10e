//! Records passes: each says its kind, the recorder places one barrier before it and a label around it.

use super::bindings::BindingSet;
use super::layout::Push;
use super::memory::{Buffer, Image};
use super::pipeline::{ComputePipeline, RasterPipeline};
use super::{Gpu, vulkan_error};
use crate::error::Result;
use ash::vk;
use std::ffi::CStr;
use std::ops::Range;

/// What a pass does, which decides what it waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PassKind {
    Transfer,
    Compute,
    Raster,
    /// Of acceleration structures.
    Build,
}

impl PassKind {
    fn stages(self) -> vk::PipelineStageFlags2 {
        match self {
            Self::Transfer => vk::PipelineStageFlags2::ALL_TRANSFER,
            Self::Compute => vk::PipelineStageFlags2::COMPUTE_SHADER,
            Self::Raster => vk::PipelineStageFlags2::ALL_GRAPHICS,
            Self::Build => vk::PipelineStageFlags2::ACCELERATION_STRUCTURE_BUILD_KHR,
        }
    }
}

const READ_WRITE: vk::AccessFlags2 =
    vk::AccessFlags2::from_raw(vk::AccessFlags2::MEMORY_READ.as_raw() | vk::AccessFlags2::MEMORY_WRITE.as_raw());

/// Records into a command buffer that has been begun.
pub(crate) struct Recorder<'a> {
    pub(super) gpu: &'a Gpu,
    commands: vk::CommandBuffer,
    /// Stages of the last pass; at first everything that was submitted before.
    pub(super) last: vk::PipelineStageFlags2,
}

impl<'a> Recorder<'a> {
    pub(super) fn new(gpu: &'a Gpu, commands: vk::CommandBuffer) -> Self {
        Self::after(gpu, commands, vk::PipelineStageFlags2::ALL_COMMANDS)
    }

    /// The first pass waits for these stages of what was submitted before.
    pub(super) fn after(gpu: &'a Gpu, commands: vk::CommandBuffer, last: vk::PipelineStageFlags2) -> Self {
        Self { gpu, commands, last }
    }

    /// The stages in which a frame's passes run.
    pub(super) fn frame_stages(gpu: &Gpu) -> vk::PipelineStageFlags2 {
        let stages = PassKind::Compute.stages() | PassKind::Transfer.stages();
        if gpu.inner.acceleration.is_some() { stages | PassKind::Build.stages() } else { stages }
    }

    pub(super) fn commands(&self) -> vk::CommandBuffer {
        self.commands
    }

    /// Starts a pass: it sees what the one before wrote. The label ends with the returned scope.
    pub(crate) fn pass(&mut self, kind: PassKind, name: &CStr) -> PassScope<'a> {
        self.barrier(kind.stages(), &[]);
        PassScope::new(self.gpu, self.commands, name)
    }

    pub(super) fn barrier(&mut self, next: vk::PipelineStageFlags2, images: &[vk::ImageMemoryBarrier2<'_>]) {
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(self.last)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(next)
            .dst_access_mask(READ_WRITE)];
        let info = vk::DependencyInfo::default().memory_barriers(&memory).image_memory_barriers(images);
        // SAFETY: the command buffer is being recorded, outside a rendering.
        unsafe { self.gpu.device().cmd_pipeline_barrier2(self.commands, &info) };
        self.last = next;
    }

    /// Brings new images into the layout that they live in, filled with zeros.
    pub(crate) fn initialise(&mut self, images: &[&Image]) {
        let transfer = PassKind::Transfer.stages();
        let to_general = |image: &&Image| {
            vk::ImageMemoryBarrier2::default()
                .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
                .dst_stage_mask(transfer)
                .dst_access_mask(READ_WRITE)
                .new_layout(vk::ImageLayout::GENERAL)
                .image(image.handle)
                .subresource_range(image.range())
        };
        let barriers: Vec<_> = images.iter().map(to_general).collect();
        self.barrier(transfer, &barriers);
        images.iter().filter(|image| image.aspect == vk::ImageAspectFlags::COLOR).for_each(|image| self.fill(image));
    }

    /// Fills images with zeros.
    pub(crate) fn clear(&mut self, images: &[&Image]) {
        self.barrier(PassKind::Transfer.stages(), &[]);
        images.iter().for_each(|image| self.fill(image));
    }

    fn fill(&self, image: &Image) {
        let zero = vk::ClearColorValue { uint32: [0; 4] };
        let (layout, range) = (vk::ImageLayout::GENERAL, [image.range()]);
        // SAFETY: the image is a colour image in the layout GENERAL; zero is the same in every format.
        unsafe { self.gpu.device().cmd_clear_color_image(self.commands, image.handle, layout, &zero, &range) };
    }

    /// Copies a whole buffer.
    pub(crate) fn copy_buffer(&mut self, from: &Buffer, to: &Buffer, size: u64) {
        let region = [vk::BufferCopy { src_offset: 0, dst_offset: 0, size }];
        self.barrier(PassKind::Transfer.stages(), &[]);
        // SAFETY: both buffers hold at least `size` bytes and were made for transfers.
        unsafe { self.gpu.device().cmd_copy_buffer(self.commands, from.handle, to.handle, &region) };
    }

    /// Writes into a buffer from within the command buffer: small data that changes from frame to frame. A multiple of 4
    /// bytes, at a multiple of 4.
    pub(crate) fn update_buffer<T: bytemuck::Pod>(&mut self, buffer: &Buffer, offset: u64, data: &[T]) {
        self.barrier(PassKind::Transfer.stages(), &[]);
        let bytes: &[u8] = bytemuck::cast_slice(data);
        for (index, part) in bytes.chunks(MOST_UPDATED).enumerate() {
            let offset = offset + (index * MOST_UPDATED) as u64;
            // SAFETY: the buffer is for transfers and holds the part; sizes and offsets are multiples of 4.
            unsafe { self.gpu.device().cmd_update_buffer(self.commands, buffer.handle, offset, part) };
        }
    }

    /// Copies pixels into an image's first mip level.
    pub(crate) fn copy_to_image(&mut self, from: &Buffer, to: &Image) {
        self.barrier(PassKind::Transfer.stages(), &[]);
        let (layout, region) = (vk::ImageLayout::GENERAL, [whole(to)]);
        // SAFETY: the buffer holds the image's pixels tightly packed, and both were made for transfers.
        unsafe { self.gpu.device().cmd_copy_buffer_to_image(self.commands, from.handle, to.handle, layout, &region) };
    }

    /// Copies an image's first mip level for the host to read.
    pub(crate) fn copy_from_image(&mut self, from: &Image, to: &Buffer) {
        self.barrier(PassKind::Transfer.stages(), &[]);
        let (layout, region) = (vk::ImageLayout::GENERAL, [whole(from)]);
        // SAFETY: the buffer has room for the image's pixels, and both were made for transfers.
        unsafe { self.gpu.device().cmd_copy_image_to_buffer(self.commands, from.handle, layout, to.handle, &region) };
    }

    /// Fills the mip levels below the first, each the mean of the one above.
    pub(crate) fn fill_mip_levels(&mut self, image: &Image) {
        let extent = |level: u32| image.size.map(|side| (side >> level).max(1) as i32);
        let corners = |level: u32| {
            let [x, y] = extent(level);
            [vk::Offset3D::default(), vk::Offset3D { x, y, z: 1 }]
        };
        let layers = |level: u32| vk::ImageSubresourceLayers {
            aspect_mask: image.aspect,
            mip_level: level,
            base_array_layer: 0,
            layer_count: 1,
        };
        for level in 1..image.mip_levels {
            self.barrier(PassKind::Transfer.stages(), &[]);
            let region = [vk::ImageBlit {
                src_subresource: layers(level - 1),
                src_offsets: corners(level - 1),
                dst_subresource: layers(level),
                dst_offsets: corners(level),
            }];
            let general = vk::ImageLayout::GENERAL;
            // SAFETY: both levels exist, and the format can be blitted with a linear filter (required for it by Vulkan).
            unsafe {
                self.gpu.device().cmd_blit_image(
                    self.commands,
                    image.handle,
                    general,
                    image.handle,
                    general,
                    &region,
                    vk::Filter::LINEAR,
                );
            }
        }
    }

    /// Records a compute pass of `groups` work groups.
    pub(crate) fn dispatch(
        &mut self,
        pipeline: &ComputePipeline,
        set: &BindingSet,
        push: &Push,
        groups: [u32; 2],
        name: &CStr,
    ) {
        let scope = self.pass(PassKind::Compute, name);
        pipeline.dispatch(self.commands, set, push, groups);
        drop(scope);
    }

    /// Records draws into colour and depth images, cleared first: zeros, and depth 1.
    pub(crate) fn render(
        &mut self,
        name: &CStr,
        color: &[&Image],
        depth: &Image,
        draws: &mut dyn FnMut(&mut Rendering),
    ) {
        let scope = self.pass(PassKind::Raster, name);
        let attachment = |image: &Image, clear: vk::ClearValue| {
            vk::RenderingAttachmentInfo::default()
                .image_view(image.view)
                .image_layout(vk::ImageLayout::GENERAL)
                .load_op(vk::AttachmentLoadOp::CLEAR)
                .store_op(vk::AttachmentStoreOp::STORE)
                .clear_value(clear)
        };
        let zero = vk::ClearValue { color: vk::ClearColorValue { uint32: [0; 4] } };
        let far = vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 } };
        let colors: Vec<_> = color.iter().map(|image| attachment(image, zero)).collect();
        let depth_attachment = attachment(depth, far);
        let [width, height] = depth.size;
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } };
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&colors)
            .depth_attachment(&depth_attachment);
        let viewport =
            vk::Viewport { width: width as f32, height: height as f32, max_depth: 1.0, ..Default::default() };
        let device = self.gpu.device();
        // SAFETY: the images are in the layout GENERAL and of one size; the rendering ends below.
        unsafe {
            device.cmd_begin_rendering(self.commands, &info);
            device.cmd_set_viewport(self.commands, 0, &[viewport]);
            device.cmd_set_scissor(self.commands, 0, &[area]);
        }
        draws(&mut Rendering { commands: self.commands });
        // SAFETY: the rendering was begun above.
        unsafe { device.cmd_end_rendering(self.commands) };
        drop(scope);
    }

    /// Makes what was written visible to the host, once it knows that the device is so far.
    pub(crate) fn show_host(&mut self) {
        let last = self.last;
        self.barrier(vk::PipelineStageFlags2::HOST, &[]);
        self.last = last;
    }

    /// Makes what was written visible to the host. Recorded last.
    pub(super) fn finish(mut self) -> Result<()> {
        self.barrier(vk::PipelineStageFlags2::HOST, &[]);
        // SAFETY: the command buffer is being recorded, outside a rendering.
        unsafe { self.gpu.device().end_command_buffer(self.commands) }
            .map_err(|result| vulkan_error("end a command buffer", result))
    }
}

/// The most that one update of a buffer may write.
const MOST_UPDATED: usize = 65_536;

fn whole(image: &Image) -> vk::BufferImageCopy {
    vk::BufferImageCopy {
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: image.aspect,
            mip_level: 0,
            base_array_layer: 0,
            layer_count: 1,
        },
        image_extent: vk::Extent3D { width: image.size[0], height: image.size[1], depth: 1 },
        ..Default::default()
    }
}

/// A rendering that has been begun.
pub(crate) struct Rendering {
    commands: vk::CommandBuffer,
}

impl Rendering {
    pub(crate) fn draw(&mut self, pipeline: &RasterPipeline, set: &BindingSet, push: &Push, vertices: Range<u32>) {
        pipeline.draw(self.commands, set, push, vertices);
    }
}

/// A debug label around a pass.
pub(crate) struct PassScope<'a> {
    gpu: &'a Gpu,
    commands: vk::CommandBuffer,
}

impl<'a> PassScope<'a> {
    fn new(gpu: &'a Gpu, commands: vk::CommandBuffer, name: &CStr) -> Self {
        if let Some(debug) = &gpu.inner.debug {
            let label = vk::DebugUtilsLabelEXT::default().label_name(name);
            // SAFETY: the command buffer is being recorded; the scope's end closes the label.
            unsafe { debug.cmd_begin_debug_utils_label(commands, &label) };
        }
        Self { gpu, commands }
    }
}

impl Drop for PassScope<'_> {
    fn drop(&mut self) {
        if let Some(debug) = &self.gpu.inner.debug {
            // SAFETY: the label was begun in `new`, in the same command buffer.
            unsafe { debug.cmd_end_debug_utils_label(self.commands) };
        }
    }
}
