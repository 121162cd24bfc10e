//! Which way rays are sent: by the cosine at the texel, toward where the light map is bright, or both. Pure.

use crate::error::{Error, Result};
use std::fmt;

/// Which way rays are sent.
///
/// Whichever it is, each ray is weighed by the density of all techniques together (the balance heuristic), so that the
/// light map is the same but for its noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Sampling {
    /// A mixture chosen from how concentrated the light is and from the variances that earlier rays showed; cosine alone
    /// where nothing else pays. The default.
    #[default]
    Auto,
    /// By the cosine alone.
    Cosine,
    /// Toward bright texels, and bright parts of a sky map, alone. For comparisons: what has no texel (a constant sky,
    /// emitters without light-map coordinates, the lesser part of a texel that two surfaces share, what is dimmer than the
    /// rest of its cluster by 2^24) is not found, and the variance beside a bright surface has no bound.
    Importance,
    /// Both, and `cosine` is the share of rays sent by the cosine, .1 to 1: a ray weighs at most pi / `cosine` times the
    /// radiance that it sees.
    Mixture {
        /// Share of rays sent by the cosine.
        cosine: f32,
    },
}

/// As the command line has it.
impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Cosine => f.write_str("cosine"),
            Self::Importance => f.write_str("importance"),
            Self::Mixture { cosine } => write!(f, "mixture={cosine}"),
        }
    }
}

/// By what aimed rays choose where on the light map they go. Whichever it is, the light map is the same but for its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AimedBy {
    /// Luminance times area alone: the same for every texel, by a mip-map of sums.
    Power,
    /// Power over squared distance, and the cosines at both ends, of clusters of texels as groups of texels see them.
    Distance,
    /// As [`AimedBy::Distance`], and by what a group's earlier rays have shown to be visible. The default.
    #[default]
    Visibility,
}

impl Sampling {
    /// Least share of the cosine in a mixture.
    pub const LEAST_COSINE: f32 = 0.1;

    /// # Errors
    /// `InvalidSettings` for a share outside its range.
    pub(crate) fn check(self) -> Result<()> {
        match self {
            Self::Mixture { cosine } if !(Self::LEAST_COSINE..=1.0).contains(&cosine) => {
                let least = Self::LEAST_COSINE;
                Err(Error::settings(format!("the cosine's share of a mixture is {cosine}; allowed is {least} to 1")))
            }
            _ => Ok(()),
        }
    }
}

/// How rays were sent, and what came of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SamplingStatistics {
    /// Share of rays sent by the cosine at present, which is the mixture's alpha: 0 to 1. Before the first ray all shares are 0.
    pub cosine_share: f32,
    /// Share of rays aimed at the light map at present.
    pub source_share: f32,
    /// Share of rays aimed at the sky map at present.
    pub sky_share: f32,
    /// Rays sent by the cosine so far.
    pub cosine_rays: u64,
    /// Rays aimed at the light map so far. One whose line of sight begins under the surface, and need not be traced, counts
    /// too.
    pub source_rays: u64,
    /// Rays aimed at the sky map so far.
    pub sky_rays: u64,
    /// Share of the rays aimed at the light map that saw the texel, lately; `None`: none has been aimed, or it is
    /// not known yet.
    pub source_seen: Option<f32>,
    /// Share of the rays aimed at the sky map that left the scene, lately; `None`: none has been aimed, or it is not known yet.
    pub sky_seen: Option<f32>,
    /// How even what shines is: 1 where all surfaces have one radiance, toward 0 the smaller the part is that shines.
    /// `None` where nobody asked.
    pub evenness: Option<f32>,
    /// What all surfaces shine, lately: luminance times world area in square scene units, over the texels of the light map.
    /// `None` where nobody asked.
    pub power: Option<f64>,
    /// Texels whose radiance is negative, infinite or no number, lately: no ray is aimed at them.
    pub invalid_texels: u64,
    /// Times that what rays are aimed by was made from the light map.
    pub pyramids: u64,
}

impl SamplingStatistics {
    /// `quanta`: of all texels together.
    pub(crate) fn count(&mut self, rays: u32, [source, sky]: [u32; 2], quanta: u64) {
        let share = |part: u32| part as f32 / rays.max(1) as f32;
        let cosine = rays - source - sky;
        (self.cosine_share, self.source_share, self.sky_share) = (share(cosine), share(source), share(sky));
        self.cosine_rays += quanta * u64::from(cosine);
        self.source_rays += quanta * u64::from(source);
        self.sky_rays += quanta * u64::from(sky);
    }

    /// `seen`: shares of the rays that were aimed lately, `rays` of a quantum.
    pub(crate) fn saw(&mut self, [source, sky]: [u32; 2], seen: [f64; 2]) {
        self.source_seen = if source > 0 { Some(seen[0] as f32) } else { self.source_seen };
        self.sky_seen = if sky > 0 { Some(seen[1] as f32) } else { self.sky_seen };
    }
}

