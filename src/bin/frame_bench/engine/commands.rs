//! The engine's command buffer: one frame is recorded, submitted and waited for at a time, since that is what is timed.

use super::timeline::Timeline;
use super::{Device, failed};
use ash::vk;
use lightoven::Result;
use std::rc::Rc;

/// A command buffer that is used again and again.
pub(crate) struct Commands {
    device: Rc<Device>,
    pool: vk::CommandPool,
    pub(super) buffer: vk::CommandBuffer,
    fence: vk::Fence,
}

impl Commands {
    pub(crate) fn new(device: &Rc<Device>) -> Result<Self> {
        let functions = &device.functions;
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.queue.family);
        // SAFETY: the family is the queue's.
        let pool = unsafe { functions.create_command_pool(&info, None) }.map_err(failed("create a command pool"))?;
        let (buffer, fence) = (vk::CommandBuffer::null(), vk::Fence::null());
        let mut commands = Self { device: device.clone(), pool, buffer, fence };
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool was just made.
        let buffers = unsafe { functions.allocate_command_buffers(&info) };
        commands.buffer = buffers.map_err(failed("create a command buffer"))?[0];
        // SAFETY: a fence needs nothing.
        let fence = unsafe { functions.create_fence(&vk::FenceCreateInfo::default(), None) };
        commands.fence = fence.map_err(failed("create a fence"))?;
        Ok(commands)
    }

    /// Begins to record; whatever was submitted has been waited for.
    pub(crate) fn begin(&mut self) -> Result<()> {
        let functions = &self.device.functions;
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: `finish` waited, so the pool's buffer is not in use.
        unsafe {
            functions
                .reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .and_then(|()| functions.begin_command_buffer(self.buffer, &info))
        }
        .map_err(failed("begin a command buffer"))
    }

    /// Submits what was recorded, to begin after what the timeline has reached, without waiting.
    pub(crate) fn submit(&mut self, after: Option<&Timeline>) -> Result<()> {
        let functions = &self.device.functions;
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.buffer)];
        let waits: Vec<_> = after.iter().map(|timeline| timeline.reached()).collect();
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&buffers).wait_semaphore_infos(&waits)];
        // SAFETY: the buffer is being recorded and complete, the fence unsignalled; this thread alone uses the queue.
        unsafe {
            functions
                .end_command_buffer(self.buffer)
                .and_then(|()| functions.queue_submit2(self.device.queue.handle, &submit, self.fence))
        }
        .map_err(failed("submit a frame"))
    }

    /// Waits for what was submitted.
    pub(crate) fn wait(&mut self) -> Result<()> {
        let functions = &self.device.functions;
        // SAFETY: the fence is that of the last submission. A device that is lost ends the wait.
        unsafe {
            functions
                .wait_for_fences(&[self.fence], true, u64::MAX)
                .and_then(|()| functions.reset_fences(&[self.fence]))
        }
        .map_err(failed("wait for a frame"))
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        let functions = &self.device.functions;
        // SAFETY: the wait ends what an error left under way; null handles are allowed.
        unsafe {
            // A lost device has nothing left to do.
            let _ = functions.device_wait_idle();
            functions.destroy_fence(self.fence, None);
            functions.destroy_command_pool(self.pool, None);
        }
    }
}
