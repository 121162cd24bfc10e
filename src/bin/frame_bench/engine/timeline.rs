//! A timeline semaphore, which tells the engine when a bake on its own queue has finished.

use super::{Device, failed};
use ash::vk;
use lightoven::Result;
use std::rc::Rc;

/// A timeline that counts bakes.
pub(crate) struct Timeline {
    device: Rc<Device>,
    pub(super) semaphore: vk::Semaphore,
    /// The last one that was asked for.
    pub(super) value: u64,
    /// The last one that was waited for.
    reached: u64,
}

impl Timeline {
    pub(crate) fn new(device: &Rc<Device>) -> Result<Self> {
        let mut kind = vk::SemaphoreTypeCreateInfo::default().semaphore_type(vk::SemaphoreType::TIMELINE);
        let info = vk::SemaphoreCreateInfo::default().push_next(&mut kind);
        // SAFETY: timelineSemaphore is among what the library asks the device for.
        let semaphore =
            unsafe { device.functions.create_semaphore(&info, None) }.map_err(failed("create a timeline semaphore"))?;
        Ok(Self { device: device.clone(), semaphore, value: 0, reached: 0 })
    }

    /// What has been waited for, for a submission that uses its results: that the host has seen it makes it visible to the
    /// host alone.
    pub(super) fn reached(&self) -> vk::SemaphoreSubmitInfo<'static> {
        let stages = vk::PipelineStageFlags2::ALL_COMMANDS;
        vk::SemaphoreSubmitInfo::default().semaphore(self.semaphore).value(self.reached).stage_mask(stages)
    }

    /// Waits for the last value.
    pub(crate) fn wait(&mut self) -> Result<()> {
        let (semaphores, values) = ([self.semaphore], [self.value]);
        let info = vk::SemaphoreWaitInfo::default().semaphores(&semaphores).values(&values);
        // SAFETY: the semaphore is a timeline, and a submission that signals the value was made.
        unsafe { self.device.functions.wait_semaphores(&info, u64::MAX) }.map_err(failed("wait for the bake"))?;
        self.reached = self.value;
        Ok(())
    }
}

impl Drop for Timeline {
    fn drop(&mut self) {
        // SAFETY: the wait ends what an error left under way.
        unsafe {
            // A lost device has nothing left to do.
            let _ = self.device.functions.device_wait_idle();
            self.device.functions.destroy_semaphore(self.semaphore, None);
        }
    }
}
