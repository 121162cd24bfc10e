//! A frame as the engine draws it: shadow map, then what the camera sees.

use super::commands::Commands;
use super::geometry::Geometry;
use super::layout::Frame;
use super::memory::{Buffer, Location};
use super::pipeline::{Pipelines, SCENE_BINDINGS};
use super::targets::{Access, SHADOW_SIZE, Targets, barrier};
use super::timer::Timer;
use super::{Device, LightMapView, failed};
use ash::vk;
use glam::{DAffine3, Mat4, Vec3};
use lightoven::Result;
use lightoven::scene::{Atlas, Scene, Sidedness};
use std::rc::Rc;
use std::time::Duration;

/// Light maps that the library may show in turn.
const MOST_LIGHT_MAPS: u32 = 8;

/// How the scene is seen and lit; the world is relative to the scene's middle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    pub(crate) world_to_clip: Mat4,
    pub(crate) world_to_sun: Mat4,
    pub(crate) eye: Vec3,
    pub(crate) exposure: f32,
    /// The way its light travels, of unit length.
    pub(crate) sun_direction: Vec3,
    pub(crate) sun_irradiance: Vec3,
    /// sRGB-encoded.
    pub(crate) background: [f32; 4],
}

/// The engine's passes.
pub(crate) struct Raster {
    device: Rc<Device>,
    pub(super) targets: Targets,
    pipelines: Pipelines,
    geometry: Geometry,
    frame: Buffer,
    pool: DescriptorPool,
    scene_set: vk::DescriptorSet,
    light_map_sets: Vec<(LightMapView, vk::DescriptorSet)>,
    timer: Option<Timer>,
}

struct DescriptorPool(Rc<Device>, vk::DescriptorPool);

impl Raster {
    /// For an image of `size`.
    pub(crate) fn new(device: &Rc<Device>, scene: &Scene, atlas: &Atlas, size: [u32; 2]) -> Result<Self> {
        let (pipelines, pool) = (Pipelines::new(device)?, DescriptorPool::new(device)?);
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let mut raster = Self {
            device: device.clone(),
            targets: Targets::new(device, size)?,
            geometry: Geometry::new(device, scene, atlas)?,
            frame: Buffer::new(device, "frame", size_of::<Frame>() as u64, usage, Location::Host)?,
            scene_set: pool.allocate(pipelines.scene_set)?,
            light_map_sets: Vec::new(),
            timer: Timer::new(device)?,
            pipelines,
            pool,
        };
        raster.write_scene_set();
        Ok(raster)
    }

    /// Moves an instance, between frames; object to world relative to the scene's middle.
    pub(crate) fn place(&mut self, instance: usize, transform: &DAffine3) -> Result<()> {
        self.geometry.place(instance, transform)
    }

    /// Records both passes.
    pub(crate) fn draw(&mut self, commands: &Commands, look: &Look, light_map: LightMapView) -> Result<()> {
        let frame = Frame {
            world_to_clip: look.world_to_clip.to_cols_array(),
            world_to_sun: look.world_to_sun.to_cols_array(),
            eye: look.eye.to_array(),
            exposure: look.exposure,
            sun_direction: look.sun_direction.to_array(),
            shadow_texel: 1.0 / SHADOW_SIZE as f32,
            sun_irradiance: look.sun_irradiance.to_array(),
            _pad: 0.0,
        };
        let bytes = bytemuck::bytes_of(&frame);
        self.frame.access(|contents| contents[..bytes.len()].copy_from_slice(bytes))?;
        let sets = [self.scene_set, self.light_map_set(light_map)?];
        if let Some(timer) = &self.timer {
            timer.start(commands.buffer);
        }
        self.shadow_pass(commands.buffer, sets);
        self.view_pass(commands.buffer, sets, look.background);
        if let Some(timer) = &self.timer {
            timer.stop(commands.buffer);
        }
        Ok(())
    }

    /// The device's time for the passes of the last frame that drew, after it has been waited for.
    pub(crate) fn time(&self) -> Option<Duration> {
        self.timer.as_ref().and_then(Timer::read)
    }

