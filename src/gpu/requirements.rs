//! What a device must have enabled: told to an engine before it makes its device, and checked afterwards.

use super::backend::{Backend, BackendChoice, choose_backend};
use super::info::{RAY_QUERY_EXTENSIONS, describe};
use crate::error::{Error, ErrorKind, Result};
use ash::vk;
use std::ffi::CStr;

bitflags::bitflags! {
    /// Features of a Vulkan device.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub struct DeviceFeatures: u32 {
        /// `VkPhysicalDeviceVulkan12Features::timelineSemaphore`
        const TIMELINE_SEMAPHORE = 1;
        /// `VkPhysicalDeviceVulkan12Features::bufferDeviceAddress`
        const BUFFER_DEVICE_ADDRESS = 1 << 1;
        /// `VkPhysicalDeviceVulkan13Features::dynamicRendering`
        const DYNAMIC_RENDERING = 1 << 2;
        /// `VkPhysicalDeviceVulkan13Features::synchronization2`
        const SYNCHRONIZATION2 = 1 << 3;
        /// `VkPhysicalDeviceVulkan13Features::maintenance4`
        const MAINTENANCE4 = 1 << 4;
        /// `VkPhysicalDeviceAccelerationStructureFeaturesKHR::accelerationStructure`
        const ACCELERATION_STRUCTURE = 1 << 5;
        /// `VkPhysicalDeviceRayQueryFeaturesKHR::rayQuery`
        const RAY_QUERY = 1 << 6;
    }
}

impl DeviceFeatures {
    /// The feature's name as Vulkan writes it.
    fn names(self) -> impl Iterator<Item = &'static str> {
        let names = [
            (Self::TIMELINE_SEMAPHORE, "timelineSemaphore"),
            (Self::BUFFER_DEVICE_ADDRESS, "bufferDeviceAddress"),
            (Self::DYNAMIC_RENDERING, "dynamicRendering"),
            (Self::SYNCHRONIZATION2, "synchronization2"),
            (Self::MAINTENANCE4, "maintenance4"),
            (Self::ACCELERATION_STRUCTURE, "accelerationStructure"),
            (Self::RAY_QUERY, "rayQuery"),
        ];
        names.into_iter().filter(move |(feature, _)| self.contains(*feature)).map(|(_, name)| name)
    }

    /// Every back end needs these.
    const ALWAYS: Self =
        Self::TIMELINE_SEMAPHORE.union(Self::DYNAMIC_RENDERING).union(Self::SYNCHRONIZATION2).union(Self::MAINTENANCE4);
    const FOR_RAY_QUERY: Self = Self::BUFFER_DEVICE_ADDRESS.union(Self::ACCELERATION_STRUCTURE).union(Self::RAY_QUERY);
}

/// What an engine enables on its device, beside what it needs itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Requirements {
    /// The back end that this is for.
    pub backend: Backend,
    /// Least version of the instance and of the device, as `VK_MAKE_API_VERSION` packs it.
    pub api_version: u32,
    /// Device extensions.
    pub device_extensions: Vec<&'static CStr>,
    /// Features; [`FeatureChain`] writes them out.
    pub features: DeviceFeatures,
}

impl Requirements {
    pub(super) fn of(backend: Backend) -> Self {
        let mut features = DeviceFeatures::ALWAYS;
        let mut device_extensions = Vec::new();
        if backend == Backend::RayQuery {
            features |= DeviceFeatures::FOR_RAY_QUERY;
            device_extensions.extend(RAY_QUERY_EXTENSIONS);
        }
        Self { backend, api_version: vk::API_VERSION_1_3, device_extensions, features }
    }

    /// # Errors
    /// `Unsupported`, naming what the physical device lacks.
    pub(super) fn find(
        instance: &ash::Instance,
        physical_device: vk::PhysicalDevice,
        choice: BackendChoice,
    ) -> Result<Self> {
        let info = describe(instance, physical_device, 0);
        if let Err(lack) = &info.usable {
            return Err(Error::new(ErrorKind::Unsupported, format!("device '{}' {lack}", info.name)));
        }
        Ok(Self::of(choose_backend(&info, choice)?))
    }

