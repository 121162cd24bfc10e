//! What is baked, on the host: described by [`SceneDesc`], checked once, read-only afterwards.

mod instance;
mod light;
mod material;
mod mesh;
mod sky;

pub mod atlas;

pub use atlas::{Atlas, AtlasRect, Resolution};
pub use instance::{Instance, Mobility};
pub use light::{Light, LightKind};
pub use material::{Material, Sidedness, Texture, TextureUse, Wrap};
pub use mesh::{Mesh, MeshDesc, MeshPart};
pub use sky::{Sky, SkyMap};

pub(crate) use material::decode_srgb;

use crate::error::{Error, Result};
use glam::{DAffine3, DVec3, Vec3};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Albedo is clamped to this, so that bounces converge (a closed room of albedo 1 has no finite answer).
pub const MAX_ALBEDO: f32 = 0.999;

/// Everything that makes up a scene, not yet checked. [`Scene::new`] checks it.
#[derive(Debug, Clone, Default)]
pub struct SceneDesc {
    /// Shown in reports and written into outputs.
    pub name: String,
    /// Meshes; instances refer to them by position.
    pub meshes: Vec<MeshDesc>,
    /// Placed copies of meshes.
    pub instances: Vec<Instance>,
    /// Materials; mesh parts refer to them by position.
    pub materials: Vec<Material>,
    /// Textures; materials refer to them by position.
    pub textures: Vec<Texture>,
    /// Point, spot and directional lights.
    pub lights: Vec<Light>,
    /// What a ray sees that leaves the scene.
    pub sky: Sky,
}

/// A checked scene: every index is in range, every number is finite, every triangle has an area.
#[derive(Debug, Clone)]
pub struct Scene {
    name: String,
    meshes: Vec<Mesh>,
    instances: Vec<Instance>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    lights: Vec<Light>,
    sky: Sky,
    warnings: Vec<String>,
}

impl Scene {
    /// Checks a description and takes it over.
    ///
    /// Degenerate triangles are dropped, singular instances left out and albedo clamped to [`MAX_ALBEDO`];
    /// each is said in [`Scene::warnings`]. An emission or albedo whose texture is black all over counts as none.
    ///
    /// # Errors
    /// `InvalidScene`, naming the mesh, material, instance or light, the value and what is allowed: an index out of
    /// range, attribute arrays of different lengths, a number that is not finite, a negative emission, albedo or
    /// intensity, light-map coordinates outside \[0,1\].
    pub fn new(desc: SceneDesc) -> Result<Self> {
        let SceneDesc { name, meshes, instances, mut materials, textures, mut lights, sky } = desc;
        let mut warnings = Vec::new();
        textures.iter().try_for_each(Texture::check)?;
        materials.iter_mut().try_for_each(|material| material.check(textures.len(), &mut warnings))?;
        let black: Vec<bool> = textures.iter().map(Texture::is_black).collect();
        materials.iter_mut().for_each(|material| material.heed_black_textures(&black));
        lights.iter_mut().try_for_each(Light::check)?;
        sky.check()?;
        let meshes: Vec<Mesh> =
            meshes.into_iter().map(|mesh| Mesh::new(mesh, &materials, &mut warnings)).collect::<Result<_>>()?;
        let mut kept = Vec::with_capacity(instances.len());
        for instance in instances {
            if instance.check(&meshes, &mut warnings)? {
                kept.push(instance);
            }
        }
        for warning in &warnings {
            tracing::warn!("{warning}");
        }
        Ok(Self { name, meshes, instances: kept, materials, textures, lights, sky, warnings })
    }

    /// The scene's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Checked meshes.
    pub fn meshes(&self) -> &[Mesh] {
        &self.meshes
    }

    /// Instances that can be baked.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// Materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Textures.
    pub fn textures(&self) -> &[Texture] {
        &self.textures
    }

    /// Analytic lights.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The sky.
    pub fn sky(&self) -> &Sky {
        &self.sky
    }

