//! What changes in a scene between frames.

use super::arguments::{choose, read, transform};
use super::baker::{LightovenBaker, with};
use super::scene::{LightovenLight, LightovenScene, LightovenSky, light as light_of, scene_of, sky as sky_of};
use super::statistics::LeftOut;
use super::status::{Failure, LightovenStatus, guard};
use glam::Vec3;

/// Moves an instance that was declared movable. `instance`: below the scene's `instance_count`. `object_to_world`: three rows of
/// four, as VkTransformMatrixKHR has them, in double precision; not NULL. Where it has not moved nothing happens. UNSUPPORTED
/// where it moves so far away, or shrinks so far beside the scene, that the hierarchy is no longer precise enough: by some 16
/// times the scene's half extent.
///
/// # Safety
/// There are 12 numbers at `object_to_world`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_set_transform(
    baker: LightovenBaker,
    instance: u32,
    object_to_world: *const f64,
) -> LightovenStatus {
    guard(|| {
        // SAFETY: by the caller's word.
        let transform = unsafe { transform(object_to_world)? };
        with(baker, |held| Ok(held.baker.set_transform(instance as usize, transform)?))
    })
}

/// Takes a movable instance out of the scene (`present` 0) or puts it back (1).
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_baker_set_present(baker: LightovenBaker, instance: u32, present: u32) -> LightovenStatus {
    guard(|| {
        let present = choose(present, "whether an instance is present", &[false, true])?;
        with(baker, |held| {
            let instance = instance as usize;
            let told = if present { held.baker.add_instance(instance) } else { held.baker.remove_instance(instance) };
            Ok(told?)
        })
    })
}

/// Replaces a light; an intensity of 0 switches it off. `index`: below the scene's `light_count`. `light`: not NULL.
/// INVALID_SCENE for a value that `lightoven_scene_create` would refuse too.
///
/// # Safety
/// `light` is as its members say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_set_light(
    baker: LightovenBaker,
    index: u32,
    light: *const LightovenLight,
) -> LightovenStatus {
    guard(|| {
        // SAFETY: by the caller's word.
        let value = unsafe { light_of(&format!("light {index}"), read(light, "the light")?)? };
        with(baker, |held| Ok(held.baker.set_light(index as usize, value)?))
    })
}

/// Changes what a material emits, before its texture. `material`: below the scene's `material_count`. `radiance`: linear
/// Rec. 709, three numbers of at least 0; not NULL.
///
/// # Safety
/// There are three numbers at `radiance`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_set_emission(
    baker: LightovenBaker,
    material: u32,
    radiance: *const f32,
) -> LightovenStatus {
    guard(|| {
        // SAFETY: by the caller's word.
        let radiance = unsafe { super::arguments::tuples::<3>(radiance, 1, "radiance")? };
        let radiance = radiance.ok_or_else(|| Failure::argument("the radiance is NULL"))?[0];
        with(baker, |held| Ok(held.baker.set_emission(material as usize, Vec3::from_array(radiance))?))
    })
}

/// Replaces the sky. A scene that was made with a map takes maps of its size; one without takes none. `sky`: not NULL.
///
/// # Safety
/// `sky` is as its members say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_set_sky(baker: LightovenBaker, sky: *const LightovenSky) -> LightovenStatus {
    guard(|| {
        // SAFETY: by the caller's word.
        let value = unsafe { sky_of(read(sky, "the sky")?)? };
        with(baker, |held| Ok(held.baker.set_sky(value)?))
    })
}

/// Takes a scene that has come to need more: its first light, texture or sky map, more lights, an object that begins to move.
/// Instances, meshes and light-map coordinates stay as they were. It waits for the device and takes about as long as making the
/// baker; the light that has been gathered stays on show. After an error all is as it was.
///
/// # Safety
/// No frame of the baker is under way; nobody else uses the device's queues meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_set_scene(baker: LightovenBaker, scene: LightovenScene) -> LightovenStatus {
    guard(|| {
        let scene = scene_of(scene)?;
        with(baker, |held| {
            held.baker.set_scene(&scene)?;
            held.metadata.scene = scene.name().to_owned();
            held.left_out = LeftOut::of(&held.baker, &scene);
            Ok(())
        })
    })
}
