//! The device that everything runs on.

use super::backend::{Backend, BackendChoice};
use super::cache::PipelineCache;
use super::info::{DeviceInfo, Messages};
use super::objects::Ledger;
use super::pipeline::{Pipeline, PipelineKey};
use super::queue::{Purpose, Queue, RawQueue};
use super::requirements::{DeviceFeatures, Requirements};
use super::shared::Shared;
use crate::error::{Error, ErrorKind, Result};
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::ffi::CStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Vulkan handles to build a [`Gpu`] from.
pub struct RawDevice<'a> {
    /// What the instance's functions are loaded by.
    pub get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    /// An instance of Vulkan 1.3 or later.
    pub instance: vk::Instance,
    /// The device's physical device.
    pub physical_device: vk::PhysicalDevice,
    /// The device, created with what [`Gpu::requirements`] said.
    pub device: vk::Device,
    /// A queue with graphics, compute and transfer: set-up runs on it, and what is recorded into the engine's commands.
    pub queue: RawQueue,
    /// A queue with compute for `Baker::submit`; `None`: `queue`.
    pub compute_queue: Option<RawQueue>,
    /// Extensions enabled on the instance. With VK_EXT_debug_utils objects are named and passes labelled.
    pub instance_extensions: &'a [&'a CStr],
    /// Extensions enabled on the device.
    pub device_extensions: &'a [&'a CStr],
    /// Features enabled on the device.
    pub features: DeviceFeatures,
    /// The back end. `Auto` takes ray queries only where they were enabled.
    pub backend: BackendChoice,
    /// What [`Gpu::pipeline_cache`] gave, perhaps in an earlier run, or nothing. Bytes of another device or driver, or
    /// damaged ones, are left aside with a warning. Nothing but those bytes: who makes up others with a right checksum
    /// hands them to the driver.
    pub pipeline_cache: &'a [u8],
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
    queue: Arc<Queue>,
    compute_queue: Option<Arc<Queue>>,
    pub(super) debug: Option<ext::debug_utils::Device>,
    pub(super) acceleration: Option<khr::acceleration_structure::Device>,
    pub(super) info: DeviceInfo,
    /// All that are alive: who needs one of them once more shares it.
    pub(super) pipelines: Shared<PipelineKey, Pipeline>,
    pub(super) ledger: Arc<Ledger>,
    pub(super) pipeline_cache: PipelineCache,
    backend: Backend,
    instance: ash::Instance,
    physical_device: vk::PhysicalDevice,
    keeper: Keeper,
}

