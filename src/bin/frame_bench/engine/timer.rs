//! How long the device took for the raster passes.

use super::{Device, failed};
use ash::vk;
use lightoven::Result;
use std::rc::Rc;
use std::time::Duration;

/// Two timestamps, before and after.
pub(super) struct Timer {
    device: Rc<Device>,
    pool: vk::QueryPool,
}

impl Timer {
    /// `None` where the queue writes no timestamps.
    pub(super) fn new(device: &Rc<Device>) -> Result<Option<Self>> {
        if device.timestamp_bits == 0 {
            return Ok(None);
        }
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2);
        // SAFETY: the description is complete.
        let pool = unsafe { device.functions.create_query_pool(&info, None) }.map_err(failed("create a query pool"))?;
        Ok(Some(Self { device: device.clone(), pool }))
    }

    pub(super) fn start(&self, commands: vk::CommandBuffer) {
        let functions = &self.device.functions;
        // SAFETY: the command buffer is being recorded, outside a rendering; the pool's last results were read.
        unsafe {
            functions.cmd_reset_query_pool(commands, self.pool, 0, 2);
            functions.cmd_write_timestamp2(commands, vk::PipelineStageFlags2::TOP_OF_PIPE, self.pool, 0);
        }
    }

    pub(super) fn stop(&self, commands: vk::CommandBuffer) {
        let stage = vk::PipelineStageFlags2::BOTTOM_OF_PIPE;
        // SAFETY: as in `start`, which reset the query.
        unsafe { self.device.functions.cmd_write_timestamp2(commands, stage, self.pool, 1) };
    }

    /// The time between both, after the commands have been waited for; `None` where they make no sense.
    pub(super) fn read(&self) -> Option<Duration> {
        let mut ticks = [0_u64; 2];
        let flags = vk::QueryResultFlags::TYPE_64;
        // SAFETY: the pool has two queries.
        unsafe { self.device.functions.get_query_pool_results(self.pool, 0, &mut ticks, flags) }.ok()?;
        let mask = u64::MAX >> (64 - self.device.timestamp_bits.min(64));
        let passed = ticks[1].wrapping_sub(ticks[0]) & mask;
        let time = Duration::from_secs_f64(passed as f64 * f64::from(self.device.limits.timestamp_period) * 1e-9);
        (passed > 0 && time < Duration::from_secs(60)).then_some(time)
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        // SAFETY: every frame is waited for, so the device is done with it.
        unsafe { self.device.functions.destroy_query_pool(self.pool, None) };
    }
}
