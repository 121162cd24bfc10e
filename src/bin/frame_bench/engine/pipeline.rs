//! The two raster pipelines and what they bind.

use super::{Device, failed};
use ash::vk;
use lightoven::Result;
use std::rc::Rc;

include!(concat!(env!("OUT_DIR"), "/frame_bench_shaders.rs"));

/// Formats of what is drawn to.
pub(super) const COLOUR_FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;
pub(super) const DEPTH_FORMAT: vk::Format = vk::Format::D32_SFLOAT;

/// Depth bias of the shadow map, in units of depth resolution and of slope.
const SHADOW_BIAS: [f32; 2] = [4.0, 3.0];

/// Kinds of the bindings of set 0, by their numbers in the shaders.
pub(super) const SCENE_BINDINGS: [vk::DescriptorType; 7] = [
    vk::DescriptorType::UNIFORM_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::STORAGE_BUFFER,
    vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
];

/// Layouts of the scene's set 0 and the light map's set 1, and pipelines.
pub(super) struct Pipelines {
    device: Rc<Device>,
    pub(super) scene_set: vk::DescriptorSetLayout,
    pub(super) light_map_set: vk::DescriptorSetLayout,
    pub(super) layout: vk::PipelineLayout,
    pub(super) shadow: vk::Pipeline,
    pub(super) view: vk::Pipeline,
}

impl Pipelines {
    pub(super) fn new(device: &Rc<Device>) -> Result<Self> {
        let mut pipelines = Self {
            device: device.clone(),
            scene_set: set_layout(device, &SCENE_BINDINGS)?,
            light_map_set: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            shadow: vk::Pipeline::null(),
            view: vk::Pipeline::null(),
        };
        pipelines.light_map_set = set_layout(device, &[vk::DescriptorType::SAMPLED_IMAGE])?;
        let layouts = [pipelines.scene_set, pipelines.light_map_set];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
        // SAFETY: the set layouts were just made.
        let layout = unsafe { device.functions.create_pipeline_layout(&info, None) };
        pipelines.layout = layout.map_err(failed("create a pipeline layout"))?;
        let shadow_vert = Module::new(device, SHADOW_VERT)?;
        let view_vert = Module::new(device, VIEW_VERT)?;
        let view_frag = Module::new(device, VIEW_FRAG)?;
        let vertex = vk::ShaderStageFlags::VERTEX;
        pipelines.shadow = pipelines.create(&[shadow_vert.stage(vertex)], &[])?;
        let stages = [view_vert.stage(vertex), view_frag.stage(vk::ShaderStageFlags::FRAGMENT)];
        pipelines.view = pipelines.create(&stages, &[COLOUR_FORMAT])?;
        Ok(pipelines)
    }

    /// A pipeline with depth, which culls and faces as the command buffer says; without colours the depth is biased.
    fn create(&self, stages: &[vk::PipelineShaderStageCreateInfo<'_>], colours: &[vk::Format]) -> Result<vk::Pipeline> {
        let vertices = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let [constant, slope] = SHADOW_BIAS;
        let rasterization = vk::PipelineRasterizationStateCreateInfo::default()
            .depth_bias_enable(colours.is_empty())
            .depth_bias_constant_factor(constant)
            .depth_bias_slope_factor(slope)
            .line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(true)
            .depth_write_enable(true)
            .depth_compare_op(vk::CompareOp::LESS);
        let masks: Vec<_> = colours
            .iter()
            .map(|_| vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA))
            .collect();
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&masks);
        let states = [
            vk::DynamicState::VIEWPORT,
            vk::DynamicState::SCISSOR,
            vk::DynamicState::CULL_MODE,
            vk::DynamicState::FRONT_FACE,
        ];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(colours)
            .depth_attachment_format(DEPTH_FORMAT);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(stages)
            .vertex_input_state(&vertices)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterization)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .push_next(&mut rendering);
        // SAFETY: the layout has every binding that the shaders use, the modules are alive.
        let made = unsafe { self.device.functions.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        made.map(|pipelines| pipelines[0]).map_err(|(_, result)| failed("create a raster pipeline")(result))
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        let functions = &self.device.functions;
        // SAFETY: every frame is waited for, so the device is done with them; null handles are allowed.
        unsafe {
            functions.destroy_pipeline(self.shadow, None);
            functions.destroy_pipeline(self.view, None);
            functions.destroy_pipeline_layout(self.layout, None);
            functions.destroy_descriptor_set_layout(self.scene_set, None);
            functions.destroy_descriptor_set_layout(self.light_map_set, None);
        }
    }
}

fn set_layout(device: &Rc<Device>, kinds: &[vk::DescriptorType]) -> Result<vk::DescriptorSetLayout> {
    let binding = |(index, kind): (usize, &vk::DescriptorType)| {
        vk::DescriptorSetLayoutBinding::default()
            .binding(index as u32)
            .descriptor_type(*kind)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT)
    };
    let bindings: Vec<_> = kinds.iter().enumerate().map(binding).collect();
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: the description is complete.
    unsafe { device.functions.create_descriptor_set_layout(&info, None) }.map_err(failed("create a set layout"))
}

/// A shader module, needed only while a pipeline is made.
struct Module {
    device: Rc<Device>,
    handle: vk::ShaderModule,
}

impl Module {
    fn new(device: &Rc<Device>, bytes: &[u8]) -> Result<Self> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(bytes);
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are SPIR-V that shaderc made and the build checked.
        let handle =
            unsafe { device.functions.create_shader_module(&info, None) }.map_err(failed("create a shader module"))?;
        Ok(Self { device: device.clone(), handle })
    }

    fn stage(&self, stage: vk::ShaderStageFlags) -> vk::PipelineShaderStageCreateInfo<'_> {
        vk::PipelineShaderStageCreateInfo::default().stage(stage).module(self.handle).name(c"main")
    }
}

impl Drop for Module {
    fn drop(&mut self) {
        // SAFETY: a module may go as soon as its pipelines are made.
        unsafe { self.device.functions.destroy_shader_module(self.handle, None) };
    }
}
