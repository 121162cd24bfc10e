//! How to bake.

use super::arguments::{check_reserved, check_result, choose, read, structures, write};
use super::scene::{LightovenScene, scene_of};
use super::status::{LightovenStatus, Outcome, guard};
use crate::baker::{
    AimedBy, BakeSettings, Bounces, Clock, ErrorEstimate, FrameSettings, Mode, Sampling, Slice, Timing, estimate_memory,
};
use crate::scene::Resolution;
use std::time::Duration;

/// Which way rays are sent. Whichever it is, the light map is the same but for its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenSampling {
    /// As it pays.
    Auto = 0,
    /// By the cosine alone.
    Cosine = 1,
    /// Toward what shines alone; for comparisons.
    Importance = 2,
    /// Both: `cosine_share` of the rays by the cosine.
    Mixture = 3,
}

/// By what aimed rays choose where they go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenAimedBy {
    /// Luminance times area alone.
    Power = 0,
    /// And distance, and the cosines at both ends.
    Distance = 1,
    /// And what earlier rays have shown to be visible. The default.
    Visibility = 2,
}

/// What is told of the error of a bake at a stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenErrorEstimate {
    /// Nothing; a bake cannot end by it.
    None = 0,
    /// Its estimate. The default.
    Told = 1,
    /// And where a bake ends by it, texels that have converged stop before the others.
    Adaptive = 2,
}

/// `LightovenBakeSettings::bounces`: as many as there are.
pub const LIGHTOVEN_ALL_BOUNCES: u32 = u32::MAX;
/// `LightovenFrameSettings::tolerable_latency_ns`: old light never leaves.
pub const LIGHTOVEN_NEVER: u64 = u64::MAX;

/// How a baker behaves that works within an engine's frames. `lightoven_frame_settings_default` fills it in.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenFrameSettings {
    /// sizeof(LightovenFrameSettings)
    pub struct_size: usize,
    /// After so long `decay_threshold` of the old light is left, nanoseconds; default half a second.
    pub tolerable_latency_ns: u64,
    /// Between 0 and 1, both excluded; default .1.
    pub decay_threshold: f64,
    /// Frames that may be recorded before the oldest of them is reported complete; 1 to 8, default 3.
    pub frames_in_flight: u32,
    /// A LightovenClock; default wall.
    pub clock: u32,
    /// A LightovenMeasure for the cost model: timestamps (the default) or host.
    pub measured_by: u32,
    /// Rays of a visit to a texel, in quanta of 16; 1 to 64. 0, the default: 1, and more where a frame has time for more.
    pub quanta: u32,
}

/// Which time the running average goes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenClock {
    /// Time as it passes.
    Wall = 0,
    /// What `lightoven_baker_set_time` says.
    Engine = 1,
}

/// What tells how long a frame took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenMeasure {
    /// Timestamps of the device; where it has none the host's clock.
    Timestamps = 0,
    /// The host's clock.
    Host = 1,
    /// Nothing, in a LightovenFrameTiming: the frame had nothing to do, or was reported complete before.
    Nothing = 2,
}

/// How to bake. `lightoven_bake_settings_default` fills it in.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenBakeSettings {
    /// sizeof(LightovenBakeSettings)
    pub struct_size: usize,
    /// Another seed gives other noise; default 0.
    pub seed: u64,
    /// How long one submission of a bake at a stretch may take, nanoseconds; default 50 ms. 0: the least that can be submitted.
    pub slice_ns: u64,
    /// NULL, the default: the scene stays as it is, and `lightoven_baker_bake` bakes it. Else it changes, and
    /// `lightoven_baker_record` or `lightoven_baker_submit` work within an engine's frames.
    pub frames: *const LightovenFrameSettings,
    /// Side of the light map in texels, 1 to 16384, where `texels_per_unit` is 0; default 512.
    pub resolution: u32,
    /// Texels for one scene unit of length; default 0: as `resolution` says.
    pub texels_per_unit: f32,
    /// How many times light is reflected: 0 to 16384, or LIGHTOVEN_ALL_BOUNCES, the default, which frames insist on, and which
    /// ends where the next one adds nothing to speak of. Of a number all are done: each costs a pass over the light map.
    pub bounces: u32,
    /// A LightovenSampling; default auto.
    pub sampling: u32,
    /// Share of rays by the cosine in a mixture, .1 to 1; default .5. Else not looked at.
    pub cosine_share: f32,
    /// A LightovenAimedBy; default visibility.
    pub aimed_by: u32,
    /// A LightovenErrorEstimate; default told.
    pub error: u32,
    /// 0.
    pub reserved: u32,
}

