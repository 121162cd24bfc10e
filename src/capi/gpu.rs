//! An engine's device.

use super::arguments::{check_result, choose, give_text, names, read, slice, structures, write};
use super::handles::Registry;
use super::status::{Failure, LightovenStatus, Outcome, guard};
use super::vulkan::{PFN_vkGetInstanceProcAddr, VkDevice, VkInstance, VkPhysicalDevice, VkQueue};
use crate::gpu::{Backend, BackendChoice, DeviceFeatures, Gpu, RawDevice, RawQueue};
use ash::vk::{self, Handle};
use std::ffi::{c_char, c_void};
use std::sync::Arc;

/// A device to bake on. The null handle has the id 0. It may be used by several threads at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct LightovenGpu {
    /// Not for use.
    pub id: u64,
}

/// What traces the rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenBackend {
    /// Ray queries where the device has them in hardware, and they were enabled; else software.
    Auto = 0,
    /// A hierarchy in storage buffers, walked by compute shaders. Runs everywhere.
    Software = 1,
    /// VK_KHR_ray_query; refused where the device has none.
    RayQuery = 2,
}

/// Features of a Vulkan device, bits of `LightovenRequirements::features` and `LightovenGpuDesc::features`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum LightovenDeviceFeature {
    /// VkPhysicalDeviceVulkan12Features::timelineSemaphore
    TimelineSemaphore = 1,
    /// VkPhysicalDeviceVulkan12Features::bufferDeviceAddress
    BufferDeviceAddress = 2,
    /// VkPhysicalDeviceVulkan13Features::dynamicRendering
    DynamicRendering = 4,
    /// VkPhysicalDeviceVulkan13Features::synchronization2
    Synchronization2 = 8,
    /// VkPhysicalDeviceVulkan13Features::maintenance4
    Maintenance4 = 16,
    /// VkPhysicalDeviceAccelerationStructureFeaturesKHR::accelerationStructure
    AccelerationStructure = 32,
    /// VkPhysicalDeviceRayQueryFeaturesKHR::rayQuery
    RayQuery = 64,
}

/// Room for the name of a device or driver, bytes.
pub const LIGHTOVEN_NAME_SIZE: usize = 256;
/// Room for names of extensions.
pub const LIGHTOVEN_MOST_EXTENSIONS: usize = 8;

/// What an engine enables on its device, beside what it needs itself.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenRequirements {
    /// sizeof(LightovenRequirements)
    pub struct_size: usize,
    /// A LightovenBackend that this is for: software or ray query.
    pub backend: u32,
    /// Least version of the instance and of the device, as VK_MAKE_API_VERSION packs it.
    pub api_version: u32,
    /// Bits of LightovenDeviceFeature.
    pub features: u32,
    /// How many of `device_extensions` are used.
    pub device_extension_count: u32,
    /// Names of device extensions, valid for ever.
    pub device_extensions: [*const c_char; LIGHTOVEN_MOST_EXTENSIONS],
}

/// Vulkan handles to bake with. Nothing of it is destroyed; all of it outlives the LightovenGpu, and its arrays are not
/// needed after the call.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenGpuDesc {
    /// sizeof(LightovenGpuDesc)
    pub struct_size: usize,
    /// What the instance's functions are loaded by: all of Vulkan is called through it, and nothing is linked.
    pub get_instance_proc_addr: PFN_vkGetInstanceProcAddr,
    /// An instance of Vulkan 1.3 or later.
    pub instance: VkInstance,
    /// The device's physical device.
    pub physical_device: VkPhysicalDevice,
    /// The device, created with what `lightoven_requirements` said.
    pub device: VkDevice,
    /// A queue with graphics, compute and transfer: set-up runs on it, and what is recorded into the engine's commands.
    pub queue: VkQueue,
    /// A queue with compute for `lightoven_baker_submit`. NULL: `queue`.
    pub compute_queue: VkQueue,
    /// The family of `queue`, with graphics and compute.
    pub queue_family: u32,
    /// The family of `compute_queue`, with compute; not looked at where that is NULL, and that of `queue` where the two
    /// are one.
    pub compute_queue_family: u32,
    /// Extensions enabled on the instance, `[instance_extension_count]`. With VK_EXT_debug_utils objects are named and passes
    /// labelled. NULL where the count is 0.
    pub instance_extensions: *const *const c_char,
    /// At most 2^32 - 1.
    pub instance_extension_count: usize,
    /// Extensions enabled on the device, `[device_extension_count]`. NULL where the count is 0.
    pub device_extensions: *const *const c_char,
    /// At most 2^32 - 1.
    pub device_extension_count: usize,
    /// What `lightoven_gpu_pipeline_cache` gave, perhaps in an earlier run. Bytes of another device or driver, or damaged ones,
    /// are left aside with a warning. NULL where the size is 0. Nothing but those bytes: who makes up others with a right checksum
    /// hands them to the driver.
    pub pipeline_cache: *const c_void,
    /// Bytes; at most 2^32 - 1.
    pub pipeline_cache_size: usize,
    /// Features enabled on the device, bits of LightovenDeviceFeature; others are not looked at.
    pub features: u32,
    /// A LightovenBackend.
    pub backend: u32,
}

