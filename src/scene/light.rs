//! Analytic lights, in the units of glTF's KHR_lights_punctual.

use super::{check_light_quantity, unit};
use crate::error::{Error, Result};
use glam::{DVec3, Vec3};

/// The kind and the placing of a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Shines from a point into all directions.
    Point {
        /// World position.
        position: DVec3,
        /// Distance at which the light has faded to 0, in scene units; `None`: it never does.
        range: Option<f32>,
    },
    /// Shines from a point into a cone.
    Spot {
        /// World position.
        position: DVec3,
        /// The way the light travels; any length but 0.
        direction: Vec3,
        /// Angle from the axis up to which it shines fully, radians.
        inner_angle: f32,
        /// Angle from the axis beyond which it does not shine, radians, at most pi/2.
        outer_angle: f32,
        /// As for a point light.
        range: Option<f32>,
    },
    /// Shines from infinitely far away.
    Directional {
        /// The way the light travels; any length but 0.
        direction: Vec3,
    },
}

/// An analytic light.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Shown in messages.
    pub name: String,
    /// Linear Rec. 709. Point and spot: radiant intensity (glTF: candela); directional: irradiance on a surface that
    /// faces it (glTF: lux).
    pub intensity: Vec3,
    /// Kind and placing.
    pub kind: LightKind,
}

impl Light {
    /// The light, its numbers checked and its direction brought to unit length.
    pub(crate) fn checked(mut self) -> Result<Self> {
        self.check()?;
        Ok(self)
    }

    /// Checks the numbers and brings directions to unit length.
    pub(super) fn check(&mut self) -> Result<()> {
        let name = &self.name;
        check_light_quantity(|| format!("the intensity of light '{name}'"), self.intensity)?;
        let unit = |direction: Vec3| {
            unit(direction).ok_or_else(|| {
                Error::scene(format!("the direction of light '{name}' is {direction}; allowed is any finite one but 0"))
            })
        };
        let placed = |position: DVec3, range: Option<f32>| {
            if !position.is_finite() {
                return Err(Error::scene(format!("the position of light '{name}' is {position}; it must be finite")));
            }
            match range {
                Some(range) if !(range > 0.0) => {
                    Err(Error::scene(format!("the range of light '{name}' is {range}; allowed is more than 0")))
                }
                _ => Ok(()),
            }
        };
        match &mut self.kind {
            LightKind::Point { position, range } => placed(*position, *range),
            LightKind::Spot { position, direction, inner_angle, outer_angle, range } => {
                placed(*position, *range)?;
                *direction = unit(*direction)?;
                let (inner, outer) = (*inner_angle, *outer_angle);
                if 0.0 <= inner && inner < outer && outer <= std::f32::consts::FRAC_PI_2 + 1e-6 {
                    return Ok(());
                }
                Err(Error::scene(format!(
                    "the cone of light '{name}' is {inner} to {outer} radians; allowed is 0 <= inner < outer <= pi/2"
                )))
            }
            LightKind::Directional { direction } => {
                *direction = unit(*direction)?;
                Ok(())
            }
        }
    }
}
