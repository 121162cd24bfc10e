//! The engine's Vulkan instance.

use super::failed;
use ash::{ext, vk};
use lightoven::{Error, ErrorKind, Result};
use std::ffi::{CStr, c_void};
use std::sync::{Mutex, PoisonError};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Whether the validation layers watch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Validation {
    Off,
    On,
}

/// An instance, destroyed when it is dropped.
pub(super) struct Instance {
    pub(super) functions: ash::Instance,
    pub(super) entry: ash::Entry,
    /// Enabled on the instance.
    pub(super) extensions: Vec<&'static CStr>,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// The messenger has its address.
    messages: Box<Mutex<Vec<String>>>,
}

impl Instance {
    /// # Errors
    /// `Unsupported` without the Vulkan loader, a driver, or the layers that are asked for.
    pub(super) fn new(validation: Validation) -> Result<Self> {
        // SAFETY: the system's Vulkan loader is trusted to be one.
        let entry = unsafe { ash::Entry::load() }
            .map_err(|error| Error::new(ErrorKind::Unsupported, "load the Vulkan loader").with_source(error))?;
        let watched = validation == Validation::On;
        let extensions = if watched { vec![ext::debug_utils::NAME] } else { Vec::new() };
        let extension_names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
        let layers = if watched { vec![VALIDATION_LAYER.as_ptr()] } else { Vec::new() };
        let application =
            vk::ApplicationInfo::default().application_name(c"frame_bench").api_version(vk::API_VERSION_1_3);
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extension_names);
        if watched {
            info = info.push_next(&mut features);
        }
        // SAFETY: the description is complete; names are NUL-terminated constants.
        let functions = unsafe { entry.create_instance(&info, None) }.map_err(|result| {
            let context = "create a Vulkan instance; it needs a driver, and with LIGHTOVEN_VALIDATION=1 the layers";
            Error::new(ErrorKind::Unsupported, context).with_source(result)
        })?;
        let mut instance = Self { functions, entry, extensions, messenger: None, messages: Box::default() };
        if watched {
            instance.listen()?;
        }
        Ok(instance)
    }

    fn listen(&mut self) -> Result<()> {
        let functions = ext::debug_utils::Instance::new(&self.entry, &self.functions);
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING,
            )
            .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
            .pfn_user_callback(Some(receive))
            .user_data((&raw const *self.messages).cast_mut().cast());
        // SAFETY: the callback's data is in a box that goes after the messenger.
        let messenger = unsafe { functions.create_debug_utils_messenger(&info, None) }
            .map_err(failed("create the debug messenger"))?;
        self.messenger = Some((functions, messenger));
        Ok(())
    }

    /// What the validation layers have said.
    pub(super) fn messages(&self) -> Vec<String> {
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// All devices, in the drivers' order.
    pub(super) fn devices(&self) -> Result<Vec<vk::PhysicalDevice>> {
        // SAFETY: the instance is valid.
        unsafe { self.functions.enumerate_physical_devices() }.map_err(failed("list the devices"))
    }
}

/// Keeps a validation message.
unsafe extern "system" fn receive(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan hands over a valid structure, and the address that `listen` gave it.
    let (data, messages) = unsafe { (&*data, &*messages.cast_const().cast::<Mutex<Vec<String>>>()) };
    // SAFETY: the message is a NUL-terminated text, or null.
    let text = unsafe { data.message_as_c_str() };
    let text = text.map_or_else(String::new, |text| text.to_string_lossy().into_owned());
    messages.lock().unwrap_or_else(PoisonError::into_inner).push(text);
    vk::FALSE
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: all that was made from the instance is gone: the device holds the instance and goes first.
        unsafe {
            if let Some((functions, messenger)) = &self.messenger {
                functions.destroy_debug_utils_messenger(*messenger, None);
            }
            self.functions.destroy_instance(None);
        }
    }
}
