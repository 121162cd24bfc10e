//! The scene on the device.

use super::nothing::Nothing;
use super::primitives::{self, Encoded, Radiators};
use crate::bvh::{Bvh, InstanceRecord, Node};
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::{self, binding};
use crate::gpu::{
    Backend, Buffer, BufferDesc, Commands, Gpu, Image, ImageDesc, Location, Recorder, Resource, Sampler, SceneStructure,
};
use crate::scene::{Light, LightKind, Scene, Sky};
use ash::vk;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// The scene's buffers.
pub(crate) struct DeviceScene {
    hierarchy: Hierarchy,
    triangles: Buffer,
    pub(super) primitives: Buffer,
    pub(super) instances: Buffer,
    pub(super) materials: Buffer,
    pub(crate) radiators: Radiators,
    /// What lies in texels beside what the g-buffer has, once somebody has looked.
    pub(crate) pieces: Arc<Buffer>,
    /// `[primitive]`, where rays are aimed.
    pub(crate) host_primitives: Vec<layout::Primitive>,
    pub(crate) lights: Arc<Buffer>,
    pub(crate) light_count: u32,
    pub(crate) sky: Arc<Image>,
    pub(crate) sky_shines: bool,
    sampler: Sampler,
}

/// What rays are traced in.
enum Hierarchy {
    Software(Buffer),
    Hardware(Box<SceneStructure>),
}

impl DeviceScene {
    pub(crate) fn new(
        gpu: &Gpu,
        commands: &mut Commands,
        scene: &Scene,
        bvh: &Bvh,
        features: Features,
        nothing: &Nothing,
    ) -> Result<Self> {
        let Encoded { primitives, radiators } = primitives::encode(scene, bvh, features);
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let input = vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS
            | vk::BufferUsageFlags::ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_KHR;
        let triangle_usage = match gpu.backend() {
            Backend::Software => TRACED,
            Backend::RayQuery => storage | input,
        };
        let triangles = upload(commands, "triangles", triangle_usage, &bvh.triangles)?;
        let hierarchy = match gpu.backend() {
            Backend::Software => Hierarchy::Software(upload_nodes(commands, bvh)?),
            Backend::RayQuery => Hierarchy::Hardware(Box::new(SceneStructure::new(gpu, commands, bvh, &triangles)?)),
        };
        let lights: Vec<layout::Light> =
            lights_that_matter(scene, features).map(|light| encode_light(light, bvh.centre)).collect();
        let sky = features.contains(Features::SKY_MAP).then(|| scene.sky());
        Ok(Self {
            hierarchy,
            triangles,
            primitives: upload(commands, "primitives", storage, &primitives)?,
            pieces: nothing.buffer(),
            host_primitives: if features.contains(Features::IMPORTANCE) { primitives } else { Vec::new() },
            instances: upload(commands, "instances", storage, &bvh.instances)?,
            materials: upload(commands, "materials", storage, &radiators.materials)?,
            radiators,
            light_count: lights.len() as u32,
            lights: upload_any(commands, "lights", &lights, nothing)?,
            sky: upload_sky(commands, sky, nothing)?,
            sky_shines: scene.sky().shines(),
            sampler: Sampler::new(gpu, [vk::SamplerAddressMode::CLAMP_TO_EDGE; 2])?,
        })
    }

    /// Whether a primitive emits.
    pub(super) fn emits(&self, primitive: u32) -> bool {
        let material = self.host_primitives[primitive as usize].material;
        self.radiators.materials[material as usize].emission != [0.0; 3]
    }

    /// Whether two primitives are parts of one plane over the light map.
    pub(super) fn same_sheet(&self, one: layout::Piece, other: layout::Piece) -> bool {
        let sheet = |piece: layout::Piece| self.host_primitives[piece.primitive as usize].sheet;
        one.instance == other.instance && sheet(one) == sheet(other)
    }

