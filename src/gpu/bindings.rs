//! What a pipeline's shaders see: resources by binding number.

use super::acceleration::SceneStructure;
use super::memory::{Buffer, Image};
use super::sampler::Sampler;
use super::{Gpu, vulkan_error};
use crate::error::Result;
use ash::vk;

/// A resource as a shader sees it.
#[derive(Clone, Copy)]
pub(crate) enum Resource<'a> {
    Storage(&'a Buffer),
    /// As texels of four words.
    Texels(&'a Buffer),
    StorageImage(&'a Image),
    Sampled(&'a Image),
    Texture(&'a Image, &'a Sampler),
    Scene(&'a SceneStructure),
}

impl Resource<'_> {
    pub(super) fn kind(self) -> vk::DescriptorType {
        match self {
            Self::Storage(_) => vk::DescriptorType::STORAGE_BUFFER,
            Self::Texels(_) => vk::DescriptorType::UNIFORM_TEXEL_BUFFER,
            Self::StorageImage(_) => vk::DescriptorType::STORAGE_IMAGE,
            Self::Sampled(_) => vk::DescriptorType::SAMPLED_IMAGE,
            Self::Texture(..) => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
            Self::Scene(_) => vk::DescriptorType::ACCELERATION_STRUCTURE_KHR,
        }
    }
}

/// The layout of set 0 for a list of resources.
pub(super) fn set_layout(
    gpu: &Gpu,
    name: &str,
    stages: vk::ShaderStageFlags,
    resources: &[(u32, Resource<'_>)],
) -> Result<vk::DescriptorSetLayout> {
    let entry = |(binding, resource): &(u32, Resource<'_>)| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(*binding)
            .descriptor_type(resource.kind())
            .descriptor_count(1)
            .stage_flags(stages)
    };
    let entries: Vec<_> = resources.iter().map(entry).collect();
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&entries);
    // SAFETY: the description is complete; binding numbers are unique by construction of the passes.
    unsafe { gpu.device().create_descriptor_set_layout(&info, None) }
        .map_err(|result| vulkan_error(format!("create the set layout of '{name}'"), result))
}

/// A descriptor set, in a pool of its own, written once.
pub(crate) struct BindingSet {
    gpu: Gpu,
    pool: vk::DescriptorPool,
    pub(super) set: vk::DescriptorSet,
}

impl BindingSet {
    /// `resources` are of the same kinds and bindings as those that the pipeline was made with; they outlive the set's
    /// last use.
    pub(super) fn new(
        gpu: &Gpu,
        name: &str,
        layout: vk::DescriptorSetLayout,
        resources: &[(u32, Resource<'_>)],
    ) -> Result<Self> {
        let size = |(_, resource): &(u32, Resource<'_>)| {
            vk::DescriptorPoolSize::default().ty(resource.kind()).descriptor_count(1)
        };
        let sizes: Vec<_> = resources.iter().map(size).collect();
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        let context = |result| vulkan_error(format!("create the descriptor set of '{name}'"), result);
        // SAFETY: the description is complete.
        let pool = unsafe { gpu.device().create_descriptor_pool(&info, None) }.map_err(context)?;
        let mut bindings = Self { gpu: gpu.clone(), pool, set: vk::DescriptorSet::null() };
        let layouts = [layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool was sized for exactly this set.
        let sets = unsafe { gpu.device().allocate_descriptor_sets(&info) }.map_err(context)?;
        bindings.set = sets[0];
        resources.iter().for_each(|(binding, resource)| bindings.write(*binding, *resource));
        Ok(bindings)
    }

    fn write(&self, binding: u32, resource: Resource<'_>) {
        let image_info = |image: &Image, sampler| {
            [vk::DescriptorImageInfo { sampler, image_view: image.view, image_layout: vk::ImageLayout::GENERAL }]
        };
        let (buffers, texels, images, structures);
        let mut scene;
        let mut write = vk::WriteDescriptorSet::default().dst_set(self.set).dst_binding(binding);
        write = write.descriptor_type(resource.kind());
        write = match resource {
            Resource::Storage(buffer) => {
                buffers = [vk::DescriptorBufferInfo { buffer: buffer.handle, offset: 0, range: vk::WHOLE_SIZE }];
                write.buffer_info(&buffers)
            }
            Resource::Texels(buffer) => {
                texels = [buffer.texels];
                write.texel_buffer_view(&texels)
            }
            Resource::StorageImage(image) | Resource::Sampled(image) => {
                images = image_info(image, vk::Sampler::null());
                write.image_info(&images)
            }
            Resource::Texture(image, sampler) => {
                images = image_info(image, sampler.handle);
                write.image_info(&images)
            }
            Resource::Scene(structure) => {
                structures = [structure.top_level()];
                scene = vk::WriteDescriptorSetAccelerationStructureKHR::default().acceleration_structures(&structures);
                write.descriptor_count(1).push_next(&mut scene)
            }
        };
        // SAFETY: the set is not in use yet, the resource is alive and of the kind that the layout has here.
        unsafe { self.gpu.device().update_descriptor_sets(&[write], &[]) };
    }
}

impl Drop for BindingSet {
    fn drop(&mut self) {
        // SAFETY: whoever recorded with the set has waited for the device before dropping it; the set goes with its pool.
        unsafe { self.gpu.device().destroy_descriptor_pool(self.pool, None) };
    }
}
