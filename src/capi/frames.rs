//! Baking within an engine's frames.

use super::arguments::{check_result, choose, each, structures, write_wanted};
use super::baker::{Held, LightovenBaker, with};
use super::settings::{LightovenMeasure, nanoseconds};
use super::status::{Failure, LightovenStatus, Outcome, guard};
use super::vulkan::{VkCommandBuffer, VkSemaphore};
use crate::baker::{FrameId, FrameReport, Learning, MeasuredBy};
use crate::gpu::{FrameCommands, TimelinePoint};
use ash::vk::Handle;
use std::time::Duration;

/// The passes of a frame, bits of `LightovenFrameReport::ran`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenRan {
    /// Transforms, lights, emission or sky were written.
    Update = 1,
    /// The top level of the hierarchy was built anew.
    TopLevel = 2,
    /// Light from analytic lights.
    Direct = 4,
    /// Rays.
    Bake = 8,
    /// Outgoing radiance of texels.
    Source = 16,
    /// A light map was written, or a part of one.
    Publish = 32,
    /// What rays are aimed by was made anew, or a part of it.
    Importance = 64,
}

/// What a frame was given to do.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenFrameReport {
    /// sizeof(LightovenFrameReport)
    pub struct_size: usize,
    /// The frame, numbered from 1, to be reported complete.
    pub frame: u64,
    /// Rays of gathering.
    pub rays: u64,
    /// Rays a texel, over all texels that take rays: a fraction where tiles take turns.
    pub samples_per_texel: f64,
    /// How long the cost model expects it to take, nanoseconds.
    pub predicted_ns: u64,
    /// How long the least that is dispatched is expected to take, nanoseconds.
    pub one_unit_ns: u64,
    /// Sweeps over all texels finished so far.
    pub sweeps: u64,
    /// Bits of LightovenRan: the passes that were recorded.
    pub ran: u32,
    /// Dispatches of direct light, rays, outgoing radiance and light maps.
    pub dispatches: u32,
    /// 1: old light leaves the running average, because something has changed lately; else 0.
    pub decaying: u32,
    /// 1: nothing was recorded, since as many frames as may be in flight had not been reported complete; else 0.
    pub held_up: u32,
}

/// How long a frame took.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenFrameTiming {
    /// sizeof(LightovenFrameTiming)
    pub struct_size: usize,
    /// The frame.
    pub frame: u64,
    /// Time of the baker's work on the device, nanoseconds.
    pub bake_ns: u64,
    /// A LightovenMeasure. Nothing: the frame had nothing to do or was reported before, and the time is 0.
    pub measured_by: u32,
    /// 1: a pipeline ran for the first time, and the driver may have compiled it within the frame; else 0.
    pub first_use: u32,
}

/// A value of a timeline semaphore.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenTimelinePoint {
    /// sizeof(LightovenTimelinePoint)
    pub struct_size: usize,
    /// A timeline semaphore of the device.
    pub semaphore: VkSemaphore,
    /// The value to wait for, or to signal.
    pub value: u64,
}

structures!(LightovenFrameReport = [72], LightovenFrameTiming = [32], LightovenTimelinePoint = [24]);

const NOT_MEASURED: LightovenFrameTiming = LightovenFrameTiming {
    struct_size: size_of::<LightovenFrameTiming>(),
    frame: 0,
    bake_ns: 0,
    measured_by: LightovenMeasure::Nothing as u32,
    first_use: 0,
};

fn told(report: &FrameReport) -> LightovenFrameReport {
    LightovenFrameReport {
        struct_size: size_of::<LightovenFrameReport>(),
        frame: report.frame.0,
        rays: report.rays,
        samples_per_texel: report.samples_per_texel,
        predicted_ns: nanoseconds(report.predicted),
        one_unit_ns: nanoseconds(report.one_unit),
        sweeps: report.sweeps,
        ran: report.ran.bits(),
        dispatches: report.dispatches,
        decaying: u32::from(report.decaying),
        held_up: u32::from(report.held_up),
    }
}

/// Records a frame's work into the engine's command buffer: about as much as the device does in `budget_ns`, and nothing for 0.
/// What the engine records afterwards sees the map that `lightoven_baker_light_map` then gives; drawing that reads it elsewhere
/// than in fragment or compute shaders needs a barrier of its own. `report`: filled in, its `struct_size` set before, or NULL.
///
/// INVALID_SETTINGS after `lightoven_baker_submit`: a baker stays with one of the two. After UNSUPPORTED or DRIVER from the device
/// the baker can only be destroyed.
///
/// # Safety
/// - The command buffer is primary, of the family of `LightovenGpuDesc::queue`, being recorded, and outside a rendering.
/// - Command buffers that one baker recorded into are submitted to that queue once each, in the order of recording. One that is
///   thrown away takes its frame with it: the baker is then to be made anew.
/// - `report` is NULL or may be written.
///
/// Afterwards pipeline, descriptor sets and push constants are others than before; nothing else is changed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_record(
    baker: LightovenBaker,
    commands: VkCommandBuffer,
    budget_ns: u64,
    report: *mut LightovenFrameReport,
) -> LightovenStatus {
    guard(|| {
        if commands.is_null() {
            return Err(Failure::argument("the command buffer is VK_NULL_HANDLE"));
        }
        with(baker, |held| {
            // A report that is refused is refused before anything is recorded.
            // SAFETY: it may be written by the caller's word.
            unsafe { write_wanted(report, "the report", &told(&FrameReport::default()))? };
            // SAFETY: the command buffer is as it has to be by the caller's word.
            let commands = unsafe { FrameCommands::new(commands) };
            let done = held.baker.record(commands, Duration::from_nanos(budget_ns))?;
            // SAFETY: as above.
            unsafe { write_wanted(report, "the report", &told(&done)) }
        })
    })
}

