//! Frames that overlap: a frame is waited for only when its command buffer is needed again.

use super::draw::Draw;
use super::{Engine, counting};
use ash::vk;
use lightoven::baker::{Baker, FrameId, FrameReport};
use lightoven::gpu::FrameCommands;
use std::time::Duration;

struct Slot {
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    frame: Option<FrameId>,
}

impl Engine {
    /// `count` frames, of which `depth` are under way at once; `before` tells the baker what changes. Returns what each of
    /// them reported.
    pub(crate) fn record_in_flight(
        &self,
        baker: &mut Baker,
        budget: Duration,
        [count, depth]: [usize; 2],
        draw: &mut Draw,
        mut before: impl FnMut(&mut Baker, usize),
    ) -> Vec<FrameReport> {
        let info = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(depth as u32);
        // SAFETY: the pool is the engine's.
        let buffers = unsafe { self.device.allocate_command_buffers(&info) }.unwrap();
        let slot = |commands| {
            // SAFETY: a fence needs nothing.
            let fence = unsafe { self.device.create_fence(&vk::FenceCreateInfo::default(), None) }.unwrap();
            Slot { commands, fence, frame: None }
        };
        let mut slots: Vec<Slot> = buffers.iter().map(|buffer| slot(*buffer)).collect();
        let mut reports = Vec::new();
        for frame in 0..count {
            let slot = &mut slots[frame % depth];
            self.wait_for(slot, baker);
            before(baker, frame);
            let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
            // SAFETY: the slot's last frame was waited for.
            unsafe { self.device.begin_command_buffer(slot.commands, &begin) }.unwrap();
            // SAFETY: the command buffer is being recorded, outside a rendering, and is submitted below, in order.
            let commands = unsafe { FrameCommands::new(slot.commands) };
            let report = counting::frame(|| baker.record(commands, budget)).unwrap();
            draw.record(&self.device, slot.commands, baker.light_map());
            let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(slot.commands)];
            let submit = [vk::SubmitInfo2::default().command_buffer_infos(&buffers)];
            // SAFETY: the commands were begun, the fence is not in use.
            unsafe {
                self.device.end_command_buffer(slot.commands).unwrap();
                self.device.queue_submit2(self.queue.handle, &submit, slot.fence).unwrap();
            }
            slot.frame = Some(report.frame);
            reports.push(report);
        }
        // In the order of the frames.
        slots.rotate_left(count % depth);
        for slot in &mut slots {
            self.wait_for(slot, baker);
            // SAFETY: the slot's frame was waited for.
            unsafe {
                self.device.destroy_fence(slot.fence, None);
                self.device.free_command_buffers(self.pool, &[slot.commands]);
            }
        }
        reports
    }

    fn wait_for(&self, slot: &mut Slot, baker: &mut Baker) {
        let Some(frame) = slot.frame.take() else { return };
        // SAFETY: the fence is that of the slot's submission; afterwards the command buffer is not in use.
        unsafe {
            self.device.wait_for_fences(&[slot.fence], true, u64::MAX).unwrap();
            self.device.reset_fences(&[slot.fence]).unwrap();
            self.device.reset_command_buffer(slot.commands, vk::CommandBufferResetFlags::empty()).unwrap();
        }
        counting::frame(|| baker.complete(frame)).unwrap();
    }
}
