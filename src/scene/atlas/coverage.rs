//! Counts texels that triangles touch, and those whose centre lies in more than one.

use glam::{UVec2, Vec2};

/// Fractional bits of a coordinate: shared edges are then exact, and neighbours never claim the same centre.
const SUBTEXEL_BITS: u32 = 8;

/// The owner of a texel that has been counted as covered more than once.
const COUNTED: u32 = u32::MAX;

/// Which instance covers each texel's centre.
pub(super) struct Coverage {
    size: UVec2,
    /// `[texel]`, row-major: instance + 1; 0: none.
    owners: Vec<u32>,
    /// `[texel]`: some triangle has a part of it.
    pub(super) touched: Vec<bool>,
    /// Texels covered at least once.
    pub(super) covered: usize,
    /// Texels that two instances cover.
    pub(super) between_instances: usize,
    /// Texels that one instance covers twice.
    pub(super) within_instance: usize,
}

impl Coverage {
    pub(super) fn new(size: UVec2) -> Self {
        let texels = size.x as usize * size.y as usize;
        Self {
            size,
            owners: vec![0; texels],
            touched: vec![false; texels],
            covered: 0,
            between_instances: 0,
            within_instance: 0,
        }
    }

    /// Adds a triangle; corners in texels.
    pub(super) fn add(&mut self, instance: u32, corners: [Vec2; 3]) {
        let one = 1_i64 << SUBTEXEL_BITS;
        let fixed = |c: f32| (f64::from(c) * one as f64).round() as i64;
        let mut corners = corners.map(|c| (fixed(c.x), fixed(c.y)));
        if cross(corners[0], corners[1], corners[2]) < 0 {
            corners.swap(1, 2);
        }
        let [a, b, c] = corners;
        let span = |lo: i64, hi: i64, limit: u32| {
            ((lo / one).clamp(0, i64::from(limit)), (hi / one + 1).clamp(0, i64::from(limit)))
        };
        let is_flat = cross(a, b, c) == 0;
        let (x0, x1) = span(a.0.min(b.0).min(c.0), a.0.max(b.0).max(c.0), self.size.x);
        let (y0, y1) = span(a.1.min(b.1).min(c.1), a.1.max(b.1).max(c.1), self.size.y);
        for y in y0..y1 {
            for x in x0..x1 {
                let centre = (x * one + one / 2, y * one + one / 2);
                let texel = x as usize + y as usize * self.size.x as usize;
                self.touched[texel] |= !is_flat && touches([a, b, c], centre, one / 2);
                if inside(a, b, centre) && inside(b, c, centre) && inside(c, a, centre) {
                    self.claim(instance, texel);
                }
            }
        }
    }

    /// Texels that the g-buffer will fill, but for what rounds the other way.
    pub(super) fn touched_texels(&self) -> usize {
        self.touched.iter().filter(|touched| **touched).count()
    }

    fn claim(&mut self, instance: u32, texel: usize) {
        match self.owners[texel] {
            0 => {
                self.owners[texel] = instance + 1;
                self.covered += 1;
            }
            COUNTED => {}
            owner => {
                self.owners[texel] = COUNTED;
                if owner == instance + 1 {
                    self.within_instance += 1;
                } else {
                    self.between_instances += 1;
                }
            }
        }
    }
}

fn cross(a: (i64, i64), b: (i64, i64), p: (i64, i64)) -> i64 {
    (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0)
}

/// Whether no edge has the whole texel on its outer side, as `glsl/include/gbuffer.glsl` has it.
fn touches([a, b, c]: [(i64, i64); 3], centre: (i64, i64), half: i64) -> bool {
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
        // In halves: half a subtexel is the 0.002 texels that touching is counted from.
        let reach = (2 * half + 1) * ((to.0 - from.0).abs() + (to.1 - from.1).abs());
        2 * cross(from, to, centre) >= -reach
    })
}

/// Left of the edge, or on it where the edge is a top or a left one.
fn inside(a: (i64, i64), b: (i64, i64), p: (i64, i64)) -> bool {
    let side = cross(a, b, p);
    side > 0 || (side == 0 && (b.1 < a.1 || (b.1 == a.1 && b.0 > a.0)))
}