/// How the rays of a quantum are shared out; together 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shares {
    pub(crate) cosine: f64,
    /// Aimed at the light map.
    pub(crate) source: f64,
    /// Aimed at the sky map.
    pub(crate) sky: f64,
}

impl Shares {
    const COSINE: Self = Self { cosine: 1.0, source: 0.0, sky: 0.0 };

    fn new(cosine: f64, source: f64, sky: f64) -> Self {
        Self { cosine, source, sky }
    }

    /// Rays of a quantum that are aimed at the light map and at the sky map: whole ones. Those by the cosine are rounded up.
    pub(crate) fn aimed_rays(self, rays: u32) -> [u32; 2] {
        let least = if self.cosine > 0.0 { 1 } else { 0 };
        // Up, so that no ray weighs more than its share allows; but for what an f32 adds to a number of rays.
        let cosine = ((self.cosine * f64::from(rays) - 1e-4).ceil().max(0.0) as u32).clamp(least, rays);
        let aimed = rays - cosine;
        let sky = (f64::from(aimed) * self.sky / (self.source + self.sky).max(1e-9)).round() as u32;
        [aimed - sky.min(aimed), sky.min(aimed)]
    }

    /// Whether any ray is aimed.
    pub(crate) fn any_aimed(self) -> bool {
        self.source + self.sky > 0.0
    }
}

/// What the source map and the rays of the last epoch tell, over all texels that take rays.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Evidence {
    /// Sum of luminance times area.
    pub(crate) power: f64,
    /// Sum of squared luminance times area.
    pub(crate) squared: f64,
    pub(crate) area: f64,
    /// Mean relative variance a ray of light from surfaces and, without a sky map, from the sky: for cosine alone, and for
    /// the two mixtures that `glsl/include/mixture.glsl` looks at, with the rest aimed at what is seen. Only where rays
    /// were aimed.
    pub(crate) surfaces: [f64; 3],
    /// The same of light from the sky map, the squared mean not subtracted.
    pub(crate) sky: [f64; 3],
}

/// Gains below this are none: rays by the cosine are stratified over the whole hemisphere, which their variance one by one
/// does not tell, and take less time.
const LEAST_GAIN: f64 = 2.0;
/// A source is even from this share on: of an even one as bright and as large, 1.
const EVEN: f64 = 0.5;

impl Evidence {
    /// About that of the irradiance: what shines, spread evenly over all surfaces.
    pub(crate) fn mean_luminance(&self) -> f32 {
        let mean = std::f64::consts::PI * self.power / self.area;
        if mean.is_finite() { mean as f32 } else { 0.0 }
    }

    /// 1 for a source of one radiance everywhere, toward 0 the smaller the part is that shines.
    pub(crate) fn evenness(&self) -> f64 {
        let evenness = self.power / self.area * (self.power / self.squared);
        if evenness.is_finite() { evenness } else { 0.0 }
    }
}

/// Decides how many rays are aimed.
#[derive(Debug, Clone)]
pub(crate) struct Chooser {
    sampling: Sampling,
    /// There is a sky map.
    sky: bool,
    shares: Shares,
}

impl Chooser {
    pub(crate) fn new(sampling: Sampling, sky: bool) -> Self {
        Self { sampling, sky, shares: Shares::COSINE }
    }

    pub(crate) fn shares(&self) -> Shares {
        self.shares
    }

    /// By what shines alone: at first, and where that has changed. `sky_shines`: a black map is not aimed at.
    pub(crate) fn begin(&mut self, evidence: &Evidence, sky_shines: bool) {
        let any = evidence.power > 0.0;
        let cosine = match self.sampling {
            Sampling::Cosine => 1.0,
            Sampling::Importance => 0.0,
            Sampling::Mixture { cosine } => f64::from(cosine),
            Sampling::Auto => 0.5,
        };
        let aims_at_source = any && (self.sampling != Sampling::Auto || evidence.evenness() < EVEN);
        let aimed = 1.0 - cosine;
        self.shares = match (aims_at_source, self.sky && sky_shines) {
            (true, true) => Shares::new(cosine, 0.5 * aimed, 0.5 * aimed),
            (true, false) => Shares::new(cosine, aimed, 0.0),
            (false, true) => Shares::new(cosine, 0.0, aimed),
            (false, false) => Shares::COSINE,
        };
    }

