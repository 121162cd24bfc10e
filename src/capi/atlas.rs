//! Where instances lie in a light map.

use super::arguments::{one_of, structures, write};
use super::baker::{LightovenBaker, with};
use super::status::{LightovenStatus, guard};

/// The layout of a light map.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenAtlas {
    /// sizeof(LightovenAtlas)
    pub struct_size: usize,
    /// Texels whose centre a surface covers.
    pub covered_texels: u64,
    /// Texels whose centre is covered more than once: their light is that of one of the surfaces.
    pub overlapping_texels: u64,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Instances that have a LightovenAtlasRect.
    pub rect_count: u32,
    /// 1: the instances' own coordinates make up one atlas, used as it is; 0: each has a rectangle of its own.
    pub shared: u32,
}

/// An instance's place: texel = light-map coordinate * `scale` + `offset`. For a coordinate of the whole map divide by its width
/// and height.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenAtlasRect {
    /// sizeof(LightovenAtlasRect)
    pub struct_size: usize,
    /// Texels for a light-map coordinate of 1, horizontally and vertically.
    pub scale: [f32; 2],
    /// Texel of light-map coordinate (0, 0).
    pub offset: [f32; 2],
}

structures!(LightovenAtlas = [40], LightovenAtlasRect = [24]);

/// Tells how a light map is laid out; it stays so. `atlas`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `atlas` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_atlas(baker: LightovenBaker, atlas: *mut LightovenAtlas) -> LightovenStatus {
    guard(|| {
        let filled = with(baker, |held| {
            let atlas = held.baker.atlas();
            Ok(LightovenAtlas {
                struct_size: size_of::<LightovenAtlas>(),
                covered_texels: atlas.covered_texels as u64,
                overlapping_texels: atlas.overlapping_texels as u64,
                width: atlas.size.x,
                height: atlas.size.y,
                rect_count: atlas.rects.len() as u32,
                shared: u32::from(atlas.shared),
            })
        })?;
        // SAFETY: it may be written by the caller's word.
        unsafe { write(atlas, "the atlas", &filled) }
    })
}

/// Tells where an instance lies in the light map: what its light-map coordinates are multiplied with and moved by where it is drawn.
/// `instance`: below the scene's `instance_count`. `rect`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `rect` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_baker_atlas_rect(
    baker: LightovenBaker,
    instance: u32,
    rect: *mut LightovenAtlasRect,
) -> LightovenStatus {
    guard(|| {
        let found = with(baker, |held| one_of(&held.baker.atlas().rects, instance, "instance", "scene").copied())?;
        let filled = LightovenAtlasRect {
            struct_size: size_of::<LightovenAtlasRect>(),
            scale: found.scale.to_array(),
            offset: found.offset.to_array(),
        };
        // SAFETY: it may be written by the caller's word.
        unsafe { write(rect, "the rectangle", &filled) }
    })
}
