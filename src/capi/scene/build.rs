//! Descriptions to scenes.

use super::desc::{
    LightovenInstance, LightovenLight, LightovenMaterial, LightovenMesh, LightovenMeshPart, LightovenSceneDesc,
    LightovenSky, LightovenTexture, LightovenTextureUse,
};
use super::info::{LightovenScene, SCENES};
use crate::capi::arguments::{check_reserved, check_result, choose, each, read, slice, text, transform, tuples};
use crate::capi::status::{Failure, LightovenStatus, Outcome, guard};
use crate::scene::{
    Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Scene, SceneDesc, Sidedness, Sky, SkyMap,
    Texture, TextureUse, Wrap,
};
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// Checks a scene and takes it over. `desc`, `scene`: not NULL. `scene` is written only where the call succeeds; nothing of the
/// description is needed after it.
///
/// INVALID_SCENE names the mesh, material, instance or light, the value and what is allowed. Triangles without area are dropped,
/// instances with a singular transform left out and albedo clamped; warnings say so (`lightoven_scene_text`).
///
/// # Safety
/// `desc` and what it points to are as its members say; `scene` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lightoven_scene_create(
    desc: *const LightovenSceneDesc,
    scene: *mut LightovenScene,
) -> LightovenStatus {
    guard(|| {
        check_result(scene, "the scene's place")?;
        // SAFETY: as its members say, by the caller's word.
        let desc = unsafe { describe(read(desc, "the description of the scene")?)? };
        let made = Scene::new(desc)?;
        // SAFETY: it may be written by the caller's word.
        unsafe { scene.write(LightovenScene { id: SCENES.insert(made) }) };
        Ok(())
    })
}

/// # Safety
/// All that it points to is as its members say; so for all below.
unsafe fn describe(desc: LightovenSceneDesc) -> Outcome<SceneDesc> {
    let mut described = SceneDesc::default();
    // SAFETY: the caller's word, passed on.
    unsafe {
        described.name = text(desc.name, "the scene's name")?;
        each(desc.meshes, desc.mesh_count, "mesh", |index, value| {
            described.meshes.push(mesh(index, value)?);
            Ok(())
        })?;
        each(desc.instances, desc.instance_count, "instance", |index, value| {
            described.instances.push(instance(index, value)?);
            Ok(())
        })?;
        each(desc.materials, desc.material_count, "material", |index, value| {
            described.materials.push(material(index, value)?);
            Ok(())
        })?;
        each(desc.textures, desc.texture_count, "texture", |index, value| {
            described.textures.push(texture(index, value)?);
            Ok(())
        })?;
        each(desc.lights, desc.light_count, "light", |index, value| {
            described.lights.push(light(&format!("light {index}"), value)?);
            Ok(())
        })?;
        if !desc.sky.is_null() {
            described.sky = sky(read(desc.sky, "the sky")?)?;
        }
    }
    Ok(described)
}

unsafe fn mesh(index: usize, mesh: LightovenMesh) -> Outcome<MeshDesc> {
    let mut parts = Vec::new();
    // SAFETY: the caller's word, passed on.
    unsafe {
        each(mesh.parts, mesh.part_count, format_args!("mesh {index}: part"), |part, value| {
            parts.push(mesh_part(&format!("mesh {index}, part {part}"), value)?);
            Ok(())
        })?;
        Ok(MeshDesc { name: named(text(mesh.name, "a mesh's name")?, "mesh", index), parts })
    }
}

unsafe fn mesh_part(what: &str, part: LightovenMeshPart) -> Outcome<MeshPart> {
    let count = part.vertex_count;
    check_reserved(part.reserved, what)?;
    // SAFETY: the caller's word, passed on.
    unsafe {
        let in_two = |pointer, name: &str| -> Outcome<Option<Vec<Vec2>>> {
            let values = tuples::<2>(pointer, count, format_args!("{what}: {name}"))?;
            Ok(values.map(|values| values.iter().copied().map(Vec2::from_array).collect()))
        };
        let in_three = |pointer, name: &str| -> Outcome<Option<Vec<Vec3>>> {
            let values = tuples::<3>(pointer, count, format_args!("{what}: {name}"))?;
            Ok(values.map(|values| values.iter().copied().map(Vec3::from_array).collect()))
        };
        let positions = in_three(part.positions, "positions")?;
        if positions.is_none() && count > 0 {
            return Err(Failure::argument(format!("{what}: the list of positions is NULL, and there are {count}")));
        }
        Ok(MeshPart {
            positions: positions.unwrap_or_default(),
            normals: in_three(part.normals, "normals")?,
            light_map_uvs: in_two(part.light_map_uvs, "light-map coordinates")?,
            albedo_uvs: in_two(part.albedo_uvs, "albedo coordinates")?,
            emission_uvs: in_two(part.emission_uvs, "emission coordinates")?,
            indices: slice(part.indices, part.index_count, format_args!("{what}: indices"))?.to_vec(),
            material: part.material as usize,
        })
    }
}