structures!(LightovenRequirements = [88], LightovenGpuDesc = [120]);

pub(super) static GPUS: Registry<Gpu> = Registry::new("GPU");

const BACKENDS: [BackendChoice; 3] = [BackendChoice::Auto, BackendChoice::Software, BackendChoice::RayQuery];

/// The device that a handle stands for.
pub(super) fn gpu_of(gpu: LightovenGpu) -> Outcome<Arc<Gpu>> {
    GPUS.get(gpu.id)
}

fn check_handle(handle: impl Handle, what: &str) -> Outcome {
    if handle.is_null() { Err(Failure::argument(format!("{what} is VK_NULL_HANDLE"))) } else { Ok(()) }
}

fn loader(function: PFN_vkGetInstanceProcAddr) -> Outcome<vk::PFN_vkGetInstanceProcAddr> {
    function.ok_or_else(|| Failure::argument("vkGetInstanceProcAddr is NULL"))
}

/// Tells what to enable on a device before it is made. `backend`: a LightovenBackend. `requirements`: filled in, not NULL;
/// its `struct_size` is set before.
///
/// # Safety
/// The instance is valid and was made by the library that `get_instance_proc_addr` belongs to; the physical device is the
/// instance's; `requirements` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_requirements(
    get_instance_proc_addr: PFN_vkGetInstanceProcAddr,
    instance: VkInstance,
    physical_device: VkPhysicalDevice,
    backend: u32,
    requirements: *mut LightovenRequirements,
) -> LightovenStatus {
    guard(|| {
        check_result(requirements, "the requirements")?;
        let get_instance_proc_addr = loader(get_instance_proc_addr)?;
        check_handle(instance, "the instance")?;
        check_handle(physical_device, "the physical device")?;
        let backend = choose(backend, "the back end", &BACKENDS)?;
        // SAFETY: the handles are valid by the caller's word.
        let needed = unsafe { Gpu::requirements(get_instance_proc_addr, instance, physical_device, backend)? };
        let mut filled = LightovenRequirements {
            struct_size: size_of::<LightovenRequirements>(),
            backend: code(needed.backend) as u32,
            api_version: needed.api_version,
            features: needed.features.bits(),
            device_extension_count: 0,
            device_extensions: [std::ptr::null(); LIGHTOVEN_MOST_EXTENSIONS],
        };
        if needed.device_extensions.len() > LIGHTOVEN_MOST_EXTENSIONS {
            return Err(Failure::internal("there is no room for the names of all extensions"));
        }
        for (place, name) in filled.device_extensions.iter_mut().zip(&needed.device_extensions) {
            *place = name.as_ptr();
            filled.device_extension_count += 1;
        }
        // SAFETY: it may be written by the caller's word.
        unsafe { write(requirements, "the requirements", &filled) }
    })
}

fn code(backend: Backend) -> LightovenBackend {
    match backend {
        Backend::Software => LightovenBackend::Software,
        Backend::RayQuery => LightovenBackend::RayQuery,
    }
}

/// Takes an engine's device. `desc`, `gpu`: not NULL. `gpu` is written only where the call succeeds. UNSUPPORTED names an
/// extension or feature that is required and was not enabled, INVALID_SETTINGS a queue family that the device does not have or
/// that cannot do the work, or two families of one queue.
///
/// # Safety
/// - `desc` and what it points to are as its members say; the handles are valid and belong together; extensions and features
///   are those that the device was created with.
/// - All of them outlive the LightovenGpu.
/// - The engine does not use the queues during `lightoven_baker_create`, `_bake`, `_bake_until`, `_read_back`, `_write_exr`,
///   `_write_png` and `_set_scene`, nor the queue for compute during `lightoven_baker_submit`: Vulkan wants one thread at a time
///   there. Calls of lightoven's may come from several threads: where they use one queue they wait for each other, whichever
///   LightovenGpu they go by.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_gpu_create(
    desc: *const LightovenGpuDesc,
    gpu: *mut LightovenGpu,
) -> LightovenStatus {
    guard(|| {
        check_result(gpu, "the GPU's place")?;
        // SAFETY: it is as its members say by the caller's word, the lists too.
        let (desc, instance_extensions, device_extensions, pipeline_cache) = unsafe {
            let desc = read(desc, "the description of the GPU")?;
            let instance_extensions =
                names(desc.instance_extensions, desc.instance_extension_count, "instance extensions")?;
            let device_extensions = names(desc.device_extensions, desc.device_extension_count, "device extensions")?;
            let cache =
                slice(desc.pipeline_cache.cast::<u8>(), desc.pipeline_cache_size, "bytes of the pipeline cache")?;
            (desc, instance_extensions, device_extensions, cache)
        };
        check_handle(desc.instance, "the instance")?;
        check_handle(desc.physical_device, "the physical device")?;
        check_handle(desc.device, "the device")?;
        check_handle(desc.queue, "the queue")?;
        let compute_queue = RawQueue { handle: desc.compute_queue, family: desc.compute_queue_family };
        let raw = RawDevice {
            get_instance_proc_addr: loader(desc.get_instance_proc_addr)?,
            instance: desc.instance,
            physical_device: desc.physical_device,
            device: desc.device,
            queue: RawQueue { handle: desc.queue, family: desc.queue_family },
            compute_queue: (!desc.compute_queue.is_null()).then_some(compute_queue),
            instance_extensions: &instance_extensions,
            device_extensions: &device_extensions,
            features: DeviceFeatures::from_bits_truncate(desc.features),
            backend: choose(desc.backend, "the back end", &BACKENDS)?,
            pipeline_cache,
        };
        // SAFETY: the same contract, by the caller's word.
        let made = unsafe { Gpu::from_raw(raw)? };
        // SAFETY: it may be written by the caller's word.
        unsafe { gpu.write(LightovenGpu { id: GPUS.insert(made) }) };
        Ok(())
    })
}

