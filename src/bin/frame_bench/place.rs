//! Where there is room in a scene for something that moves, and from where to look at it.

use crate::random::Random;
use glam::{DVec3, Vec3};
use lightoven::bvh::{Bvh, Hit, Ray};

/// Points that are tried.
const CANDIDATES: usize = 400;
/// Directions that each is looked around in.
const DIRECTIONS: usize = 48;
/// More room than this, of the scene's longest side, is no better: the middle of the sky is no place to be.
const ENOUGH_ROOM: f64 = 0.12;
/// What room counts for beside the share of front faces in view: a street is better than a tunnel.
const ROOM_WEIGHT: f64 = 2.0;
/// What distance counts for beside the share of front faces in the picture.
const BACK_WEIGHT: f64 = 0.3;
/// What is farther from the camera than this, of the scene's longest side, is not in the way.
const ENOUGH_VIEW: f64 = 0.6;
/// The camera stands this far behind at most, of the scene's longest side.
const MOST_BACK: f64 = 0.6;
/// Over this share of back faces in view a point is inside something.
const MOST_BACK_FACES: f64 = 0.1;
/// Directions that the camera may look in.
const GAZES: usize = 24;

/// Room for something that moves. All is relative to [`Bvh::centre`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    /// Its middle.
    pub(crate) middle: DVec3,
    /// Nothing is nearer to the middle than this.
    pub(crate) room: f64,
    /// The way the camera looks, of unit length and nearly level.
    pub(crate) gaze: DVec3,
    /// How far behind the middle the camera can stand.
    pub(crate) back: f64,
}

impl Place {
    /// Seeks in a box around the origin whose half sides are `half`.
    pub(crate) fn find(bvh: &Bvh, half: DVec3) -> Self {
        let mut random = Random::new(0);
        let longest = 2.0 * half.max_element();
        let enough = ENOUGH_ROOM * longest;
        let (mut best, mut best_score) = ((DVec3::ZERO, 0.1 * longest), f64::NEG_INFINITY);
        for _ in 0..CANDIDATES {
            let [x, y, z] = [0, 1, 2].map(|_| 1.8 * random.unit() - 0.9);
            let middle = half * DVec3::new(x, y, z);
            let around = Surroundings::of(bvh, middle, half);
            let score = ROOM_WEIGHT * around.room.min(enough) / enough + around.front_faces;
            if around.back_faces <= MOST_BACK_FACES && score > best_score {
                (best, best_score) = ((middle, around.room), score);
            }
        }
        let (middle, room) = best;
        let gaze = best_gaze(bvh, middle, longest);
        Self { middle, room: room.min(enough), gaze, back: 0.85 * behind(bvh, middle, gaze, longest) }
    }
}

/// What a point sees around it.
struct Surroundings {
    /// To the nearest surface or to the box.
    room: f64,
    front_faces: f64,
    back_faces: f64,
}

impl Surroundings {
    fn of(bvh: &Bvh, middle: DVec3, half: DVec3) -> Self {
        let (mut front, mut back) = (0, 0);
        let mut room = (half - middle.abs()).min_element();
        for direction in (0..DIRECTIONS).map(around) {
            if let Some(hit) = trace(bvh, middle, direction, 1e6 * half.max_element()) {
                room = room.min(f64::from(hit.t));
                (front, back) = if hit.front_face { (front + 1, back) } else { (front, back + 1) };
            }
        }
        let share = |count: i32| f64::from(count) / DIRECTIONS as f64;
        Self { room, front_faces: share(front), back_faces: share(back) }
    }
}

/// Evenly spread directions: a spiral from pole to pole at the golden angle.
fn around(index: usize) -> DVec3 {
    let y = 1.0 - (2 * index + 1) as f64 / DIRECTIONS as f64;
    let (sine, cosine) = (2.399_963_229_728_653 * index as f64).sin_cos();
    let radius = (1.0 - y * y).sqrt();
    DVec3::new(radius * cosine, y, radius * sine)
}

/// The direction in which a camera behind the middle sees the most front faces, and has some distance to them.
fn best_gaze(bvh: &Bvh, middle: DVec3, longest: f64) -> DVec3 {
    let gazes = (0..GAZES).map(|index| {
        let (sine, cosine) = (std::f64::consts::TAU * index as f64 / GAZES as f64).sin_cos();
        let gaze = DVec3::new(cosine, -0.15, sine).normalize();
        let back = behind(bvh, middle, gaze, longest);
        (gaze, view(bvh, middle - 0.85 * back * gaze, gaze, longest) + BACK_WEIGHT * back / (MOST_BACK * longest))
    });
    gazes.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(DVec3::X, |(gaze, _)| gaze)
}

/// Share of front faces in what a camera sees, those that are near for less.
fn view(bvh: &Bvh, eye: DVec3, gaze: DVec3, longest: f64) -> f64 {
    let side = gaze.cross(DVec3::Y);
    let up = side.cross(gaze);
    let rays = (-4..=4).flat_map(|x| (-2..=2).map(move |y| gaze + 0.2 * (f64::from(x) * side + f64::from(y) * up)));
    let worth = |ray| match trace(bvh, eye, ray, 4.0 * longest) {
        Some(hit) if hit.front_face => (f64::from(hit.t) / (ENOUGH_VIEW * longest)).min(1.0),
        _ => 0.0,
    };
    rays.map(worth).sum::<f64>() / 45.0
}

/// How far it is from the middle against the gaze to what is there, or to where the camera need not go any farther.
fn behind(bvh: &Bvh, middle: DVec3, gaze: DVec3, longest: f64) -> f64 {
    let most = MOST_BACK * longest;
    trace(bvh, middle, -gaze, most).map_or(most, |hit| f64::from(hit.t))
}

fn trace(bvh: &Bvh, origin: DVec3, direction: DVec3, most: f64) -> Option<Hit> {
    let [origin, direction] = [origin, direction].map(|v| -> Vec3 { v.as_vec3() });
    bvh.trace_closest(&Ray { origin, t_min: 0.0, direction, t_max: most as f32 }, None)
}
