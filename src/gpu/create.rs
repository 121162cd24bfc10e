//! Makes an instance and a device of our own.

use super::backend::Backend;
use super::device::{Gpu, Loaded, OwnedInstance, Owner};
use super::info::{DeviceInfo, Messages, describe, queue_family};
use super::queue::{Queue, RawQueue};
use super::requirements::{FeatureChain, Requirements};
use super::vulkan_error;
use crate::error::{Error, ErrorKind, Result};
use ash::{ext, vk};
use std::ffi::{CStr, c_void};
use std::sync::Arc;

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// An instance, watched by the validation layers where asked for.
///
/// # Errors
/// `Unsupported` without the Vulkan loader, a driver, or the layer that is asked for.
pub(crate) fn create_instance(validation: bool) -> Result<OwnedInstance> {
    // SAFETY: the system's Vulkan loader is trusted to be one.
    let entry = unsafe { ash::Entry::load() }.map_err(|error| {
        let context = "load the Vulkan loader; on Debian install libvulkan1";
        Error::new(ErrorKind::Unsupported, context).with_source(error)
    })?;
    let layers = if validation { vec![VALIDATION_LAYER.as_ptr()] } else { Vec::new() };
    let extensions = if validation { vec![ext::debug_utils::NAME.as_ptr()] } else { Vec::new() };
    let application = vk::ApplicationInfo::default().application_name(c"lightoven").api_version(vk::API_VERSION_1_3);
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions);
    if validation {
        info = info.push_next(&mut features);
    }
    // SAFETY: the description is complete; names are NUL-terminated constants.
    let instance = unsafe { entry.create_instance(&info, None) }.map_err(instance_error)?;
    let messages = Arc::new(Messages::default());
    let mut owned = OwnedInstance { instance, messenger: None, messages, entry };
    if validation {
        owned.messenger = Some(create_messenger(&owned)?);
    }
    Ok(owned)
}

fn instance_error(result: vk::Result) -> Error {
    match result {
        vk::Result::ERROR_INCOMPATIBLE_DRIVER => no_driver(),
        vk::Result::ERROR_LAYER_NOT_PRESENT => {
            vulkan_error("the validation layers are missing; on Debian install vulkan-validationlayers", result)
        }
        result => vulkan_error("create a Vulkan instance", result),
    }
}

fn no_driver() -> Error {
    let context = "no Vulkan driver; on Debian install mesa-vulkan-drivers (lavapipe) or the GPU's own driver";
    Error::new(ErrorKind::Unsupported, context)
}

fn create_messenger(owned: &OwnedInstance) -> Result<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)> {
    let functions = ext::debug_utils::Instance::new(&owned.entry, &owned.instance);
    let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
        // Not PERFORMANCE: it would have every image leave the layout GENERAL for each copy.
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(receive))
        .user_data(Arc::as_ptr(&owned.messages).cast_mut().cast());
    // SAFETY: the callback's data lives in `owned`, which destroys the messenger before it goes.
    let messenger = unsafe { functions.create_debug_utils_messenger(&info, None) }
        .map_err(|result| vulkan_error("create the debug messenger", result))?;
    Ok((functions, messenger))
}

/// Keeps a validation message.
unsafe extern "system" fn receive(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan hands over a valid structure, and the pointer that create_messenger gave it.
    let (data, messages) = unsafe { (&*data, &*messages.cast_const().cast::<Messages>()) };
    // SAFETY: the message is a NUL-terminated text, or null.
    let text = unsafe { data.message_as_c_str() };
    messages.push(text.map_or_else(String::new, |text| text.to_string_lossy().into_owned()));
    vk::FALSE
}

fn physical_devices(owned: &OwnedInstance) -> Result<Vec<vk::PhysicalDevice>> {
    // SAFETY: the instance is valid.
    let devices = unsafe { owned.instance.enumerate_physical_devices() };
    match devices {
        Ok(devices) if devices.is_empty() => Err(no_driver()),
        Err(vk::Result::ERROR_INITIALIZATION_FAILED) => Err(no_driver()),
        devices => devices.map_err(|result| vulkan_error("list the devices", result)),
    }
}

/// What the devices are, in the drivers' order.
pub(crate) fn list_devices(owned: &OwnedInstance) -> Result<Vec<DeviceInfo>> {
    let devices = physical_devices(owned)?.into_iter().enumerate();
    Ok(devices.map(|(index, device)| describe(&owned.instance, device, index)).collect())
}

/// A device with what lightoven needs and nothing else.
pub(crate) fn create_device(
    owned: OwnedInstance,
    index: usize,
    backend: Backend,
    pipeline_cache: &[u8],
) -> Result<Gpu> {
    let physical_device = physical_devices(&owned)?[index];
    let lacks = || Error::new(ErrorKind::Unsupported, "the device has no queue for graphics and compute together");
    let family = queue_family(&owned.instance, physical_device).ok_or_else(lacks)?;
    let priorities = [1.0];
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities)];
    let requirements = Requirements::of(backend);
    let extensions: Vec<_> = requirements.device_extensions.iter().map(|extension| extension.as_ptr()).collect();
    let mut features = FeatureChain::new(requirements.features);
    let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&extensions);
    let info = features.attach(info);
    // SAFETY: extensions and features were found on the device (describe), names are NUL-terminated constants.
    let device = unsafe { owned.instance.create_device(physical_device, &info, None) }
        .map_err(|result| vulkan_error("create the device", result))?;
    // SAFETY: the queue was asked for above.
    let queue = RawQueue { handle: unsafe { device.get_device_queue(family, 0) }, family };
    let debug_utils = owned.messenger.is_some();
    let instance = owned.instance.clone();
    let owner = Owner { device: device.clone(), _instance: owned };
    let queue = Queue::new(queue, &instance, physical_device, device.handle())?;
    let loaded =
        Loaded { instance, physical_device, device, queue, compute_queue: None, backend, debug_utils, pipeline_cache };
    Gpu::owned(loaded, owner, index)
}
