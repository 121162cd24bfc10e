//! What a bake takes on the device, told before anything is allocated.

use super::dark::is_dark;
use super::{BakeSettings, Baker};
use crate::error::{Error, ErrorKind, Result};
use crate::features::Features;
use crate::gpu::DeviceInfo;
use crate::gpu::layout::GROUP;
use crate::pass::{Aim, DeviceScene, Gbuffer, Links, Maps, Sources};
use crate::scene::{Atlas, Scene, Sky};

/// Device memory by what it is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryEstimate {
    /// Name and bytes of what the bake holds, to about 5 %.
    pub parts: Vec<(&'static str, u64)>,
    /// The same of what it holds beside them while it is set up.
    pub set_up: Vec<(&'static str, u64)>,
    /// What the bake needs of the scene; all else is left out.
    pub features: Features,
    /// Whether the light map can only be black.
    pub is_dark: bool,
}

impl MemoryEstimate {
    /// All that the bake holds, bytes.
    pub fn total(&self) -> u64 {
        self.parts.iter().map(|(_, bytes)| bytes).sum()
    }

    /// What leaving things out saves, in words and bytes; 0 where it saves time alone.
    pub fn left_out(&self, scene: &Scene, atlas: &Atlas) -> Vec<(&'static str, u64)> {
        if self.is_dark {
            let lit = Self::of(scene, atlas, Features::of(scene) | Features::GATHERING);
            return vec![(
                "nothing shines, or nothing is lit: no pipeline and no ray",
                lit.most().saturating_sub(self.most()),
            )];
        }
        let with = |bits| Self::of(scene, atlas, self.features | bits).most().saturating_sub(self.most());
        self.features.left_out().into_iter().map(|(bits, words)| (words, with(bits))).collect()
    }

    /// About the most that it ever takes, bytes.
    pub fn most(&self) -> u64 {
        self.total() + self.set_up.iter().map(|(_, bytes)| bytes).sum::<u64>()
    }

    pub(super) fn of(scene: &Scene, atlas: &Atlas, mut features: Features) -> Self {
        let size = atlas.size.to_array();
        let (all, baked) = (u64::from(size[0]) * u64::from(size[1]), atlas.touched_texels as u64);
        let linked_rays = Links::rays(baked).filter(|_| features.contains(Features::LINKS));
        features.set(Features::LINKS, linked_rays.is_some());
        let groups = baked.div_ceil(u64::from(GROUP));
        let mut parts: Vec<_> = Maps::bytes(size, sky_size(scene), features).collect();
        let is_dynamic = features.contains(Features::DYNAMIC);
        parts.extend([("texels", baked * 4), ("sums", groups * 16)]);
        // While they are looked for there are two of them.
        parts.push(("nearest texels", if is_dynamic { all * 4 } else { all * 8 }));
        if is_dynamic && features.contains(Features::SKY_MAP) {
            let [width, height] = sky_size(scene).map(u64::from);
            parts.push(("sky staging", width * height * 16));
        }
        if features.contains(Features::IMPORTANCE) {
            parts.push(("importance sums", Aim::sums_bytes(size)));
            let emits = scene.materials().iter().any(crate::scene::Material::is_emissive);
            // Whether texels are shared is seen when they are looked at.
            let may_share = emits || features.contains(Features::SHARED_TEXELS);
            parts.extend(may_share.then_some(("pieces map", all * 4)));
        }
        if features.contains(Features::CLUSTERS) {
            parts.push(("clusters", all * 4 + Sources::bytes(baked, features)));
        }
        if let Some(rays) = linked_rays {
            parts.push(("links", Links::bytes(baked, rays)));
        }
        if features.contains(Features::GATHERING) && !is_dynamic {
            parts.push(("activity", groups * 4));
        }
        parts.extend(DeviceScene::bytes(scene, features));
        // Read by the host.
        let mut set_up = vec![("gbuffer depth", all * 4), ("read-back", all * 16)];
        if is_dynamic {
            set_up.push(("lit texels", all * 16));
        }
        set_up.extend(Gbuffer::texture_bytes(scene, features));
        Self { parts, set_up, features, is_dark: false }
    }

    /// Of a bake with these settings.
    pub(super) fn of_bake(scene: &Scene, atlas: &Atlas, settings: &BakeSettings) -> Self {
        if is_dark(scene, atlas, settings) {
            return Self::of_dark(atlas);
        }
        Self::of(scene, atlas, Features::required(scene, settings))
    }

    fn of_dark(atlas: &Atlas) -> Self {
        let parts = vec![("light map", 16 * u64::from(atlas.size.x) * u64::from(atlas.size.y))];
        Self { parts, set_up: Vec::new(), features: Features::empty(), is_dark: true }
    }

    /// `OutOfMemory` where the device does not have as much.
    pub(super) fn check(&self, size: [u32; 2], info: &DeviceInfo) -> Result<()> {
        let (most, available) = (self.most(), info.device_memory_bytes);
        if most <= available {
            return Ok(());
        }
        let [width, height] = size;
        let name = &info.name;
        Err(Error::new(
            ErrorKind::OutOfMemory,
            format!("a light map of {width} x {height} needs {most} bytes; device '{name}' has {available}"),
        ))
    }
}

/// Columns and rows of the scene's sky map; 1 and 1 where it has none.
fn sky_size(scene: &Scene) -> [u32; 2] {
    if let Sky::Map(map) = scene.sky() { [map.width, map.height] } else { [1, 1] }
}

impl Baker {
    /// What it takes on the device, by what it has come to need. `scene`: the one that it bakes.
    pub fn memory_estimate(&self, scene: &Scene) -> MemoryEstimate {
        match self.core() {
            Ok(core) => MemoryEstimate::of(scene, &core.atlas, core.features),
            Err(dark) => MemoryEstimate::of_dark(&dark.atlas),
        }
    }
}

/// The layout of the scene's light map, and what baking it takes.
///
/// # Errors
/// As [`Atlas::new`], and `InvalidSettings` for what [`Baker::new`] refuses on any device.
pub fn estimate_memory(scene: &Scene, settings: &BakeSettings) -> Result<(Atlas, MemoryEstimate)> {
    settings.check()?;
    let atlas = Atlas::new(scene, settings.resolution)?;
    let estimate = MemoryEstimate::of_bake(scene, &atlas, settings);
    Ok((atlas, estimate))
}
