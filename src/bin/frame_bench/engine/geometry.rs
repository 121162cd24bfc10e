//! The scene as the raster shaders read it.

use super::Device;
use super::layout::{NO_PICTURE, Picture, Placing, Surface, Vertex};
use super::memory::Buffer;
use ash::vk;
use glam::{DAffine3, Vec2, Vec3};
use lightoven::Result;
use lightoven::scene::{Atlas, Mesh, Scene, Sidedness, Texture, TextureUse, Wrap};
use std::ops::Range;
use std::rc::Rc;

/// What one draw call draws: the triangles of one instance that are culled alike.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Batch {
    pub(super) instance: u32,
    pub(super) vertices: Range<u32>,
    pub(super) sidedness: Sidedness,
}

/// Buffers of a scene, and what to draw.
pub(super) struct Geometry {
    pub(super) vertices: Buffer,
    pub(super) placings: Buffer,
    pub(super) surfaces: Buffer,
    pub(super) pictures: Buffer,
    pub(super) pixels: Buffer,
    pub(super) batches: Vec<Batch>,
    /// `[instance]`; of a mirrored one the corners run the other way.
    pub(super) mirrored: Vec<bool>,
    placed: Vec<Placing>,
}

impl Geometry {
    /// Buffers that the host writes: they are filled once, and a benchmark's scenes are small.
    pub(super) fn new(device: &Rc<Device>, scene: &Scene, atlas: &Atlas) -> Result<Self> {
        let mut vertices = Vec::new();
        let ranges: Vec<_> = scene.meshes().iter().map(|mesh| append_mesh(mesh, scene, &mut vertices)).collect();
        let batch = |(index, range): (usize, &(Range<u32>, Sidedness))| Batch {
            instance: index as u32,
            vertices: range.0.clone(),
            sidedness: range.1,
        };
        let instances = scene.instances().iter().enumerate();
        let batches =
            instances.flat_map(|(index, instance)| ranges[instance.mesh].iter().map(move |r| batch((index, r))));
        let batches = batches.filter(|batch| !batch.vertices.is_empty()).collect();
        let mut pictures = Pictures::default();
        let surfaces: Vec<_> = scene
            .materials()
            .iter()
            .map(|material| Surface {
                albedo: material.albedo.to_array(),
                albedo_picture: pictures.add(scene.textures(), material.albedo_texture),
                emission: material.emission.to_array(),
                emission_picture: pictures.add(scene.textures(), material.emission_texture),
            })
            .collect();
        let placed: Vec<_> = scene
            .instances()
            .iter()
            .zip(&atlas.rects)
            .map(|(instance, rect)| Placing {
                object_to_world: rows(&scene.centred(instance, scene.centre())),
                scale: rect.scale.to_array(),
                offset: rect.offset.to_array(),
            })
            .collect();
        let mirrored = scene.instances().iter().map(|i| i.transform.matrix3.determinant() < 0.0).collect();
        Ok(Self {
            vertices: storage(device, "vertices", &vertices)?,
            placings: storage(device, "placings", &placed)?,
            surfaces: storage(device, "surfaces", &surfaces)?,
            pictures: storage(device, "pictures", &pictures.entries)?,
            pixels: storage(device, "pixels", &pictures.pixels)?,
            batches,
            mirrored,
            placed,
        })
    }

    /// Moves an instance; object to world relative to the scene's middle.
    pub(super) fn place(&mut self, instance: usize, transform: &DAffine3) -> Result<()> {
        self.placed[instance].object_to_world = rows(transform);
        let bytes = bytemuck::bytes_of(&self.placed[instance]);
        let start = instance * size_of::<Placing>();
        self.placings.access(|contents| contents[start..start + bytes.len()].copy_from_slice(bytes))
    }
}

fn storage<T: bytemuck::Pod>(device: &Rc<Device>, name: &str, data: &[T]) -> Result<Buffer> {
    Buffer::holding(device, name, bytemuck::cast_slice(data), vk::BufferUsageFlags::STORAGE_BUFFER)
}

