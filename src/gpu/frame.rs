//! Frames: the engine's command buffer to record into, or one of our own to submit.

use super::{Gpu, Recorder, vulkan_error};
use crate::error::Result;
use ash::vk;

/// A command buffer of the engine's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameCommands(pub(super) vk::CommandBuffer);

impl FrameCommands {
    /// # Safety
    /// - The command buffer is primary, of the queue family of [`super::RawDevice::queue`], being recorded, and outside a
    ///   rendering.
    /// - It is so until `Baker::record` returns, and the value is used for no other command buffer.
    /// - Command buffers that one baker recorded into are submitted to that queue once each, in the order of recording. One
    ///   that is thrown away takes its frame with it: the baker is then to be made anew.
    ///
    /// Afterwards pipeline, descriptor sets and push constants are others than before; nothing else is changed.
    pub unsafe fn new(commands: vk::CommandBuffer) -> Self {
        Self(commands)
    }
}

/// A value of a timeline semaphore.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimelinePoint {
    semaphore: vk::Semaphore,
    value: u64,
}

impl TimelinePoint {
    /// # Safety
    /// The semaphore is a timeline semaphore of the device and lives until the submission that it is given to is done.
    /// A value to wait for is signalled at some time; a value to signal is larger than the semaphore's value then.
    pub unsafe fn new(semaphore: vk::Semaphore, value: u64) -> Self {
        Self { semaphore, value }
    }

    fn info(&self, stages: vk::PipelineStageFlags2) -> vk::SemaphoreSubmitInfo<'static> {
        vk::SemaphoreSubmitInfo::default().semaphore(self.semaphore).value(self.value).stage_mask(stages)
    }
}

/// Command buffers of our own, one for each frame that may be under way.
pub(crate) struct FrameSubmitter {
    gpu: Gpu,
    buffers: Vec<(vk::CommandPool, vk::CommandBuffer)>,
    waits: Vec<vk::SemaphoreSubmitInfo<'static>>,
    signals: Vec<vk::SemaphoreSubmitInfo<'static>>,
}

impl FrameSubmitter {
    pub(crate) fn new(gpu: &Gpu, frames: u32) -> Result<Self> {
        let context = |result| vulkan_error("create a frame's command buffer", result);
        let mut submitter = Self { gpu: gpu.clone(), buffers: Vec::new(), waits: Vec::new(), signals: Vec::new() };
        for _ in 0..frames {
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.compute_queue().family);
            // SAFETY: the family is the queue's.
            let pool = unsafe { gpu.device().create_command_pool(&info, None) }.map_err(context)?;
            submitter.buffers.push((pool, vk::CommandBuffer::null()));
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            // SAFETY: the pool was just made.
            let buffers = unsafe { gpu.device().allocate_command_buffers(&info) }.map_err(context)?;
            if let Some(last) = submitter.buffers.last_mut() {
                last.1 = buffers[0];
            }
        }
        Ok(submitter)
    }

    /// A row's command buffer, begun. The frame that used it before is done.
    pub(crate) fn begin(&self, row: u32) -> Result<FrameCommands> {
        let context = |result| vulkan_error("begin a frame's command buffer", result);
        let (pool, buffer) = self.buffers[row as usize];
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the frame that used the pool's buffer has been reported complete.
        unsafe {
            self.gpu.device().reset_command_pool(pool, vk::CommandPoolResetFlags::empty()).map_err(context)?;
            self.gpu.device().begin_command_buffer(buffer, &begin).map_err(context)?;
        }
        Ok(FrameCommands(buffer))
    }

    /// Submits what was recorded, or nothing, between waits and signals. Does not wait.
    pub(crate) fn submit(
        &mut self,
        commands: Option<FrameCommands>,
        wait: &[TimelinePoint],
        signal: &[TimelinePoint],
    ) -> Result<()> {
        let context = |result| vulkan_error("submit a frame", result);
        if let Some(FrameCommands(buffer)) = commands {
            // SAFETY: the buffer was begun by `begin` and is outside a rendering.
            unsafe { self.gpu.device().end_command_buffer(buffer) }.map_err(context)?;
        }
        let stages = vk::PipelineStageFlags2::ALL_COMMANDS;
        self.waits.clear();
        self.waits.extend(wait.iter().map(|point| point.info(stages)));
        self.signals.clear();
        self.signals.extend(signal.iter().map(|point| point.info(stages)));
        let buffer = commands.map_or(vk::CommandBuffer::null(), |FrameCommands(buffer)| buffer);
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(buffer)];
        let submit = [vk::SubmitInfo2::default()
            .wait_semaphore_infos(&self.waits)
            .signal_semaphore_infos(&self.signals)
            .command_buffer_infos(&buffers[..usize::from(commands.is_some())])];
        let queue = self.gpu.compute_queue().lock();
        // SAFETY: the buffer is recorded, the semaphores are what `TimelinePoint::new` asks for, the queue is locked.
        unsafe { self.gpu.device().queue_submit2(*queue, &submit, vk::Fence::null()) }.map_err(context)
    }
}

impl Drop for FrameSubmitter {
    fn drop(&mut self) {
        for (pool, _) in &self.buffers {
            // SAFETY: every frame has been reported complete, by the contract of the baker's drop.
            unsafe { self.gpu.device().destroy_command_pool(*pool, None) };
        }
    }
}

impl<'a> Recorder<'a> {
    /// Records into a frame. Waits for work of the kinds that a baker does, not for the engine's drawing: what the engine
    /// still reads is not written.
    pub(crate) fn frame(gpu: &'a Gpu, commands: FrameCommands) -> Self {
        Self::after(gpu, commands.0, Self::frame_stages(gpu))
    }

    /// What is being recorded, for a frame within it.
    pub(crate) fn frame_commands(&self) -> FrameCommands {
        FrameCommands(self.commands())
    }

    /// Makes the light map visible to fragment and compute shaders and to copies that the engine records next. Narrow, so
    /// that its shadow maps need not wait.
    pub(crate) fn publish(&mut self) {
        let readers = vk::PipelineStageFlags2::FRAGMENT_SHADER
            | vk::PipelineStageFlags2::COMPUTE_SHADER
            | vk::PipelineStageFlags2::ALL_TRANSFER;
        self.barrier(readers, &[]);
        // What follows of our own does not wait for the engine's drawing.
        self.last = Self::frame_stages(self.gpu);
    }
}
