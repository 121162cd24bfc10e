//! What a bake needs, from its scene and its settings.

use super::{AimedBy, BakeSettings, Bounces, ErrorEstimate, Mode, Sampling};
use crate::error::{Error, Result};
use crate::features::Features;
use crate::scene::Scene;

impl Features {
    /// Those that may be switched on without being needed.
    pub const LEFT_OUT_AT_WILL: Self = Self::INSTANCES
        .union(Self::SINGLE_SIDED)
        .union(Self::UNMAPPED)
        .union(Self::SKY_CONSTANT)
        .union(Self::SKY_MAP)
        .union(Self::LIGHTS)
        .union(Self::TEXTURES)
        .union(Self::IMPORTANCE)
        .union(Self::SHARED_TEXELS)
        .union(Self::CLUSTERS)
        .union(Self::VISIBILITY)
        .union(Self::LINKS)
        .union(Self::HALVES)
        .union(Self::ADAPTIVE);

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
        let reflects = scene.materials().iter().any(|material| material.albedo.max_element() > 0.0);
        features.set(Self::LINKS, is_still && reflects && bounces > 1);
        features.set(Self::HALVES, is_still && settings.error != ErrorEstimate::None);
        features.set(Self::ADAPTIVE, is_still && settings.error == ErrorEstimate::Adaptive);
        features | settings.unneeded
    }
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