    /// What a shader that knows surfaces sees.
    pub(super) fn surface_resources(&self) -> Vec<(u32, Resource<'_>)> {
        vec![
            (binding::TRIANGLES, Resource::Storage(&self.triangles)),
            (binding::PRIMITIVES, Resource::Storage(&self.primitives)),
            (binding::INSTANCES, Resource::Storage(&self.instances)),
            (binding::MATERIALS, Resource::Storage(&self.materials)),
        ]
    }

    /// What a shader that traces rays sees.
    pub(super) fn tracing_resources(&self) -> Vec<(u32, Resource<'_>)> {
        let mut resources = self.surface_resources();
        resources.extend(match &self.hierarchy {
            Hierarchy::Software(nodes) => vec![
                (binding::HIERARCHY, Resource::Storage(nodes)),
                (binding::NODE_TEXELS, Resource::Texels(nodes)),
                (binding::TRIANGLE_TEXELS, Resource::Texels(&self.triangles)),
            ],
            Hierarchy::Hardware(structure) => vec![(binding::HIERARCHY, Resource::Scene(structure))],
        });
        resources
    }

    /// Columns and rows of the sky map.
    pub(crate) fn sky_size(&self) -> [u32; 2] {
        self.sky.size()
    }

    pub(super) fn sky(&self) -> (u32, Resource<'_>) {
        (binding::SKY_MAP, Resource::Texture(&self.sky, &self.sampler))
    }

    /// Records where the instances now are: the records of those that have changed, and the top level.
    pub(crate) fn record_placing(
        &mut self,
        recorder: &mut Recorder<'_>,
        bvh: &Bvh,
        instances: Range<usize>,
    ) -> Result<()> {
        let offset = (instances.start * size_of::<InstanceRecord>()) as u64;
        recorder.update_buffer(&self.instances, offset, &bvh.instances[instances]);
        match &mut self.hierarchy {
            Hierarchy::Software(nodes) => {
                let first = bvh.bottom_nodes();
                recorder.update_buffer(nodes, (first * size_of::<Node>()) as u64, &bvh.nodes[first..]);
                Ok(())
            }
            Hierarchy::Hardware(structure) => structure.rebuild(recorder, bvh),
        }
    }

    pub(crate) fn record_lights(&self, recorder: &mut Recorder<'_>, lights: &[layout::Light]) {
        recorder.update_buffer(&self.lights, 0, lights);
    }

    pub(crate) fn record_radiators(&self, recorder: &mut Recorder<'_>) {
        recorder.update_buffer(&self.materials, 0, &self.radiators.materials);
    }

    /// Triangles of all meshes that are placed.
    pub(crate) fn triangles(scene: &Scene) -> u64 {
        let mut placed = vec![false; scene.meshes().len()];
        scene.instances().iter().for_each(|instance| placed[instance.mesh] = true);
        let meshes = scene.meshes().iter().zip(placed).filter(|(_, placed)| *placed);
        meshes.map(|(mesh, _)| mesh.len() as u64).sum()
    }

    /// Bytes that the scene takes on the device, by name.
    pub(crate) fn bytes(scene: &Scene, features: Features) -> Vec<(&'static str, u64)> {
        let triangles = Self::triangles(scene);
        let size = |bytes: usize, count: u64| bytes as u64 * count;
        let mut parts = vec![
            // Leaves of up to four; measured .27 to .54 nodes a triangle.
            ("nodes", size(size_of::<Node>(), triangles * 2 / 5 + 1)),
            ("triangles", size(size_of::<crate::bvh::Triangle>(), triangles)),
            ("primitives", size(size_of::<layout::Primitive>(), triangles)),
            ("instances", size(size_of::<InstanceRecord>(), scene.instances().len() as u64)),
            ("materials", size(size_of::<layout::Material>(), scene.materials().len() as u64)),
        ];
        let lights = lights_that_matter(scene, features).count() as u64;
        if lights > 0 {
            parts.push(("lights", size(size_of::<layout::Light>(), lights)));
        }
        if let Sky::Map(map) = scene.sky()
            && features.contains(Features::SKY_MAP)
        {
            parts.push(("sky map", size(16, map.pixels.len() as u64)));
        }
        parts
    }
}

