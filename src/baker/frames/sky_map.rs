//! A sky map that changes: copied with the next frame, through memory that is there from the start.

use super::report::FrameId;
use crate::error::{Error, Result};
use crate::gpu::{Buffer, BufferDesc, Gpu, Image, Location, Recorder};
use crate::scene::{Sky, SkyMap};
use ash::vk;
use glam::Vec3;

pub(super) struct SkyUpload {
    size: [u32; 2],
    pixels: Vec<[f32; 4]>,
    staging: Buffer,
    /// The frame that reads `staging`.
    read_by: FrameId,
}

impl SkyUpload {
    pub(super) fn new(gpu: &Gpu, map: &SkyMap) -> Result<Self> {
        let size = [map.width, map.height];
        let pixels: Vec<[f32; 4]> = map.pixels.iter().map(|pixel| pixel.extend(1.0).to_array()).collect();
        let bytes = size_of_val(pixels.as_slice()) as u64;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let desc = BufferDesc { name: "sky staging", size: bytes, usage, location: Location::Upload };
        Ok(Self { size, pixels, staging: Buffer::new(gpu, desc)?, read_by: FrameId::default() })
    }

    /// `[pixel]`, as they are or will be with the next frame.
    pub(super) fn pixels(&self) -> &[[f32; 4]] {
        &self.pixels
    }

    /// The sky has been checked. Returns whether it is another one than before.
    pub(super) fn set(&mut self, sky: Sky) -> Result<bool> {
        let [width, height] = self.size;
        match sky {
            Sky::Black => Ok(self.replace(std::iter::repeat(Vec3::ZERO))),
            Sky::Constant(radiance) => Ok(self.replace(std::iter::repeat(radiance))),
            Sky::Map(map) if [map.width, map.height] == self.size => Ok(self.replace(map.pixels.into_iter())),
            Sky::Map(map) => Err(Error::settings(format!(
                "the sky map is {} x {}; allowed is the size that the scene was declared with, {width} x {height}",
                map.width, map.height
            ))),
        }
    }

    fn replace(&mut self, radiances: impl Iterator<Item = Vec3>) -> bool {
        let mut changed = false;
        for (pixel, radiance) in self.pixels.iter_mut().zip(radiances) {
            let radiance = radiance.extend(1.0).to_array();
            changed |= std::mem::replace(pixel, radiance) != radiance;
        }
        changed
    }

    /// `false`: an earlier frame still reads the memory that the copy goes through.
    pub(super) fn record(
        &mut self,
        recorder: &mut Recorder<'_>,
        sky: &Image,
        frame: FrameId,
        completed: FrameId,
    ) -> bool {
        if self.read_by > completed {
            return false;
        }
        self.staging.write(&self.pixels);
        recorder.copy_to_image(&self.staging, sky);
        self.read_by = frame;
        true
    }
}
