//! What a bake takes on the device, told before anything is allocated.

use super::BakeSettings;
use crate::error::{Error, ErrorKind, Result};
use crate::features::Features;
use crate::gpu::DeviceInfo;
use crate::gpu::layout::GROUP;
use crate::pass::{DeviceScene, Links, Maps, Sources};
use crate::scene::{Atlas, Scene, Sky};

/// Device memory by what it is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// Name and bytes.
    pub parts: Vec<(&'static str, u64)>,
    /// What the bake needs of the scene; all else is left out.
    pub features: Features,
}

impl MemoryEstimate {
    /// All parts together, bytes.
    pub fn total(&self) -> u64 {
        self.parts.iter().map(|(_, bytes)| bytes).sum()
    }

    pub(super) fn of(scene: &Scene, size: [u32; 2], mut features: Features) -> Self {
        let texels = u64::from(size[0]) * u64::from(size[1]);
        features.set(Features::LINKS, features.contains(Features::LINKS) && Links::rays(texels).is_some());
        let mut parts: Vec<_> = Maps::bytes(size, sky_size(scene), features).collect();
        // The g-buffer's depth, the list of texels, the two images of the dilation.
        parts.extend([("gbuffer depth", texels * 4), ("texels", texels * 4), ("nearest texels", texels * 8)]);
        if features.contains(Features::CLUSTERS) {
            parts.push(("clusters", Sources::bytes(texels)));
        }
        if features.contains(Features::LINKS) {
            parts.push(("links", Links::most_bytes(texels)));
        }
        if features.contains(Features::ADAPTIVE) {
            parts.push(("activity", texels.div_ceil(u64::from(GROUP)) * 4));
        }
        parts.extend(DeviceScene::bytes(scene, features));
        Self { parts, features }
    }

    /// `OutOfMemory` where the device does not have as much.
    pub(super) fn check(&self, size: [u32; 2], info: &DeviceInfo) -> Result<()> {
        let (total, available) = (self.total(), info.device_memory_bytes);
        if total <= available {
            return Ok(());
        }
        let [width, height] = size;
        let name = &info.name;
        Err(Error::new(
            ErrorKind::OutOfMemory,
            format!("a light map of {width} x {height} needs {total} bytes; device '{name}' has {available}"),
        ))
    }
}

/// Columns and rows of the scene's sky map; 1 and 1 where it has none.
fn sky_size(scene: &Scene) -> [u32; 2] {
    if let Sky::Map(map) = scene.sky() { [map.width, map.height] } else { [1, 1] }
}

/// The layout of the scene's light map, and what baking it takes.
///
/// # Errors
/// As [`Atlas::new`].
pub fn estimate_memory(scene: &Scene, settings: &BakeSettings) -> Result<(Atlas, MemoryEstimate)> {
    let atlas = Atlas::new(scene, settings.resolution)?;
    let estimate = MemoryEstimate::of(scene, atlas.size.to_array(), Features::required(scene, settings));
    Ok((atlas, estimate))
}
