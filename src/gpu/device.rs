//! The device that everything runs on.

use super::info::{DeviceInfo, Messages};
use super::vulkan_error;
use crate::error::{Error, ErrorKind, Result};
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Which back end traces the rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The host-built hierarchy in storage buffers, walked by a GLSL function. Runs everywhere.
    Software,
    /// `VK_KHR_ray_query`.
    RayQuery,
}

impl Backend {
    /// The name that the command line and reports use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Software => "software",
            Self::RayQuery => "ray-query",
        }
    }
}

/// Which back end is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum BackendChoice {
    /// Ray queries where the device has them in hardware, else software. A CPU device's own ray query is several times
    /// slower than the software back end and is not chosen.
    #[default]
    Auto,
    /// Always software.
    Software,
    /// Always ray queries; an error on a device without them.
    RayQuery,
}

/// Vulkan handles to build a [`Gpu`] from.
pub struct RawDevice {
    /// A loaded instance, Vulkan 1.3.
    pub instance: ash::Instance,
    /// The device's physical device.
    pub physical_device: vk::PhysicalDevice,
    /// A loaded device with dynamicRendering, synchronization2 and maintenance4.
    pub device: ash::Device,
    /// A queue with compute, graphics and transfer.
    pub queue: vk::Queue,
    /// The queue's family.
    pub queue_family: u32,
    /// The back end; `RayQuery` needs VK_KHR_ray_query and VK_KHR_acceleration_structure enabled, their features and
    /// bufferDeviceAddress with them.
    pub backend: Backend,
    /// Whether VK_EXT_debug_utils is enabled on the instance: objects are named and passes labelled.
    pub debug_utils: bool,
}

/// A device to bake on. Clones share it.
#[derive(Clone)]
pub struct Gpu {
    pub(super) inner: Arc<Inner>,
}

pub(super) struct Inner {
    // Dropped in this order: memory before the device that it belongs to.
    allocator: Mutex<Allocator>,
    pub(super) device: ash::Device,
    queue: Mutex<vk::Queue>,
    pub(super) queue_family: u32,
    pub(super) debug: Option<ext::debug_utils::Device>,
    pub(super) acceleration: Option<khr::acceleration_structure::Device>,
    pub(super) info: DeviceInfo,
    backend: Backend,
    _owner: Option<Owner>,
}

/// An instance and a device of our own, destroyed with the last clone of the [`Gpu`].
pub(crate) struct Owner {
    pub(crate) device: ash::Device,
    /// Goes after the device.
    pub(crate) _instance: OwnedInstance,
}

/// An instance of our own, with its messenger.
pub(crate) struct OwnedInstance {
    pub(crate) instance: ash::Instance,
    pub(crate) messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// The messenger writes here until the instance is gone.
    pub(crate) messages: Arc<Messages>,
    /// The loaded library, which the instance's functions are in.
    pub(crate) entry: ash::Entry,
}

impl Drop for Owner {
    fn drop(&mut self) {
        // SAFETY: the device is ours, and whatever was made from it held a clone of the Gpu, so it is gone.
        unsafe { self.device.destroy_device(None) };
    }
}

impl Drop for OwnedInstance {
    fn drop(&mut self) {
        // SAFETY: the instance is ours and its device went before it (field order of Owner).
        unsafe {
            if let Some((functions, messenger)) = &self.messenger {
                functions.destroy_debug_utils_messenger(*messenger, None);
            }
            self.instance.destroy_instance(None);
        }
    }
}

impl Gpu {
    /// Takes an engine's device. Nothing that is passed in is destroyed.
    ///
    /// # Errors
    /// `OutOfMemory` or `Driver` where the memory allocator cannot be made.
    ///
    /// # Safety
    /// The handles belong together, are valid, have what [`RawDevice`] asks for enabled, and outlive every clone of the
    /// `Gpu` and everything made from it. Nobody else uses the queue while a method of the baker runs.
    pub unsafe fn from_raw(raw: RawDevice) -> Result<Self> {
        Self::assemble(raw, None, 0)
    }

    /// A device of our own, which goes with the last clone.
    pub(crate) fn owned(raw: RawDevice, owner: Owner, index: usize) -> Result<Self> {
        Self::assemble(raw, Some(owner), index)
    }

    fn assemble(raw: RawDevice, owner: Option<Owner>, index: usize) -> Result<Self> {
        let RawDevice { instance, physical_device, device, queue, queue_family, backend, debug_utils } = raw;
        let info = super::info::describe(&instance, physical_device, index);
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: backend == Backend::RayQuery,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })
        .map_err(|error| Error::new(ErrorKind::Driver, "create the memory allocator").with_source(error))?;
        let inner = Inner {
            allocator: Mutex::new(allocator),
            debug: debug_utils.then(|| ext::debug_utils::Device::new(&instance, &device)),
            acceleration: (backend == Backend::RayQuery)
                .then(|| khr::acceleration_structure::Device::new(&instance, &device)),
            device,
            queue: Mutex::new(queue),
            queue_family,
            info,
            backend,
            _owner: owner,
        };
        Ok(Self { inner: Arc::new(inner) })
    }

    /// What the device is and can do.
    pub fn info(&self) -> &DeviceInfo {
        &self.inner.info
    }

    /// Which back end traces the rays.
    pub fn backend(&self) -> Backend {
        self.inner.backend
    }

    /// Waits until the queue has nothing left to do: for tools and for the end, never within a frame.
    pub(crate) fn wait(&self) -> Result<()> {
        let queue = self.queue();
        // SAFETY: the queue is valid and locked.
        unsafe { self.inner.device.queue_wait_idle(*queue) }
            .map_err(|result| vulkan_error("wait for the queue", result))
    }

    /// The queue, for this thread alone while the guard lives.
    pub(super) fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.inner.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn device(&self) -> &ash::Device {
        &self.inner.device
    }

    pub(super) fn allocator(&self) -> MutexGuard<'_, Allocator> {
        // A panic in another thread leaves the allocator as it was between two calls.
        self.inner.allocator.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Names an object for debuggers and validation messages.
    pub(super) fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        let Some(debug) = &self.inner.debug else { return };
        let Ok(name) = std::ffi::CString::new(name) else { return };
        let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
        // SAFETY: the handle was made from this device a moment ago. A failure costs nothing but the name.
        let _ = unsafe { debug.set_debug_utils_object_name(&info) };
    }
}
