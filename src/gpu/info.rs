//! What devices are and can do, and what validation says about how they are used.

use ash::{khr, vk};
use std::ffi::CStr;
use std::sync::{Mutex, PoisonError};

/// What a device is and can do.
#[derive(Debug, Clone)]
pub struct DeviceInfo {
    /// Place in the driver's list.
    pub index: usize,
    /// The device's name.
    pub name: String,
    /// The driver's name and version.
    pub driver: String,
    /// The vendor's id, of the PCI or Khronos's own.
    pub vendor_id: u32,
    /// The vendor's id of the device.
    pub device_id: u32,
    /// Of device and driver: compiled pipelines serve where it is the same.
    pub pipeline_cache_uuid: [u8; 16],
    /// Vulkan version: major, minor, patch.
    pub api_version: (u32, u32, u32),
    /// "discrete GPU", "CPU", ...
    pub kind: &'static str,
    /// Whether it has VK_KHR_ray_query and VK_KHR_acceleration_structure.
    pub ray_query: bool,
    /// Whether lightoven runs on it, or what it lacks.
    pub usable: Result<(), String>,
    /// Largest storage buffer that a shader can see, bytes.
    pub max_storage_buffer_bytes: u64,
    /// Most texels of a buffer that a shader reads as texels.
    pub max_texel_buffer_elements: u64,
    /// Largest side of a light map, texels.
    pub max_image_side: u32,
    /// Size of the largest device-local heap, bytes.
    pub device_memory_bytes: u64,
}

impl DeviceInfo {
    /// Whether the device is the host's own processor.
    pub fn is_cpu(&self) -> bool {
        self.kind == KIND_CPU
    }

    /// Whether the software back end reads the hierarchy as texels: where any storage buffer can be read so. Lavapipe
    /// has 8 texels of four words in 55 instructions and without a branch, and as much of a storage buffer in 350; on two
    /// game levels of 8 k and 14 k triangles it traces 1.3 and 1.4 times the rays a second.
    pub(super) fn reads_texels(&self) -> bool {
        self.max_texel_buffer_elements.saturating_mul(TEXEL_BYTES) >= self.max_storage_buffer_bytes
    }
}

const KIND_CPU: &str = "CPU";

/// Bytes of a texel of a buffer: four words.
pub(super) const TEXEL_BYTES: u64 = 16;

/// Extensions that the hardware back end needs.
pub(crate) const RAY_QUERY_EXTENSIONS: [&CStr; 3] =
    [khr::ray_query::NAME, khr::acceleration_structure::NAME, khr::deferred_host_operations::NAME];

/// Asks a physical device what it is.
pub(crate) fn describe(instance: &ash::Instance, device: vk::PhysicalDevice, index: usize) -> DeviceInfo {
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    // SAFETY: the physical device is the instance's, the structures are chained as their types say.
    unsafe { instance.get_physical_device_properties2(device, &mut properties) };
    let base = properties.properties;
    // SAFETY: as above.
    let memory = unsafe { instance.get_physical_device_memory_properties(device) };
    let heaps = memory.memory_heaps_as_slice().iter();
    let local = heaps.filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL)).map(|heap| heap.size);
    let version = base.api_version;
    DeviceInfo {
        index,
        name: text(base.device_name_as_c_str()),
        driver: format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str())),
        vendor_id: base.vendor_id,
        device_id: base.device_id,
        pipeline_cache_uuid: base.pipeline_cache_uuid,
        api_version: (vk::api_version_major(version), vk::api_version_minor(version), vk::api_version_patch(version)),
        kind: match base.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => "discrete GPU",
            vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated GPU",
            vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual GPU",
            vk::PhysicalDeviceType::CPU => KIND_CPU,
            _ => "other",
        },
        ray_query: has_ray_query(instance, device),
        usable: usable(instance, device, version),
        max_storage_buffer_bytes: u64::from(base.limits.max_storage_buffer_range),
        max_texel_buffer_elements: u64::from(base.limits.max_texel_buffer_elements),
        max_image_side: base.limits.max_image_dimension2_d,
        device_memory_bytes: local.max().unwrap_or(0),
    }
}

