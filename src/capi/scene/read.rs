//! Scenes from glTF.

use super::build::sky;
use super::desc::LightovenSky;
use super::info::{LightovenScene, SCENES};
use crate::capi::arguments::{check_reserved, check_result, choose, read, required_text, slice, structures, text};
use crate::capi::status::{LightovenStatus, Outcome, guard};
use crate::io::gltf::{self, ReadSettings, SidednessChoice};
use crate::scene::Scene;
use std::ffi::{c_char, c_void};
use std::path::Path;

/// What surfaces of a glTF file answer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenGltfSidedness {
    /// As the materials' `doubleSided` says.
    AsWritten = 0,
    /// Every surface answers on both sides.
    AllDouble = 1,
}

/// How glTF is read. NULL in its place: as written, with a black sky.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenGltf {
    /// sizeof(LightovenGltf)
    pub struct_size: usize,
    /// glTF has no sky of its own. NULL: black.
    pub sky: *const LightovenSky,
    /// A LightovenGltfSidedness.
    pub sidedness: u32,
    /// 0.
    pub reserved: u32,
}

structures!(LightovenGltf = [24]);

/// # Safety
/// `settings` is NULL or as its members say.
unsafe fn settings(settings: *const LightovenGltf) -> Outcome<(ReadSettings, *const LightovenSky)> {
    if settings.is_null() {
        return Ok((ReadSettings::default(), std::ptr::null()));
    }
    // SAFETY: the caller's word, passed on.
    let settings = unsafe { read(settings, "the settings")? };
    check_reserved(settings.reserved, "the settings")?;
    let choices = [SidednessChoice::AsWritten, SidednessChoice::AllDouble];
    Ok((ReadSettings { sidedness: choose(settings.sidedness, "the sidedness", &choices)? }, settings.sky))
}

/// Gives the scene its sky and the caller its handle.
///
/// # Safety
/// `under` is NULL or as its members say; `place` may be written.
unsafe fn finish(mut scene: Scene, under: *const LightovenSky, place: *mut LightovenScene) -> Outcome {
    // SAFETY: the caller's word, passed on.
    unsafe {
        if !under.is_null() {
            scene.set_sky(sky(read(under, "the sky")?)?)?;
        }
        place.write(LightovenScene { id: SCENES.insert(scene) });
    }
    Ok(())
}

/// Reads a .gltf or .glb file: its TEXCOORD_1 is the light map, what an animation moves is movable. `path`: UTF-8, not NULL.
/// `gltf`: NULL for the defaults. `scene`: not NULL, written only where the call succeeds.
///
/// # Safety
/// `path` ends with a NUL; `gltf` is NULL or as its members say; `scene` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_scene_read_gltf(
    path: *const c_char,
    gltf: *const LightovenGltf,
    scene: *mut LightovenScene,
) -> LightovenStatus {
    guard(|| {
        check_result(scene, "the scene's place")?;
        // SAFETY: by the caller's word.
        unsafe {
            let path = required_text(path, "the path")?;
            let (settings, sky) = settings(gltf)?;
            finish(gltf::read(Path::new(&path), &settings)?, sky, scene)
        }
    })
}

/// Reads a .gltf or .glb file that is in memory.
///
/// `data`: its `size` bytes, at least 1. `name`: that of the scene, UTF-8; NULL: "memory". `folder`: where files lie that it
/// refers to, UTF-8; NULL: it may refer to none, and holds its buffers and images itself. `gltf`: NULL for the defaults.
/// `scene`: not NULL, written only where the call succeeds.
///
/// # Safety
/// As `lightoven_scene_read_gltf`; there are `size` bytes at `data`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_scene_read_gltf_memory(
    data: *const c_void,
    size: usize,
    name: *const c_char,
    folder: *const c_char,
    gltf: *const LightovenGltf,
    scene: *mut LightovenScene,
) -> LightovenStatus {
    guard(|| {
        check_result(scene, "the scene's place")?;
        // SAFETY: by the caller's word.
        unsafe {
            let bytes = slice(data.cast::<u8>(), size, "bytes of the file")?.to_vec();
            let name = if name.is_null() { "memory".to_owned() } else { text(name, "the name")? };
            let folder = if folder.is_null() { None } else { Some(text(folder, "the folder")?) };
            let (settings, sky) = settings(gltf)?;
            let read = gltf::read_bytes(&name, bytes, folder.as_deref().map(Path::new), &settings)?;
            finish(read, sky, scene)
        }
    })
}
