//! KHR_lights_punctual.

use super::names;
use crate::scene::{Light, LightKind};
use glam::{DAffine3, DVec3, Vec3};
use gltf::Node;
use gltf::khr_lights_punctual::{Kind, Light as Source};

/// A light where its node stands; it shines along the node's -z.
pub(super) fn read(light: &Source<'_>, node: &Node<'_>, transform: &DAffine3) -> Light {
    let position = transform.translation;
    let direction = transform.transform_vector3(DVec3::NEG_Z).normalize_or_zero().as_vec3();
    let range = light.range();
    let kind = match light.kind() {
        Kind::Directional => LightKind::Directional { direction },
        Kind::Point => LightKind::Point { position, range },
        Kind::Spot { inner_cone_angle, outer_cone_angle } => LightKind::Spot {
            position,
            direction,
            inner_angle: inner(inner_cone_angle, outer_cone_angle),
            outer_angle: outer_cone_angle,
            range,
        },
    };
    let name = names::given_or(light.name(), || names::of_node(node));
    Light { name, intensity: Vec3::from(light.color()) * light.intensity(), kind }
}

/// Exporters write a hard-edged cone with both angles the same, where the extension wants the inner one smaller.
fn inner(inner: f32, outer: f32) -> f32 {
    if inner == outer { outer.next_down() } else { inner }
}
