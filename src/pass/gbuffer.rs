//! Draws the g-buffer in light-map space: which point of which triangle each texel is.
//! Reads the scene and its textures; writes the surface map, and with textures of albedo or of emission the map of each.
//! Two triangles a triangle.

use super::textures::{Batch, Pair, TextureKind, Textures, batches};
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
    /// One for each kind of texture; one without where there are none.
    layers: Vec<Layer>,
    _list: Buffer,
}

/// A batch of an instance.
struct Draw {
    instance: u32,
    batch: usize,
    vertices: std::ops::Range<u32>,
}

/// The surface map, and a map of textures that is drawn with it.
struct Layer {
    textures: Option<Textures>,
    /// `[batch]`
    sets: Vec<BindingSet>,
}

const VERTICES: u32 = 6;

impl Gbuffer {
    pub(crate) fn new(context: Context<'_>, commands: &mut Commands, scene: &Scene, bvh: &Bvh) -> Result<Self> {
        let Context { gpu, constants, scene: device_scene, maps } = context;
        let kinds = TextureKind::needed(Features::from_bits_truncate(constants.features));
        let textures = kinds.into_iter().map(|kind| Textures::new(commands, scene, bvh, kind).map(Some));
        let mut textures = textures.collect::<Result<Vec<_>>>()?;
        if textures.is_empty() {
            textures.push(None);
        }
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
        let pipeline = create_pipeline(gpu, constants, device_scene, textures[0].as_ref(), &list)?;
        let layer = |textures: Option<Textures>| {
            let set = |batch: &Batch| pipeline.bind(&resources(device_scene, textures.as_ref(), &list, batch.pair));
            let sets = batches.iter().map(set).collect::<Result<_>>()?;
            Ok(Layer { textures, sets })
        };
        let layers = textures.into_iter().map(layer).collect::<Result<_>>()?;
        Ok(Self { pipeline, depth, draws: draws_of(scene, &batches), layers, _list: list })
    }

    /// Bytes that textures take on the device until the pass has run, about.
    pub(crate) fn texture_bytes(scene: &Scene, features: Features) -> Option<(&'static str, u64)> {
        let kinds = TextureKind::needed(features);
        let bytes = kinds.iter().map(|kind| Textures::bytes(scene, *kind, DeviceScene::triangles(scene))).sum();
        (!kinds.is_empty()).then_some(("textures", bytes))
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
        for layer in &self.layers {
            let tints = layer.textures.iter().map(|textures| textures.kind.map(maps));
            let color: Vec<&Image> = std::iter::once(&maps.surface).chain(tints).collect();
            recorder.render(c"gbuffer", &color, &self.depth, &mut |rendering: &mut Rendering| {
                for draw in &self.draws {
                    let push = Push { instance: draw.instance, ..*push };
                    rendering.draw(&self.pipeline, &layer.sets[draw.batch], &push, part(draw.vertices.clone()));
                }
            });
        }
    }
}

/// Batch by batch, each for every instance of its mesh.
fn draws_of(scene: &Scene, batches: &[Batch]) -> Vec<Draw> {
    let mut instances = vec![Vec::new(); scene.meshes().len()];
    for (index, instance) in scene.instances().iter().enumerate() {
        instances[instance.mesh].push(index as u32);
    }
    let mut draws = Vec::new();
    for (batch, Batch { mesh, triangles, .. }) in batches.iter().enumerate() {
        let vertices = triangles.start * VERTICES..triangles.end * VERTICES;
        draws.extend(instances[*mesh].iter().map(|&instance| Draw { instance, batch, vertices: vertices.clone() }));
    }
    draws
}

fn resources<'a>(
    scene: &'a DeviceScene,
    textures: Option<&'a Textures>,
    list: &'a Buffer,
    pair: Pair,
) -> Vec<(u32, Resource<'a>)> {
    let mut resources = scene.surface_resources();
    resources.push((binding::TEXELS, Resource::Storage(list)));
    if let Some(textures) = textures {
        let (image, sampler) = textures.of(pair);
        resources.extend([
            (binding::TEXTURE, Resource::Texture(image, sampler)),
            (binding::TEXCOORDS, Resource::Storage(&textures.texcoords)),
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
    let formats = [vk::Format::R32G32B32A32_UINT, vk::Format::R32G32B32A32_SFLOAT];
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
