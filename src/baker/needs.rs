//! What a bake needs, from its scene and its settings.

use super::{AimedBy, BakeSettings, Bounces, ErrorEstimate, Mode, Sampling};
use crate::error::{Error, Result};
use crate::features::Features;
use crate::scene::Scene;

/// What is built on something else, from the top.
const STANDS_ON: [(Features, Features); 4] = [
    (Features::VISIBILITY, Features::CLUSTERS),
    (Features::CLUSTERS, Features::IMPORTANCE),
    (Features::SHARED_TEXELS, Features::IMPORTANCE),
    (Features::OF_RAYS, Features::GATHERING),
];

impl Features {
    /// Those that may be switched on without being needed.
    pub const LEFT_OUT_AT_WILL: Self =
        Self::INSTANCES.union(Self::SINGLE_SIDED).union(Self::LIGHTS).union(Self::GATHERING).union(Self::OF_RAYS);

    /// What a bake of `scene` with these settings needs, and what they switch on beside it. [`Features::SHARED_TEXELS`] is
    /// found out when texels are looked at, and [`Features::LINKS`] given up where there is no room.
    pub fn required(scene: &Scene, settings: &BakeSettings) -> Self {
        let mut features = match settings.mode {
            Mode::Still => Self::of(scene),
            Mode::Frames(_) => Self::of_changing(scene),
        };
        let (is_still, aims) = (settings.mode == Mode::Still, settings.sampling != Sampling::Cosine);
        features.set(Self::IMPORTANCE, aims);
        features.set(Self::CLUSTERS, aims && settings.aimed_by != AimedBy::Power);
        features.set(Self::VISIBILITY, aims && settings.aimed_by == AimedBy::Visibility);
        let bounces = match settings.bounces {
            Bounces::Auto => u32::MAX,
            Bounces::Limit(limit) => limit,
        };
        let reflects = bounces > 0 && scene.materials().iter().any(|material| material.albedo.max_element() > 0.0);
        features.set(Self::LINKS, is_still && reflects && bounces > 1);
        features.set(Self::HALVES, is_still && settings.error != ErrorEstimate::None);
        if is_still && !reflects {
            features.remove(Self::ALBEDO_TEXTURES);
        }
        let gathers = !is_still
            || finds_light(scene, features, reflects)
            || settings.unneeded.intersects(Self::OF_RAYS | Self::GATHERING);
        features.set(Self::GATHERING, gathers);
        if !gathers {
            features.remove(Self::OF_RAYS);
        }
        (features | settings.unneeded).with_what_they_stand_on()
    }

    fn with_what_they_stand_on(mut self) -> Self {
        for (above, below) in STANDS_ON {
            self.set(below, self.intersects(above | below));
        }
        self
    }
}

/// Whether any ray can bring light in a scene that stays as it is. `reflects`: light from analytic lights too.
fn finds_light(scene: &Scene, features: Features, reflects: bool) -> bool {
    scene.emits() || scene.sky().shines() || reflects && features.contains(Features::LIGHTS)
}

