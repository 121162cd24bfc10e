//! Builds scenes of rectangles, each with a chart of its own in the light map.

use crate::error::{Error, Result};
use crate::scene::{Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Scene, SceneDesc, Sky};
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// Side of the light map of every scene here, texels.
pub const SIDE: u32 = 128;
/// Charts in a row.
const COLUMNS: u32 = 4;

/// A rectangle's place in the light map: a square of whole texels.
#[derive(Debug, Clone, Copy)]
pub struct Chart {
    /// First column and row.
    first: [u32; 2],
    /// Columns, and rows.
    pub size: u32,
    /// Side of the light map, texels.
    side: u32,
    /// How far the chart ends before the outermost texels' borders, texels; negative: how far beyond them.
    inset: f32,
}

impl Chart {
    /// One of 16 of 6 x 6 texels. The chart ends on the borders of its texels.
    pub fn new(index: u32) -> Self {
        debug_assert!(index < 16);
        Self::at([index % COLUMNS * 8 + 1, index / COLUMNS * 8 + 1], 6)
    }

    /// One of 12 of 28 x 28 texels, apart from the small ones.
    pub fn large(index: u32) -> Self {
        debug_assert!(index < 12);
        Self::at([index % COLUMNS * 31 + 2, 34 + index / COLUMNS * 31], 28)
    }

    /// From this column and row on, with this many of both. Right of column 32 and above row 34 there are no others.
    pub fn at(first: [u32; 2], size: u32) -> Self {
        Self { first, size, side: SIDE, inset: 0.0 }
    }

    /// In a light map of another side.
    pub fn on(self, side: u32) -> Self {
        Self { side, ..self }
    }

    /// Ends `inset` texels earlier, so that no texel is merely touched.
    pub fn inset(self, inset: f32) -> Self {
        Self { inset, ..self }
    }

    /// Side of the surface in the chart, texels.
    pub fn side(self) -> f64 {
        f64::from(self.size) - 2.0 * f64::from(self.inset)
    }

    /// Light-map coordinates of the corners (0, 0), (1, 0), (1, 1), (0, 1) of the rectangle.
    fn corners(self) -> [Vec2; 4] {
        [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|share| self.uv(share))
    }

    /// Light-map coordinates at a share of both sides.
    pub fn uv(self, share: Vec2) -> Vec2 {
        let [x, y] = self.first.map(|first| first as f32);
        let (lo, hi) = (Vec2::new(x, y) + self.inset, Vec2::new(x, y) + self.size as f32 - self.inset);
        (lo + (hi - lo) * share) / self.side as f32
    }

    /// The texels, row-major: place in the light map, and the centre's place in the rectangle.
    pub fn texels(self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let [x, y] = self.first;
        (0..self.size * self.size).map(move |i| {
            let (column, row) = (i % self.size, i / self.size);
            let along = |texel: u32| (f64::from(texel) + 0.5 - f64::from(self.inset)) / self.side();
            (((y + row) * self.side + x + column) as usize, [along(column), along(row)])
        })
    }
}

/// A parallelogram; its front is where `u` x `v` points.
#[derive(Debug, Clone, Copy)]
pub struct Quad {
    pub corner: Vec3,
    pub u: Vec3,
    pub v: Vec3,
    /// `None`: it receives no light.
    pub chart: Option<Chart>,
    pub material: usize,
}

impl Quad {
    /// The point at a share of both sides.
    pub fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.corner.as_dvec3() + self.u.as_dvec3() * u + self.v.as_dvec3() * v
    }

    /// Its chart.
    ///
    /// # Errors
    /// `InvalidScene` where it has none.
    pub fn mapped(&self) -> Result<Chart> {
        self.chart.ok_or_else(|| Error::scene("the rectangle has no chart"))
    }

    fn part(&self) -> MeshPart {
        let Self { corner, u, v, .. } = *self;
        let unit = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        MeshPart {
            positions: vec![corner, corner + u, corner + u + v, corner + v],
            light_map_uvs: self.chart.map(|chart| chart.corners().to_vec()),
            albedo_uvs: Some(unit.clone()),
            emission_uvs: Some(unit),
            indices: vec![0, 1, 2, 0, 2, 3],
            material: self.material,
            ..MeshPart::default()
        }
    }
}