    fn shadow_pass(&self, commands: vk::CommandBuffer, sets: [vk::DescriptorSet; 2]) {
        let shadow = &self.targets.shadow;
        self.barriers(commands, &[barrier(shadow, None, Access::DEPTH)]);
        let depth = depth_attachment(shadow.view(), vk::AttachmentStoreOp::STORE);
        self.begin(commands, [SHADOW_SIZE; 2], &[], &depth);
        self.draw_batches(commands, self.pipelines.shadow, sets, |_| vk::CullModeFlags::NONE);
        self.end(commands);
    }

    fn view_pass(&self, commands: vk::CommandBuffer, sets: [vk::DescriptorSet; 2], background: [f32; 4]) {
        let Targets { colour, depth, shadow, .. } = &self.targets;
        self.barriers(
            commands,
            &[
                barrier(shadow, Some(Access::DEPTH), Access::SAMPLED),
                barrier(colour, None, Access::COLOUR),
                barrier(depth, None, Access::DEPTH),
            ],
        );
        let clear = vk::ClearValue { color: vk::ClearColorValue { float32: background } };
        let colours = [vk::RenderingAttachmentInfo::default()
            .image_view(colour.view())
            .image_layout(vk::ImageLayout::GENERAL)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .clear_value(clear)];
        let depth = depth_attachment(depth.view(), vk::AttachmentStoreOp::DONT_CARE);
        self.begin(commands, colour.size, &colours, &depth);
        self.draw_batches(commands, self.pipelines.view, sets, |sidedness| match sidedness {
            Sidedness::Single => vk::CullModeFlags::BACK,
            Sidedness::Double => vk::CullModeFlags::NONE,
        });
        self.end(commands);
    }

    fn barriers(&self, commands: vk::CommandBuffer, barriers: &[vk::ImageMemoryBarrier2<'_>]) {
        let info = vk::DependencyInfo::default().image_memory_barriers(barriers);
        // SAFETY: the command buffer is being recorded, outside a rendering; the images are alive until it was waited for.
        unsafe { self.device.functions.cmd_pipeline_barrier2(commands, &info) };
    }

    fn begin(
        &self,
        commands: vk::CommandBuffer,
        [width, height]: [u32; 2],
        colours: &[vk::RenderingAttachmentInfo<'_>],
        depth: &vk::RenderingAttachmentInfo<'_>,
    ) {
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } };
        let viewport =
            vk::Viewport { x: 0.0, y: 0.0, width: width as f32, height: height as f32, min_depth: 0.0, max_depth: 1.0 };
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(colours)
            .depth_attachment(depth);
        let functions = &self.device.functions;
        // SAFETY: the command buffer is being recorded, the attachments are of this size and in the layout GENERAL.
        unsafe {
            functions.cmd_begin_rendering(commands, &info);
            functions.cmd_set_viewport(commands, 0, &[viewport]);
            functions.cmd_set_scissor(commands, 0, &[area]);
        }
    }

    fn end(&self, commands: vk::CommandBuffer) {
        // SAFETY: a rendering was begun.
        unsafe { self.device.functions.cmd_end_rendering(commands) };
    }

    fn draw_batches(
        &self,
        commands: vk::CommandBuffer,
        pipeline: vk::Pipeline,
        sets: [vk::DescriptorSet; 2],
        cull: impl Fn(Sidedness) -> vk::CullModeFlags,
    ) {
        let (functions, graphics) = (&self.device.functions, vk::PipelineBindPoint::GRAPHICS);
        // SAFETY: a rendering with the pipeline's formats was begun, the sets are of the pipeline's layouts.
        unsafe {
            functions.cmd_bind_pipeline(commands, graphics, pipeline);
            functions.cmd_bind_descriptor_sets(commands, graphics, self.pipelines.layout, 0, &sets, &[]);
        }
        for batch in &self.geometry.batches {
            let face = match self.geometry.mirrored[batch.instance as usize] {
                false => vk::FrontFace::COUNTER_CLOCKWISE,
                true => vk::FrontFace::CLOCKWISE,
            };
            let (first, count) = (batch.vertices.start, batch.vertices.end - batch.vertices.start);
            // SAFETY: pipeline and sets are bound; vertices and instance are inside their buffers (geometry.rs).
            unsafe {
                functions.cmd_set_cull_mode(commands, cull(batch.sidedness));
                functions.cmd_set_front_face(commands, face);
                functions.cmd_draw(commands, count, 1, first, batch.instance);
            }
        }
    }

