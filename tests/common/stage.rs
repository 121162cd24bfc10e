//! Builds scenes of rectangles, each with a chart of its own in the light map.

use glam::{DAffine3, DVec3, Vec2, Vec3};
use lightoven::scene::{Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Scene, SceneDesc, Sky};

/// Side of the light map of every scene here, texels.
pub(crate) const SIDE: u32 = 128;
/// Charts in a row.
const COLUMNS: u32 = 4;

/// A rectangle's place in the light map: a square of whole texels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chart {
    /// First column and row.
    first: [u32; 2],
    /// Columns, and rows.
    pub(crate) size: u32,
    /// Side of the light map, texels.
    side: u32,
    /// How far the chart ends before the outermost texels' borders, texels; negative: how far beyond them.
    inset: f32,
}

impl Chart {
    /// One of 16 of 6 x 6 texels. The chart ends on the borders of its texels.
    pub(crate) fn new(index: u32) -> Self {
        assert!(index < 16);
        Self::at([index % COLUMNS * 8 + 1, index / COLUMNS * 8 + 1], 6)
    }

    /// One of 12 of 28 x 28 texels, apart from the small ones.
    pub(crate) fn large(index: u32) -> Self {
        assert!(index < 12);
        Self::at([index % COLUMNS * 31 + 2, 34 + index / COLUMNS * 31], 28)
    }

    /// From this column and row on, with this many of both. Right of column 32 and above row 34 there are no others.
    pub(crate) fn at(first: [u32; 2], size: u32) -> Self {
        Self { first, size, side: SIDE, inset: 0.0 }
    }

    /// In a light map of another side.
    pub(crate) fn on(self, side: u32) -> Self {
        Self { side, ..self }
    }

    /// Ends `inset` texels earlier, so that no texel is merely touched.
    pub(crate) fn inset(self, inset: f32) -> Self {
        Self { inset, ..self }
    }

    /// Side of the surface in the chart, texels.
    pub(crate) fn side(self) -> f64 {
        f64::from(self.size) - 2.0 * f64::from(self.inset)
    }

    /// Light-map coordinates of the corners (0, 0), (1, 0), (1, 1), (0, 1) of the rectangle.
    fn corners(self) -> [Vec2; 4] {
        [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|share| self.uv(share))
    }

    /// Light-map coordinates at a share of both sides.
    pub(crate) fn uv(self, share: Vec2) -> Vec2 {
        let [x, y] = self.first.map(|first| first as f32);
        let (lo, hi) = (Vec2::new(x, y) + self.inset, Vec2::new(x, y) + self.size as f32 - self.inset);
        (lo + (hi - lo) * share) / self.side as f32
    }

    /// The texels, row-major: place in the light map, and the centre's place in the rectangle.
    pub(crate) fn texels(self) -> impl Iterator<Item = (usize, [f64; 2])> {
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
pub(crate) struct Quad {
    pub(crate) corner: Vec3,
    pub(crate) u: Vec3,
    pub(crate) v: Vec3,
    /// `None`: it receives no light.
    pub(crate) chart: Option<Chart>,
    pub(crate) material: usize,
}

impl Quad {
    /// The point at a share of both sides.
    pub(crate) fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.corner.as_dvec3() + self.u.as_dvec3() * u + self.v.as_dvec3() * v
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
pub(crate) struct Stage {
    pub(crate) desc: SceneDesc,
}

impl Stage {
    pub(crate) fn new() -> Self {
        Self { desc: SceneDesc { name: "stage".into(), ..SceneDesc::default() } }
    }

    /// A grey, single-sided material, which emits white.
    pub(crate) fn material(&mut self, albedo: f32, emission: f32) -> usize {
        let (albedo, emission) = (Vec3::splat(albedo), Vec3::splat(emission));
        self.desc.materials.push(Material { albedo, emission, ..Material::default() });
        self.desc.materials.len() - 1
    }

    pub(crate) fn light(&mut self, kind: LightKind) {
        self.desc.lights.push(Light { name: "light".into(), intensity: Vec3::ONE, kind });
    }

    pub(crate) fn sky(&mut self, radiance: f32) {
        self.desc.sky = Sky::Constant(Vec3::splat(radiance));
    }

    /// A mesh of these rectangles, placed by `transform`.
    pub(crate) fn place(&mut self, quads: &[Quad], transform: DAffine3) {
        self.place_parts(quads.iter().map(Quad::part).collect(), transform);
    }

    /// A mesh of these parts, placed by `transform`.
    pub(crate) fn place_parts(&mut self, parts: Vec<MeshPart>, transform: DAffine3) {
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
    pub(crate) fn with(mut self, quads: &[Quad]) -> Scene {
        self.place(quads, DAffine3::IDENTITY);
        self.build()
    }

    pub(crate) fn build(self) -> Scene {
        let scene = Scene::new(self.desc).unwrap();
        assert_eq!(scene.warnings(), Vec::<String>::new());
        scene
    }
}

/// The six walls of a box, fronts inward: floor (z), ceiling, x, opposite, y, opposite. `chart` of 0 to 5 gives their charts.
pub(crate) fn room(lo: Vec3, hi: Vec3, chart: impl Fn(u32) -> Chart, material: usize) -> [Quad; 6] {
    let size = hi - lo;
    let (x, y, z) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    let mut index = 0;
    [(lo, x, y), (lo + z, y, x), (lo, y, z), (lo + x, z, y), (lo, z, x), (lo + y, x, z)].map(|(corner, u, v)| {
        index += 1;
        Quad { corner, u, v, chart: Some(chart(index - 1)), material }
    })
}

/// A square in the plane z = `height`, centred over the origin.
pub(crate) fn level_square(side: f32, height: f32, facing: Facing, chart: Chart, material: usize) -> Quad {
    let corner = Vec3::new(-0.5 * side, -0.5 * side, height);
    let (u, v) = match facing {
        Facing::Up => (Vec3::X * side, Vec3::Y * side),
        Facing::Down => (Vec3::Y * side, Vec3::X * side),
    };
    Quad { corner, u, v, chart: Some(chart), material }
}

/// Where a level square's front is.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Facing {
    Up,
    Down,
}