structures!(LightovenFrameSettings = [40], LightovenBakeSettings = [64]);

/// Fills in the defaults. `settings`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `settings` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_bake_settings_default(settings: *mut LightovenBakeSettings) -> LightovenStatus {
    let default = LightovenBakeSettings {
        struct_size: size_of::<LightovenBakeSettings>(),
        seed: 0,
        slice_ns: 50_000_000,
        frames: std::ptr::null(),
        resolution: 512,
        texels_per_unit: 0.0,
        bounces: LIGHTOVEN_ALL_BOUNCES,
        sampling: LightovenSampling::Auto as u32,
        cosine_share: 0.5,
        aimed_by: LightovenAimedBy::Visibility as u32,
        error: LightovenErrorEstimate::Told as u32,
        reserved: 0,
    };
    // SAFETY: it may be written by the caller's word.
    guard(|| unsafe { write(settings, "the settings", &default) })
}

/// Fills in the defaults. `settings`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `settings` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_frame_settings_default(settings: *mut LightovenFrameSettings) -> LightovenStatus {
    let FrameSettings { tolerable_latency, decay_threshold, frames_in_flight, .. } = FrameSettings::default();
    let default = LightovenFrameSettings {
        struct_size: size_of::<LightovenFrameSettings>(),
        tolerable_latency_ns: nanoseconds(tolerable_latency),
        decay_threshold,
        frames_in_flight,
        clock: LightovenClock::Wall as u32,
        measured_by: LightovenMeasure::Timestamps as u32,
        quanta: 0,
    };
    // SAFETY: it may be written by the caller's word.
    guard(|| unsafe { write(settings, "the settings", &default) })
}

/// As many as fit.
pub(super) fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// # Safety
/// `settings` is NULL or as its members say; NULL stands for the defaults.
pub(super) unsafe fn bake_settings(settings: *const LightovenBakeSettings) -> Outcome<BakeSettings> {
    if settings.is_null() {
        return Ok(BakeSettings::default());
    }
    // SAFETY: the caller's word, passed on.
    let (settings, mode) = unsafe {
        let settings = read(settings, "the settings")?;
        (settings, mode(settings.frames)?)
    };
    check_reserved(settings.reserved, "the settings")?;
    let resolution = if settings.texels_per_unit == 0.0 {
        Resolution::Texels(settings.resolution)
    } else {
        Resolution::PerUnit(settings.texels_per_unit)
    };
    let mixture = Sampling::Mixture { cosine: settings.cosine_share };
    let samplings = [Sampling::Auto, Sampling::Cosine, Sampling::Importance, mixture];
    let errors = [ErrorEstimate::None, ErrorEstimate::Told, ErrorEstimate::Adaptive];
    Ok(BakeSettings {
        resolution,
        bounces: match settings.bounces {
            LIGHTOVEN_ALL_BOUNCES => Bounces::Auto,
            limit => Bounces::Limit(limit),
        },
        sampling: choose(settings.sampling, "the sampling", &samplings)?,
        aimed_by: choose(
            settings.aimed_by,
            "what aimed rays go by",
            &[AimedBy::Power, AimedBy::Distance, AimedBy::Visibility],
        )?,
        error: choose(settings.error, "the error estimate", &errors)?,
        seed: settings.seed,
        slice: Slice::Time(Duration::from_nanos(settings.slice_ns)),
        mode,
        ..BakeSettings::default()
    })
}