    /// By the variances that rays have shown. Cosine alone, once chosen, stays: it shows no others.
    pub(crate) fn learn(&mut self, evidence: &Evidence) {
        if self.sampling != Sampling::Auto || !self.shares.any_aimed() {
            return;
        }
        let ([s0, s1, s2], [k0, k1, k2]) = (evidence.surfaces, evidence.sky);
        let mixtures: &[(f64, Shares)] = if self.sky {
            &[
                (s1 + 2.0 * k0, Shares::new(0.5, 0.5, 0.0)),
                // The squared mean is subtracted once.
                (2.0 * s0 + 1.0 + k1, Shares::new(0.5, 0.0, 0.5)),
                (s2 + k2, Shares::new(0.5, 0.25, 0.25)),
            ]
        } else {
            &[(s1, Shares::new(0.5, 0.5, 0.0)), (s2, Shares::new(0.25, 0.75, 0.0))]
        };
        let cosine = s0 + k0;
        if !mixtures.iter().all(|(variance, _)| variance.is_finite()) || !cosine.is_finite() {
            return;
        }
        let best = mixtures.iter().min_by(|one, other| one.0.total_cmp(&other.0));
        self.shares = match best {
            Some((variance, shares)) if *variance * LEAST_GAIN < cosine => *shares,
            _ => Shares::COSINE,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_whole_and_all_are_used() {
        assert_eq!(Shares::new(0.5, 0.5, 0.0).aimed_rays(64), [32, 0]);
        assert_eq!(Shares::new(0.5, 0.25, 0.25).aimed_rays(16), [4, 4]);
        assert_eq!(Shares::new(0.3, 0.7, 0.0).aimed_rays(16), [11, 0]);
        assert_eq!(Shares::new(0.01, 0.99, 0.0).aimed_rays(16), [15, 0]);
        assert_eq!(Shares::new(0.0, 1.0, 0.0).aimed_rays(16), [16, 0]);
        assert_eq!(Shares::COSINE.aimed_rays(16), [0, 0]);
        assert_eq!(Shares::new(0.0, 0.0, 1.0).aimed_rays(64), [0, 64]);
    }

    /// A hundredth of an area of 10 that shines with 5.
    const LAMP: Evidence = Evidence { power: 0.5, squared: 2.5, area: 10.0, surfaces: [40.0, 3.0, 2.0], sky: [0.0; 3] };

    #[test]
    fn an_even_source_is_not_aimed_at() {
        let even = Evidence { power: 30.0, squared: 90.0, area: 10.0, ..Evidence::default() };
        assert!((even.evenness() - 1.0).abs() < 1e-12 && (LAMP.evenness() - 0.01).abs() < 1e-12);
        let mut chooser = Chooser::new(Sampling::Auto, false);
        chooser.begin(&even, true);
        assert_eq!(chooser.shares(), Shares::COSINE);
        chooser.begin(&LAMP, true);
        assert_eq!(chooser.shares(), Shares::new(0.5, 0.5, 0.0));
        chooser.begin(&Evidence::default(), true);
        assert_eq!(chooser.shares(), Shares::COSINE, "nothing shines");
    }

    #[test]
    fn the_least_variance_is_chosen_where_it_pays() {
        let mut chooser = Chooser::new(Sampling::Auto, false);
        chooser.begin(&LAMP, true);
        chooser.learn(&LAMP);
        assert_eq!(chooser.shares(), Shares::new(0.25, 0.75, 0.0));
        chooser.learn(&Evidence { surfaces: [f64::NAN; 3], ..LAMP });
        assert_eq!(chooser.shares(), Shares::new(0.25, 0.75, 0.0), "no numbers, no change");
        chooser.learn(&Evidence { surfaces: [3.0, 2.0, 2.5], ..LAMP });
        assert_eq!(chooser.shares(), Shares::COSINE);
        chooser.learn(&LAMP);
        assert_eq!(chooser.shares(), Shares::COSINE, "it stays until the source changes");
    }

    #[test]
    fn the_sky_is_aimed_at_where_it_matters() {
        let mut chooser = Chooser::new(Sampling::Auto, true);
        chooser.begin(&LAMP, true);
        assert_eq!(chooser.shares(), Shares::new(0.5, 0.25, 0.25));
        chooser.learn(&Evidence { surfaces: [-0.9; 3], sky: [50.0, 2.0, 3.0], ..LAMP });
        assert_eq!(chooser.shares(), Shares::new(0.5, 0.0, 0.5));
        chooser.begin(&LAMP, false);
        assert_eq!(chooser.shares(), Shares::new(0.5, 0.5, 0.0), "the map is black");
    }

    #[test]
    fn what_is_asked_for_is_done() {
        for (sampling, shares) in [
            (Sampling::Cosine, Shares::new(1.0, 0.0, 0.0)),
            (Sampling::Importance, Shares::new(0.0, 1.0, 0.0)),
            (Sampling::Mixture { cosine: 0.25 }, Shares::new(0.25, 0.75, 0.0)),
        ] {
            let mut chooser = Chooser::new(sampling, false);
            chooser.begin(&LAMP, true);
            chooser.learn(&LAMP);
            assert_eq!(chooser.shares(), shares);
        }
        assert!(
            Sampling::Mixture { cosine: 0.09 }.check().is_err()
                && Sampling::Mixture { cosine: f32::NAN }.check().is_err()
        );
        assert!(Sampling::Mixture { cosine: 0.1 }.check().is_ok());
    }
}
