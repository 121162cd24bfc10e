//! A baker: made, read, destroyed. `still.rs` bakes at a stretch, `frames.rs` within frames, `changes.rs` tells of changes,
//! `statistics.rs` what was done.

use super::arguments::{check_result, required_text, structures, write};
use super::gpu::{LightovenGpu, gpu_of};
use super::handles::Registry;
use super::scene::{LightovenScene, scene_of};
use super::settings::{LightovenBakeSettings, bake_settings};
use super::statistics::LeftOut;
use super::status::{Failure, LightovenStatus, Outcome, guard};
use super::vulkan::{VkFormat, VkImage, VkImageLayout, VkImageView};
use crate::baker::{Baker, LightMap};
use crate::gpu::{Gpu, TimelinePoint};
use crate::io::exr::{self, Metadata};
use crate::io::preview;
use std::ffi::c_char;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

/// Bakes the light map of one scene on one device. The null handle has the id 0. One thread at a time: a call while another one
/// works on the same baker, also from that one's callback, gives IN_USE. Destroy it once every frame that it recorded or
/// submitted, and every frame that uses one of its light maps, has finished on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct LightovenBaker {
    /// Not for use.
    pub id: u64,
}

/// What a handle stands for.
pub(super) struct Held {
    pub(super) baker: Baker,
    /// Of submissions, kept so that frames allocate nothing.
    pub(super) points: [Vec<TimelinePoint>; 2],
    pub(super) metadata: Metadata,
    pub(super) left_out: LeftOut,
    /// Goes last, and keeps its handle from being destroyed.
    _gpu: Arc<Gpu>,
}

pub(super) static BAKERS: Registry<Mutex<Held>> = Registry::new("baker");

/// Works on a baker, for this call alone.
pub(super) fn with<T>(baker: LightovenBaker, work: impl FnOnce(&mut Held) -> Outcome<T>) -> Outcome<T> {
    let held = BAKERS.get(baker.id)?;
    work(&mut *alone(&held, baker.id)?)
}

/// What a handle stands for, where no other call works on it and none has broken it.
fn alone<T>(held: &Mutex<T>, id: u64) -> Outcome<MutexGuard<'_, T>> {
    held.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Failure::in_use(format!("the baker {id} is in use by another call")),
        TryLockError::Poisoned(_) => {
            Failure::internal(format!("the baker {id} broke in an earlier call; it can only be destroyed"))
        }
    })
}

/// Makes a baker. `settings`: NULL for the defaults. `baker`: not NULL, written only where the call succeeds. It waits for the
/// device.
///
/// # Safety
/// `settings` is NULL or as its members say; `baker` may be written; nobody else uses the device's queues meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_create(
    gpu: LightovenGpu,
    scene: LightovenScene,
    settings: *const LightovenBakeSettings,
    baker: *mut LightovenBaker,
) -> LightovenStatus {
    guard(|| {
        check_result(baker, "the baker's place")?;
        let (gpu, scene) = (gpu_of(gpu)?, scene_of(scene)?);
        // SAFETY: by the caller's word.
        let settings = unsafe { bake_settings(settings)? };
        let metadata = Metadata {
            scene: scene.name().to_owned(),
            seed: settings.seed,
            samples: 0.0,
            device: gpu.info().name.clone(),
            version: format!("lightoven {}", env!("CARGO_PKG_VERSION")),
        };
        let made = Baker::new(&gpu, &scene, &settings)?;
        let left_out = LeftOut::of(&made, &scene);
        let held = Held { baker: made, points: [Vec::new(), Vec::new()], metadata, left_out, _gpu: gpu };
        // SAFETY: it may be written by the caller's word.
        unsafe { baker.write(LightovenBaker { id: BAKERS.insert(Mutex::new(held)) }) };
        Ok(())
    })
}

/// Destroys a baker, without waiting. Nothing happens for the null handle. IN_USE while another call works on it.
///
/// # Safety
/// Every frame that it recorded or submitted, and every frame that uses one of its light maps, has finished on the device.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_destroy(baker: LightovenBaker) -> LightovenStatus {
    guard(|| BAKERS.remove(baker.id, "another call"))
}

/// The newest finished light map on the device. It is not written again before the frame after the one that replaced it has been
/// reported complete: use it in the next frame that is recorded, and ask again for the one after.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenLightMap {
    /// sizeof(LightovenLightMap)
    pub struct_size: usize,
    /// The image.
    pub image: VkImage,
    /// A view of all of it; one of three, and the same for the same image.
    pub view: VkImageView,
    /// Grows by 1 with every finished map; 0: none is finished yet. Always 0 for a scene that stays as it is.
    pub generation: u64,
    /// Sweeps over all texels that it holds. Always 0 for a scene that stays as it is.
    pub sweeps: u64,
    /// VK_FORMAT_R32G32B32A32_SFLOAT. RGB: irradiance, linear Rec. 709, scene units; A: 1 where the texel lies on a surface, else 0.
    /// Gutters are filled. Not every device filters such images linearly.
    pub format: VkFormat,
    /// The layout that the image is in, now and always.
    pub layout: VkImageLayout,
    /// Columns.
    pub width: u32,
    /// Rows; the first is light-map coordinate v = 0.
    pub height: u32,
}