/// Who keeps the device alive.
enum Keeper {
    /// An engine, by its word.
    Engine,
    /// It is our own.
    Own(#[expect(dead_code, reason = "held to be dropped last")] Box<Owner>),
    /// It is that of another [`Gpu`], which plays the engine.
    Lender(#[expect(dead_code, reason = "held to be dropped last")] Gpu),
}

/// A device with its functions loaded.
pub(super) struct Loaded<'a> {
    pub(super) instance: ash::Instance,
    pub(super) physical_device: vk::PhysicalDevice,
    pub(super) device: ash::Device,
    pub(super) queue: Arc<Queue>,
    pub(super) compute_queue: Option<Arc<Queue>>,
    pub(super) backend: Backend,
    pub(super) debug_utils: bool,
    pub(super) pipeline_cache: &'a [u8],
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

/// `Unsupported` where a function of the Vulkan version that is needed is not there.
fn check_version(function: vk::PFN_vkVoidFunction, name: &CStr) -> Result<()> {
    let name = name.to_string_lossy();
    let missing = || format!("there is no {name}: the instance was created for a Vulkan before 1.3, which is needed");
    function.map(|_| ()).ok_or_else(|| Error::new(ErrorKind::Unsupported, missing()))
}

/// The instance's functions.
///
/// # Safety
/// The instance is valid and of the library that `get_instance_proc_addr` belongs to.
unsafe fn load_instance(
    get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
    instance: vk::Instance,
) -> Result<ash::Instance> {
    // SAFETY: the instance is valid by the caller's word.
    unsafe {
        let name = c"vkGetPhysicalDeviceProperties2";
        check_version(get_instance_proc_addr(instance, name.as_ptr()), name)?;
        Ok(ash::Instance::load(&ash::StaticFn { get_instance_proc_addr }, instance))
    }
}

impl Gpu {
    /// What an engine has to enable on a device, before it makes it.
    ///
    /// # Errors
    /// `Unsupported`, naming what the physical device lacks.
    ///
    /// # Safety
    /// The instance is valid and was made by the library that `get_instance_proc_addr` belongs to; the physical device is
    /// the instance's.
    pub unsafe fn requirements(
        get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
        instance: vk::Instance,
        physical_device: vk::PhysicalDevice,
        backend: BackendChoice,
    ) -> Result<Requirements> {
        // SAFETY: the instance is valid by the caller's word.
        let instance = unsafe { load_instance(get_instance_proc_addr, instance)? };
        Requirements::find(&instance, physical_device, backend)
    }

    /// Takes an engine's device. Nothing that is passed in is destroyed.
    ///
    /// # Errors
    /// `Unsupported`, naming an extension or feature that is required and was not enabled; `InvalidSettings` for a queue
    /// family that the device does not have, or that cannot do the work, or two families of one queue; `OutOfMemory` or
    /// `Driver` where the memory allocator or the pipeline cache cannot be made.
    ///
    /// # Safety
    /// - The handles are valid and belong together; extensions and features are those that the device was created with.
    /// - All of them outlive every clone of the `Gpu` and everything made from it.
    /// - A frame is reported to `Baker::complete` only once it has finished on the device, with all that uses a light map of
    ///   its baker in it. A baker is dropped, or its light map read back, only while no frame of it is under way.
    /// - Nobody else uses the queues during `Baker::new`, `Baker::bake`, `Baker::read_back` and by `Tracer` and
    ///   `GatherBench`, nor the queue for compute during `Baker::submit`: Vulkan wants one thread at a time there. All that
    ///   this crate does with one queue waits for each other, whichever `Gpu` it goes by.
    pub unsafe fn from_raw(raw: RawDevice<'_>) -> Result<Self> {
        // SAFETY: instance and device are valid by the caller's word.
        let (instance, device) = unsafe {
            let instance = load_instance(raw.get_instance_proc_addr, raw.instance)?;
            let name = c"vkCmdPipelineBarrier2";
            check_version(instance.get_device_proc_addr(raw.device, name.as_ptr()), name)?;
            let device = ash::Device::load(instance.fp_v1_0(), raw.device);
            (instance, device)
        };
        let enabled = Requirements::of(Backend::RayQuery).check(raw.device_extensions, raw.features).is_ok();
        let choice = match raw.backend {
            BackendChoice::Auto if !enabled => BackendChoice::Software,
            choice => choice,
        };
        let requirements = Requirements::find(&instance, raw.physical_device, choice)?;
        requirements.check(raw.device_extensions, raw.features)?;
        // SAFETY: the physical device is the instance's by the caller's word.
        let families = unsafe { instance.get_physical_device_queue_family_properties(raw.physical_device) };
        Purpose::ALL.check(raw.queue.family, &families)?;
        if let Some(compute) = raw.compute_queue {
            Purpose::COMPUTE.check(compute.family, &families)?;
            raw.queue.check_family_of(compute)?;
        }
        let queue = |queue| Queue::new(queue, &instance, raw.physical_device, raw.device);
        let other = raw.compute_queue.filter(|queue| queue.handle != raw.queue.handle);
        let loaded = Loaded {
            physical_device: raw.physical_device,
            device,
            queue: queue(raw.queue)?,
            compute_queue: other.map(queue).transpose()?,
            instance,
            backend: requirements.backend,
            debug_utils: raw.instance_extensions.contains(&ext::debug_utils::NAME),
            pipeline_cache: raw.pipeline_cache,
        };
        Self::assemble(loaded, Keeper::Engine, 0)
    }

    /// A device of our own, which goes with the last clone.
    pub(super) fn owned(loaded: Loaded<'_>, owner: Owner, index: usize) -> Result<Self> {
        Self::assemble(loaded, Keeper::Own(Box::new(owner)), index)
    }

    /// The same device and queues once more, called by these functions and not our own.
    pub(super) fn lent(&self, device: ash::Device) -> Result<Self> {
        let inner = &self.inner;
        let loaded = Loaded {
            instance: inner.instance.clone(),
            physical_device: inner.physical_device,
            device,
            queue: Arc::clone(&inner.queue),
            compute_queue: inner.compute_queue.clone(),
            backend: inner.backend,
            debug_utils: inner.debug.is_some(),
            pipeline_cache: &[],
        };
        Self::assemble(loaded, Keeper::Lender(self.clone()), inner.info.index)
    }

    fn assemble(loaded: Loaded<'_>, keeper: Keeper, index: usize) -> Result<Self> {
        let Loaded { instance, physical_device, device, queue, compute_queue, backend, debug_utils, pipeline_cache } =
            loaded;
        let info = super::info::describe(&instance, physical_device, index);
        let pipeline_cache = PipelineCache::new(&device, &info, pipeline_cache)?;
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
            queue,
            compute_queue,
            info,
            pipelines: Shared::default(),
            ledger: Arc::default(),
            pipeline_cache,
            backend,
            instance,
            physical_device,
            keeper,
        };
        Ok(Self { inner: Arc::new(inner) })
    }

    /// Whether instance and device are our own: there is then no engine whose frames to work in.
    pub(crate) fn is_owned(&self) -> bool {
        matches!(self.inner.keeper, Keeper::Own(_))
    }

    /// What the device is and can do.
    pub fn info(&self) -> &DeviceInfo {
        &self.inner.info
    }

    /// Which back end traces the rays.
    pub fn backend(&self) -> Backend {
        self.inner.backend
    }

    /// Memory that buffers and images on this device hold now, bytes. What the host writes and reads is among it, an
    /// engine's own is not.
    pub fn allocated_bytes(&self) -> u64 {
        self.allocator().generate_report().total_allocated_bytes
    }

    /// The same by the names of the buffers and images, in no order; those of a name one by one.
    pub fn allocations(&self) -> Vec<(String, u64)> {
        let report = self.allocator().generate_report();
        report.allocations.into_iter().map(|allocation| (allocation.name, allocation.size)).collect()
    }

    /// The queue for set-up and for what the engine submits.
    pub(super) fn queue(&self) -> &Queue {
        &self.inner.queue
    }

    /// The queue for work of our own within frames.
    pub(super) fn compute_queue(&self) -> &Queue {
        self.inner.compute_queue.as_deref().unwrap_or(&self.inner.queue)
    }

    /// The queues' families where they are two: memory is then shared between them.
    pub(super) fn families(&self) -> Option<[u32; 2]> {
        let families = [self.queue().family, self.compute_queue().family];
        (families[0] != families[1]).then_some(families)
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
