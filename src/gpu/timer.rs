//! Timestamps on the device, read without waiting.

use super::{Commands, Gpu, Recorder, vulkan_error};
use crate::error::Result;
use crate::gpu::info::Timestamps;
use ash::vk;
use std::time::Duration;

/// Timestamps of a frame: one before its first dispatch and one after each.
pub(crate) const MARKS: usize = 64;

/// A row of timestamps for each frame that may be under way.
pub(crate) struct Timer {
    gpu: Gpu,
    pool: vk::QueryPool,
    timestamps: Timestamps,
}

impl Timer {
    /// `None`: the queues have no timestamps.
    pub(crate) fn new(gpu: &Gpu, frames: u32) -> Result<Option<Self>> {
        // Frames may run on either queue; their counters need not agree, but each frame's marks are of one queue.
        let (Some(timestamps), Some(other)) = (gpu.queue().timestamps, gpu.compute_queue().timestamps) else {
            return Ok(None);
        };
        let valid_bits = timestamps.valid_bits.min(other.valid_bits);
        let timestamps = Timestamps { valid_bits, ..timestamps };
        let count = frames * MARKS as u32;
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(count);
        // SAFETY: the description is complete.
        let pool = unsafe { gpu.device().create_query_pool(&info, None) }
            .map_err(|result| vulkan_error("create a query pool for timestamps", result))?;
        Ok(Some(Self { gpu: gpu.clone(), pool, timestamps }))
    }

    /// Forgets what a frame's row held. Recorded before its first mark.
    pub(crate) fn reset(&self, recorder: &Recorder<'_>, row: u32) {
        // SAFETY: the row is within the pool, the frame that used it is done, and no rendering is under way.
        unsafe {
            self.gpu.device().cmd_reset_query_pool(recorder.commands(), self.pool, row * MARKS as u32, MARKS as u32);
        }
    }

    /// A timestamp once the last pass recorded is done.
    pub(crate) fn mark(&self, recorder: &Recorder<'_>, row: u32, mark: usize) {
        // Of one stage; before a frame's first pass it is that of the dispatches before.
        let single = recorder.last.as_raw().is_power_of_two();
        let stage = if single { recorder.last } else { vk::PipelineStageFlags2::COMPUTE_SHADER };
        let query = row * MARKS as u32 + mark as u32;
        // SAFETY: the query was reset in the same command buffer and is written once.
        unsafe { self.gpu.device().cmd_write_timestamp2(recorder.commands(), stage, self.pool, query) };
    }

    /// Seconds between a row's first `spans.len() + 1` marks; `false` where one of them is not there or is not valid.
    pub(crate) fn read(&self, row: u32, spans: &mut [f64]) -> bool {
        let mut results = [[0_u64; 2]; MARKS];
        let results = &mut results[..=spans.len()];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WITH_AVAILABILITY;
        let first = row * MARKS as u32;
        // SAFETY: as many queries are read as there is room for, two words each.
        let read = unsafe { self.gpu.device().get_query_pool_results(self.pool, first, results, flags) };
        if read.is_err() || results.iter().any(|[ticks, available]| *available == 0 || *ticks == 0) {
            return false;
        }
        for (span, pair) in spans.iter_mut().zip(results.windows(2)) {
            *span = self.timestamps.seconds(pair[0][0], pair[1][0]);
        }
        // Longer than a minute: the counter was reset, or was never one.
        spans.iter().all(|span| *span < 60.0)
    }
}

impl Drop for Timer {
    fn drop(&mut self) {
        // SAFETY: the frames that wrote to it are done before their baker is dropped.
        unsafe { self.gpu.device().destroy_query_pool(self.pool, None) };
    }
}

/// Times work that is waited for.
pub(crate) struct Stopwatch(Option<Timer>);

impl Stopwatch {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        Ok(Self(Timer::new(gpu, 1)?))
    }

    /// Records, submits and waits; returns how long the device took, or where it has no valid timestamps the time from
    /// submission to completion.
    pub(crate) fn run(&self, commands: &mut Commands, record: impl FnOnce(&mut Recorder<'_>)) -> Result<Duration> {
        let mark = |recorder: &Recorder<'_>, mark| self.0.iter().for_each(|timer| timer.mark(recorder, 0, mark));
        let from_submission = commands.run(|recorder| {
            self.0.iter().for_each(|timer| timer.reset(recorder, 0));
            mark(recorder, 0);
            record(recorder);
            mark(recorder, 1);
            Ok(())
        })?;
        let mut span = [0.0];
        let valid = self.0.as_ref().is_some_and(|timer| timer.read(0, &mut span));
        Ok(if valid { Duration::from_secs_f64(span[0]) } else { from_submission })
    }
}
