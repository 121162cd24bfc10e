//! Where the moving things and the camera are in each frame: closed paths around a place with room.

use crate::place::Place;
use glam::{DAffine3, DQuat, DVec3, Mat4, Vec3, camera};
use std::f64::consts::TAU;

/// Frames until everything is back where it was.
const PERIOD: u64 = 480;
/// Field of view from top to bottom.
const VERTICAL_FIELD: f32 = 1.1;

/// The paths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    pub(crate) place: Place,
    /// Half the moving box's side.
    pub(crate) box_half_side: f64,
    /// The scene's longest side.
    pub(crate) longest: f64,
}

/// One frame's poses, relative to the scene's middle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    pub(crate) mover: DAffine3,
    pub(crate) lamp: DVec3,
    pub(crate) eye: DVec3,
    pub(crate) target: DVec3,
}

impl Motion {
    pub(crate) fn at(&self, frame: u64) -> Pose {
        let turn = TAU * (frame % PERIOD) as f64 / PERIOD as f64;
        let Place { middle, room, gaze, back } = self.place;
        let side = gaze.cross(DVec3::Y).normalize_or(DVec3::X);
        let level = DVec3::Y.cross(side);
        // The box's corners stay inside the room around the middle.
        let reach = (room - 1.8 * self.box_half_side).max(0.0);
        let circle = |radius: f64, angle: f64| radius * (angle.cos() * side + angle.sin() * level);
        let mover = middle + circle(0.9 * reach, turn) + DVec3::Y * 0.3 * reach * (3.0 * turn).sin();
        let spin = DQuat::from_axis_angle(DVec3::new(0.36, 0.8, 0.48).normalize(), 2.0 * turn);
        let lamp = middle - circle(0.7 * room, 2.0 * turn) + DVec3::Y * 0.5 * room;
        let eye = middle - back * gaze + circle(0.06 * back, turn) + DVec3::Y * 0.04 * back * (2.0 * turn).sin();
        let target = middle + circle(0.2 * room, 2.0 * turn);
        Pose { mover: DAffine3::from_rotation_translation(spin, mover), lamp, eye, target }
    }
}

impl Pose {
    /// World to clip space, for an image of this aspect ratio.
    pub(crate) fn world_to_clip(&self, aspect_ratio: f32, longest: f64) -> Mat4 {
        let (near, far) = (2e-3 * longest as f32, 4.0 * longest as f32);
        let clip = camera::rh::proj::vulkan::perspective(VERTICAL_FIELD, aspect_ratio, near, far);
        clip * camera::rh::view::look_at_mat4(self.eye.as_vec3(), self.target.as_vec3(), Vec3::Y)
    }
}

/// World to the shadow map's clip space, for a scene within `radius` of the origin.
pub(crate) fn world_to_sun(direction: Vec3, radius: f32) -> Mat4 {
    let up = if direction.y.abs() > 0.9 { Vec3::Z } else { Vec3::Y };
    let clip = camera::rh::proj::vulkan::orthographic(-radius, radius, -radius, radius, radius, 3.0 * radius);
    clip * camera::rh::view::look_to_mat4(-2.0 * radius * direction, direction, up)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion() -> Motion {
        let place = Place { middle: DVec3::new(1.0, 2.0, 3.0), room: 0.5, gaze: DVec3::NEG_Z, back: 2.0 };
        Motion { place, box_half_side: 0.05, longest: 4.0 }
    }

    #[test]
    fn paths_are_closed_and_stay_in_the_room() {
        let motion = motion();
        let poses: Vec<Pose> = (0..=PERIOD).map(|frame| motion.at(frame)).collect();
        assert_eq!(poses[0].mover, poses[PERIOD as usize].mover);
        let farthest = |of: fn(&Pose) -> DVec3| {
            poses.iter().map(|pose| of(pose).distance(motion.place.middle)).fold(0.0, f64::max)
        };
        let corner = 3.0_f64.sqrt() * motion.box_half_side;
        assert!(farthest(|pose| pose.mover.translation) + corner < motion.place.room);
        assert!(farthest(|pose| pose.lamp) < motion.place.room);
        let still = poses.windows(2).filter(|pair| pair[0].mover.translation == pair[1].mover.translation);
        assert_eq!(still.count(), 0);
    }

    #[test]
    fn what_is_looked_at_is_in_the_middle_and_the_scene_is_in_the_shadow_map() {
        let motion = motion();
        let pose = motion.at(7);
        let centre = pose.world_to_clip(1.5, motion.longest).project_point3(pose.target.as_vec3());
        assert!(centre.truncate().length() < 1e-4 && centre.z > 0.0 && centre.z < 1.0, "{centre}");
        for direction in [Vec3::NEG_Y, Vec3::new(0.6, -0.8, 0.0), Vec3::X] {
            let matrix = world_to_sun(direction, 2.0);
            for point in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_ONE].map(|p| 1.9 * p.normalize()) {
                let p = matrix.project_point3(point);
                assert!(p.truncate().abs().max_element() <= 1.0 && p.z > 0.0 && p.z < 1.0, "{direction}: {p}");
            }
            let toward = matrix.project_point3(-direction).z;
            assert!(toward < matrix.project_point3(direction).z, "nearer to the sun is less deep");
        }
    }
}