structures!(LightovenLightMap = [56]);

/// Gives the newest finished light map. `light_map`: not NULL; its `struct_size` is set before. With a scene that stays as it is
/// there is one, which `lightoven_baker_read_back` finishes.
///
/// # Safety
/// `light_map` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_light_map(
    baker: LightovenBaker,
    light_map: *mut LightovenLightMap,
) -> LightovenStatus {
    guard(|| {
        let newest = with(baker, |held| Ok(held.baker.light_map()))?;
        let filled = LightovenLightMap {
            struct_size: size_of::<LightovenLightMap>(),
            image: newest.image,
            view: newest.view,
            generation: newest.generation,
            sweeps: newest.sweeps,
            format: newest.format,
            layout: newest.layout,
            width: newest.size[0],
            height: newest.size[1],
        };
        // SAFETY: it may be written by the caller's word.
        unsafe { write(light_map, "the light map", &filled) }
    })
}

/// Copies the light map, gutters filled, to the host: waits for the device; no frame is then under way. `pixels`: room for
/// `pixel_count` times four floats, R, G, B and A, `[height][width][4]` from light-map coordinate v = 0; not NULL.
/// `pixel_count`: width times height of `lightoven_baker_light_map`, and nothing else.
///
/// # Safety
/// There is room for so many at `pixels`; nobody else uses the device's queues meanwhile, and no frame is under way.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_read_back(
    baker: LightovenBaker,
    pixels: *mut f32,
    pixel_count: usize,
) -> LightovenStatus {
    guard(|| {
        check_result(pixels, "the pixels")?;
        let pixel_list = with(baker, |held| {
            let [width, height] = held.baker.light_map().size;
            let expected = width as usize * height as usize;
            if pixel_count != expected {
                let text = format!("the number of pixels is {pixel_count}; allowed is {width} x {height} = {expected}");
                return Err(Failure::argument(text));
            }
            Ok(held.baker.read_back()?.pixels)
        })?;
        // SAFETY: there is room for so many by the caller's word.
        unsafe { std::ptr::copy_nonoverlapping(pixel_list.as_ptr(), pixels.cast::<[f32; 4]>(), pixel_list.len()) };
        Ok(())
    })
}

/// Writes the light map as OpenEXR: R, G, B and A as 32-bit floats, with scene, seed, samples, device and version as attributes.
/// It is written beside and renamed: what was there is replaced, and its mode kept, its owner and access lists not. A link is
/// followed, even where it leads to nothing yet; what is no file, or a file without a name such as a deleted one, is refused.
/// `path`: UTF-8, not NULL. Waits as `lightoven_baker_read_back` does.
///
/// # Safety
/// `path` ends with a NUL; otherwise as `lightoven_baker_read_back`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_write_exr(baker: LightovenBaker, path: *const c_char) -> LightovenStatus {
    guard(|| {
        // SAFETY: by the caller's word.
        let path = unsafe { required_text(path, "the path")? };
        let (light_map, metadata) = read_back_with_metadata(baker)?;
        Ok(exr::write_light_map(Path::new(&path), &light_map, &metadata)?)
    })
}

/// Writes a picture of the light map for the eye, as 8-bit PNG, its exposure chosen by its 99th percentile. Otherwise as
/// `lightoven_baker_write_exr`, links and modes too.
///
/// # Safety
/// As `lightoven_baker_write_exr`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_write_png(baker: LightovenBaker, path: *const c_char) -> LightovenStatus {
    guard(|| {
        // SAFETY: by the caller's word.
        let path = unsafe { required_text(path, "the path")? };
        let (light_map, _) = read_back_with_metadata(baker)?;
        Ok(preview::write_preview(Path::new(&path), &light_map)?)
    })
}

fn read_back_with_metadata(baker: LightovenBaker) -> Outcome<(LightMap, Metadata)> {
    with(baker, |held| {
        let light_map = held.baker.read_back()?;
        Ok((light_map, Metadata { samples: held.baker.statistics().samples_per_texel, ..held.metadata.clone() }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_broke_or_is_in_use_is_told() {
        let held = Mutex::new(1);
        let text = |held: &Mutex<i32>| alone(held, 7).map(|_| ()).map_err(|failure| failure.to_string());
        assert_eq!(text(&held), Ok(()));
        let used = held.lock().expect("is free");
        assert_eq!(text(&held), Err("the baker 7 is in use by another call".into()));
        drop(used);
        let broken = std::panic::catch_unwind(|| {
            let _held = held.lock();
            panic!("half way");
        });
        assert!(broken.is_err());
        assert_eq!(text(&held), Err("the baker 7 broke in an earlier call; it can only be destroyed".into()));
    }
}
