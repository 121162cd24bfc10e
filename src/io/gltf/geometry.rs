//! Meshes in use.

use super::accessors::Accessors;
use super::bounds::Buffers;
use super::materials::{Materials, UvSource};
use super::names;
use crate::error::Result;
use crate::scene::{MeshDesc, MeshPart};
use glam::{Vec2, Vec3};
use gltf::json::mesh::Primitive as Json;
use gltf::json::validation::Checked;
use gltf::mesh::{Mode, Semantic};
use gltf::{Accessor, Document, Mesh, Primitive};
use std::collections::{HashMap, HashSet};

/// `n` of the `TEXCOORD_n` that is the light map.
const LIGHT_MAP_SET: u32 = 1;

/// Meshes in the order of their first use, and what was noticed.
pub(super) struct Meshes<'a> {
    document: &'a Document,
    /// The document's, by position: the crate counts its way to each from the first one on.
    accessors: Vec<Accessor<'a>>,
    meshes: Vec<MeshDesc>,
    /// From the document's index.
    positions: HashMap<usize, usize>,
    /// `[mesh]` triangles without light-map coordinates.
    unmapped: Vec<usize>,
    /// Those of all instances.
    unmapped_in_scene: usize,
    /// Numbers read from accessors.
    numbers: usize,
    /// In the order of their first use, and to look up.
    skinned: Vec<String>,
    known_skinned: HashSet<String>,
    morphed: Vec<String>,
    others: Vec<String>,
}

impl<'a> Meshes<'a> {
    /// None of a document's.
    pub(super) fn new(document: &'a Document) -> Self {
        Self {
            document,
            accessors: document.accessors().collect(),
            meshes: Vec::new(),
            positions: HashMap::new(),
            unmapped: Vec::new(),
            unmapped_in_scene: 0,
            numbers: 0,
            skinned: Vec::new(),
            known_skinned: HashSet::new(),
            morphed: Vec::new(),
            others: Vec::new(),
        }
    }

    /// The position of a mesh among those in use, for one more instance of it.
    pub(super) fn place(
        &mut self,
        mesh: &Mesh<'_>,
        skinned: bool,
        buffers: &Buffers,
        materials: &mut Materials,
    ) -> Result<usize> {
        let position = match self.positions.get(&mesh.index()) {
            Some(position) => *position,
            None => self.add(mesh, buffers, materials)?,
        };
        self.unmapped_in_scene = self.unmapped_in_scene.saturating_add(self.unmapped[position]);
        let name = &self.meshes[position].name;
        if skinned && self.known_skinned.insert(name.clone()) {
            self.skinned.push(name.clone());
        }
        Ok(position)
    }

    fn add(&mut self, mesh: &Mesh<'_>, buffers: &Buffers, materials: &mut Materials) -> Result<usize> {
        let name = names::of_mesh(mesh);
        let mut parts = Vec::new();
        let mut unmapped = 0;
        let mut left_out: Vec<Mode> = Vec::new();
        let mut accessors = Accessors::new(buffers, self.numbers);
        let described = &self.document.as_json().meshes[mesh.index()].primitives;
        for (primitive, json) in mesh.primitives().zip(described) {
            let Some(topology) = Topology::of(primitive.mode()) else {
                left_out.push(primitive.mode());
                continue;
            };
            let mut reader = PrimitiveReader {
                mesh: &name,
                primitive: &primitive,
                json,
                all: &self.accessors,
                accessors: &mut accessors,
            };
            let Some(part) = reader.part(topology, materials, &mut self.others)? else { continue };
            if part.light_map_uvs.is_none() {
                unmapped += if part.indices.is_empty() { part.positions.len() } else { part.indices.len() } / 3;
            }
            parts.push(part);
        }
        self.numbers = accessors.read();
        if !left_out.is_empty() {
            let count = left_out.len();
            left_out.dedup();
            self.others
                .push(format!("mesh '{name}': {count} primitives that are no triangles are left out: {left_out:?}"));
        }
        if mesh.primitives().any(|primitive| primitive.morph_targets().next().is_some()) {
            self.morphed.push(name.clone());
        }
        self.meshes.push(MeshDesc { name, parts });
        self.unmapped.push(unmapped);
        self.positions.insert(mesh.index(), self.meshes.len() - 1);
        Ok(self.meshes.len() - 1)
    }

    /// What was left out or taken for something else.
    pub(super) fn warnings(&self) -> Vec<String> {
        let mut warnings = self.others.clone();
        if !self.skinned.is_empty() {
            warnings.push(format!("skinned meshes are baked in their bind pose: {}", names::list(&self.skinned)));
        }
        if !self.morphed.is_empty() {
            warnings.push(format!("morph targets are not applied: {}", names::list(&self.morphed)));
        }
        if self.unmapped_in_scene > 0 {
            warnings.push(format!(
                "{} triangles have no light-map coordinates (TEXCOORD_{LIGHT_MAP_SET}): they block and emit light and \
                 receive none",
                self.unmapped_in_scene
            ));
        }
        warnings
    }