    /// Whether any surface emits.
    pub(crate) fn emits(&self) -> bool {
        let emits = |material: &u32| self.materials[*material as usize].is_emissive();
        self.instances.iter().any(|instance| self.meshes[instance.mesh].materials().iter().any(emits))
    }

    /// Replaces the sky: file formats for scenes rarely carry one.
    ///
    /// # Errors
    /// `InvalidScene` for a radiance that is negative or not finite, or a map with a wrong number of pixels; the scene
    /// keeps its sky.
    pub fn set_sky(&mut self, sky: Sky) -> Result<()> {
        sky.check()?;
        self.sky = sky;
        Ok(())
    }

    /// What was dropped, clamped or left out when the scene was checked, one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Adds what was noticed outside the check, by a reader for instance.
    pub fn warn(&mut self, warning: String) {
        tracing::warn!("{warning}");
        self.warnings.push(warning);
    }

    /// Triangles over all instances, those of a shared mesh counted once for each.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|instance| self.meshes[instance.mesh].len()).sum()
    }

    /// Smallest and largest world coordinate of any vertex; `None` without triangles.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let mut bounds: Option<(DVec3, DVec3)> = None;
        for instance in &self.instances {
            for position in self.meshes[instance.mesh].positions().iter().flatten() {
                let p = instance.transform.transform_point3(position.as_dvec3());
                let (lo, hi) = bounds.unwrap_or((p, p));
                bounds = Some((lo.min(p), hi.max(p)));
            }
        }
        bounds
    }

    /// The point that everything on the device is relative to: the middle of the bounds. Subtracted in f64, so that a
    /// scene far from the origin keeps its precision.
    pub fn centre(&self) -> DVec3 {
        self.bounds().map_or(DVec3::ZERO, |(lo, hi)| (lo + hi) * 0.5)
    }

    /// An instance's transform relative to [`Scene::centre`].
    pub fn centred(&self, instance: &Instance, centre: DVec3) -> DAffine3 {
        DAffine3 { matrix3: instance.transform.matrix3, translation: instance.transform.translation - centre }
    }
}

/// `Ok` when every component is finite and not negative.
pub(crate) fn check_light_quantity(what: impl Fn() -> String, value: Vec3) -> Result<()> {
    if value.is_finite() && value.min_element() >= 0.0 {
        return Ok(());
    }
    Err(Error::scene(format!("{} is {value}; allowed are finite numbers of at least 0", what())))
}

/// A direction brought to unit length; `None` for 0 and for what is not finite. In f64, where no f32 is so long or so short
/// that its square is none.
fn unit(direction: Vec3) -> Option<Vec3> {
    direction.as_dvec3().try_normalize().map(|unit| unit.as_vec3())
}

impl Scene {
    /// A hash of what surfaces look like: materials, textures and where they lie, and of an only instance, which bakes in its
    /// own space, how it is placed. Equal scenes have the same within a process.
    pub(crate) fn looks(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        for Material { name: _, albedo, albedo_texture, emission, emission_texture, sidedness } in &self.materials {
            [*albedo, *emission].map(|colour| colour.to_array().map(f32::to_bits)).hash(&mut hasher);
            (albedo_texture, emission_texture, sidedness).hash(&mut hasher);
        }
        for Texture { name: _, width, height, pixels } in &self.textures {
            (width, height, pixels).hash(&mut hasher);
        }
        for mesh in &self.meshes {
            mesh.materials().hash(&mut hasher);
            for corners in mesh.albedo_uvs().iter().chain(mesh.emission_uvs()) {
                corners.map(|uv| uv.to_array().map(f32::to_bits)).hash(&mut hasher);
            }
        }
        if let [only] = self.instances.as_slice() {
            only.transform.to_cols_array().map(f64::to_bits).hash(&mut hasher);
        }
        hasher.finish()
    }
}

#[cfg(test)]
mod tests;
