//! About how bright a scene is, without baking it: for the exposure, and for lights that are to be seen beside its own.

use glam::Vec3;
use lightoven::scene::{LightKind, Scene, Sky};

/// Luminance by the weights of Rec. 709.
fn luminance(colour: Vec3) -> f64 {
    f64::from(colour.dot(Vec3::new(0.2126, 0.7152, 0.0722)))
}

/// Mean irradiance if all that shines fell evenly on all surfaces, with the light of reflection (of half the light) on
/// top; 1 for a scene without light. `radius` is that of a ball around it. Emission textures count as white.
pub(crate) fn mean_irradiance(scene: &Scene, radius: f64) -> f64 {
    use std::f64::consts::PI;
    let (mut area, mut flux) = (0.0, 0.0);
    for instance in scene.instances() {
        let mesh = &scene.meshes()[instance.mesh];
        for (corners, material) in mesh.positions().iter().zip(mesh.materials()) {
            let [a, b, c] = corners.map(|p| instance.transform.transform_point3(p.as_dvec3()));
            let triangle = 0.5 * (b - a).cross(c - a).length();
            area += triangle;
            flux += PI * luminance(scene.materials()[*material as usize].emission) * triangle;
        }
    }
    for light in scene.lights() {
        let intensity = luminance(light.intensity);
        flux += match light.kind {
            LightKind::Point { .. } => 4.0 * PI * intensity,
            LightKind::Spot { outer_angle, .. } => 2.0 * PI * (1.0 - f64::from(outer_angle.cos())) * intensity,
            LightKind::Directional { .. } => 0.25 * area * intensity,
        };
    }
    flux += match scene.sky() {
        Sky::Black => 0.0,
        Sky::Constant(radiance) => PI * luminance(*radiance) * area.min(4.0 * PI * radius * radius),
        Sky::Map(map) => {
            let mean = map.pixels.iter().map(|pixel| luminance(*pixel)).sum::<f64>() / map.pixels.len() as f64;
            PI * mean * area.min(4.0 * PI * radius * radius)
        }
    };
    let irradiance = 2.0 * flux / area;
    if irradiance.is_finite() && irradiance > 0.0 { irradiance } else { 1.0 }
}
