//! The engine's device: made with what the library asks for and nothing else, for the engine needs no more than that.

use super::failed;
use super::hosting::requirements;
use super::instance::{Instance, Validation};
use ash::vk;
use lightoven::gpu::{BackendChoice, FeatureChain, Requirements};
use lightoven::{Error, ErrorKind, Result};
use std::rc::Rc;

/// What the device is to be.
#[derive(Debug, Clone)]
pub(crate) struct DeviceSettings {
    /// Its index or a part of its name; `None`: the first that the library runs on, GPUs before CPUs.
    pub(crate) device: Option<String>,
    pub(crate) backend: BackendChoice,
    pub(crate) validation: Validation,
}

/// A queue and its family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Queue {
    pub(super) handle: vk::Queue,
    pub(super) family: u32,
}

/// A device with its queues, destroyed with its last owner.
pub(crate) struct Device {
    pub(super) functions: ash::Device,
    pub(super) physical: vk::PhysicalDevice,
    pub(super) queue: Queue,
    /// A second queue, of a family without graphics where there is one.
    pub(super) compute_queue: Option<Queue>,
    pub(super) requirements: Requirements,
    pub(super) backend: BackendChoice,
    pub(super) limits: vk::PhysicalDeviceLimits,
    pub(super) memory: vk::PhysicalDeviceMemoryProperties,
    /// Of the timestamps that the queue writes; 0: it writes none.
    pub(super) timestamp_bits: u32,
    // Goes last.
    pub(super) instance: Instance,
}

impl Device {
    /// # Errors
    /// `Unsupported` without a driver or where the device lacks what the library needs; `InvalidSettings` for a device
    /// that does not exist.
    pub(crate) fn new(settings: &DeviceSettings) -> Result<Rc<Self>> {
        let instance = Instance::new(settings.validation)?;
        let (physical, requirements) = choose(&instance, settings)?;
        // SAFETY: the physical device is the instance's.
        let families = unsafe { instance.functions.get_physical_device_queue_family_properties(physical) };
        let (family, compute) = queue_places(&families)?;
        let mut counts = vec![0_u32; families.len()];
        for (family, index) in [Some((family, 0)), compute].into_iter().flatten() {
            counts[family as usize] = counts[family as usize].max(index + 1);
        }
        let priorities = [1.0, 1.0];
        let wanted = counts.iter().enumerate().filter(|(_, count)| **count > 0);
        let queues: Vec<_> = wanted
            .map(|(family, count)| {
                let priorities = &priorities[..*count as usize];
                vk::DeviceQueueCreateInfo::default().queue_family_index(family as u32).queue_priorities(priorities)
            })
            .collect();
        let extensions: Vec<_> = requirements.device_extensions.iter().map(|name| name.as_ptr()).collect();
        let mut chain = FeatureChain::new(requirements.features);
        let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&extensions);
        let info = chain.attach(info);
        // SAFETY: the library found extensions and features on the device; names are NUL-terminated constants.
        let functions =
            unsafe { instance.functions.create_device(physical, &info, None) }.map_err(failed("create the device"))?;
        let queue_at = |(family, index)| {
            // SAFETY: this queue was asked for above.
            let handle = unsafe { functions.get_device_queue(family, index) };
            Queue { handle, family }
        };
        // SAFETY: the physical device is the instance's.
        let (properties, memory) = unsafe {
            let functions = &instance.functions;
            (
                functions.get_physical_device_properties(physical),
                functions.get_physical_device_memory_properties(physical),
            )
        };
        Ok(Rc::new(Self {
            queue: queue_at((family, 0)),
            compute_queue: compute.map(queue_at),
            functions,
            physical,
            requirements,
            backend: settings.backend,
            limits: properties.limits,
            memory,
            timestamp_bits: families[family as usize].timestamp_valid_bits,
            instance,
        }))
    }

    /// Whether there is a second queue for bakes.
    pub(crate) fn has_compute_queue(&self) -> bool {
        self.compute_queue.is_some()
    }

    /// What the validation layers have said; empty is as it should be.
    pub(crate) fn validation_messages(&self) -> Vec<String> {
        self.instance.messages()
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: whatever was made from the device holds it, so it is gone; the wait ends what its queues still do.
        unsafe {
            // A lost device has nothing left to do.
            let _ = self.functions.device_wait_idle();
            self.functions.destroy_device(None);
        }
    }
}

/// Family of the graphics queue; family and index of the queue for baking, if there is a second one.
fn queue_places(families: &[vk::QueueFamilyProperties]) -> Result<(u32, Option<(u32, u32)>)> {
    let has = |family: &vk::QueueFamilyProperties, flags| family.queue_flags.contains(flags);
    let (graphics, compute) = (vk::QueueFlags::GRAPHICS, vk::QueueFlags::COMPUTE);
    let main = families.iter().position(|family| has(family, graphics | compute)).ok_or_else(|| {
        Error::new(ErrorKind::Unsupported, "the device has no queue for graphics and compute together")
    })?;
    let alone = families.iter().position(|family| has(family, compute) && !has(family, graphics));
    let second = (families[main].queue_count > 1).then_some((main as u32, 1));
    Ok((main as u32, alone.map(|family| (family as u32, 0)).or(second)))
}

fn choose(instance: &Instance, settings: &DeviceSettings) -> Result<(vk::PhysicalDevice, Requirements)> {
    let describe = |device: vk::PhysicalDevice| {
        // SAFETY: the physical device is the instance's.
        let properties = unsafe { instance.functions.get_physical_device_properties(device) };
        let name =
            properties.device_name_as_c_str().map_or("unknown".into(), |name| name.to_string_lossy().into_owned());
        (device, name, properties.device_type == vk::PhysicalDeviceType::CPU)
    };
    let devices: Vec<_> = instance.devices()?.into_iter().map(describe).collect();
    let names =
        || devices.iter().enumerate().map(|(i, (_, name, _))| format!("{i} '{name}'")).collect::<Vec<_>>().join(", ");
    let Some(wanted) = settings.device.as_deref() else {
        let mut found = Err(Error::new(ErrorKind::Unsupported, "no Vulkan device"));
        for (device, _, _) in devices.iter().filter(|(_, _, cpu)| !cpu).chain(devices.iter().filter(|(_, _, cpu)| *cpu))
        {
            found = requirements(instance, *device, settings.backend).map(|requirements| (*device, requirements));
            if found.is_ok() {
                break;
            }
        }
        return found;
    };
    let found = match wanted.parse::<usize>() {
        Ok(index) => devices.get(index),
        Err(_) if wanted.is_empty() => None,
        Err(_) => devices.iter().find(|(_, name, _)| name.to_lowercase().contains(&wanted.to_lowercase())),
    };
    let missing =
        || Error::new(ErrorKind::InvalidSettings, format!("there is no device '{wanted}'; there are: {}", names()));
    let (device, _, _) = found.ok_or_else(missing)?;
    Ok((*device, requirements(instance, *device, settings.backend)?))
}
