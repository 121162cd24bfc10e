//! The handle of a scene, and what it tells.

use crate::capi::arguments::{choose, give_text, one_of, structures, write};
use crate::capi::handles::Registry;
use crate::capi::status::{LightovenStatus, Outcome, guard};
use crate::scene::Scene;
use std::ffi::c_char;
use std::sync::Arc;

/// A checked scene, read-only. The null handle has the id 0. It may be used by several threads at a time, and destroyed as
/// soon as bakers have been made from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct LightovenScene {
    /// Not for use.
    pub id: u64,
}

pub(in crate::capi) static SCENES: Registry<Scene> = Registry::new("scene");

/// The scene that a handle stands for.
pub(in crate::capi) fn scene_of(scene: LightovenScene) -> Outcome<Arc<Scene>> {
    SCENES.get(scene.id)
}

/// Destroys a scene. Nothing happens for the null handle. IN_USE while another thread uses it.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_scene_destroy(scene: LightovenScene) -> LightovenStatus {
    guard(|| SCENES.remove(scene.id, "another thread"))
}

/// What a scene holds.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenSceneInfo {
    /// sizeof(LightovenSceneInfo)
    pub struct_size: usize,
    /// Triangles over all instances.
    pub triangle_count: u64,
    /// Instances that can be baked; bakers count them as here.
    pub instance_count: u32,
    /// Materials.
    pub material_count: u32,
    /// Point, spot and directional lights.
    pub light_count: u32,
    /// What was dropped, clamped or left out, one sentence each.
    pub warning_count: u32,
}

structures!(LightovenSceneInfo = [32]);

/// Tells what a scene holds. `info`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `info` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_scene_info(scene: LightovenScene, info: *mut LightovenSceneInfo) -> LightovenStatus {
    guard(|| {
        let scene = scene_of(scene)?;
        let filled = LightovenSceneInfo {
            struct_size: size_of::<LightovenSceneInfo>(),
            triangle_count: scene.triangle_count() as u64,
            instance_count: scene.instances().len() as u32,
            material_count: scene.materials().len() as u32,
            light_count: scene.lights().len() as u32,
            warning_count: scene.warnings().len() as u32,
        };
        // SAFETY: it may be written by the caller's word.
        unsafe { write(info, "the scene's info", &filled) }
    })
}

/// Texts of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenSceneText {
    /// The name of an instance: what it is moved by is its index.
    Instance = 0,
    /// The name of a material.
    Material = 1,
    /// The name of a light.
    Light = 2,
    /// A warning.
    Warning = 3,
}

const KINDS: [LightovenSceneText; 4] = [
    LightovenSceneText::Instance,
    LightovenSceneText::Material,
    LightovenSceneText::Light,
    LightovenSceneText::Warning,
];

/// Gives a text of a scene: UTF-8, ended by a NUL, cut short where `capacity` is too small for all of it.
///
/// `kind`: a LightovenSceneText. `index`: below the count of these in LightovenSceneInfo. `buffer`: room for `capacity` bytes, or
/// NULL. `length`: set to the whole text's bytes without the NUL, or NULL; not both are NULL.
///
/// # Safety
/// `buffer` has room for `capacity` bytes where it is not NULL; `length` may be written where it is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_scene_text(
    scene: LightovenScene,
    kind: u32,
    index: u32,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> LightovenStatus {
    guard(|| {
        let scene = scene_of(scene)?;
        let text = match choose(kind, "the kind of text", &KINDS)? {
            LightovenSceneText::Instance => &one_of(scene.instances(), index, "instance", "scene")?.name,
            LightovenSceneText::Material => &one_of(scene.materials(), index, "material", "scene")?.name,
            LightovenSceneText::Light => &one_of(scene.lights(), index, "light", "scene")?.name,
            LightovenSceneText::Warning => one_of(scene.warnings(), index, "warning", "scene")?,
        };
        // SAFETY: the caller's word, passed on.
        unsafe { give_text(text, buffer, capacity, length) }
    })
}
