//! What a scene does not need is left out, and leaving it out changes nothing.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;
#[path = "common/shared_scenes.rs"]
mod shared_scenes;

use device::on_both_back_ends;
use lightoven::Features;
use lightoven::baker::{BakeSettings, Baker, ErrorEstimate, LightMap, Sampling, Stop, estimate_memory};
use lightoven::gpu::{Backend, Gpu};
use lightoven::io::gltf::{self, ReadSettings, SidednessChoice};
use lightoven::scene::{Resolution, Scene};
use shared_scenes::shared_scene;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

on_both_back_ends!(the_same_bits, the_same_light, the_same_means, as_much_as_was_estimated, nothing_of_what_is_absent);

const ASSETS: [&str; 5] = ["cornell", "courtyard", "doorway", "furnace", "tiny_lamp"];
const LEVELS: [&str; 2] = ["wrackdm17.glb", "islandctf.glb"];

/// Name and scene of every asset, and of the levels that are there.
fn scenes() -> impl Iterator<Item = (&'static str, Scene)> {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let assets = ASSETS.map(|name| (name, Some(assets.join(name).with_extension("gltf"))));
    let levels = LEVELS.map(|name| (name, shared_scene(name)));
    let read = |path: PathBuf| gltf::read(&path, &read_settings(&path)).unwrap();
    assets.into_iter().chain(levels).filter_map(move |(name, path)| Some((name, read(path?))))
}

/// Levels are meant to be seen from both sides.
fn read_settings(path: &Path) -> ReadSettings {
    let is_level = path.extension().is_some_and(|extension| extension == "glb");
    let sidedness = if is_level { SidednessChoice::AllDouble } else { SidednessChoice::default() };
    ReadSettings { sidedness }
}

/// Nothing that a scene is not known to need.
fn sparing(unneeded: Features) -> BakeSettings {
    let resolution = Resolution::Texels(64);
    BakeSettings { resolution, sampling: Sampling::Cosine, error: ErrorEstimate::None, unneeded, ..Default::default() }
}

fn bake(gpu: &Gpu, scene: &Scene, settings: BakeSettings) -> LightMap {
    let mut baker = Baker::new(gpu, scene, &settings).unwrap();
    // More than two quanta, whose halves' sums are rounded in another order than one sum.
    let stop = Stop { samples: Some(320), ..Stop::default() };
    baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    baker.read_back().unwrap()
}

/// All at once, but for what is in [`OTHER_ROUNDING`].
fn the_same_bits(gpu: &Gpu) {
    for (name, scene) in scenes() {
        let unneeded = Features::LEFT_OUT_AT_WILL.difference(OTHER_ROUNDING);
        let needed = Features::required(&scene, &sparing(Features::empty()));
        assert!(!unneeded.difference(needed).is_empty(), "{name}: nothing is left out");
        let [least, most] = [Features::empty(), unneeded].map(|unneeded| bake(gpu, &scene, sparing(unneeded)));
        let bits = |map: &LightMap| map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>();
        let differ = bits(&least).iter().zip(bits(&most)).filter(|(one, other)| *one != other).count();
        assert_eq!(differ, 0, "{name}: texels differ");
        assert!(least.pixels.iter().any(|pixel| pixel[1] > 0.0), "{name}: nothing is lit");
    }
}

/// What changes bits: a top level over a single instance, whose rays are then traced in the mesh's own space; and rays that
/// may be aimed, and are not, for the bounces then have two sets of rays, of which the second is kept. Clusters, and what has
/// been seen of them, bring aimed rays along. Halves of the samples are summed each for itself.
const OTHER_ROUNDING: Features = Features::INSTANCES
    .union(Features::IMPORTANCE)
    .union(Features::CLUSTERS)
    .union(Features::VISIBILITY)
    .union(Features::HALVES);

/// But for single texels, in which a wall stands or not, or a ray that found a lamp passes it, as rounding has it: 19 at most.
fn the_same_light(gpu: &Gpu) {
    for (name, scene) in scenes() {
        let least = bake(gpu, &scene, sparing(Features::empty()));
        let level = least.pixels.iter().map(|pixel| pixel[1]).sum::<f32>() / least.pixels.len() as f32;
        for unneeded in OTHER_ROUNDING.difference(Features::required(&scene, &sparing(Features::empty()))) {
            let map = bake(gpu, &scene, sparing(unneeded));
            let apart = |(one, other): (&[f32; 4], &[f32; 4])| (one[1] - other[1]).abs() / level;
            let apart: Vec<f32> = least.pixels.iter().zip(&map.pixels).map(apart).collect();
            let far = apart.iter().filter(|apart| **apart > 0.05).count();
            assert!(far <= apart.len() / 100, "{name} with {unneeded:?}: {far} texels of {} differ", apart.len());
            let mean = apart.iter().filter(|apart| **apart <= 0.05).sum::<f32>() / apart.len() as f32;
            assert!(mean < 2e-3, "{name} with {unneeded:?}: {mean} apart in the mean");
        }
    }
}

/// Independent bakes behind a standard error.
const SEEDS: u64 = 12;

