//! Vulkan's own types, under the names that its headers give them.

use ash::vk;

pub(super) type VkInstance = vk::Instance;
pub(super) type VkPhysicalDevice = vk::PhysicalDevice;
pub(super) type VkDevice = vk::Device;
pub(super) type VkQueue = vk::Queue;
pub(super) type VkCommandBuffer = vk::CommandBuffer;
pub(super) type VkSemaphore = vk::Semaphore;
pub(super) type VkImage = vk::Image;
pub(super) type VkImageView = vk::ImageView;
pub(super) type VkImageLayout = vk::ImageLayout;
pub(super) type VkFormat = vk::Format;
/// C has it as a pointer that may be NULL.
#[expect(non_camel_case_types, reason = "Vulkan's own name")]
pub(super) type PFN_vkGetInstanceProcAddr = Option<vk::PFN_vkGetInstanceProcAddr>;