/// Lets the device go; nothing that the engine made is destroyed. Nothing happens for the null handle. IN_USE while bakers of
/// it live.
#[unsafe(no_mangle)]
pub extern "C" fn lightoven_gpu_destroy(gpu: LightovenGpu) -> LightovenStatus {
    guard(|| GPUS.remove(gpu.id, "its bakers, which are destroyed first, or by another thread"))
}

/// What a device holds for its bakers.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct LightovenGpuInfo {
    /// sizeof(LightovenGpuInfo)
    pub struct_size: usize,
    /// A LightovenBackend: software or ray query.
    pub backend: u32,
    /// Compute and graphics pipelines.
    pub pipelines: u32,
    /// Device memory that buffers and images of lightoven hold, bytes.
    pub allocated_bytes: u64,
    /// The device's name, UTF-8, ended by a NUL.
    pub name: [c_char; LIGHTOVEN_NAME_SIZE],
    /// The driver's name and version, UTF-8, ended by a NUL; cut short where it is longer.
    pub driver: [c_char; LIGHTOVEN_NAME_SIZE],
}

structures!(LightovenGpuInfo = [536]);

/// Tells what a device holds. `info`: not NULL; its `struct_size` is set before.
///
/// # Safety
/// `info` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_gpu_info(gpu: LightovenGpu, info: *mut LightovenGpuInfo) -> LightovenStatus {
    guard(|| {
        let gpu = gpu_of(gpu)?;
        let mut filled = LightovenGpuInfo {
            struct_size: size_of::<LightovenGpuInfo>(),
            backend: code(gpu.backend()) as u32,
            pipelines: gpu.objects().pipelines.len() as u32,
            allocated_bytes: gpu.allocated_bytes(),
            name: [0; LIGHTOVEN_NAME_SIZE],
            driver: [0; LIGHTOVEN_NAME_SIZE],
        };
        for (place, text) in [(&mut filled.name, &gpu.info().name), (&mut filled.driver, &gpu.info().driver)] {
            // SAFETY: so much room is there.
            unsafe { give_text(text, place.as_mut_ptr(), place.len(), std::ptr::null_mut())? };
        }
        // SAFETY: it may be written by the caller's word.
        unsafe { write(info, "the GPU's info", &filled) }
    })
}

/// Gives the compiled pipelines as bytes, for the engine to keep and hand in the next time. `size`: not NULL; with `data` NULL it
/// is set to the bytes there are, else it tells the room at `data` and is set to what was written. INVALID_ARGUMENT where the
/// room is too small, for pipelines that were compiled in between made it grow: `size` is then set to what is needed.
///
/// # Safety
/// `size` may be read and written; `data` is NULL or has room for as many bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_gpu_pipeline_cache(
    gpu: LightovenGpu,
    size: *mut usize,
    data: *mut c_void,
) -> LightovenStatus {
    guard(|| {
        check_result(size, "the size")?;
        let bytes = gpu_of(gpu)?.pipeline_cache()?;
        // SAFETY: it may be read by the caller's word.
        let room = unsafe { size.read() };
        if !data.is_null() && room < bytes.len() {
            let needed = bytes.len();
            // SAFETY: it may be written by the caller's word.
            unsafe { size.write(needed) };
            return Err(Failure::argument(format!("there is room for {room} bytes; the pipeline cache has {needed}")));
        }
        // SAFETY: there is room for all of them, and the size may be written, by the caller's word.
        unsafe {
            if !data.is_null() {
                std::ptr::copy_nonoverlapping(bytes.as_ptr(), data.cast::<u8>(), bytes.len());
            }
            size.write(bytes.len());
        }
        Ok(())
    })
}
