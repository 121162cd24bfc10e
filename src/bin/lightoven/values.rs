//! Values on the command line, from text. Errors say what is allowed; clap puts the option and the value before them.

use crate::arguments::SkyArgument;
use crate::bench::growth::{LEAST_SIDE, LEAST_TRIANGLES};
use glam::Vec3;
use lightoven::baker::{AimedBy, Bounces, Sampling, Stop};
use lightoven::bvh::FIRST_BITS;
use lightoven::scene::atlas::MAX_RESOLUTION;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A year: far beyond any bake, and far below what a clock can add.
const MAX_HOURS: f64 = 8760.0;

/// Most samples of a bake that is made to be noisy, and most such bakes.
const MAX_FEW_SAMPLES: u32 = 1 << 20;
const MAX_SEEDS: u32 = 1000;

/// Most rays of a round: 80 bytes each on the device, once for each back end.
const MAX_BENCH_RAYS: u32 = 1 << 24;
const MAX_ROUNDS: u32 = 1000;

fn whole(text: &str, range: RangeInclusive<u32>) -> Result<u32, String> {
    let allowed = || format!("allowed is a whole number from {} to {}", range.start(), range.end());
    text.parse().ok().filter(|number| range.contains(number)).ok_or_else(allowed)
}

pub(crate) fn samples(text: &str) -> Result<u32, String> {
    whole(text, 1..=Stop::MAX_SAMPLES)
}

pub(crate) fn few_samples(text: &str) -> Result<u32, String> {
    whole(text, 1..=MAX_FEW_SAMPLES)
}

/// One bake has no variance.
pub(crate) fn seeds(text: &str) -> Result<u32, String> {
    whole(text, 2..=MAX_SEEDS)
}

pub(crate) fn bench_rays(text: &str) -> Result<u32, String> {
    whole(text, 1..=MAX_BENCH_RAYS)
}

pub(crate) fn most_triangles(text: &str) -> Result<u32, String> {
    whole(text, LEAST_TRIANGLES..=1 << FIRST_BITS)
}

pub(crate) fn most_texels(text: &str) -> Result<u32, String> {
    whole(text, LEAST_SIDE..=MAX_RESOLUTION)
}

pub(crate) fn rounds(text: &str) -> Result<u32, String> {
    whole(text, 1..=MAX_ROUNDS)
}

pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("allowed is a whole number from 0 to {}", u64::MAX))
}

pub(crate) fn resolution(text: &str) -> Result<u32, String> {
    whole(text, 1..=MAX_RESOLUTION)
}

pub(crate) fn texels_per_unit(text: &str) -> Result<f32, String> {
    let positive = |density: &f32| *density > 0.0 && density.is_finite();
    text.parse().ok().filter(positive).ok_or_else(|| "allowed is a finite number over 0".into())
}

pub(crate) fn error(text: &str) -> Result<f32, String> {
    let inside = |error: &f32| *error > 0.0 && *error <= 1.0;
    text.parse().ok().filter(inside).ok_or_else(|| "allowed is a number over 0 and up to 1".into())
}

pub(crate) fn scale(text: &str) -> Result<f64, String> {
    let positive = |scale: &f64| *scale > 0.0 && scale.is_finite();
    text.parse().ok().filter(positive).ok_or_else(|| "allowed is a finite number over 0".into())
}

pub(crate) fn bounces(text: &str) -> Result<Bounces, String> {
    match text {
        "auto" => Ok(Bounces::Auto),
        _ => match text.parse() {
            Ok(count) if count <= Bounces::MAX_LIMIT => Ok(Bounces::Limit(count)),
            _ => Err(format!("allowed is auto or a whole number from 0 to {}", Bounces::MAX_LIMIT)),
        },
    }
}

/// Which way rays are sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    pub(crate) sampling: Sampling,
    pub(crate) aimed_by: AimedBy,
}

/// `auto`, `mixture=0.25`, `auto:power`.
pub(crate) fn way(text: &str) -> Result<Way, String> {
    let Some((before, after)) = text.split_once(':') else {
        return Ok(Way { sampling: sampling(text)?, aimed_by: AimedBy::default() });
    };
    let aimed_by = AIMED_BY.iter().find(|(_, name)| *name == after).map(|(aimed_by, _)| *aimed_by);
    let sampling = sampling(before)?;
    let aimed_by = aimed_by.filter(|_| sampling != Sampling::Cosine);
    aimed_by
        .map(|aimed_by| Way { sampling, aimed_by })
        .ok_or_else(|| "allowed after a colon is power, distance or visibility, where rays are aimed".into())
}

const AIMED_BY: [(AimedBy, &str); 3] =
    [(AimedBy::Power, "power"), (AimedBy::Distance, "distance"), (AimedBy::Visibility, "visibility")];

/// A mixture without a share has one half.
fn sampling(text: &str) -> Result<Sampling, String> {
    let allowed = || {
        let least = Sampling::LEAST_COSINE;
        format!("allowed is auto, cosine, importance, mixture, or mixture=A with A from {least} to 1")
    };
    match text {
        "auto" => Ok(Sampling::Auto),
        "cosine" => Ok(Sampling::Cosine),
        "importance" => Ok(Sampling::Importance),
        "mixture" => Ok(Sampling::Mixture { cosine: 0.5 }),
        _ => {
            let share = text.strip_prefix("mixture=").and_then(|share| share.parse::<f32>().ok());
            let cosine = share.filter(|share| (Sampling::LEAST_COSINE..=1.0).contains(share));
            cosine.map(|cosine| Sampling::Mixture { cosine }).ok_or_else(allowed)
        }
    }
}

