//! What a baker has done, how, and what it does without.

use super::arguments::{check_result, give_text, one_of, structures, write};
use super::baker::{LightovenBaker, with};
use super::status::{LightovenStatus, guard};
use crate::baker::{Baker, SamplingStatistics, Seconds, Statistics};
use crate::scene::Scene;
use std::ffi::c_char;

/// What a baker does without, in words and bytes.
pub(super) struct LeftOut {
    parts: Vec<(&'static str, u64)>,
    is_dark: bool,
}

impl LeftOut {
    /// `scene`: the one that is baked.
    pub(super) fn of(baker: &Baker, scene: &Scene) -> Self {
        let estimate = baker.memory_estimate(scene);
        Self { parts: estimate.left_out(scene, baker.atlas()), is_dark: estimate.is_dark }
    }
}

/// What a baker has done.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenStatistics {
    /// sizeof(LightovenStatistics)
    pub struct_size: usize,
    /// Texels that take rays.
    pub texels: u64,
    /// Texels on a surface that are inside something and are filled from their neighbours.
    pub invalid_texels: u64,
    /// Rays traced, shadow rays of analytic lights not counted.
    pub rays: u64,
    /// Samples of a texel, in the mean.
    pub samples_per_texel: f64,
    /// Million rays a second of baking; 0 before a bake has begun, and within frames.
    pub mrays_per_s: f64,
    /// Root of relMSE as it is estimated; below 0: not known.
    pub estimated_error: f32,
    /// Bound on what further bounces would add, relative to the mean radiance: infinite before two are done, and 0 before
    /// a bake has begun, and within frames.
    pub bounces_missing: f32,
    /// Epochs finished.
    pub epochs: u32,
    /// What was noticed, one sentence each.
    pub warning_count: u32,
    /// Samples of the texels that have most; with LIGHTOVEN_ERROR_ESTIMATE_ADAPTIVE others may have fewer. 0 within frames.
    pub most_samples: f64,
    /// World area of the texels that take rays, square scene units; 0 until a bake has begun, and within frames.
    pub area: f64,
    /// Rays sent by the cosine so far.
    pub cosine_rays: u64,
    /// Rays aimed at the light map so far.
    pub source_rays: u64,
    /// Rays aimed at the sky map so far.
    pub sky_rays: u64,
    /// What all surfaces shine, lately: luminance times world area in square scene units; below 0: not known.
    pub power: f64,
    /// Texels whose radiance is negative, infinite or no number, lately: no ray is aimed at them.
    pub unaimed_texels: u64,
    /// Times that what rays are aimed by was made from the light map.
    pub pyramids: u64,
    /// Time for the hierarchy on the host, nanoseconds, as all times.
    pub bvh_ns: u64,
    /// For the layout of the light map, the upload of the scene and the g-buffer.
    pub gbuffer_ns: u64,
    /// For finding what rays can be aimed at.
    pub aiming_ns: u64,
    /// For the first source map and light from analytic lights.
    pub direct_ns: u64,
    /// For what rays are aimed by.
    pub importance_ns: u64,
    /// For rays and source maps. Times within frames are those of LightovenFrameTiming.
    pub bake_ns: u64,
    /// For light maps, their gutters and error estimates.
    pub resolve_ns: u64,
    /// For pipelines, and what the driver compiles at their first use.
    pub compile_ns: u64,
    /// Share of rays sent by the cosine at present, a mixture's alpha; 0 to 1, as all shares. Before the first ray
    /// these three are 0.
    pub cosine_share: f32,
    /// Share of rays aimed at the light map at present.
    pub source_share: f32,
    /// Share of rays aimed at the sky map at present.
    pub sky_share: f32,
    /// Share of the rays aimed at the light map that saw what they were aimed at, lately; below 0: none was aimed, or it is
    /// not known yet.
    pub source_seen: f32,
    /// Share of the rays aimed at the sky map that left the scene, lately; below 0: none was aimed, or it is not known yet.
    pub sky_seen: f32,
    /// How even what shines is: 1 where all surfaces have one radiance, toward 0 the smaller the part is that shines; below 0: not
    /// known.
    pub evenness: f32,
    /// What is left out because scene and settings do not need it; `lightoven_baker_left_out` has words for it.
    pub left_out_count: u32,
    /// 1: the light map can only be black, and nothing was built; else 0.
    pub dark: u32,
}

