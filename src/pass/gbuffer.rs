//! Draws the g-buffer in light-map space: which point of which triangle each texel is.
//! Reads the scene and its textures; writes the surface map, and with textures those of albedo and emission. Two
//! triangles a triangle.

use super::textures::{Batch, Textures, batches};
use super::{Context, DeviceScene, Maps};
use crate::bvh::Bvh;
use crate::error::Result;
use crate::features::Features;
use crate::gpu::layout::{Push, binding};
use crate::gpu::{
    BindingSet, Buffer, BufferDesc, Commands, Constants, GBUFFER_FRAG, GBUFFER_VERT, Gpu, Image, ImageDesc, Location,
    RasterDesc, RasterPipeline, Recorder, Rendering, Resource, TEXTURED_FRAG,
};
use crate::scene::Scene;
use ash::vk;

/// The pass, and what only it needs: it can be dropped once it has run.
pub(crate) struct Gbuffer {
    pipeline: RasterPipeline,
    depth: Image,
    draws: Vec<Draw>,
    /// Where there are any, albedo and emission are drawn too.
    textures: Option<Textures>,
    _list: Buffer,
}

/// A batch of an instance.
struct Draw {
    instance: u32,
    set: std::rc::Rc<BindingSet>,
    vertices: std::ops::Range<u32>,
}

const VERTICES: u32 = 6;

impl Gbuffer {
    pub(crate) fn new(context: Context<'_>, commands: &mut Commands, scene: &Scene, bvh: &Bvh) -> Result<Self> {
        let Context { gpu, constants, scene: device_scene, maps } = context;
        let textured = Features::from_bits_truncate(constants.features).contains(Features::TEXTURES);
        let textures = textured.then(|| Textures::new(gpu, commands, scene)).transpose()?;
        let (batches, primitives) = batches(scene, bvh);
        let list = commands.upload(
            BufferDesc {
                name: "batches",
                size: size_of_val(primitives.as_slice()) as u64,
                usage: vk::BufferUsageFlags::STORAGE_BUFFER,
                location: Location::Device,
            },
            &primitives,
        )?;
        let depth = create_depth(gpu, commands, maps.size)?;
        let pipeline = create_pipeline(gpu, constants, device_scene, textures.as_ref(), &list)?;
        let mut draws = Vec::new();
        for batch in &batches {
            let set =
                std::rc::Rc::new(pipeline.bind(&resources(device_scene, textures.as_ref(), &list, batch.pair))?);
            draws.extend(draws_of(scene, batch).map(|(instance, vertices)| Draw {
                instance,
                set: set.clone(),
                vertices,
            }));
        }
        Ok(Self { pipeline, depth, draws, textures, _list: list })
    }

    pub(crate) fn record(&self, recorder: &mut Recorder<'_>, maps: &Maps, push: &Push) {
        self.draw(recorder, maps, push, &|vertices| vertices);
    }

    /// Draws one triangle into images that are drawn again afterwards: drivers that compile at the first use do so here.
    pub(crate) fn record_first_use(&self, recorder: &mut Recorder<'_>, maps: &Maps, push: &Push) {
        self.draw(recorder, maps, push, &|vertices| vertices.start..vertices.start + VERTICES);
    }

    fn draw(
        &self,
        recorder: &mut Recorder<'_>,
        maps: &Maps,
        push: &Push,
        part: &dyn Fn(std::ops::Range<u32>) -> std::ops::Range<u32>,
    ) {
        let mut color = vec![&maps.surface];
        if self.textures.is_some() {
            color.extend([&*maps.albedo, &maps.emission]);
        }
        recorder.render(c"gbuffer", &color, &self.depth, &mut |rendering: &mut Rendering| {
            for draw in &self.draws {
                let push = Push { instance: draw.instance, ..*push };
                rendering.draw(&self.pipeline, &draw.set, &push, part(draw.vertices.clone()));
            }
        });
    }
}

/// (instance, vertices) of every instance of the batch's mesh.
fn draws_of<'a>(scene: &'a Scene, batch: &'a Batch) -> impl Iterator<Item = (u32, std::ops::Range<u32>)> + 'a {
    let of_mesh = scene.instances().iter().enumerate().filter(|(_, instance)| instance.mesh == batch.mesh);
    of_mesh.map(|(index, _)| (index as u32, batch.triangles.start * VERTICES..batch.triangles.end * VERTICES))
}

fn resources<'a>(
    scene: &'a DeviceScene,
    textures: Option<&'a Textures>,
    list: &'a Buffer,
    pair: super::textures::Pair,
) -> Vec<(u32, Resource<'a>)> {
    let mut resources = scene.surface_resources();
    resources.push((binding::TEXELS, Resource::Storage(list)));
    if let Some(textures) = textures {
        let texture = |usage| {
            let (image, sampler) = textures.of(usage);
            Resource::Texture(image, sampler)
        };
        resources.extend([
            (binding::ALBEDO_TEXTURE, texture(pair[0])),
            (binding::EMISSION_TEXTURE, texture(pair[1])),
            (binding::TEXCOORDS, Resource::Storage(&scene.texcoords)),
        ]);
    }
    resources
}

fn create_depth(gpu: &Gpu, commands: &mut Commands, size: [u32; 2]) -> Result<Image> {
    let (format, usage) = (DEPTH_FORMAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT);
    let depth = Image::new(gpu, ImageDesc { name: "gbuffer depth", size, format, usage, mip_levels: 1 })?;
    commands.run(|recorder| {
        recorder.initialise(&[&depth]);
        Ok(())
    })?;
    Ok(depth)
}

const DEPTH_FORMAT: vk::Format = vk::Format::D32_SFLOAT;

fn create_pipeline(
    gpu: &Gpu,
    constants: Constants,
    scene: &DeviceScene,
    textures: Option<&Textures>,
    list: &Buffer,
) -> Result<RasterPipeline> {
    let formats = [vk::Format::R32G32B32A32_UINT, vk::Format::R32G32B32A32_SFLOAT, vk::Format::R32G32B32A32_SFLOAT];
    let (fragment, color_formats) =
        if textures.is_some() { (&TEXTURED_FRAG, &formats[..]) } else { (&GBUFFER_FRAG, &formats[..1]) };
    let desc = RasterDesc {
        name: "gbuffer",
        vertex: &GBUFFER_VERT,
        fragment,
        constants,
        color_formats,
        depth_format: DEPTH_FORMAT,
    };
    RasterPipeline::new(gpu, &desc, &resources(scene, textures, list, [None, None]))
}