fn rows(transform: &DAffine3) -> [[f32; 4]; 3] {
    let (m, t) = (transform.matrix3.transpose(), transform.translation);
    [m.x_axis.extend(t.x), m.y_axis.extend(t.y), m.z_axis.extend(t.z)].map(|row| row.as_vec4().to_array())
}

/// Appends a mesh's corners, those of one-sided triangles first.
fn append_mesh(mesh: &Mesh, scene: &Scene, vertices: &mut Vec<Vertex>) -> [(Range<u32>, Sidedness); 2] {
    [Sidedness::Single, Sidedness::Double].map(|sidedness| {
        let start = vertices.len() as u32;
        for triangle in 0..mesh.len() {
            if scene.materials()[mesh.materials()[triangle] as usize].sidedness == sidedness {
                vertices.extend(corners(mesh, triangle));
            }
        }
        (start..vertices.len() as u32, sidedness)
    })
}

fn corners(mesh: &Mesh, triangle: usize) -> [Vertex; 3] {
    let (positions, normals): (&[Vec3; 3], &[Vec3; 3]) = (&mesh.positions()[triangle], &mesh.normals()[triangle]);
    let light_map_uvs = mesh.light_map_uvs()[triangle];
    let uv = |uvs: &[[Vec2; 3]], corner: usize| uvs.get(triangle).map_or([0.0; 2], |uvs| uvs[corner].to_array());
    [0, 1, 2].map(|corner| Vertex {
        position: positions[corner].to_array(),
        material: mesh.materials()[triangle],
        normal: normals[corner].to_array(),
        mapped: u32::from(light_map_uvs.is_some()),
        light_map_uv: light_map_uvs.map_or([0.0; 2], |uvs| uvs[corner].to_array()),
        albedo_uv: uv(mesh.albedo_uvs(), corner),
        emission_uv: uv(mesh.emission_uvs(), corner),
        _pad: [0.0; 2],
    })
}

/// Textures as materials use them, and their pixels as four half floats each.
#[derive(Default)]
struct Pictures {
    entries: Vec<Picture>,
    pixels: Vec<[u32; 2]>,
    /// Texture and its first pixel.
    loaded: Vec<(usize, u32)>,
}

impl Pictures {
    fn add(&mut self, textures: &[Texture], used: Option<TextureUse>) -> u32 {
        let Some(TextureUse { texture: index, wrap }) = used else { return NO_PICTURE };
        let texture = &textures[index];
        let first_pixel = match self.loaded.iter().find(|(loaded, _)| *loaded == index) {
            Some((_, first)) => *first,
            None => {
                let first = self.pixels.len() as u32;
                self.pixels.extend(texture.pixels.iter().map(linear_halves));
                self.loaded.push((index, first));
                first
            }
        };
        let [across, down] = wrap.map(wrap_code);
        let (width, height) = (texture.width, texture.height);
        self.entries.push(Picture { first_pixel, width, height, wrap: across | down << 8 });
        self.entries.len() as u32 - 1
    }
}

/// As `WRAP_...` in the shader.
fn wrap_code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 0,
        Wrap::MirroredRepeat => 1,
        Wrap::ClampToEdge => 2,
    }
}

fn linear_halves(pixel: &[u8; 4]) -> [u32; 2] {
    let [r, g, b, _] = pixel.map(|c| u32::from(half(decode_srgb(f32::from(c) / 255.0))));
    [r | g << 16, b]
}

/// The linear value of an sRGB-encoded one in [0, 1] (IEC 61966-2-1).
fn decode_srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// A number in [0, 1] as a half float, rounded down; what is below the least normal one, 6e-5, is 0.
fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    let exponent = (bits >> 23) as i32 - 127 + 15;
    if exponent <= 0 { 0 } else { ((exponent as u32) << 10 | (bits >> 13 & 0x3ff)) as u16 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_those_of_ieee_754() {
        assert_eq!((half(0.0), half(1.0), half(0.5), half(0.75)), (0, 0x3c00, 0x3800, 0x3a00));
        assert_eq!(linear_halves(&[255, 0, 255, 9]), [0x3c00, 0x3c00]);
    }
}
