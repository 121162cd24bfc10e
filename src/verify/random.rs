//! Numbers that look random and are the same every time.

use glam::Vec3;

/// A linear congruential generator, of which the upper bits are used.
pub(super) struct Random(pub(super) u64);

impl Random {
    /// In `[0, 1)`, 24 bits.
    pub(super) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    /// Below `count`, which is at most 2^24.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (f64::from(self.unit()) * count as f64) as usize
    }

    /// Along an axis, either way.
    pub(super) fn axis(&mut self) -> Vec3 {
        let axis = self.below(6);
        Vec3::AXES[axis % 3] * if axis < 3 { 1.0 } else { -1.0 }
    }

    /// Each coordinate in `[-1, 1)`.
    pub(super) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}
