//! Which way rays are sent: by the cosine at the texel, toward where the light map is bright, or both. Pure.

use crate::error::{Error, Result};

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
    /// emitters without light-map coordinates, the lesser part of a texel that two surfaces share) is not found, and the
    /// variance beside a bright surface has no bound.
    Importance,
    /// Both, and `cosine` is the share of rays sent by the cosine, .1 to 1: a ray weighs at most pi / `cosine` times the
    /// radiance that it sees.
    Mixture {
        /// Share of rays sent by the cosine.
        cosine: f32,
    },
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
