//! Baking at a stretch.

use super::arguments::{check_result, read, structures};
use super::baker::{LightovenBaker, with};
use super::settings::nanoseconds;
use super::status::{LightovenStatus, Outcome, guard};
use crate::baker::{Baker, Outcome as Ended, Phase, Progress, Stop};
use crate::error::{Error, Result};
use std::ffi::c_void;
use std::ops::ControlFlow;
use std::time::Duration;

/// When a bake ends: at whichever comes first. With nothing set it goes on until its callback ends it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenStop {
    /// sizeof(LightovenStop)
    pub struct_size: usize,
    /// Time from the call, nanoseconds; with `lightoven_baker_bake_until` that of all calls. 0: no limit.
    pub time_ns: u64,
    /// Rays a texel; rounded up to a multiple of 64, at most 2^30. 0: no limit.
    pub samples: u32,
    /// Estimated relative error of the irradiance, the root of relMSE, more than 0. 0: no limit.
    pub error: f32,
}

/// What a bake is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenPhase {
    /// Scene, hierarchy, g-buffer.
    Preparing = 0,
    /// Finding out how light is reflected.
    Bounces = 1,
    /// Collecting samples.
    Samples = 2,
}

/// How far a bake is.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenProgress {
    /// sizeof(LightovenProgress)
    pub struct_size: usize,
    /// Rays traced.
    pub rays: u64,
    /// Samples of a texel, in the mean.
    pub samples_per_texel: u64,
    /// Time since the call, or that of all calls, as the stop's time counts; nanoseconds.
    pub elapsed_ns: u64,
    /// Time to the stop at the rate so far, nanoseconds; the largest number while it cannot be told.
    pub time_left_ns: u64,
    /// Million rays a second of baking.
    pub mrays_per_s: f64,
    /// How far it is on the way to the stop, 0 to 1.
    pub fraction: f32,
    /// Root of relMSE as it is estimated; below 0: not known yet.
    pub estimated_error: f32,
    /// A LightovenPhase.
    pub phase: u32,
    /// Epochs finished.
    pub epoch: u32,
}

/// Called between slices of a bake, on the thread that bakes. `progress` is valid within the call, `user` is what
/// `lightoven_baker_bake` was given. 0: the bake goes on; else it ends, and keeps what it has. It returns: no exception and no
/// longjmp leaves it.
pub type LightovenProgressCallback =
    Option<unsafe extern "C" fn(progress: *const LightovenProgress, user: *mut c_void) -> i32>;

/// How a bake ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenEnd {
    /// The stop was reached.
    Finished = 0,
    /// The callback ended it.
    Interrupted = 1,
}

structures!(LightovenStop = [24], LightovenProgress = [64]);

/// Bakes a scene that stays as it is until `stop`, or until `callback` ends it; a later call goes on from there.
///
/// `stop`: not NULL. `callback`: NULL for none. `user`: passed to it. `end`: set to a LightovenEnd where the call succeeds, or
/// NULL. INVALID_SETTINGS for a stop outside its range, and for one without any limit and without a callback, which would never
/// end.
///
/// # Safety
/// `stop` is as its members say; `callback` may be called with `user`; `end` is NULL or may be written; nobody else uses the
/// device's queues meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_bake(
    baker: LightovenBaker,
    stop: *const LightovenStop,
    callback: LightovenProgressCallback,
    user: *mut c_void,
    end: *mut u32,
) -> LightovenStatus {
    // SAFETY: the same contract.
    guard(|| unsafe { bake(baker, Baker::bake, stop, callback, user, end) })
}

/// `lightoven_baker_bake` for one that looks at the light map on the way, the samples being those of a bake at a stretch: the
/// stop's time is what all calls take together, the clock stands still between them, and nothing is said of bounces that are
/// missing, for the bake goes on.
///
/// # Safety
/// As `lightoven_baker_bake`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_bake_until(
    baker: LightovenBaker,
    stop: *const LightovenStop,
    callback: LightovenProgressCallback,
    user: *mut c_void,
    end: *mut u32,
) -> LightovenStatus {
    // SAFETY: the same contract.
    guard(|| unsafe { bake(baker, Baker::bake_until, stop, callback, user, end) })
}

/// What bakes: [`Baker::bake`] or [`Baker::bake_until`].
type Way = fn(&mut Baker, &Stop, &mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<Ended>;

/// # Safety
/// As [`lightoven_baker_bake`].
unsafe fn bake(
    baker: LightovenBaker,
    way: Way,
    stop: *const LightovenStop,
    callback: LightovenProgressCallback,
    user: *mut c_void,
    end: *mut u32,
) -> Outcome {
    if !end.is_null() {
        check_result(end, "the end's place")?;
    }
    // SAFETY: as its members say, by the caller's word.
    let stop = limits(unsafe { read(stop, "the stop")? }, callback)?;
    let mut report = |progress: &Progress| {
        let told = told(progress);
        // SAFETY: it may be called so by the caller's word.
        let ends = callback.is_some_and(|callback| unsafe { callback(&raw const told, user) } != 0);
        if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let ended = match with(baker, |held| Ok(way(&mut held.baker, &stop, &mut report)?))? {
        Ended::Finished => LightovenEnd::Finished,
        Ended::Interrupted => LightovenEnd::Interrupted,
    };
    if !end.is_null() {
        // SAFETY: it may be written by the caller's word.
        unsafe { end.write(ended as u32) };
    }
    Ok(())
}

fn limits(stop: LightovenStop, callback: LightovenProgressCallback) -> Outcome<Stop> {
    let limits = Stop {
        samples: (stop.samples != 0).then_some(stop.samples),
        error: (stop.error != 0.0).then_some(stop.error),
        time: (stop.time_ns != 0).then(|| Duration::from_nanos(stop.time_ns)),
    };
    if limits == Stop::default() && callback.is_none() {
        let text = "the stop has no limit, and there is no callback: the bake would never end";
        return Err(Error::settings(text).into());
    }
    Ok(limits)
}

fn told(progress: &Progress) -> LightovenProgress {
    let phase = match progress.phase {
        Phase::Preparing => LightovenPhase::Preparing,
        Phase::Bounces => LightovenPhase::Bounces,
        Phase::Samples => LightovenPhase::Samples,
    };
    LightovenProgress {
        struct_size: size_of::<LightovenProgress>(),
        rays: progress.rays,
        samples_per_texel: progress.samples_per_texel,
        elapsed_ns: nanoseconds(progress.elapsed),
        time_left_ns: progress.time_left.map_or(u64::MAX, nanoseconds),
        mrays_per_s: progress.mrays_per_s,
        fraction: progress.fraction,
        estimated_error: progress.estimated_error.unwrap_or(-1.0),
        phase: phase as u32,
        epoch: progress.epoch,
    }
}
