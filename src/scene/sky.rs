//! What a ray sees that leaves the scene.

use super::check_light_quantity;
use crate::error::{Error, Result};
use glam::Vec3;

/// What a ray sees that leaves the scene.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Sky {
    /// Nothing.
    #[default]
    Black,
    /// The same radiance from everywhere, linear Rec. 709.
    Constant(Vec3),
    /// A radiance for every direction.
    Map(SkyMap),
}

/// An equirectangular radiance map, y up, constant within a pixel.
///
/// A direction d looks at column `width * (atan2(d.z, d.x) / 2 pi + 1/2)` and row `height * acos(d.y) / pi`: the top row
/// is straight up, the middle column looks along +x.
#[derive(Debug, Clone, PartialEq)]
pub struct SkyMap {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Radiance `[pixel]`, row-major from the top, linear Rec. 709.
    pub pixels: Vec<Vec3>,
}

impl Sky {
    /// Whether any light comes from it.
    pub(crate) fn shines(&self) -> bool {
        match self {
            Self::Black => false,
            Self::Constant(radiance) => *radiance != Vec3::ZERO,
            Self::Map(map) => map.pixels.iter().any(|pixel| *pixel != Vec3::ZERO),
        }
    }

    pub(crate) fn check(&self) -> Result<()> {
        match self {
            Self::Black => Ok(()),
            Self::Constant(radiance) => check_light_quantity(|| "the sky's radiance".into(), *radiance),
            Self::Map(map) => map.check(),
        }
    }
}

impl SkyMap {
    fn check(&self) -> Result<()> {
        let Self { width, height, pixels } = self;
        let expected = *width as usize * *height as usize;
        if expected == 0 || pixels.len() != expected {
            let found = pixels.len();
            return Err(Error::scene(format!(
                "the sky map is {width} x {height} with {found} pixels; allowed is width x height of them, at least 1"
            )));
        }
        pixels.iter().enumerate().try_for_each(|(index, pixel)| {
            let (x, y) = (index % *width as usize, index / *width as usize);
            check_light_quantity(|| format!("the sky map's pixel at column {x}, row {y}"), *pixel)
        })
    }
}