/// Submits a frame's work to the queue for compute: about as much as the device does in `budget_ns`, and nothing for 0. It
/// begins when all of `wait` are reached; all of `signal` follow it, even where there was nothing to do. A map that it finishes is
/// given once the frame has been reported complete; a submission that uses the map waits for the frame's `signal`.
///
/// `wait`, `signal`: `[wait_count]` and `[signal_count]`, NULL where the count is 0; at most 2^32 - 1 each. `report`: filled in, its
/// `struct_size` set before, or NULL. INVALID_SETTINGS after `lightoven_baker_record`. After DEVICE_LOST, OUT_OF_MEMORY or DRIVER
/// from the device the baker can only be destroyed.
///
/// # Safety
/// The semaphores are timeline semaphores of the device and live until the submission is done; a value to wait for is signalled at
/// some time, a value to signal is larger than the semaphore's then. Nobody else uses the queue meanwhile. `report` is NULL or may
/// be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_submit(
    baker: LightovenBaker,
    budget_ns: u64,
    wait: *const LightovenTimelinePoint,
    wait_count: usize,
    signal: *const LightovenTimelinePoint,
    signal_count: usize,
    report: *mut LightovenFrameReport,
) -> LightovenStatus {
    guard(|| {
        with(baker, |held| {
            let Held { baker, points: [waits, signals], .. } = held;
            // SAFETY: the lists are there, and the report may be written, by the caller's word.
            unsafe {
                points(waits, wait, wait_count, "point to wait for")?;
                points(signals, signal, signal_count, "point to signal")?;
                write_wanted(report, "the report", &told(&FrameReport::default()))?;
            }
            let done = baker.submit(Duration::from_nanos(budget_ns), waits, signals)?;
            // SAFETY: as above.
            unsafe { write_wanted(report, "the report", &told(&done)) }
        })
    })
}

/// # Safety
/// `first` is NULL or points to `count` points, whose semaphores are as `TimelinePoint::new` asks for.
unsafe fn points(
    kept: &mut Vec<TimelinePoint>,
    first: *const LightovenTimelinePoint,
    count: usize,
    what: &str,
) -> Outcome {
    kept.clear();
    // SAFETY: the caller's word, passed on.
    unsafe {
        each(first, count, what, |index, point| {
            if point.semaphore.is_null() {
                return Err(Failure::argument(format!("the semaphore of {what} {index} is VK_NULL_HANDLE")));
            }
            kept.push(TimelinePoint::new(point.semaphore, point.value));
            Ok(())
        })
    }
}

/// The engine reports: this frame and all before it have finished on the device, with all that used a light map in them.
/// `timing`: filled in, its `struct_size` set before, or NULL.
///
/// # Safety
/// They have; `timing` is NULL or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_complete(
    baker: LightovenBaker,
    frame: u64,
    timing: *mut LightovenFrameTiming,
) -> LightovenStatus {
    guard(|| {
        // A timing that is refused is refused before the frame is complete.
        // SAFETY: it may be written by the caller's word.
        unsafe { write_wanted(timing, "the timing", &NOT_MEASURED)? };
        let taken = with(baker, |held| Ok(held.baker.complete(FrameId(frame))?))?;
        let measured_by = taken.map_or(LightovenMeasure::Nothing, |taken| match taken.measured_by {
            MeasuredBy::Timestamps => LightovenMeasure::Timestamps,
            MeasuredBy::Host => LightovenMeasure::Host,
        });
        let filled = LightovenFrameTiming {
            frame,
            bake_ns: taken.map_or(0, |taken| nanoseconds(taken.bake)),
            measured_by: measured_by as u32,
            first_use: u32::from(taken.is_some_and(|taken| taken.first_use)),
            ..NOT_MEASURED
        };
        // SAFETY: it may be written by the caller's word.
        unsafe { write_wanted(timing, "the timing", &filled) }
    })
}

/// The time of the next frame, nanoseconds from any beginning, with LIGHTOVEN_CLOCK_ENGINE. Time that runs backwards stands still.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_baker_set_time(baker: LightovenBaker, now_ns: u64) -> LightovenStatus {
    guard(|| with(baker, |held| Ok(held.baker.set_time(Duration::from_nanos(now_ns))?)))
}

/// Whether the cost model goes on learning from what frames take. `learns`: 1, the default, for budgets that are kept; 0 for equal work with
/// equal budgets, whatever that takes.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_baker_set_learning(baker: LightovenBaker, learns: u32) -> LightovenStatus {
    guard(|| {
        let learning = choose(learns, "learning", &[Learning::Held, Learning::On])?;
        with(baker, |held| Ok(held.baker.set_learning(learning)?))
    })
}

/// Rays that a frame of this budget has for each texel, as far as is known. `samples`: not NULL; 0 for a scene that stays as it is.
///
/// # Safety
/// `samples` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_samples_per_texel(
    baker: LightovenBaker,
    budget_ns: u64,
    samples: *mut f64,
) -> LightovenStatus {
    guard(|| {
        check_result(samples, "the samples' place")?;
        let known = with(baker, |held| Ok(held.baker.samples_per_texel(Duration::from_nanos(budget_ns))))?;
        // SAFETY: it may be written by the caller's word.
        unsafe { samples.write(known) };
        Ok(())
    })
}
