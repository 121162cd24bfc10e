//! Records, submits and waits: for set-up, for tools and for tests.

use super::memory::{Buffer, BufferDesc, Image, ImageDesc, Location};
use super::recorder::Recorder;
use super::{Gpu, vulkan_error};
use crate::error::Result;
use ash::vk;
use std::time::{Duration, Instant};

/// A command buffer that is used again and again, each time waited for.
pub(crate) struct Commands {
    gpu: Gpu,
    pool: vk::CommandPool,
    buffer: vk::CommandBuffer,
    fence: vk::Fence,
}

impl Commands {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        let device = gpu.device();
        let context = |result| vulkan_error("create a command buffer", result);
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.queue().family);
        // SAFETY: the family is the queue's.
        let pool = unsafe { device.create_command_pool(&info, None) }.map_err(context)?;
        let mut commands = Self { gpu: gpu.clone(), pool, buffer: vk::CommandBuffer::null(), fence: vk::Fence::null() };
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool was just made.
        commands.buffer = unsafe { device.allocate_command_buffers(&info) }.map_err(context)?[0];
        // SAFETY: a fence needs nothing.
        commands.fence = unsafe { device.create_fence(&vk::FenceCreateInfo::default(), None) }.map_err(context)?;
        Ok(commands)
    }

    /// The device that they run on.
    pub(crate) fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Records, submits and waits; returns the time from submission to completion.
    pub(crate) fn run(&mut self, record: impl FnOnce(&mut Recorder<'_>) -> Result<()>) -> Result<Duration> {
        let device = self.gpu.device();
        let context = |result| vulkan_error("submit commands", result);
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the last run was waited for, so the pool's buffer is not in use.
        unsafe {
            device.reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty()).map_err(context)?;
            device.begin_command_buffer(self.buffer, &begin).map_err(context)?;
        }
        let mut recorder = Recorder::new(&self.gpu, self.buffer);
        record(&mut recorder)?;
        recorder.finish()?;
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.buffer)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&buffers)];
        let started = Instant::now();
        // SAFETY: the buffer is recorded, the fence unsignalled, the queue locked.
        unsafe { device.queue_submit2(*self.gpu.queue().lock(), &submit, self.fence) }.map_err(context)?;
        // SAFETY: the fence is that of the submission. A device that is lost ends the wait.
        unsafe {
            device.wait_for_fences(&[self.fence], true, u64::MAX).map_err(context)?;
            device.reset_fences(&[self.fence]).map_err(context)?;
        }
        Ok(started.elapsed())
    }

    /// A buffer that the device reads, filled.
    pub(crate) fn upload<T: bytemuck::Pod>(&mut self, desc: BufferDesc<'_>, data: &[T]) -> Result<Buffer> {
        let usage = desc.usage | vk::BufferUsageFlags::TRANSFER_DST;
        let buffer = Buffer::new(&self.gpu, BufferDesc { usage, location: Location::Device, ..desc })?;
        if !data.is_empty() {
            let staging = self.staging(data)?;
            let size = size_of_val(data) as u64;
            self.run(|recorder| {
                recorder.copy_buffer(&staging, &buffer, size);
                Ok(())
            })?;
        }
        Ok(buffer)
    }

    /// An image that the device reads, filled with tightly packed pixels, with its mip levels.
    pub(crate) fn upload_image<T: bytemuck::Pod>(&mut self, desc: ImageDesc<'_>, pixels: &[T]) -> Result<Image> {
        let transfers = vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::TRANSFER_SRC;
        let image = Image::new(&self.gpu, ImageDesc { usage: desc.usage | transfers, ..desc })?;
        let staging = self.staging(pixels)?;
        self.run(|recorder| {
            recorder.initialise(&[&image]);
            recorder.copy_to_image(&staging, &image);
            recorder.fill_mip_levels(&image);
            Ok(())
        })?;
        Ok(image)
    }

    /// An image's pixels, tightly packed.
    pub(crate) fn read_image<T: bytemuck::Pod>(&mut self, image: &Image) -> Result<Vec<T>> {
        let pixels = u64::from(image.size[0]) * u64::from(image.size[1]);
        let usage = vk::BufferUsageFlags::TRANSFER_DST;
        let size = pixels * size_of::<T>() as u64;
        let desc = BufferDesc { name: "read back", size, usage, location: Location::ReadBack };
        let buffer = Buffer::new(&self.gpu, desc)?;
        self.run(|recorder| {
            recorder.copy_from_image(image, &buffer);
            Ok(())
        })?;
        Ok(bytemuck::pod_collect_to_vec(&buffer.bytes()[..size as usize]))
    }

    fn staging<T: bytemuck::Pod>(&self, data: &[T]) -> Result<Buffer> {
        let (size, usage) = (size_of_val(data) as u64, vk::BufferUsageFlags::TRANSFER_SRC);
        let mut staging =
            Buffer::new(&self.gpu, BufferDesc { name: "staging", size, usage, location: Location::Upload })?;
        staging.write(data);
        Ok(staging)
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        let device = self.gpu.device();
        // SAFETY: every run was waited for, or the device is lost; null handles are allowed.
        unsafe {
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
        }
    }
}