/// What has other random numbers, and what is rounded otherwise: the same means within 4 standard errors.
fn the_same_means(gpu: &Gpu) {
    for (name, scene) in scenes() {
        let needed = Features::required(&scene, &sparing(Features::empty()));
        let [least, least_error] = mean_and_error(gpu, &scene, Features::empty(), 1);
        for (index, unneeded) in OTHER_ROUNDING.difference(needed).iter().enumerate() {
            let [mean, error] = mean_and_error(gpu, &scene, unneeded, 1 + SEEDS * (index as u64 + 1));
            let sigma = error.hypot(least_error);
            println!("{name}, {unneeded:?}: {mean} and {least}, of which sigma is {sigma:.1e}");
            // A closed room that shines evenly has no noise, and is rounded all the same.
            let allowed = 4.0 * sigma + 1e-6 * least;
            assert!((mean - least).abs() <= allowed, "{name} with {unneeded:?}: {mean} and {least}, sigma {sigma}");
        }
    }
}

/// Mean irradiance of a light map, all channels, over bakes with seeds from `first` on, and its standard error.
fn mean_and_error(gpu: &Gpu, scene: &Scene, unneeded: Features, first: u64) -> [f64; 2] {
    // Pipelines live while one baker has them.
    let mut kept = None;
    let mut mean_of = |seed: u64| {
        let settings = BakeSettings { seed, resolution: Resolution::Texels(32), ..sparing(unneeded) };
        let mut baker = Baker::new(gpu, scene, &settings).unwrap();
        let stop = Stop { samples: Some(192), ..Stop::default() };
        baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
        let map = baker.read_back().unwrap();
        kept.get_or_insert(baker);
        let lit = map.pixels.iter().filter(|pixel| pixel[3] == 1.0);
        let sum: f64 = lit.flat_map(|[red, green, blue, _]| [*red, *green, *blue]).map(f64::from).sum();
        sum / map.pixels.len() as f64
    };
    let means: Vec<f64> = (first..first + SEEDS).map(&mut mean_of).collect();
    let mean = means.iter().sum::<f64>() / SEEDS as f64;
    let squares: f64 = means.iter().map(|one| (one - mean).powi(2)).sum();
    [mean, (squares / ((SEEDS - 1) * SEEDS) as f64).sqrt()]
}

/// Of device memory, whatever is needed: within 5 %. How large a driver makes its acceleration structures it alone knows.
fn as_much_as_was_estimated(gpu: &Gpu) {
    for (name, scene) in scenes() {
        for settings in [sparing(Features::empty()), sparing(Features::LEFT_OUT_AT_WILL), BakeSettings::default()] {
            let settings = BakeSettings { resolution: Resolution::Texels(256), ..settings };
            let before = gpu.allocated_bytes();
            let estimate = estimate_memory(&scene, &settings).unwrap().1;
            let baker = Baker::new(gpu, &scene, &settings).unwrap();
            let taken = gpu.allocated_bytes() - before;
            let off = estimate.total() as f64 / taken as f64 - 1.0;
            assert!(
                off.abs() < if gpu.backend() == Backend::Software { 0.05 } else { 0.1 },
                "{name}: {off:+.3} of {taken}: {:?}, {:?}",
                estimate.parts,
                gpu.allocations()
            );
            drop(baker);
            assert_eq!(gpu.allocated_bytes(), before, "{name}: memory stays");
        }
    }
}

/// What there is of a feature alone: pipelines, buffers and images.
const BEHIND: [(Features, &[&str]); 9] = [
    (Features::SKY_MAP, &["sky map", "sky importance pyramid", "sky evidence map"]),
    (Features::LIGHTS, &["direct.comp", "lights", "direct map"]),
    (Features::ALBEDO_TEXTURES, &["albedo map"]),
    (Features::EMISSION_TEXTURES, &["emission map"]),
    (Features::IMPORTANCE, &["importance.comp", "importance sums", "evidence map", "aimed luminance"]),
    (Features::SHARED_TEXELS, &["pieces map", "pieces"]),
    (
        Features::CLUSTERS,
        &[
            "clusters.comp",
            "weights.comp",
            "clusters",
            "sums within clusters",
            "texels of clusters",
            "seats",
            "sightings",
        ],
    ),
    (Features::LINKS, &["bounce.comp", "links"]),
    (Features::HALVES.union(Features::LINKS), &["mean of odd quanta"]),
];

fn nothing_of_what_is_absent(gpu: &Gpu) {
    let settings = |error, sampling| BakeSettings {
        resolution: Resolution::Texels(64),
        error,
        sampling,
        ..BakeSettings::default()
    };
    for (name, scene) in scenes() {
        for settings in [
            settings(ErrorEstimate::None, Sampling::Cosine),
            settings(ErrorEstimate::Told, Sampling::Auto),
            settings(ErrorEstimate::Adaptive, Sampling::Mixture { cosine: 0.5 }),
        ] {
            let baker = Baker::new(gpu, &scene, &settings).unwrap();
            let objects = gpu.objects();
            let alive = |name: &&str| {
                [&objects.pipelines, &objects.buffers, &objects.images]
                    .iter()
                    .any(|objects| objects.contains_key(*name))
            };
            let features = baker.features();
            for (feature, behind) in BEHIND.iter().filter(|(feature, _)| !features.intersects(*feature)) {
                let found: Vec<_> = behind.iter().filter(|name| alive(name)).collect();
                assert!(found.is_empty(), "{name}, without {feature:?}: {found:?} exist");
            }
            // The names are right: what is there is found.
            for (feature, behind) in BEHIND.iter().filter(|(feature, _)| features.contains(*feature)) {
                let found = behind.iter().filter(|name| alive(name)).count();
                let needs_both = *feature == Features::SKY_MAP && !features.contains(Features::IMPORTANCE);
                assert!(found == behind.len() || needs_both, "{name}, with {feature:?}: {found} of {behind:?}");
            }
            drop(baker);
            assert_eq!(gpu.objects().count(), 0, "{name}: {:?}", gpu.objects());
        }
    }
}
