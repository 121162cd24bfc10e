//! What a scene does not need is left out, and leaving it out changes nothing.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;
#[path = "common/shared_scenes.rs"]
mod shared_scenes;

use device::on_both_back_ends;
use glam::{DAffine3, DVec3, Vec2, Vec3};
use lightoven::Features;
use lightoven::baker::{AimedBy, BakeSettings, Baker, ErrorEstimate, LightMap, Sampling, Stop, estimate_memory};
use lightoven::gpu::{Backend, Gpu};
use lightoven::io::gltf::{self, ReadSettings, SidednessChoice};
use lightoven::scene::{
    Instance, Light, LightKind, Material, MeshDesc, MeshPart, Mobility, Resolution, Scene, SceneDesc, Sky, SkyMap,
    Texture, TextureUse, Wrap,
};
use shared_scenes::shared_scene;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

on_both_back_ends!(the_same_bits, the_same_light, the_same_means, as_much_as_was_estimated, nothing_of_what_is_absent);

const ASSETS: [&str; 5] = ["cornell", "courtyard", "doorway", "furnace", "tiny_lamp"];
const LEVELS: [&str; 2] = ["wrackdm17.glb", "islandctf.glb"];

/// Name and scene of every asset, of one under two skies, and of the levels that are there.
fn scenes() -> impl Iterator<Item = (&'static str, Scene)> {
    let skies = [("doorway under a sky", Sky::Constant(Vec3::splat(2.0))), ("doorway under a map", sky_map())];
    let under = skies.into_iter().map(|(name, sky)| {
        let mut scene = gltf::read(&asset("doorway"), &ReadSettings::default()).unwrap();
        scene.set_sky(sky).unwrap();
        (name, scene)
    });
    assets_and_levels().chain(under)
}

/// Of eight by four pixels.
fn sky_map() -> Sky {
    Sky::Map(SkyMap {
        width: 8,
        height: 4,
        pixels: (0..32).map(|pixel| Vec3::splat(1.0 + pixel as f32 / 16.0)).collect(),
    })
}

fn asset(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name).with_extension("gltf")
}

fn assets_and_levels() -> impl Iterator<Item = (&'static str, Scene)> {
    let assets = ASSETS.map(|name| (name, Some(asset(name))));
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
    let unneeded = Features::LEFT_OUT_AT_WILL.difference(OTHER_ROUNDING);
    // The closed forms have the scenes whose rays find no light: extreme case 17.
    let mut switched_on = Features::GATHERING;
    for (name, scene) in scenes() {
        let needed = Features::required(&scene, &sparing(Features::empty()));
        switched_on |= unneeded.difference(needed);
        let [least, most] = [Features::empty(), unneeded].map(|unneeded| bake(gpu, &scene, sparing(unneeded)));
        let bits = |map: &LightMap| map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>();
        let differ = bits(&least).iter().zip(bits(&most)).filter(|(one, other)| *one != other).count();
        assert_eq!(differ, 0, "{name}: texels differ");
        assert!(least.pixels.iter().any(|pixel| pixel[1] > 0.0), "{name}: nothing is lit");
    }
    // Light is reflected in every one of them.
    assert_eq!(unneeded.difference(switched_on), Features::LINKS, "never switched on without need");
}

/// What changes bits: a top level over a single instance, whose rays are then traced in the mesh's own space; and rays that
/// may be aimed, and are not, for the bounces then have two sets of rays, of which the second is kept. Clusters, what has been
/// seen of them, and shared texels bring aimed rays along. Halves of the samples are summed each for itself.
const OTHER_ROUNDING: Features = Features::INSTANCES
    .union(Features::IMPORTANCE)
    .union(Features::SHARED_TEXELS)
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
/// What 4 standard errors are where these are estimated from so many: Student's t of 22 degrees of freedom that is exceeded
/// as seldom, 6.3e-5.
const FOUR_SIGMA: f64 = 4.924;

/// With everything that could be left out: the same means within 4 standard errors.
fn the_same_means(gpu: &Gpu) {
    for (name, scene) in scenes() {
        let [least, least_error] = mean_and_error(gpu, &scene, Features::empty(), 1);
        let [most, most_error] = mean_and_error(gpu, &scene, Features::LEFT_OUT_AT_WILL, 1 + SEEDS);
        let sigma = least_error.hypot(most_error);
        println!("{name}: {least} without what it does not need, {most} with all, of which sigma is {sigma:.1e}");
        // A closed room that shines evenly has no noise, and is rounded all the same.
        let allowed = FOUR_SIGMA * sigma + 1e-6 * least;
        assert!((most - least).abs() <= allowed, "{name}: {least} without, {most} with all, sigma {sigma}");
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
const BEHIND: [(Features, &[&str]); 11] = [
    (Features::SKY_MAP, &["sky map", "sky importance pyramid", "sky evidence map"]),
    (Features::LIGHTS, &["direct.comp", "lights", "direct map"]),
    (Features::ALBEDO_TEXTURES, &["albedo map"]),
    (Features::EMISSION_TEXTURES, &["emission map"]),
    (Features::IMPORTANCE, &["importance.comp", "importance sums", "evidence map", "aimed luminance"]),
    (Features::SHARED_TEXELS, &["pieces map", "pieces"]),
    (
        Features::CLUSTERS,
        &["clusters.comp", "weights.comp", "clusters", "sums within clusters", "texels of clusters", "seats"],
    ),
    (Features::VISIBILITY, &["sightings"]),
    (Features::GATHERING, &["bake.comp", "source.comp", "source map", "mean of even quanta", "activity"]),
    (Features::LINKS, &["bounce.comp", "links"]),
    (Features::HALVES.union(Features::LINKS), &["mean of odd quanta"]),
];

/// A textured floor whose light no surface reflects.
fn lit_by_a_point() -> (&'static str, Scene) {
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].to_vec();
    let part = MeshPart {
        positions: corners.iter().map(|corner| corner.extend(0.0)).collect(),
        light_map_uvs: Some(corners.clone()),
        albedo_uvs: Some(corners),
        indices: vec![0, 1, 2, 0, 2, 3],
        ..MeshPart::default()
    };
    let instance =
        Instance { name: "floor".into(), mesh: 0, transform: DAffine3::IDENTITY, mobility: Mobility::Static };
    let albedo_texture = Some(TextureUse { texture: 0, wrap: [Wrap::Repeat; 2] });
    let kind = LightKind::Point { position: DVec3::Z, range: None };
    let desc = SceneDesc {
        meshes: vec![MeshDesc { name: "floor".into(), parts: vec![part] }],
        instances: vec![instance],
        materials: vec![Material { albedo_texture, ..Material::default() }],
        textures: vec![Texture { name: "white".into(), width: 1, height: 1, pixels: vec![[255; 4]] }],
        lights: vec![Light { name: "lamp".into(), intensity: Vec3::ONE, kind }],
        ..SceneDesc::default()
    };
    ("lit by a point", Scene::new(desc).unwrap())
}

fn nothing_of_what_is_absent(gpu: &Gpu) {
    let settings = |error, sampling| BakeSettings {
        resolution: Resolution::Texels(64),
        error,
        sampling,
        ..BakeSettings::default()
    };
    let by_distance = BakeSettings { aimed_by: AimedBy::Distance, ..settings(ErrorEstimate::Told, Sampling::Auto) };
    for (name, scene) in scenes().chain([lit_by_a_point()]) {
        for settings in [
            by_distance.clone(),
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
