//! What stands behind the bindings of absent features: shaders that never read them are bound to something all the same.

use crate::error::Result;
use crate::gpu::{Buffer, BufferDesc, Commands, Image, ImageDesc, Location};
use ash::vk;
use std::sync::Arc;

/// One texel of each format, and a few bytes: shared by all that is not needed.
pub(crate) struct Nothing {
    images: [(vk::Format, Arc<Image>); 3],
    buffer: Arc<Buffer>,
}

/// Of images that a feature may do without.
const FORMATS: [vk::Format; 3] = [vk::Format::R32G32B32A32_SFLOAT, vk::Format::R32_SFLOAT, vk::Format::R32_UINT];

impl Nothing {
    pub(crate) fn new(commands: &mut Commands) -> Result<Self> {
        let gpu = commands.gpu().clone();
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let image = |format| {
            let desc = ImageDesc { name: "nothing", size: [1, 1], format, usage, mip_levels: 1 };
            Ok((format, Arc::new(Image::new(&gpu, desc)?)))
        };
        let [radiance, scalar, index] = FORMATS;
        let images = [image(radiance)?, image(scalar)?, image(index)?];
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let desc = BufferDesc { name: "nothing", size: 0, usage, location: Location::Device };
        let nothing = Self { images, buffer: Arc::new(Buffer::new(&gpu, desc)?) };
        commands.run(|recorder| {
            recorder.initialise(&nothing.images.each_ref().map(|(_, image)| &**image));
            Ok(())
        })?;
        Ok(nothing)
    }

    /// A black texel. Of a format that no optional image has, one of [`FORMATS`].
    pub(super) fn image(&self, format: vk::Format) -> Arc<Image> {
        let found = self.images.iter().find(|(of, _)| *of == format);
        found.map_or_else(|| self.images[0].1.clone(), |(_, image)| image.clone())
    }

    pub(super) fn buffer(&self) -> Arc<Buffer> {
        self.buffer.clone()
    }
}
