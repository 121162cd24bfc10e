//! What a scene needs: what it does not need is not run, not built and not allocated.

use crate::scene::{Material, Mobility, Scene, Sidedness, Sky};

bitflags::bitflags! {
    /// What a scene needs, as the shaders' specialisation constant has it (`glsl/include/layout.glsl`).
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub struct Features: u32 {
        /// A top level over more than one instance.
        const INSTANCES = 1;
        /// Some surface is black from behind: texels inside of something are looked for.
        const SINGLE_SIDED = 1 << 1;
        /// Some triangle has no place in the light map.
        const UNMAPPED = 1 << 2;
        /// The sky is a map.
        const SKY_MAP = 1 << 3;
        /// There are analytic lights. Their kinds have no bits: 200 point lights over a Cornell box took 1.01 s with the
        /// branches of other kinds cut out of the shader, and 1.02 with them.
        const LIGHTS = 1 << 4;
        /// Some surface of the light map has a texture of albedo, which then differs from texel to texel.
        const ALBEDO_TEXTURES = 1 << 5;
        /// Some surface of the light map that shines, or may come to, has a texture of emission.
        const EMISSION_TEXTURES = 1 << 6;
        /// The light map follows a scene that changes.
        const DYNAMIC = 1 << 7;
        /// Rays are aimed at light as well: no property of the scene, but of how it is baked.
        const IMPORTANCE = 1 << 8;
        /// Something that emits shares a texel with another surface.
        const SHARED_TEXELS = 1 << 9;
        /// Rays are aimed at clusters of texels, by distance too.
        const CLUSTERS = 1 << 10;
        /// And by what has been seen of them.
        const VISIBILITY = 1 << 11;
        /// Light is reflected again and again along rays that are traced once: where so many may be kept.
        const LINKS = 1 << 12;
        /// Samples are kept in two halves, which tell the error.
        const HALVES = 1 << 13;
        /// There is light that rays can find: what shines beside analytic lights, or what these shine at and that reflects.
        const GATHERING = 1 << 14;
    }
}

impl Features {
    /// What `scene` needs when it changes while it is baked: of sky and lights also what may come.
    pub(crate) fn of_changing(scene: &Scene) -> Self {
        let mut features = Self::of(scene) | Self::DYNAMIC;
        features.set(Self::SKY_MAP, matches!(scene.sky(), Sky::Map(_)));
        features.set(Self::LIGHTS, !scene.lights().is_empty());
        // A material that is dark now may shine later.
        features
            .set(Self::EMISSION_TEXTURES, baked_materials(scene).any(|material| material.emission_texture.is_some()));
        let moves = scene.instances().iter().any(|instance| instance.mobility == Mobility::Movable);
        features.set(Self::INSTANCES, features.contains(Self::INSTANCES) || moves);
        features
    }

    /// What `scene` needs when it stays as it is.
    pub(crate) fn of(scene: &Scene) -> Self {
        let materials = || scene.materials().iter();
        let meshes = || scene.instances().iter().map(|instance| &scene.meshes()[instance.mesh]);
        let mut features = Self::empty();
        features.set(Self::INSTANCES, scene.instances().len() != 1);
        features.set(Self::SINGLE_SIDED, materials().any(|material| material.sidedness == Sidedness::Single));
        features.set(Self::UNMAPPED, meshes().any(|mesh| mesh.light_map_uvs().iter().any(Option::is_none)));
        features.set(Self::SKY_MAP, matches!(scene.sky(), Sky::Map(_)) && scene.sky().shines());
        features.set(Self::LIGHTS, scene.lights().iter().any(|light| light.intensity.max_element() > 0.0));
        features.set(Self::ALBEDO_TEXTURES, baked_materials(scene).any(|material| material.albedo_texture.is_some()));
        let emission = |material: &Material| material.emission_texture.is_some() && material.is_emissive();
        features.set(Self::EMISSION_TEXTURES, baked_materials(scene).any(emission));
        features
    }

    /// Those that serve rays, and nothing else.
    pub(crate) const OF_RAYS: Self = Self::UNMAPPED
        .union(Self::SKY_MAP)
        .union(Self::ALBEDO_TEXTURES)
        .union(Self::EMISSION_TEXTURES)
        .union(Self::IMPORTANCE)
        .union(Self::SHARED_TEXELS)
        .union(Self::CLUSTERS)
        .union(Self::VISIBILITY)
        .union(Self::LINKS)
        .union(Self::HALVES);

    /// What the scene does without, in words.
    pub fn left_out(self) -> Vec<(Self, &'static str)> {
        let words = [
            (Self::INSTANCES, "one instance: no top level of the hierarchy"),
            (Self::SINGLE_SIDED, "no single-sided surface: no back-face tests"),
            (Self::UNMAPPED, "every triangle has light-map coordinates: no look-up of unmapped ones"),
            (Self::SKY_MAP, "no map of the sky"),
            (Self::LIGHTS, "no analytic lights: no direct pass and no map for it"),
            (Self::ALBEDO_TEXTURES, "no textures of albedo: no map of it"),
            (Self::EMISSION_TEXTURES, "no textures of emission: no map of it"),
            (Self::GATHERING, "no light that rays could find: none sent, and no maps for them"),
            (Self::IMPORTANCE, "rays by the cosine alone: none aimed, no lines of sight"),
            (Self::CLUSTERS, "no rays aimed by distance: no clusters of what shines"),
            (Self::VISIBILITY, "none by what has been seen: no rays counted"),
            (Self::LINKS, "no links: every bounce traces its rays"),
            (Self::HALVES, "no error asked for: no halves of the samples"),
            (Self::DYNAMIC, "nothing changes: no running average, no second source map"),
        ];
        // Where no rays are sent nothing is left out of them.
        let known = if self.contains(Self::GATHERING) { Self::all() } else { Self::all().difference(Self::OF_RAYS) };
        words.into_iter().filter(|(bits, _)| known.contains(*bits) && !self.intersects(*bits)).collect()
    }
}

/// Those of triangles that have a place in the light map, one for each of them.
pub(crate) fn baked_materials(scene: &Scene) -> impl Iterator<Item = &Material> {
    let meshes = scene.instances().iter().map(|instance| &scene.meshes()[instance.mesh]);
    let triangles = meshes.flat_map(|mesh| mesh.materials().iter().zip(mesh.light_map_uvs()));
    triangles.filter(|(_, uvs)| uvs.is_some()).map(|(material, _)| &scene.materials()[*material as usize])
}