// Until it told how rays are sent it was of 64 bytes.
structures!(LightovenStatistics = [64, 224]);

fn told(done: &Statistics, left_out: &LeftOut) -> LightovenStatistics {
    let (sampling, seconds): (SamplingStatistics, Seconds) = (done.sampling, done.seconds);
    // What is too large for the number becomes the largest.
    let nanoseconds = |seconds: f64| (seconds * 1e9) as u64;
    LightovenStatistics {
        struct_size: size_of::<LightovenStatistics>(),
        texels: done.texels,
        invalid_texels: done.invalid_texels,
        rays: done.rays,
        samples_per_texel: done.samples_per_texel,
        mrays_per_s: done.mrays_per_s,
        estimated_error: done.estimated_error.unwrap_or(-1.0),
        bounces_missing: done.bounces_missing,
        epochs: done.epochs,
        warning_count: done.warnings.len() as u32,
        most_samples: done.most_samples,
        area: done.area,
        cosine_rays: sampling.cosine_rays,
        source_rays: sampling.source_rays,
        sky_rays: sampling.sky_rays,
        power: sampling.power.unwrap_or(-1.0),
        unaimed_texels: sampling.invalid_texels,
        pyramids: sampling.pyramids,
        bvh_ns: nanoseconds(seconds.bvh),
        gbuffer_ns: nanoseconds(seconds.gbuffer),
        aiming_ns: nanoseconds(seconds.aiming),
        direct_ns: nanoseconds(seconds.direct),
        importance_ns: nanoseconds(seconds.importance),
        bake_ns: nanoseconds(seconds.bake),
        resolve_ns: nanoseconds(seconds.resolve),
        compile_ns: nanoseconds(seconds.compile),
        cosine_share: sampling.cosine_share,
        source_share: sampling.source_share,
        sky_share: sampling.sky_share,
        source_seen: sampling.source_seen.unwrap_or(-1.0),
        sky_seen: sampling.sky_seen.unwrap_or(-1.0),
        evenness: sampling.evenness.unwrap_or(-1.0),
        left_out_count: left_out.parts.len() as u32,
        dark: u32::from(left_out.is_dark),
    }
}

/// Tells what has been done so far. `statistics`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `statistics` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_statistics(
    baker: LightovenBaker,
    statistics: *mut LightovenStatistics,
) -> LightovenStatus {
    guard(|| {
        let filled = with(baker, |held| Ok(told(held.baker.statistics(), &held.left_out)))?;
        // SAFETY: it may be written by the caller's word.
        unsafe { write(statistics, "the statistics", &filled) }
    })
}

/// Gives a warning: UTF-8, ended by a NUL, cut short where `capacity` is too small for all of it. `index`: below
/// `LightovenStatistics::warning_count`; the other parameters are those of `lightoven_scene_text`.
///
/// # Safety
/// As `lightoven_scene_text`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_warning(
    baker: LightovenBaker,
    index: u32,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> LightovenStatus {
    guard(|| {
        with(baker, |held| {
            let warning = one_of(&held.baker.statistics().warnings, index, "warning", "baker")?;
            // SAFETY: the caller's word, passed on.
            unsafe { give_text(warning, buffer, capacity, length) }
        })
    })
}

/// Gives what a baker does without, in words, such as "no analytic lights": UTF-8, ended by a NUL, cut short where `capacity` is too small
/// for all of it. `index`: below `LightovenStatistics::left_out_count`. `bytes`: set to about what that saves of device memory, 0
/// where it saves time alone, or NULL; the other parameters are those of `lightoven_scene_text`, but for
/// `buffer` and `length`, which may both be NULL where `bytes` is not.
///
/// # Safety
/// As `lightoven_scene_text`; `bytes` is NULL or may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_left_out(
    baker: LightovenBaker,
    index: u32,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
    bytes: *mut u64,
) -> LightovenStatus {
    guard(|| {
        if !bytes.is_null() {
            check_result(bytes, "the bytes' place")?;
        }
        with(baker, |held| {
            let (words, saved) = one_of(&held.left_out.parts, index, "part left out", "baker")?;
            if bytes.is_null() || !buffer.is_null() || !length.is_null() {
                // SAFETY: the caller's word, passed on.
                unsafe { give_text(words, buffer, capacity, length)? };
            }
            if !bytes.is_null() {
                // SAFETY: it may be written by the caller's word.
                unsafe { bytes.write(*saved) };
            }
            Ok(())
        })
    })
}
