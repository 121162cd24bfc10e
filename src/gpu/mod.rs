//! The Vulkan layer: the only folder with unsafe code. Descriptions go in, finished objects come out; each holds the
//! device alive and frees what it owns.
#![expect(unsafe_code, reason = "Vulkan is called here and nowhere else")]

mod acceleration;
mod backend;
mod bindings;
mod cache;
mod commands;
mod constants;
mod create;
mod device;
mod frame;
mod info;
mod memory;
mod objects;
mod pipeline;
mod queue;
mod recorder;
mod rehearsal;
mod requirements;
mod sampler;
mod shader;
mod shared;
mod spirv;
mod timer;

pub(crate) mod layout;

pub use backend::{Backend, BackendChoice};
pub use device::{Gpu, RawDevice};
pub use frame::{FrameCommands, TimelinePoint};
pub use info::DeviceInfo;
pub use objects::Objects;
pub use queue::RawQueue;
pub use requirements::{DeviceFeatures, FeatureChain, Requirements};

pub(crate) use acceleration::SceneStructure;
pub(crate) use backend::choose_backend;
pub(crate) use bindings::{BindingSet, Resource};
pub(crate) use commands::Commands;
pub(crate) use constants::Constants;
pub(crate) use create::{create_device, create_instance, list_devices};
pub(crate) use frame::FrameSubmitter;
pub(crate) use info::Messages;
pub(crate) use memory::{Buffer, BufferDesc, Image, ImageDesc, Location};
pub(crate) use pipeline::{ComputePipeline, RasterDesc, RasterPipeline};
pub(crate) use recorder::{Recorder, Rendering};
pub(crate) use sampler::Sampler;
pub(crate) use shader::{
    BAKE, BOUNCE, CLUSTERS, DILATE, DIRECT, EMIT, GBUFFER_FRAG, GBUFFER_VERT, IMPORTANCE, PUBLISH, RESOLVE, SETTLE,
    SOURCE, TEXTURED_FRAG, TRACE, WEIGHTS,
};
pub(crate) use timer::{MARKS, Stopwatch, Timer};

use crate::error::{Error, ErrorKind};
use ash::vk;
use std::borrow::Cow;

/// A failed Vulkan call as an error of the crate; the `vk::Result` stays its source.
pub(crate) fn vulkan_error(context: impl Into<Cow<'static, str>>, result: vk::Result) -> Error {
    let kind = match result {
        vk::Result::ERROR_OUT_OF_HOST_MEMORY | vk::Result::ERROR_OUT_OF_DEVICE_MEMORY => ErrorKind::OutOfMemory,
        vk::Result::ERROR_DEVICE_LOST => ErrorKind::DeviceLost,
        vk::Result::ERROR_INCOMPATIBLE_DRIVER
        | vk::Result::ERROR_EXTENSION_NOT_PRESENT
        | vk::Result::ERROR_FEATURE_NOT_PRESENT
        | vk::Result::ERROR_LAYER_NOT_PRESENT => ErrorKind::Unsupported,
        _ => ErrorKind::Driver,
    };
    Error::new(kind, context).with_source(result)
}
