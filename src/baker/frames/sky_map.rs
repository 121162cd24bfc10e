//! A sky map that changes: copied with the next frame, through memory that is there from the start.

use super::report::FrameId;
use crate::error::{Error, Result};
use crate::gpu::{Buffer, BufferDesc, Gpu, Image, Location, Recorder};
use crate::scene::Sky;
use ash::vk;

pub(super) struct SkyUpload {
    size: [u32; 2],
    pixels: Vec<[f32; 4]>,
    staging: Buffer,
    /// The frame that reads `staging`.
    read_by: FrameId,
}

impl SkyUpload {
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self> {
        let pixels = vec![[0.0; 4]; size[0] as usize * size[1] as usize];
        let bytes = size_of_val(pixels.as_slice()) as u64;
        let usage = vk::BufferUsageFlags::TRANSFER_SRC;
        let desc = BufferDesc { name: "sky staging", size: bytes, usage, location: Location::Upload };
        Ok(Self { size, pixels, staging: Buffer::new(gpu, desc)?, read_by: FrameId::default() })
    }

    /// The sky has been checked.
    pub(super) fn set(&mut self, sky: Sky) -> Result<()> {
        match sky {
            Sky::Black => self.pixels.fill([0.0; 4]),
            Sky::Constant(radiance) => self.pixels.fill(radiance.extend(1.0).to_array()),
            Sky::Map(map) => {
                let [width, height] = self.size;
                if [map.width, map.height] != self.size {
                    let found = [map.width, map.height];
                    return Err(Error::settings(format!(
                        "the sky map is {} x {}; allowed is the size that the scene was declared with, {width} x {height}",
                        found[0], found[1]
                    )));
                }
                for (pixel, radiance) in self.pixels.iter_mut().zip(&map.pixels) {
                    *pixel = radiance.extend(1.0).to_array();
                }
            }
        }
        Ok(())
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
