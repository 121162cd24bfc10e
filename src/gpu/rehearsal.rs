//! The device as an engine would lend it, and as it is when it is lost: for `verify`, which plays the engine.

use super::Gpu;
use crate::error::Result;
use ash::vk;
use std::cell::Cell;

thread_local! {
    /// What really submits, and how often it does so before the device is lost.
    static SUBMISSIONS: Cell<Option<(vk::PFN_vkQueueSubmit2, u32)>> = const { Cell::new(None) };
}

impl Gpu {
    /// The same device, as if it were an engine's, with memory of its own.
    pub(crate) fn as_of_an_engine(&self) -> Result<Self> {
        self.lent(self.device().clone())
    }

    /// The same for a device that takes so many more submissions and is then lost, as far as can be told from here: the
    /// real one is as it was. One at a time, on this thread.
    pub(crate) fn as_lost_after(&self, submissions: u32) -> Result<Self> {
        let device = self.device();
        let mut functions = device.fp_v1_3().clone();
        SUBMISSIONS.set(Some((functions.queue_submit2, submissions)));
        functions.queue_submit2 = submit;
        let (first, second, third) = (device.fp_v1_0().clone(), device.fp_v1_1().clone(), device.fp_v1_2().clone());
        self.lent(ash::Device::from_parts_1_3(device.handle(), first, second, third, functions))
    }

    /// The device of [`Gpu::as_lost_after`] is lost after so many more.
    pub(crate) fn lose_after(&self, submissions: u32) {
        SUBMISSIONS.set(SUBMISSIONS.get().map(|(really, _)| (really, submissions)));
    }
}

unsafe extern "system" fn submit(
    queue: vk::Queue,
    count: u32,
    submissions: *const vk::SubmitInfo2<'_>,
    fence: vk::Fence,
) -> vk::Result {
    match SUBMISSIONS.get() {
        Some((really, left @ 1..)) => {
            SUBMISSIONS.set(Some((really, left - 1)));
            // SAFETY: as the caller has it; the function is the device's own.
            unsafe { really(queue, count, submissions, fence) }
        }
        _ => vk::Result::ERROR_DEVICE_LOST,
    }
}