/// A name, or what stands for it in messages.
fn named(name: String, kind: &str, index: usize) -> String {
    if name.is_empty() { format!("{kind} {index}") } else { name }
}

unsafe fn instance(index: usize, instance: LightovenInstance) -> Outcome<Instance> {
    let mobility = choose(instance.mobility, "an instance's mobility", &[Mobility::Static, Mobility::Movable])?;
    // SAFETY: the caller's word, passed on.
    unsafe {
        let name = named(text(instance.name, "an instance's name")?, "instance", index);
        let placed = instance.object_to_world;
        let transform = if placed.is_null() { DAffine3::IDENTITY } else { transform(placed)? };
        Ok(Instance { name, mesh: instance.mesh as usize, transform, mobility })
    }
}

unsafe fn material(index: usize, material: LightovenMaterial) -> Outcome<Material> {
    check_reserved(material.reserved, format_args!("material {index}"))?;
    // SAFETY: the caller's word, passed on.
    unsafe {
        Ok(Material {
            name: named(text(material.name, "a material's name")?, "material", index),
            albedo: Vec3::from_array(material.albedo),
            albedo_texture: texture_use(material.albedo_texture)?,
            emission: Vec3::from_array(material.emission),
            emission_texture: texture_use(material.emission_texture)?,
            sidedness: choose(material.sidedness, "a sidedness", &[Sidedness::Single, Sidedness::Double])?,
        })
    }
}

unsafe fn texture_use(used: *const LightovenTextureUse) -> Outcome<Option<TextureUse>> {
    if used.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's word, passed on.
    let used = unsafe { read(used, "a material's texture")? };
    check_reserved(used.reserved, "a material's texture")?;
    let wrap = |number| choose(number, "a texture's wrap", &[Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge]);
    Ok(Some(TextureUse { texture: used.texture as usize, wrap: [wrap(used.wrap_u)?, wrap(used.wrap_v)?] }))
}

/// Columns times rows.
fn area(width: u32, height: u32) -> usize {
    usize::try_from(u64::from(width) * u64::from(height)).unwrap_or(usize::MAX)
}

unsafe fn texture(index: usize, texture: LightovenTexture) -> Outcome<Texture> {
    let LightovenTexture { width, height, .. } = texture;
    // SAFETY: the caller's word, passed on; arrays of bytes lie as bytes do.
    unsafe {
        let what = format!("pixels of texture {index}");
        let pixels = slice(texture.pixels.cast::<[u8; 4]>(), area(width, height), &what)?.to_vec();
        Ok(Texture { name: named(text(texture.name, "a texture's name")?, "texture", index), width, height, pixels })
    }
}

/// # Safety
/// Its name is NULL or ends with a NUL.
pub(in crate::capi) unsafe fn light(otherwise: &str, light: LightovenLight) -> Outcome<Light> {
    let (position, direction) = (DVec3::from_array(light.position), Vec3::from_array(light.direction));
    let range = (light.range != 0.0).then_some(light.range);
    let (inner_angle, outer_angle) = (light.inner_angle, light.outer_angle);
    let kinds = [
        LightKind::Point { position, range },
        LightKind::Spot { position, direction, inner_angle, outer_angle, range },
        LightKind::Directional { direction },
    ];
    let kind = choose(light.kind, "the kind of a light", &kinds)?;
    // SAFETY: the caller's word, passed on.
    let name = unsafe { text(light.name, "a light's name")? };
    let name = if name.is_empty() { otherwise.to_owned() } else { name };
    Ok(Light { name, intensity: Vec3::from_array(light.intensity), kind })
}

/// # Safety
/// A map's pixels are there.
pub(in crate::capi) unsafe fn sky(sky: LightovenSky) -> Outcome<Sky> {
    let LightovenSky { width, height, .. } = sky;
    match choose(sky.kind, "the kind of the sky", &[0, 1, 2])? {
        0 => Ok(Sky::Black),
        1 => Ok(Sky::Constant(Vec3::from_array(sky.radiance))),
        _ => {
            // SAFETY: the caller's word, passed on.
            let pixels = unsafe { tuples::<3>(sky.pixels, area(width, height), "pixels of the sky map")? };
            let pixels = pixels.ok_or_else(|| Failure::argument("the list of pixels of the sky map is NULL"))?;
            Ok(Sky::Map(SkyMap { width, height, pixels: pixels.iter().copied().map(Vec3::from_array).collect() }))
        }
    }
}