/// One that is dark now may shine later, where the scene changes.
fn lights_that_matter(scene: &Scene, features: Features) -> impl Iterator<Item = &Light> {
    let all = features.contains(Features::DYNAMIC);
    scene.lights().iter().filter(move |light| all || light.intensity != Vec3::ZERO)
}

/// What the software back end traces rays in is read one way or the other.
const TRACED: vk::BufferUsageFlags = vk::BufferUsageFlags::from_raw(
    vk::BufferUsageFlags::STORAGE_BUFFER.as_raw() | vk::BufferUsageFlags::UNIFORM_TEXEL_BUFFER.as_raw(),
);

/// With room for any top level.
fn upload_nodes(commands: &mut Commands, bvh: &Bvh) -> Result<Buffer> {
    let mut nodes = bvh.nodes.clone();
    nodes.resize(bvh.most_nodes(), Node::zeroed());
    upload(commands, "nodes", TRACED, &nodes)
}

fn upload<T: bytemuck::Pod>(
    commands: &mut Commands,
    name: &str,
    usage: vk::BufferUsageFlags,
    data: &[T],
) -> Result<Buffer> {
    let size = size_of_val(data) as u64;
    commands.upload(BufferDesc { name, size, usage, location: Location::Device }, data)
}

fn upload_any<T: bytemuck::Pod>(
    commands: &mut Commands,
    name: &str,
    data: &[T],
    nothing: &Nothing,
) -> Result<Arc<Buffer>> {
    if data.is_empty() {
        return Ok(nothing.buffer());
    }
    upload(commands, name, vk::BufferUsageFlags::STORAGE_BUFFER, data).map(Arc::new)
}

/// `sky`: where a map of it is needed, or switched on.
fn upload_sky(commands: &mut Commands, sky: Option<&Sky>, nothing: &Nothing) -> Result<Arc<Image>> {
    let (format, usage) = (vk::Format::R32G32B32A32_SFLOAT, vk::ImageUsageFlags::SAMPLED);
    let Some(sky) = sky else { return Ok(nothing.image(format)) };
    let (size, pixels) = match sky {
        Sky::Map(map) => ([map.width, map.height], map.pixels.as_slice()),
        Sky::Constant(radiance) => ([1, 1], std::slice::from_ref(radiance)),
        Sky::Black => ([1, 1], &[Vec3::ZERO][..]),
    };
    let pixels: Vec<[f32; 4]> = pixels.iter().map(|pixel| pixel.extend(1.0).to_array()).collect();
    let desc = ImageDesc { name: "sky map", size, format, usage, mip_levels: 1 };
    commands.upload_image(desc, &pixels).map(Arc::new)
}

pub(crate) fn encode_light(light: &Light, centre: DVec3) -> layout::Light {
    let mut encoded: layout::Light = layout::Light::zeroed();
    encoded.intensity = light.intensity.into();
    let place = |position: DVec3, range: Option<f32>| ((position - centre).as_vec3().into(), range.unwrap_or(0.0));
    match light.kind {
        LightKind::Point { position, range } => (encoded.position, encoded.range) = place(position, range),
        LightKind::Spot { position, direction, inner_angle, outer_angle, range } => {
            encoded.kind = 1;
            (encoded.position, encoded.range) = place(position, range);
            encoded.direction = direction.into();
            // KHR_lights_punctual: the reference's own scale and offset, with its own least difference.
            let (inner, outer) = (inner_angle.cos(), outer_angle.cos());
            encoded.cone_scale = 1.0 / (inner - outer).max(0.001);
            encoded.cone_offset = -outer * encoded.cone_scale;
        }
        LightKind::Directional { direction } => {
            encoded.kind = 2;
            encoded.direction = direction.into();
        }
    }
    encoded
}