    /// The meshes, for [`crate::scene::SceneDesc`].
    pub(super) fn into_meshes(self) -> Vec<MeshDesc> {
        self.meshes
    }
}

/// How corners make up triangles.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    fn of(mode: Mode) -> Option<Self> {
        match mode {
            Mode::Triangles => Some(Self::List),
            Mode::TriangleStrip => Some(Self::Strip),
            Mode::TriangleFan => Some(Self::Fan),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
        }
    }

    /// The corners of triangle `t`, in the order of glTF 2.0, section 3.7.2.1.
    fn triangle(self, t: usize) -> [usize; 3] {
        match self {
            Self::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Self::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Self::Fan => [t + 1, t + 2, 0],
        }
    }

    /// Indices of a list; empty where every three vertices are a triangle.
    fn list(self, indices: Option<Vec<u32>>, vertices: usize) -> Vec<u32> {
        if self == Self::List {
            return indices.unwrap_or_default();
        }
        let corners = indices.as_ref().map_or(vertices, Vec::len);
        let vertex = |corner: usize| indices.as_ref().map_or(corner as u32, |indices| indices[corner]);
        (0..corners.saturating_sub(2)).flat_map(|t| self.triangle(t)).map(vertex).collect()
    }
}

/// Reads one primitive.
struct PrimitiveReader<'a, 'b> {
    mesh: &'a str,
    primitive: &'a Primitive<'a>,
    json: &'a Json,
    /// The document's accessors.
    all: &'a [Accessor<'a>],
    accessors: &'a mut Accessors<'b>,
}

impl PrimitiveReader<'_, '_> {
    /// `None` where it has no triangle.
    fn part(
        &mut self,
        topology: Topology,
        materials: &mut Materials,
        warnings: &mut Vec<String>,
    ) -> Result<Option<MeshPart>> {
        let Some(positions) = self.vectors::<3>(&Semantic::Positions)? else { return Ok(None) };
        let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from).collect();
        let role = self.role("indices");
        let indices = self.json.indices.and_then(|index| self.all.get(index.value()));
        let indices = indices.map(|accessor| self.accessors.indices(accessor, &role)).transpose()?;
        let indices = topology.list(indices, positions.len());
        if topology != Topology::List && indices.is_empty() {
            return Ok(None);
        }
        let normals = self.vectors::<3>(&Semantic::Normals)?;
        let light_map_uvs = self.vectors::<2>(&Semantic::TexCoords(LIGHT_MAP_SET))?;
        let material = materials.place(&self.primitive.material());
        let mut texcoords = [None, None];
        for (uvs, source) in texcoords.iter_mut().zip(materials.uv_sources(material)) {
            let Some(source) = source else { continue };
            *uvs = self.texcoords(source)?;
            if uvs.is_none() {
                warnings.push(format!(
                    "{} is missing, which material '{}' needs: its texture's corner is used",
                    self.role(&format!("TEXCOORD_{}", source.set)),
                    materials.name(material)
                ));
            }
        }
        let [albedo_uvs, emission_uvs] = texcoords;
        Ok(Some(MeshPart {
            positions,
            normals: normals.map(|normals| normals.into_iter().map(Vec3::from).collect()),
            light_map_uvs: light_map_uvs.map(|uvs| uvs.into_iter().map(Vec2::from).collect()),
            albedo_uvs,
            emission_uvs,
            indices,
            material,
        }))
    }

    fn texcoords(&mut self, source: UvSource) -> Result<Option<Vec<Vec2>>> {
        let uvs = self.vectors::<2>(&Semantic::TexCoords(source.set))?;
        Ok(uvs.map(|uvs| uvs.into_iter().map(|uv| source.transform.transform_point2(Vec2::from(uv))).collect()))
    }

    /// An attribute's values; `None` where the primitive has it not.
    fn vectors<const N: usize>(&mut self, semantic: &Semantic) -> Result<Option<Vec<[f32; N]>>> {
        let index = self.json.attributes.get(&Checked::Valid(semantic.clone()));
        let Some(accessor) = index.and_then(|index| self.all.get(index.value())) else { return Ok(None) };
        let role = self.role(&semantic.to_string());
        self.accessors.vectors(accessor, &role).map(Some)
    }

    fn role(&self, attribute: &str) -> String {
        format!("{attribute} of mesh '{}', primitive {}", self.mesh, self.primitive.index())
    }
}