    /// # Errors
    /// `Unsupported`, naming what is required and was not enabled.
    pub(super) fn check(&self, extensions: &[&CStr], features: DeviceFeatures) -> Result<()> {
        let for_backend = self.backend.name();
        let unmet = |what: String| Err(Error::new(ErrorKind::Unsupported, what));
        if let Some(name) = self.device_extensions.iter().find(|name| !extensions.contains(name)) {
            let name = name.to_string_lossy();
            return unmet(format!(
                "the device was created without the extension {name}, which the back end '{for_backend}' needs"
            ));
        }
        match self.features.difference(features).names().next() {
            Some(name) => unmet(format!(
                "the device was created without the feature {name}, which the back end '{for_backend}' needs"
            )),
            None => Ok(()),
        }
    }
}

/// The structures that a device's creation is told its features by. An engine that fills structures of its own sets the
/// same members there instead: Vulkan allows each structure once.
#[derive(Debug, Default)]
pub struct FeatureChain {
    features: Option<DeviceFeatures>,
    vulkan12: vk::PhysicalDeviceVulkan12Features<'static>,
    vulkan13: vk::PhysicalDeviceVulkan13Features<'static>,
    acceleration_structure: vk::PhysicalDeviceAccelerationStructureFeaturesKHR<'static>,
    ray_query: vk::PhysicalDeviceRayQueryFeaturesKHR<'static>,
}

impl FeatureChain {
    /// For these features and no others.
    pub fn new(features: DeviceFeatures) -> Self {
        let has = |feature| features.contains(feature);
        Self {
            features: Some(features),
            vulkan12: vk::PhysicalDeviceVulkan12Features::default()
                .timeline_semaphore(has(DeviceFeatures::TIMELINE_SEMAPHORE))
                .buffer_device_address(has(DeviceFeatures::BUFFER_DEVICE_ADDRESS)),
            vulkan13: vk::PhysicalDeviceVulkan13Features::default()
                .dynamic_rendering(has(DeviceFeatures::DYNAMIC_RENDERING))
                .synchronization2(has(DeviceFeatures::SYNCHRONIZATION2))
                .maintenance4(has(DeviceFeatures::MAINTENANCE4)),
            acceleration_structure: vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default()
                .acceleration_structure(has(DeviceFeatures::ACCELERATION_STRUCTURE)),
            ray_query: vk::PhysicalDeviceRayQueryFeaturesKHR::default().ray_query(has(DeviceFeatures::RAY_QUERY)),
        }
    }

    /// Chains the structures to a device's description; those of extensions only where their feature is wanted.
    pub fn attach<'a>(&'a mut self, info: vk::DeviceCreateInfo<'a>) -> vk::DeviceCreateInfo<'a> {
        let features = self.features.unwrap_or(DeviceFeatures::empty());
        let mut info = info.push_next(&mut self.vulkan12).push_next(&mut self.vulkan13);
        if features.contains(DeviceFeatures::ACCELERATION_STRUCTURE) {
            info = info.push_next(&mut self.acceleration_structure);
        }
        if features.contains(DeviceFeatures::RAY_QUERY) {
            info = info.push_next(&mut self.ray_query);
        }
        info
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_enabled_is_named() {
        let requirements = Requirements::of(Backend::RayQuery);
        let all = &requirements.device_extensions;
        let message = |extensions: &[&CStr], features| match requirements.check(extensions, features) {
            Ok(()) => String::new(),
            Err(error) => error.to_string(),
        };
        assert_eq!(message(all, DeviceFeatures::all()), "");
        assert!(message(&all[1..], DeviceFeatures::all()).contains("VK_KHR_ray_query"));
        for (feature, name) in [
            (DeviceFeatures::TIMELINE_SEMAPHORE, "timelineSemaphore"),
            (DeviceFeatures::SYNCHRONIZATION2, "synchronization2"),
            (DeviceFeatures::RAY_QUERY, "rayQuery"),
        ] {
            assert!(message(all, DeviceFeatures::all().difference(feature)).contains(name), "{name}");
        }
        let software = Requirements::of(Backend::Software);
        assert!(software.check(&[], DeviceFeatures::ALWAYS).is_ok());
    }
}
