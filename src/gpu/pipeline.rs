//! Pipelines: shader, specialisation constants and the kinds of resources in, a finished pipeline out.

use super::bindings::{BindingSet, Resource, set_layout};
use super::constants::Constants;
use super::layout::Push;
use super::objects::Counted;
use super::shader::Shader;
use super::{Gpu, vulkan_error};
use crate::error::Result;
use ash::vk;
use std::sync::Arc;

/// What makes two pipelines the same.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct PipelineKey {
    /// One of each stage.
    shaders: Vec<&'static str>,
    constants: Constants,
    bindings: Vec<(u32, vk::DescriptorType)>,
    /// Those of the attachments, depth last; none for a compute pipeline.
    formats: Vec<vk::Format>,
}

/// A pipeline's layout with that of its set, guarded.
struct Layout {
    gpu: Gpu,
    stages: vk::ShaderStageFlags,
    set_layout: vk::DescriptorSetLayout,
    handle: vk::PipelineLayout,
}

impl Layout {
    fn new(
        gpu: &Gpu,
        name: &'static str,
        stages: vk::ShaderStageFlags,
        resources: &[(u32, Resource<'_>)],
    ) -> Result<Self> {
        let set_layout = set_layout(gpu, name, stages, resources)?;
        let mut layout = Self { gpu: gpu.clone(), stages, set_layout, handle: vk::PipelineLayout::null() };
        let layouts = [layout.set_layout];
        let ranges = [vk::PushConstantRange { stage_flags: stages, offset: 0, size: size_of::<Push>() as u32 }];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts).push_constant_ranges(&ranges);
        // SAFETY: the description is complete; the block is within the 128 bytes that every device has.
        layout.handle = unsafe { gpu.device().create_pipeline_layout(&info, None) }
            .map_err(|result| vulkan_error(format!("create the layout of pipeline '{name}'"), result))?;
        Ok(layout)
    }
}

impl Drop for Layout {
    fn drop(&mut self) {
        let device = self.gpu.device();
        // SAFETY: the pipeline went before it, or was never made; null handles are allowed.
        unsafe {
            device.destroy_pipeline_layout(self.handle, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

/// What compute and raster pipelines have in common. All that need the same share one.
pub(super) struct Pipeline {
    gpu: Gpu,
    name: &'static str,
    handle: vk::Pipeline,
    layout: Layout,
    _counted: Counted,
}

impl Pipeline {
    fn new(gpu: &Gpu, name: &'static str, handle: vk::Pipeline, layout: Layout, modules: &[&[u32]]) -> Self {
        gpu.name(handle, name);
        Self { gpu: gpu.clone(), name, handle, layout, _counted: gpu.count_pipeline(name, modules) }
    }

    fn bind(&self, resources: &[(u32, Resource<'_>)]) -> Result<BindingSet> {
        BindingSet::new(&self.gpu, self.name, self.layout.set_layout, resources)
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: each that shared it has waited, before dropping its share, for the device to be done with what it
        // recorded.
        unsafe { self.gpu.device().destroy_pipeline(self.handle, None) };
    }
}

/// A shader module, needed only while a pipeline is made.
struct Module<'a> {
    gpu: &'a Gpu,
    handle: vk::ShaderModule,
}

impl<'a> Module<'a> {
    fn new(gpu: &'a Gpu, shader: &Shader, words: &[u32]) -> Result<Self> {
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words are SPIR-V that shaderc made and the build checked.
        let handle = unsafe { gpu.device().create_shader_module(&info, None) }
            .map_err(|result| vulkan_error(format!("create shader module '{}'", shader.name), result))?;
        Ok(Self { gpu, handle })
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: a module may go as soon as its pipelines are made.
        unsafe { self.gpu.device().destroy_shader_module(self.handle, None) };
    }
}

/// A compute pipeline.
pub(crate) struct ComputePipeline(Arc<Pipeline>);

impl ComputePipeline {
    /// `resources` give the kinds of bindings; sets are made by [`ComputePipeline::bind`].
    pub(crate) fn new(
        gpu: &Gpu,
        shader: &Shader,
        constants: Constants,
        resources: &[(u32, Resource<'_>)],
    ) -> Result<Self> {
        let words = shader.words(gpu.backend());
        let constants = Constants { texel_buffers: gpu.info().reads_texels().into(), ..constants };
        let key = PipelineKey {
            shaders: vec![shader.name],
            constants: constants.as_read_by([&*words]),
            bindings: kinds(resources),
            formats: Vec::new(),
        };
        let make = |key: &PipelineKey| {
            let layout = Layout::new(gpu, shader.name, vk::ShaderStageFlags::COMPUTE, resources)?;
            let module = Module::new(gpu, shader, &words)?;
            let specialization = key.constants.specialization();
            let stage = stage(vk::ShaderStageFlags::COMPUTE, &module, &specialization);
            let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout.handle);
            // SAFETY: the layout has every binding that the shader uses (layout/tests.rs), the module is alive.
            let made = unsafe { gpu.device().create_compute_pipelines(gpu.pipelines_kept(), &[info], None) };
            Ok(Pipeline::new(gpu, shader.name, first(made, shader.name)?, layout, &[&words]))
        };
        gpu.inner.pipelines.get_or_make(key, make).map(Self)
    }

    /// A set with these resources, of the kinds that the pipeline was made with.
    pub(crate) fn bind(&self, resources: &[(u32, Resource<'_>)]) -> Result<BindingSet> {
        self.0.bind(resources)
    }

    /// Records a dispatch.
    pub(super) fn dispatch(&self, commands: vk::CommandBuffer, set: &BindingSet, push: &Push, groups: [u32; 2]) {
        let device = self.0.gpu.device();
        record_state(&self.0, commands, vk::PipelineBindPoint::COMPUTE, set, push);
        // SAFETY: the command buffer is being recorded, pipeline, set and constants are bound.
        unsafe { device.cmd_dispatch(commands, groups[0], groups[1], 1) };
    }
}

/// What a raster pipeline draws with and into.
pub(crate) struct RasterDesc<'a> {
    pub(crate) name: &'static str,
    pub(crate) vertex: &'a Shader,
    pub(crate) fragment: &'a Shader,
    pub(crate) constants: Constants,
    pub(crate) color_formats: &'a [vk::Format],
    pub(crate) depth_format: vk::Format,
}

/// A raster pipeline: triangle lists without vertex buffers, nearest depth wins and of equal ones the last, no blending, no culling.
pub(crate) struct RasterPipeline(Arc<Pipeline>);

impl RasterPipeline {
    /// `resources` give the kinds of bindings; sets are made by [`RasterPipeline::bind`].
    pub(crate) fn new(gpu: &Gpu, desc: &RasterDesc<'_>, resources: &[(u32, Resource<'_>)]) -> Result<Self> {
        let words = [desc.vertex, desc.fragment].map(|shader| shader.words(gpu.backend()));
        let key = PipelineKey {
            shaders: vec![desc.vertex.name, desc.fragment.name],
            constants: desc.constants.as_read_by(words.iter().map(Vec::as_slice)),
            bindings: kinds(resources),
            formats: [desc.color_formats, &[desc.depth_format]].concat(),
        };
        let make = |key: &PipelineKey| {
            let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
            let layout = Layout::new(gpu, desc.name, stages, resources)?;
            let handle = Self::create(gpu, desc, &words, key.constants, &layout)?;
            Ok(Pipeline::new(gpu, desc.name, handle, layout, &[&words[0], &words[1]]))
        };
        gpu.inner.pipelines.get_or_make(key, make).map(Self)
    }

    fn create(
        gpu: &Gpu,
        desc: &RasterDesc<'_>,
        words: &[Vec<u32>; 2],
        constants: Constants,
        layout: &Layout,
    ) -> Result<vk::Pipeline> {
        let vertex = Module::new(gpu, desc.vertex, &words[0])?;
        let fragment = Module::new(gpu, desc.fragment, &words[1])?;
        let specialization = constants.specialization();
        let shader_stages = [
            stage(vk::ShaderStageFlags::VERTEX, &vertex, &specialization),
            stage(vk::ShaderStageFlags::FRAGMENT, &fragment, &specialization),
        ];
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(true)
            .depth_write_enable(true)
            .depth_compare_op(vk::CompareOp::LESS_OR_EQUAL);
        let write_all =
            vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA);
        let attachments = vec![write_all; desc.color_formats.len()];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&attachments);
        let dynamic_states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic_states);
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(desc.color_formats)
            .depth_attachment_format(desc.depth_format);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&shader_stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout.handle)
            .push_next(&mut rendering);
        // SAFETY: the layout has every binding that the shaders use (layout/tests.rs), the modules are alive.
        let made = unsafe { gpu.device().create_graphics_pipelines(gpu.pipelines_kept(), &[info], None) };
        first(made, desc.name)
    }

    /// A set with these resources, of the kinds that the pipeline was made with.
    pub(crate) fn bind(&self, resources: &[(u32, Resource<'_>)]) -> Result<BindingSet> {
        self.0.bind(resources)
    }

    /// Records a draw, within a rendering of the recorder's.
    pub(super) fn draw(
        &self,
        commands: vk::CommandBuffer,
        set: &BindingSet,
        push: &Push,
        vertices: std::ops::Range<u32>,
    ) {
        record_state(&self.0, commands, vk::PipelineBindPoint::GRAPHICS, set, push);
        // SAFETY: the command buffer is inside a rendering, pipeline, set and constants are bound.
        unsafe { self.0.gpu.device().cmd_draw(commands, vertices.end - vertices.start, 1, vertices.start, 0) };
    }
}

fn stage<'a>(
    stage: vk::ShaderStageFlags,
    module: &Module<'_>,
    specialization: &'a vk::SpecializationInfo<'a>,
) -> vk::PipelineShaderStageCreateInfo<'a> {
    vk::PipelineShaderStageCreateInfo::default()
        .stage(stage)
        .module(module.handle)
        .name(c"main")
        .specialization_info(specialization)
}

/// The only pipeline of a call that makes one.
fn first(made: Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>, name: &str) -> Result<vk::Pipeline> {
    let pipelines = made.map_err(|(_, result)| vulkan_error(format!("create pipeline '{name}'"), result))?;
    Ok(pipelines[0])
}

/// Bindings with what stands there.
fn kinds(resources: &[(u32, Resource<'_>)]) -> Vec<(u32, vk::DescriptorType)> {
    resources.iter().map(|(binding, resource)| (*binding, resource.kind())).collect()
}

fn record_state(
    pipeline: &Pipeline,
    commands: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    set: &BindingSet,
    push: &Push,
) {
    let device = pipeline.gpu.device();
    let layout = &pipeline.layout;
    // SAFETY: the command buffer is being recorded; set and constants fit the pipeline's layout.
    unsafe {
        device.cmd_bind_pipeline(commands, point, pipeline.handle);
        device.cmd_bind_descriptor_sets(commands, point, layout.handle, 0, &[set.set], &[]);
        device.cmd_push_constants(commands, layout.handle, layout.stages, 0, bytemuck::bytes_of(push));
    }
}
