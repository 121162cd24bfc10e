//! Draws with the light map: a triangle over the whole picture, shaded by what the engine finds in it.

use ash::vk;
use lightoven::baker::DeviceLightMap;

/// What a frame is drawn with.
pub(crate) struct Draw {
    size: u32,
    image: vk::Image,
    memory: vk::DeviceMemory,
    view: vk::ImageView,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pipeline: vk::Pipeline,
    descriptors: vk::DescriptorPool,
    /// One for each view that a baker has shown.
    sets: Vec<(vk::ImageView, vk::DescriptorSet)>,
}

const SHADER: &str = "
@group(0) @binding(0) var light_map: texture_2d<f32>;
@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
@fragment fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(light_map, vec2<i32>(place.xy), 0);
}";

fn spirv() -> Vec<u32> {
    let module = naga::front::wgsl::parse_str(SHADER).unwrap();
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all());
    let info = validator.validate(&module).unwrap();
    naga::back::spv::write_vec(&module, &info, &naga::back::spv::Options::default(), None).unwrap()
}

const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

impl Draw {
    pub(crate) fn new(device: &ash::Device, size: u32) -> Self {
        // SAFETY: plain Vulkan, as its specification has it; handles are those that were just made.
        unsafe {
            let info = vk::ImageCreateInfo::default()
                .image_type(vk::ImageType::TYPE_2D)
                .format(FORMAT)
                .extent(vk::Extent3D { width: size, height: size, depth: 1 })
                .mip_levels(1)
                .array_layers(1)
                .samples(vk::SampleCountFlags::TYPE_1)
                .usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
            let image = device.create_image(&info, None).unwrap();
            let requirements = device.get_image_memory_requirements(image);
            let kind = requirements.memory_type_bits.trailing_zeros();
            let info = vk::MemoryAllocateInfo::default().allocation_size(requirements.size).memory_type_index(kind);
            let memory = device.allocate_memory(&info, None).unwrap();
            device.bind_image_memory(image, memory, 0).unwrap();
            let range = vk::ImageSubresourceRange::default()
                .aspect_mask(vk::ImageAspectFlags::COLOR)
                .level_count(1)
                .layer_count(1);
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(FORMAT)
                .subresource_range(range);
            let view = device.create_image_view(&info, None).unwrap();
            let bindings = [vk::DescriptorSetLayoutBinding::default()
                .descriptor_type(vk::DescriptorType::SAMPLED_IMAGE)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::FRAGMENT)];
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let set_layout = device.create_descriptor_set_layout(&info, None).unwrap();
            let layouts = [set_layout];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
            let layout = device.create_pipeline_layout(&info, None).unwrap();
            let pipeline = create_pipeline(device, layout);
            let sizes = [vk::DescriptorPoolSize::default().ty(vk::DescriptorType::SAMPLED_IMAGE).descriptor_count(8)];
            let info = vk::DescriptorPoolCreateInfo::default().max_sets(8).pool_sizes(&sizes);
            let descriptors = device.create_descriptor_pool(&info, None).unwrap();
            Self { size, image, memory, view, set_layout, layout, pipeline, descriptors, sets: Vec::new() }
        }
    }

    /// The set for a view, written when it is first seen.
    fn set(&mut self, device: &ash::Device, map: &DeviceLightMap) -> vk::DescriptorSet {
        if let Some((_, set)) = self.sets.iter().find(|(view, _)| *view == map.view) {
            return *set;
        }
        let layouts = [self.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.descriptors).set_layouts(&layouts);
        // SAFETY: the pool has room for more sets than a baker has maps.
        let set = unsafe { device.allocate_descriptor_sets(&info) }.unwrap()[0];
        let image = [vk::DescriptorImageInfo::default().image_view(map.view).image_layout(map.layout)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .descriptor_type(vk::DescriptorType::SAMPLED_IMAGE)
            .image_info(&image);
        // SAFETY: the set is new; the view lives as long as its baker.
        unsafe { device.update_descriptor_sets(&[write], &[]) };
        self.sets.push((map.view, set));
        set
    }

    pub(crate) fn record(&mut self, device: &ash::Device, commands: vk::CommandBuffer, map: DeviceLightMap) {
        let set = self.set(device, &map);
        let range =
            vk::ImageSubresourceRange::default().aspect_mask(vk::ImageAspectFlags::COLOR).level_count(1).layer_count(1);
        let writes = vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT;
        let barrier = [vk::ImageMemoryBarrier2::default()
            .src_stage_mask(writes)
            .dst_stage_mask(writes)
            .dst_access_mask(vk::AccessFlags2::COLOR_ATTACHMENT_WRITE)
            .new_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .image(self.image)
            .subresource_range(range)];
        let area = vk::Rect2D { extent: vk::Extent2D { width: self.size, height: self.size }, ..Default::default() };
        let attachment = [vk::RenderingAttachmentInfo::default()
            .image_view(self.view)
            .image_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)];
        let rendering = vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&attachment);
        // SAFETY: the command buffer is being recorded; all objects live until the frame was waited for.
        unsafe {
            device.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().image_memory_barriers(&barrier));
            device.cmd_begin_rendering(commands, &rendering);
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline);
            device.cmd_bind_descriptor_sets(commands, vk::PipelineBindPoint::GRAPHICS, self.layout, 0, &[set], &[]);
            device.cmd_draw(commands, 3, 1, 0, 0);
            device.cmd_end_rendering(commands);
        }
    }

    pub(crate) fn destroy(self, device: &ash::Device) {
        // SAFETY: every frame was waited for.
        unsafe {
            device.destroy_descriptor_pool(self.descriptors, None);
            device.destroy_pipeline(self.pipeline, None);
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
            device.destroy_image_view(self.view, None);
            device.destroy_image(self.image, None);
            device.free_memory(self.memory, None);
        }
    }
}

/// # Safety
/// The layout is of this device.
unsafe fn create_pipeline(device: &ash::Device, layout: vk::PipelineLayout) -> vk::Pipeline {
    let words = spirv();
    // SAFETY: the words are valid SPIR-V, the description is complete.
    unsafe {
        let module = device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&words), None).unwrap();
        let stage = |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(name);
        let stages =
            [stage(vk::ShaderStageFlags::VERTEX, c"vertex"), stage(vk::ShaderStageFlags::FRAGMENT, c"fragment")];
        let input = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let area = vk::Rect2D { extent: vk::Extent2D { width: 64, height: 64 }, ..Default::default() };
        let viewports = [vk::Viewport { width: 64.0, height: 64.0, max_depth: 1.0, ..Default::default() }];
        let scissors = [area];
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewports(&viewports).scissors(&scissors);
        let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let mask = [vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&mask);
        let formats = [FORMAT];
        let mut rendering = vk::PipelineRenderingCreateInfo::default().color_attachment_formats(&formats);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .color_blend_state(&blend)
            .layout(layout)
            .push_next(&mut rendering);
        let made = device.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None);
        device.destroy_shader_module(module, None);
        made.unwrap()[0]
    }
}
