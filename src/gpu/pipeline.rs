//! Pipelines: shader, specialisation constants and the kinds of resources in, a finished pipeline out.

use super::bindings::{BindingSet, Resource, set_layout};
use super::layout::Push;
use super::shader::Shader;
use super::{Gpu, vulkan_error};
use crate::bvh::Bvh;
use crate::error::Result;
use crate::features::Features;
use ash::vk;
use bytemuck::{Pod, Zeroable};

/// Values of the specialisation constants; their ids are their places here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Constants {
    /// The scene's `Features`.
    pub(crate) features: u32,
    /// Entries of the traversal stack.
    pub(crate) stack_size: u32,
    /// What `trace.comp` asks of a ray; nobody else reads it.
    pub(crate) query: u32,
    /// Whether the hierarchy is read as texels: [`super::DeviceInfo::reads_texels`], set where a pipeline is made.
    pub(crate) texel_buffers: vk::Bool32,
}

/// Entries of the stack beside nodes: where traversal ends, and where it leaves an object.
const STACK_MARKS: u32 = 2;

impl Constants {
    /// For a scene that needs `features`. The stack grows in steps, so that scenes of about the same depth share compiled
    /// pipelines.
    pub(crate) fn new(features: Features, bvh: &Bvh) -> Self {
        let stack_size = (bvh.most_stack_size() + STACK_MARKS).next_multiple_of(8);
        Self { features: features.bits(), stack_size, query: 0, texel_buffers: vk::FALSE }
    }
}

const CONSTANT_ENTRIES: [vk::SpecializationMapEntry; 4] = [
    vk::SpecializationMapEntry { constant_id: 0, offset: 0, size: 4 },
    vk::SpecializationMapEntry { constant_id: 1, offset: 4, size: 4 },
    vk::SpecializationMapEntry { constant_id: 2, offset: 8, size: 4 },
    vk::SpecializationMapEntry { constant_id: 3, offset: 12, size: 4 },
];

/// What compute and raster pipelines have in common, guarded.
struct Parts {
    gpu: Gpu,
    name: &'static str,
    stages: vk::ShaderStageFlags,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
}

impl Parts {
    fn new(
        gpu: &Gpu,
        name: &'static str,
        stages: vk::ShaderStageFlags,
        resources: &[(u32, Resource<'_>)],
    ) -> Result<Self> {
        let mut parts = Self {
            gpu: gpu.clone(),
            name,
            stages,
            set_layout: set_layout(gpu, name, stages, resources)?,
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
        };
        let layouts = [parts.set_layout];
        let ranges = [vk::PushConstantRange { stage_flags: stages, offset: 0, size: size_of::<Push>() as u32 }];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts).push_constant_ranges(&ranges);
        // SAFETY: the description is complete; the block is within the 128 bytes that every device has.
        parts.layout = unsafe { gpu.device().create_pipeline_layout(&info, None) }
            .map_err(|result| vulkan_error(format!("create the layout of pipeline '{name}'"), result))?;
        Ok(parts)
    }
}

impl Drop for Parts {
    fn drop(&mut self) {
        let device = self.gpu.device();
        // SAFETY: whoever recorded with it has waited for the device before dropping it; null handles are allowed.
        unsafe {
            device.destroy_pipeline(self.pipeline, None);
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

/// A shader module, needed only while a pipeline is made.
struct Module<'a> {
    gpu: &'a Gpu,
    handle: vk::ShaderModule,
}

impl<'a> Module<'a> {
    fn new(gpu: &'a Gpu, shader: &Shader) -> Result<Self> {
        let words = shader.words(gpu.backend());
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
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
pub(crate) struct ComputePipeline(Parts);

impl ComputePipeline {
    /// `resources` give the kinds of bindings; sets are made by [`ComputePipeline::bind`].
    pub(crate) fn new(
        gpu: &Gpu,
        shader: &Shader,
        constants: Constants,
        resources: &[(u32, Resource<'_>)],
    ) -> Result<Self> {
        let mut parts = Parts::new(gpu, shader.name, vk::ShaderStageFlags::COMPUTE, resources)?;
        let module = Module::new(gpu, shader)?;
        let constants = Constants { texel_buffers: gpu.info().reads_texels().into(), ..constants };
        let values = bytemuck::bytes_of(&constants);
        let specialization = vk::SpecializationInfo::default().map_entries(&CONSTANT_ENTRIES).data(values);
        let stage = stage(vk::ShaderStageFlags::COMPUTE, &module, &specialization);
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(parts.layout);
        // SAFETY: the layout has every binding that the shader uses (layout/tests.rs), the module is alive.
        let made = unsafe { gpu.device().create_compute_pipelines(vk::PipelineCache::null(), &[info], None) };
        parts.pipeline = first(made, shader.name)?;
        gpu.name(parts.pipeline, shader.name);
        Ok(Self(parts))
    }

    /// A set with these resources, of the kinds that the pipeline was made with.
    pub(crate) fn bind(&self, resources: &[(u32, Resource<'_>)]) -> Result<BindingSet> {
        BindingSet::new(&self.0.gpu, self.0.name, self.0.set_layout, resources)
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
pub(crate) struct RasterPipeline(Parts);

impl RasterPipeline {
    /// `resources` give the kinds of bindings; sets are made by [`RasterPipeline::bind`].
    pub(crate) fn new(gpu: &Gpu, desc: &RasterDesc<'_>, resources: &[(u32, Resource<'_>)]) -> Result<Self> {
        let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let mut parts = Parts::new(gpu, desc.name, stages, resources)?;
        let (vertex, fragment) = (Module::new(gpu, desc.vertex)?, Module::new(gpu, desc.fragment)?);
        let values = bytemuck::bytes_of(&desc.constants);
        let specialization = vk::SpecializationInfo::default().map_entries(&CONSTANT_ENTRIES).data(values);
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
            .layout(parts.layout)
            .push_next(&mut rendering);
        // SAFETY: the layout has every binding that the shaders use (layout/tests.rs), the modules are alive.
        let made = unsafe { gpu.device().create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        parts.pipeline = first(made, desc.name)?;
        gpu.name(parts.pipeline, desc.name);
        Ok(Self(parts))
    }

    /// A set with these resources, of the kinds that the pipeline was made with.
    pub(crate) fn bind(&self, resources: &[(u32, Resource<'_>)]) -> Result<BindingSet> {
        BindingSet::new(&self.0.gpu, self.0.name, self.0.set_layout, resources)
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

fn record_state(
    parts: &Parts,
    commands: vk::CommandBuffer,
    point: vk::PipelineBindPoint,
    set: &BindingSet,
    push: &Push,
) {
    let device = parts.gpu.device();
    // SAFETY: the command buffer is being recorded; set and constants fit the pipeline's layout.
    unsafe {
        device.cmd_bind_pipeline(commands, point, parts.pipeline);
        device.cmd_bind_descriptor_sets(commands, point, parts.layout, 0, &[set.set], &[]);
        device.cmd_push_constants(commands, parts.layout, parts.stages, 0, bytemuck::bytes_of(push));
    }
}
