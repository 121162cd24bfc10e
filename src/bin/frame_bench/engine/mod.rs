//! A small engine, such as might embed the library: an instance and a device of its own, a shadow pass, a camera pass.
//! The only folder of the benchmark with unsafe code.
#![expect(unsafe_code, reason = "this stands for a foreign engine, which calls Vulkan itself")]

mod commands;
mod device;
mod geometry;
mod hosting;
mod instance;
mod layout;
mod memory;
mod pipeline;
mod raster;
mod screenshot;
mod targets;
mod timeline;
mod timer;

pub(crate) use commands::Commands;
pub(crate) use device::{Device, DeviceSettings};
pub(crate) use hosting::{Hosted, frame_commands, timeline_point};
pub(crate) use instance::Validation;
pub(crate) use raster::{Look, Raster};
pub(crate) use timeline::Timeline;

#[cfg(test)]
use pipeline::{SHADOW_VERT, VIEW_FRAG, VIEW_VERT};

use ash::vk;
use lightoven::{Error, ErrorKind};
use std::borrow::Cow;

/// The light map as the library shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct LightMapView {
    pub(crate) view: vk::ImageView,
    pub(crate) layout: vk::ImageLayout,
}

/// A failed Vulkan call, for `map_err`.
fn failed(context: impl Into<Cow<'static, str>>) -> impl FnOnce(vk::Result) -> Error {
    move |result| {
        let kind = match result {
            vk::Result::ERROR_OUT_OF_HOST_MEMORY | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => ErrorKind::OutOfMemory,
            vk::Result::ERROR_DEVICE_LOST => ErrorKind::DeviceLost,
            _ => ErrorKind::Driver,
        };
        Error::new(kind, context).with_source(result)
    }
}