/// A scene that grows.
pub struct Stage {
    pub desc: SceneDesc,
}

impl Default for Stage {
    fn default() -> Self {
        Self::new()
    }
}

impl Stage {
    pub fn new() -> Self {
        Self { desc: SceneDesc { name: "stage".into(), ..SceneDesc::default() } }
    }

    /// A grey, single-sided material, which emits white.
    pub fn material(&mut self, albedo: f32, emission: f32) -> usize {
        let (albedo, emission) = (Vec3::splat(albedo), Vec3::splat(emission));
        self.desc.materials.push(Material { albedo, emission, ..Material::default() });
        self.desc.materials.len() - 1
    }

    pub fn light(&mut self, kind: LightKind) {
        self.desc.lights.push(Light { name: "light".into(), intensity: Vec3::ONE, kind });
    }

    pub fn sky(&mut self, radiance: f32) {
        self.desc.sky = Sky::Constant(Vec3::splat(radiance));
    }

    /// A mesh of these rectangles, placed by `transform`.
    pub fn place(&mut self, quads: &[Quad], transform: DAffine3) {
        self.place_parts(quads.iter().map(Quad::part).collect(), transform);
    }

    /// A mesh of these parts, placed by `transform`.
    pub fn place_parts(&mut self, parts: Vec<MeshPart>, transform: DAffine3) {
        let mesh = self.desc.meshes.len();
        self.desc.meshes.push(MeshDesc { name: format!("mesh {mesh}"), parts });
        self.desc.instances.push(Instance {
            name: format!("instance {mesh}"),
            mesh,
            transform,
            mobility: Mobility::Static,
        });
    }

    /// The scene with these rectangles as its only further mesh, where they are.
    ///
    /// # Errors
    /// As [`Stage::build`].
    pub fn with(mut self, quads: &[Quad]) -> Result<Scene> {
        self.place(quads, DAffine3::IDENTITY);
        self.build()
    }

    /// The scene.
    ///
    /// # Errors
    /// `InvalidScene` where the scene is none, or there is something to warn of.
    pub fn build(self) -> Result<Scene> {
        let scene = Scene::new(self.desc)?;
        match scene.warnings() {
            [] => Ok(scene),
            warnings => Err(Error::scene(warnings.join("; "))),
        }
    }
}

/// The six walls of a box, fronts inward: floor (z), ceiling, x, opposite, y, opposite. `chart` of 0 to 5 gives their charts.
pub fn room(lo: Vec3, hi: Vec3, chart: impl Fn(u32) -> Chart, material: usize) -> [Quad; 6] {
    let size = hi - lo;
    let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    let mut index = 0;
    [(lo, x, y), (lo + z, y, x), (lo, y, z), (lo + x, z, y), (lo, z, x), (lo + y, x, z)].map(|(corner, u, v)| {
        index += 1;
        Quad { corner, u, v, chart: Some(chart(index - 1)), material }
    })
}

/// A square in the plane z = `height`, centred over the origin.
pub fn level_square(side: f32, height: f32, facing: Facing, chart: Chart, material: usize) -> Quad {
    let corner = Vec3::new(-0.5 * side, -0.5 * side, height);
    let (u, v) = match facing {
        Facing::Up => (Vec3::X * side, Vec3::Y * side),
        Facing::Down => (Vec3::Y * side, Vec3::X * side),
    };
    Quad { corner, u, v, chart: Some(chart), material }
}

/// Where a level square's front is.
#[derive(Debug, Clone, Copy)]
pub enum Facing {
    Up,
    Down,
}
