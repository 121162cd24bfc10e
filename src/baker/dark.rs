//! A bake of a scene in which nothing shines, or nothing receives light: its light map is black, and no ray is sent.

use super::{BakeSettings, ErrorEstimate, LightMap, Mode, Outcome, Progress, Statistics, Stop};
use crate::error::Result;
use crate::gpu::{Commands, Gpu, Image, ImageDesc};
use crate::scene::{Atlas, Scene};
use ash::vk;
use std::ops::ControlFlow;
use std::time::Duration;

/// A black light map.
pub(super) struct Dark {
    pub(super) atlas: Atlas,
    pub(super) statistics: Statistics,
    pub(super) image: Image,
    map: LightMap,
    tells_error: bool,
}

/// Whether a light map can only be black: that of a scene which stays as it is, and in which everything is left out that is
/// not needed.
pub(super) fn is_dark(scene: &Scene, atlas: &Atlas, settings: &BakeSettings) -> bool {
    settings.mode == Mode::Still && settings.unneeded.is_empty() && (atlas.touched_texels == 0 || !shines(scene))
}

fn shines(scene: &Scene) -> bool {
    scene.sky().shines() || scene.lights().iter().any(|light| light.intensity.max_element() > 0.0) || scene.emits()
}

pub(super) fn nothing_to_bake(scene: &Scene) -> String {
    format!("nothing to bake in '{}': no triangle has light-map coordinates (TEXCOORD_1)", scene.name())
}

impl Dark {
    pub(super) fn new(gpu: &Gpu, scene: &Scene, atlas: Atlas, error: ErrorEstimate) -> Result<Self> {
        let tells_error = error != ErrorEstimate::None;
        let mut statistics = Statistics::default();
        let [width, height] = atlas.size.to_array();
        let covered = atlas.touched(scene);
        statistics.texels = covered.iter().filter(|covered| **covered).count() as u64;
        statistics.warn(if statistics.texels == 0 {
            nothing_to_bake(scene)
        } else {
            let name = scene.name();
            format!("nothing shines in '{name}': no emission, no light, no sky; its light map is black")
        });
        let pixel = |covered: &bool| [0.0, 0.0, 0.0, f32::from(u8::from(*covered))];
        let map = LightMap { width, height, pixels: covered.iter().map(pixel).collect() };
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_SRC;
        let format = vk::Format::R32G32B32A32_SFLOAT;
        let desc = ImageDesc { name: "light map", size: [width, height], format, usage, mip_levels: 1 };
        let image = Commands::new(gpu)?.upload_image(desc, &map.pixels)?;
        Ok(Self { atlas, statistics, image, map, tells_error })
    }

    /// Done at once.
    pub(super) fn bake(
        &mut self,
        stop: &Stop,
        progress: &mut dyn FnMut(&Progress) -> ControlFlow<()>,
    ) -> Result<Outcome> {
        stop.check_for(self.tells_error)?;
        self.statistics.estimated_error = Some(0.0).filter(|_| self.tells_error);
        // Nothing is left that could be broken off.
        let _ = progress(&self.statistics.progress_at_end(stop, Duration::ZERO));
        Ok(Outcome::Finished)
    }

    pub(super) fn read_back(&self) -> LightMap {
        self.map.clone()
    }
}
