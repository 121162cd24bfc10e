//! How the library is let onto the engine's device: every unsafe function that it has for an engine is called here.

use super::commands::Commands;
use super::device::{Device, Queue};
use super::instance::Instance;
use super::timeline::Timeline;
use ash::vk;
use lightoven::Result;
use lightoven::baker::{BakeSettings, Baker};
use lightoven::gpu::{BackendChoice, DeviceInfo, FrameCommands, Gpu, RawDevice, RawQueue, Requirements, TimelinePoint};
use lightoven::scene::Scene;
use std::rc::Rc;

/// What the library asks of a device.
///
/// # Errors
/// `Unsupported`, naming what the device lacks.
pub(super) fn requirements(
    instance: &Instance,
    device: vk::PhysicalDevice,
    backend: BackendChoice,
) -> Result<Requirements> {
    let loader = instance.entry.static_fn().get_instance_proc_addr;
    // SAFETY: the entry made the instance, and the physical device is the instance's.
    unsafe { Gpu::requirements(loader, instance.functions.handle(), device, backend) }
}

/// A baker on the engine's device.
pub(crate) struct Hosted {
    pub(crate) baker: Baker,
    pub(crate) info: DeviceInfo,
    pub(crate) backend: &'static str,
    // Goes after the baker, which lives on it.
    _device: Rc<Device>,
}

impl Hosted {
    pub(crate) fn new(device: &Rc<Device>, scene: &Scene, settings: &BakeSettings) -> Result<Self> {
        let raw_queue = |queue: Queue| RawQueue { handle: queue.handle, family: queue.family };
        let raw = RawDevice {
            get_instance_proc_addr: device.instance.entry.static_fn().get_instance_proc_addr,
            instance: device.instance.functions.handle(),
            physical_device: device.physical,
            device: device.functions.handle(),
            queue: raw_queue(device.queue),
            compute_queue: device.compute_queue.map(raw_queue),
            instance_extensions: &device.instance.extensions,
            device_extensions: &device.requirements.device_extensions,
            features: device.requirements.features,
            backend: device.backend,
            pipeline_cache: &[],
        };
        // SAFETY: the handles are the device's, made with these extensions and features. They outlive the baker, which
        // holds the only clones of the Gpu and is dropped before the device. There is one thread.
        let gpu = unsafe { Gpu::from_raw(raw) }?;
        let (info, backend) = (gpu.info().clone(), gpu.backend().name());
        Ok(Self { baker: Baker::new(&gpu, scene, settings)?, info, backend, _device: device.clone() })
    }
}

/// The engine's command buffer, as the library takes it.
pub(crate) fn frame_commands(commands: &Commands) -> FrameCommands {
    // SAFETY: the buffer is primary and of the family of the queue that the library was given; `Frames` begins it before
    // and submits it once afterwards, in order; renderings are begun and ended within `Raster::draw`.
    unsafe { FrameCommands::new(commands.buffer) }
}

/// The timeline's next value, for the library to signal.
pub(crate) fn timeline_point(timeline: &mut Timeline) -> TimelinePoint {
    timeline.value += 1;
    // SAFETY: the semaphore is a timeline of the device, which waits for the device before it goes; its values grow.
    unsafe { TimelinePoint::new(timeline.semaphore, timeline.value) }
}