/// # Safety
/// `frames` is NULL or as its members say.
unsafe fn mode(frames: *const LightovenFrameSettings) -> Outcome<Mode> {
    if frames.is_null() {
        return Ok(Mode::Still);
    }
    // SAFETY: the caller's word, passed on.
    let frames = unsafe { read(frames, "the settings of frames")? };
    Ok(Mode::Frames(FrameSettings {
        tolerable_latency: match frames.tolerable_latency_ns {
            LIGHTOVEN_NEVER => Duration::MAX,
            latency => Duration::from_nanos(latency),
        },
        decay_threshold: frames.decay_threshold,
        frames_in_flight: frames.frames_in_flight,
        clock: choose(frames.clock, "the clock", &[Clock::Wall, Clock::Engine])?,
        timing: choose(frames.measured_by, "what frames are measured by", &[Timing::Timestamps, Timing::Host])?,
        quanta: (frames.quanta != 0).then_some(frames.quanta),
    }))
}

/// What a bake will take.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenEstimate {
    /// sizeof(LightovenEstimate)
    pub struct_size: usize,
    /// Most device memory that the baker ever takes, while it is made too; bytes, to about 5 %.
    pub most_bytes: u64,
    /// Device memory that it holds once it is made.
    pub held_bytes: u64,
    /// Texels whose centre a surface covers.
    pub covered_texels: u64,
    /// Columns of the light map.
    pub width: u32,
    /// Rows of the light map.
    pub height: u32,
}

structures!(LightovenEstimate = [40]);

/// Tells what a baker will take, before anything is allocated. `settings`: NULL for the defaults. `estimate`: not NULL; its
/// `struct_size` is set before.
///
/// # Safety
/// `settings` is NULL or as its members say; `estimate` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_estimate_memory(
    scene: LightovenScene,
    settings: *const LightovenBakeSettings,
    estimate: *mut LightovenEstimate,
) -> LightovenStatus {
    guard(|| {
        check_result(estimate, "the estimate")?;
        // SAFETY: by the caller's word.
        let settings = unsafe { bake_settings(settings)? };
        let (atlas, memory) = estimate_memory(&*scene_of(scene)?, &settings)?;
        let filled = LightovenEstimate {
            struct_size: size_of::<LightovenEstimate>(),
            most_bytes: memory.most(),
            held_bytes: memory.total(),
            covered_texels: atlas.covered_texels as u64,
            width: atlas.size.x,
            height: atlas.size.y,
        };
        // SAFETY: it may be written by the caller's word.
        unsafe { write(estimate, "the estimate", &filled) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_those_of_the_rust_interface() {
        // SAFETY: sizes are set, any other bytes will do.
        unsafe {
            let mut frames: LightovenFrameSettings = std::mem::zeroed();
            frames.struct_size = size_of::<LightovenFrameSettings>();
            assert_eq!(lightoven_frame_settings_default(&raw mut frames), LightovenStatus::Ok);
            let mut settings: LightovenBakeSettings = std::mem::zeroed();
            settings.struct_size = size_of::<LightovenBakeSettings>();
            assert_eq!(lightoven_bake_settings_default(&raw mut settings), LightovenStatus::Ok);
            assert_eq!(bake_settings(&raw const settings).expect("is valid"), BakeSettings::default());
            settings.frames = &raw const frames;
            let expected = BakeSettings { mode: Mode::Frames(FrameSettings::default()), ..BakeSettings::default() };
            assert_eq!(bake_settings(&raw const settings).expect("is valid"), expected);
            settings.reserved = 1;
            let refused = bake_settings(&raw const settings).expect_err("must be refused").to_string();
            assert!(refused.contains("'reserved' of the settings is 1"), "{refused}");
        }
    }
}