/// What is switched on beside what is needed.
pub(super) fn check_unneeded(settings: &BakeSettings) -> Result<()> {
    let allowed = match settings.mode {
        Mode::Still => Features::LEFT_OUT_AT_WILL,
        Mode::Frames(_) => Features::empty(),
    };
    let other = settings.unneeded.difference(allowed);
    if other.is_empty() {
        return Ok(());
    }
    Err(Error::settings(format!("{other:?} cannot be switched on where it is not needed; allowed are {allowed:?}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Light, LightKind, Material, SceneDesc, Sky};
    use glam::{DVec3, Vec3};

    /// Under a sky.
    fn scene(albedo: f32) -> Scene {
        let material = Material { albedo: Vec3::splat(albedo), ..Material::default() };
        let sky = Sky::Constant(Vec3::ONE);
        Scene::new(SceneDesc { materials: vec![material], sky, ..SceneDesc::default() }).expect("is valid")
    }

    /// With a point light, and nothing else that shines.
    fn lit_by_a_point(albedo: f32) -> Scene {
        let material = Material { albedo: Vec3::splat(albedo), ..Material::default() };
        let kind = LightKind::Point { position: DVec3::ZERO, range: None };
        let lights = vec![Light { name: "lamp".into(), intensity: Vec3::ONE, kind }];
        Scene::new(SceneDesc { materials: vec![material], lights, ..SceneDesc::default() }).expect("is valid")
    }

    fn needs(settings: BakeSettings) -> Features {
        Features::required(&scene(0.5), &settings)
    }

    #[test]
    fn settings_decide_what_the_scene_does_not() {
        let cosine = BakeSettings { sampling: Sampling::Cosine, ..BakeSettings::default() };
        let aims = Features::IMPORTANCE | Features::CLUSTERS | Features::VISIBILITY;
        assert!(needs(BakeSettings::default()).contains(aims | Features::LINKS | Features::HALVES));
        assert!(!needs(cosine.clone()).intersects(aims));
        let by_power = BakeSettings { aimed_by: AimedBy::Power, ..BakeSettings::default() };
        assert_eq!(needs(by_power) & aims, Features::IMPORTANCE);
        let error = |error| needs(BakeSettings { error, ..cosine.clone() }) & Features::HALVES;
        assert_eq!(error(ErrorEstimate::None), Features::empty());
        assert_eq!(error(ErrorEstimate::Told), Features::HALVES);
        assert_eq!(error(ErrorEstimate::Adaptive), Features::HALVES);
        let once = BakeSettings { bounces: Bounces::Limit(1), ..cosine.clone() };
        assert!(!needs(once).contains(Features::LINKS) && needs(cosine.clone()).contains(Features::LINKS));
        assert!(!Features::required(&scene(0.0), &cosine).contains(Features::LINKS));
    }

    #[test]
    fn rays_are_needed_where_they_can_find_light() {
        let needs = |scene: &Scene, bounces| Features::required(scene, &BakeSettings { bounces, ..Default::default() });
        let of_rays = Features::OF_RAYS | Features::GATHERING;
        assert!(needs(&scene(0.0), Bounces::Limit(0)).contains(Features::GATHERING | Features::IMPORTANCE));
        assert!(needs(&lit_by_a_point(0.5), Bounces::Limit(1)).contains(Features::GATHERING));
        for (albedo, bounces) in [(0.5, Bounces::Limit(0)), (0.0, Bounces::Auto)] {
            let features = needs(&lit_by_a_point(albedo), bounces);
            assert!(!features.intersects(of_rays) && features.contains(Features::LIGHTS), "{features:?}");
            let words: Vec<_> = features.left_out().into_iter().map(|(bits, _)| bits).collect();
            assert!(words.contains(&Features::GATHERING) && !words.contains(&Features::LINKS), "{words:?}");
        }
        for unneeded in [Features::HALVES, Features::GATHERING] {
            let all_the_same = BakeSettings { bounces: Bounces::Limit(0), unneeded, ..Default::default() };
            let features = Features::required(&lit_by_a_point(0.5), &all_the_same);
            assert!(features.contains(Features::GATHERING | Features::HALVES | Features::IMPORTANCE), "{features:?}");
        }
    }

    #[test]
    fn what_stands_on_something_brings_it_along() {
        let with = |unneeded| {
            needs(BakeSettings {
                sampling: Sampling::Cosine,
                error: ErrorEstimate::None,
                unneeded,
                ..BakeSettings::default()
            })
        };
        assert!(with(Features::VISIBILITY).contains(Features::CLUSTERS | Features::IMPORTANCE));
        assert!(!with(Features::HALVES).intersects(Features::IMPORTANCE));
    }

    #[test]
    fn what_cannot_be_switched_on_is_refused() {
        let check = |unneeded| check_unneeded(&BakeSettings { unneeded, ..BakeSettings::default() });
        assert!(check(Features::LEFT_OUT_AT_WILL).is_ok());
        let error = check(Features::DYNAMIC).expect_err("must be refused").to_string();
        assert!(error.contains("DYNAMIC") && error.contains("INSTANCES"), "{error}");
    }
}