impl Way {
    pub(crate) const AUTO: Self = Self { sampling: Sampling::Auto, aimed_by: AimedBy::Visibility };

    /// As it is written on the command line.
    pub(crate) fn name(self) -> String {
        let name = match self.sampling {
            Sampling::Auto => "auto".into(),
            Sampling::Cosine => "cosine".into(),
            Sampling::Importance => "importance".into(),
            Sampling::Mixture { cosine } => format!("mixture={cosine}"),
        };
        let aimed_by = AIMED_BY.iter().find(|(aimed_by, _)| *aimed_by == self.aimed_by);
        match aimed_by {
            Some((aimed_by, after)) if *aimed_by != AimedBy::default() => format!("{name}:{after}"),
            _ => name,
        }
    }
}

pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let allowed = || format!("allowed is over 0 and up to {MAX_HOURS}h, as in 30s, 1.5m, 2h, 500ms or 30");
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[number.len()..] {
        "ms" => 1e-3,
        "" | "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        _ => return Err(allowed()),
    };
    let seconds = number.parse::<f64>().map_err(|_| allowed())? * unit;
    if !(seconds > 0.0 && seconds <= MAX_HOURS * 3600.0) {
        return Err(allowed());
    }
    Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero()).ok_or_else(allowed)
}

pub(crate) fn sky(text: &str) -> Result<SkyArgument, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|part| part.trim().parse::<f32>()).collect();
    if let Ok(numbers) = numbers {
        let usable = |c: &f32| c.is_finite() && *c >= 0.0;
        return match numbers[..] {
            [r, g, b] if numbers.iter().all(usable) => Ok(SkyArgument::Constant(Vec3::new(r, g, b))),
            _ => Err("allowed are three finite numbers of at least 0, as in 1,1,1".into()),
        };
    }
    if Path::new(text).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        return Ok(SkyArgument::File(PathBuf::from(text)));
    }
    Err("allowed are three numbers, as in 1,1,1, or a file whose name ends in .exr".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_have_units() {
        let ms = |text| duration(text).map(|time| time.as_millis());
        assert_eq!(ms("30s"), Ok(30_000));
        assert_eq!(ms("1.5m"), Ok(90_000));
        assert_eq!(ms("2h"), Ok(7_200_000));
        assert_eq!(ms("500ms"), Ok(500));
        assert_eq!(ms("2.5"), Ok(2_500));
        for bad in ["", "s", "0", "0s", "-1s", "nan", "inf", "NaNs", "30 s", "3d", "9000h", "1e400", "1e-30", "ä"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn skies_are_numbers_or_files() {
        assert_eq!(sky("1,0.5, 0"), Ok(SkyArgument::Constant(Vec3::new(1.0, 0.5, 0.0))));
        assert_eq!(sky("a,b.EXR"), Ok(SkyArgument::File("a,b.EXR".into())));
        for bad in ["", "1", "1,1", "1,1,1,1", "-1,0,0", "nan,0,0", "inf,0,0", "sky.hdr", "1,1,x"] {
            assert!(sky(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_have_ranges() {
        assert_eq!((samples("1"), resolution("16384"), error("1")), (Ok(1), Ok(16384), Ok(1.0)));
        assert!(matches!(bounces("0"), Ok(Bounces::Limit(0))) && matches!(bounces("auto"), Ok(Bounces::Auto)));
        assert!(matches!(bounces("16384"), Ok(Bounces::Limit(Bounces::MAX_LIMIT))));
        assert_eq!(sampling("mixture=0.25"), Ok(Sampling::Mixture { cosine: 0.25 }));
        for name in ["auto", "cosine", "importance", "mixture=0.25", "auto:power", "mixture=0.5:distance"] {
            assert_eq!(way(name).map(Way::name), Ok(name.to_owned()));
        }
        assert_eq!(way("auto:visibility"), way("auto"));
        assert!(["auto:", "auto:x", ":power", "cosine:power", "auto:power:power"].iter().all(|bad| way(bad).is_err()));
        assert!(
            ["", "mixture=", "mixture=0", "mixture=nan", "mixture=1.01", "Cosine"]
                .iter()
                .all(|bad| sampling(bad).is_err())
        );
        assert!(["0", "-1", "1.5", "4294967296"].iter().all(|bad| samples(bad).is_err()));
        assert_eq!((few_samples("1048576"), seeds("2"), seeds("1000")), (Ok(1 << 20), Ok(2), Ok(1000)));
        assert!(few_samples("1048577").is_err() && seeds("1").is_err() && seeds("1001").is_err());
        assert!(["0", "16385", "100000", "x"].iter().all(|bad| resolution(bad).is_err()));
        assert!(["0", "-1", "nan", "inf", "1.1"].iter().all(|bad| error(bad).is_err()));
        assert!(["0", "-1", "nan", "inf"].iter().all(|bad| scale(bad).is_err() && texels_per_unit(bad).is_err()));
        assert!(["-1", "16385", "4000000000", "none"].iter().all(|bad| bounces(bad).is_err()));
    }
}