fn text<E>(name: Result<&CStr, E>) -> String {
    name.map_or_else(|_| "unknown".into(), |name| name.to_string_lossy().into_owned())
}

fn usable(instance: &ash::Instance, device: vk::PhysicalDevice, version: u32) -> Result<(), String> {
    if version < vk::API_VERSION_1_3 {
        let (major, minor) = (vk::api_version_major(version), vk::api_version_minor(version));
        return Err(format!("has Vulkan {major}.{minor}; 1.3 is needed"));
    }
    let mut features12 = vk::PhysicalDeviceVulkan12Features::default();
    let mut features13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut features12).push_next(&mut features13);
    // SAFETY: the physical device is the instance's and has Vulkan 1.3, the structures are chained as their types say.
    unsafe { instance.get_physical_device_features2(device, &mut features) };
    let needed = [
        (features13.dynamic_rendering, "dynamicRendering"),
        (features13.synchronization2, "synchronization2"),
        (features13.maintenance4, "maintenance4"),
        (features12.timeline_semaphore, "timelineSemaphore"),
    ];
    if let Some((_, name)) = needed.iter().find(|(present, _)| *present == vk::FALSE) {
        return Err(format!("lacks the feature {name}"));
    }
    queue_family(instance, device).map(|_| ()).ok_or_else(|| "has no queue for graphics and compute together".into())
}

/// How the timestamps of a queue family count.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timestamps {
    pub(super) valid_bits: u32,
    pub(super) ns_per_tick: f64,
}

impl Timestamps {
    /// Seconds between two timestamps, of which only the valid bits count and wrap round.
    pub(super) fn seconds(self, from: u64, to: u64) -> f64 {
        let mask = if self.valid_bits >= 64 { u64::MAX } else { (1 << self.valid_bits) - 1 };
        (to.wrapping_sub(from) & mask) as f64 * self.ns_per_tick * 1e-9
    }
}

/// `None`: the family has no timestamps.
pub(super) fn timestamps(instance: &ash::Instance, device: vk::PhysicalDevice, family: u32) -> Option<Timestamps> {
    // SAFETY: the physical device is the instance's.
    let (families, properties) = unsafe {
        (instance.get_physical_device_queue_family_properties(device), instance.get_physical_device_properties(device))
    };
    let valid_bits = families.get(family as usize).map_or(0, |family| family.timestamp_valid_bits);
    let ns_per_tick = f64::from(properties.limits.timestamp_period);
    (valid_bits > 0 && ns_per_tick > 0.0).then_some(Timestamps { valid_bits, ns_per_tick })
}

/// The first family that does graphics and compute.
pub(crate) fn queue_family(instance: &ash::Instance, device: vk::PhysicalDevice) -> Option<u32> {
    let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    // SAFETY: the physical device is the instance's.
    let families = unsafe { instance.get_physical_device_queue_family_properties(device) };
    families.iter().position(|family| family.queue_flags.contains(wanted)).map(|index| index as u32)
}

fn has_ray_query(instance: &ash::Instance, device: vk::PhysicalDevice) -> bool {
    // SAFETY: the physical device is the instance's.
    let Ok(extensions) = (unsafe { instance.enumerate_device_extension_properties(device) }) else { return false };
    let has = |name: &CStr| extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
    RAY_QUERY_EXTENSIONS.iter().all(|name| has(name))
}

/// What the validation layers said.
#[derive(Debug, Default)]
pub(crate) struct Messages(Mutex<Vec<String>>);

impl Messages {
    pub(crate) fn push(&self, message: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(message);
    }

    pub(crate) fn all(&self) -> Vec<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