    fn write_scene_set(&mut self) {
        let Geometry { vertices, placings, surfaces, pictures, pixels, .. } = &self.geometry;
        let buffers = [&self.frame, vertices, placings, surfaces, pictures, pixels]
            .map(|buffer| [vk::DescriptorBufferInfo::default().buffer(buffer.handle()).range(buffer.size)]);
        let shadow = [vk::DescriptorImageInfo::default()
            .sampler(self.targets.shadow_sampler.1)
            .image_view(self.targets.shadow.view())
            .image_layout(vk::ImageLayout::GENERAL)];
        let writes: Vec<_> = SCENE_BINDINGS
            .iter()
            .enumerate()
            .map(|(binding, kind)| {
                let write = vk::WriteDescriptorSet::default()
                    .dst_set(self.scene_set)
                    .dst_binding(binding as u32)
                    .descriptor_type(*kind)
                    .descriptor_count(1);
                match buffers.get(binding) {
                    Some(buffer) => write.buffer_info(buffer),
                    None => write.image_info(&shadow),
                }
            })
            .collect();
        // SAFETY: no frame uses the set yet; buffers and image live as long as it.
        unsafe { self.device.functions.update_descriptor_sets(&writes, &[]) };
    }

    /// The set of a light map: each that the library shows in turn gets one when it is first seen.
    fn light_map_set(&mut self, light_map: LightMapView) -> Result<vk::DescriptorSet> {
        if let Some((_, set)) = self.light_map_sets.iter().find(|(known, _)| *known == light_map) {
            return Ok(*set);
        }
        let set = self.pool.allocate(self.pipelines.light_map_set)?;
        let image = [vk::DescriptorImageInfo::default().image_view(light_map.view).image_layout(light_map.layout)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .descriptor_type(vk::DescriptorType::SAMPLED_IMAGE)
            .image_info(&image);
        // SAFETY: no frame uses the set yet; the library's images live as long as its baker, which goes after the last
        // frame.
        unsafe { self.device.functions.update_descriptor_sets(&[write], &[]) };
        self.light_map_sets.push((light_map, set));
        Ok(set)
    }
}

fn depth_attachment(view: vk::ImageView, store: vk::AttachmentStoreOp) -> vk::RenderingAttachmentInfo<'static> {
    let far = vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 };
    vk::RenderingAttachmentInfo::default()
        .image_view(view)
        .image_layout(vk::ImageLayout::GENERAL)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(store)
        .clear_value(vk::ClearValue { depth_stencil: far })
}

impl DescriptorPool {
    fn new(device: &Rc<Device>) -> Result<Self> {
        let size = |ty, descriptor_count| vk::DescriptorPoolSize { ty, descriptor_count };
        let sizes = [
            size(vk::DescriptorType::UNIFORM_BUFFER, 1),
            size(vk::DescriptorType::STORAGE_BUFFER, 5),
            size(vk::DescriptorType::COMBINED_IMAGE_SAMPLER, 1),
            size(vk::DescriptorType::SAMPLED_IMAGE, MOST_LIGHT_MAPS),
        ];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1 + MOST_LIGHT_MAPS).pool_sizes(&sizes);
        // SAFETY: the description is complete.
        let pool = unsafe { device.functions.create_descriptor_pool(&info, None) };
        Ok(Self(device.clone(), pool.map_err(failed("create a descriptor pool"))?))
    }

    fn allocate(&self, layout: vk::DescriptorSetLayout) -> Result<vk::DescriptorSet> {
        let layouts = [layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(self.1).set_layouts(&layouts);
        // SAFETY: the layout is alive; a pool that is used up is an error, not undefined.
        let sets = unsafe { self.0.functions.allocate_descriptor_sets(&info) };
        Ok(sets.map_err(failed("create a descriptor set"))?[0])
    }
}

impl Drop for DescriptorPool {
    fn drop(&mut self) {
        // SAFETY: every frame is waited for, so the device is done with its sets.
        unsafe { self.0.functions.destroy_descriptor_pool(self.1, None) };
    }
}
