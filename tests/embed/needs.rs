//! A running baker whose scene comes to need what was left out.

use crate::engine::Engine;
use crate::live::Live;
use crate::stage::{Chart, Facing, Quad, SIDE, Stage, level_square};
use glam::{DAffine3, DVec3, Vec3, Vec4};
use lightoven::baker::{BakeSettings, Baker, FrameSettings, LightMap, Mode, Sampling, estimate_memory};
use lightoven::gpu::BackendChoice;
use lightoven::scene::{LightKind, Mobility, Resolution, Scene, Sky, SkyMap, Texture, TextureUse, Wrap};
use lightoven::{ErrorKind, Features};

/// What the scene comes to have.
#[derive(Debug, Clone, Copy, PartialEq)]
enum With {
    Nothing,
    Light,
    /// And no lamp that emits.
    LightAlone,
    MovingSquare,
    TexturedLamp,
    TexturedFloor,
    SkyMap,
}

/// A grey floor under a lamp, and a square above its edge.
fn scene(with: With) -> Scene {
    let mut stage = Stage::new();
    let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 5.0));
    let light = level_square(0.5, 1.0, Facing::Down, Chart::new(0), lamp);
    stage.place(&[level_square(1.0, 0.0, Facing::Up, Chart::large(0), grey), light], DAffine3::IDENTITY);
    let square = Quad { chart: Some(Chart::new(1)), ..level_square(0.2, 0.0, Facing::Up, Chart::new(1), grey) };
    stage.place(&[square], at(0.6));
    if with == With::LightAlone {
        stage.desc.materials[lamp].emission = Vec3::ZERO;
    }
    match with {
        With::Nothing => {}
        With::Light | With::LightAlone => {
            stage.light(LightKind::Point { position: DVec3::new(0.3, 0.3, 0.8), range: None })
        }
        With::SkyMap => {
            let (width, height) = (512, 256);
            let pixels = vec![Vec3::ONE; width * height];
            stage.desc.sky = Sky::Map(SkyMap { width: width as u32, height: height as u32, pixels });
        }
        With::MovingSquare => stage.desc.instances[1].mobility = Mobility::Movable,
        With::TexturedLamp | With::TexturedFloor => {
            let pixels = vec![[0, 255, 0, 255]; 4];
            stage.desc.textures.push(Texture { name: "green".into(), width: 2, height: 2, pixels });
            let green = Some(TextureUse { texture: 0, wrap: [Wrap::Repeat; 2] });
            if with == With::TexturedLamp {
                stage.desc.materials[lamp].emission_texture = green;
            } else {
                stage.desc.materials[grey].albedo_texture = green;
            }
        }
    }
    stage.build()
}

fn at(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 0.5))
}

fn live(backend: BackendChoice, with: With) -> Option<Live> {
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let mut live = Live::sampled(backend, &scene(with), frames, Sampling::Cosine)?;
    live.warm_up();
    live.frames(80, 0.1);
    Some(live)
}

fn floor() -> Vec<usize> {
    Chart::large(0).texels().map(|(texel, _)| texel).collect()
}

fn bits(map: &LightMap) -> Vec<[u32; 4]> {
    map.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Texels are lit at once, and as they were; then the new light comes, as it is in a baker that was made with it.
fn comes_to_need(backend: BackendChoice, from: With, with: With, feature: Features, watched: &[usize]) {
    let Some(mut live) = live(backend, from) else { return };
    assert!(feature.is_empty() || !live.baker.features().contains(feature));
    let (before, shown) = (live.baker.read_back().unwrap(), live.baker.light_map());
    live.baker.set_scene(&scene(with)).unwrap();
    assert!(live.baker.features().contains(feature));
    assert_eq!(live.baker.light_map(), shown, "the engine's light map is another");
    let after = live.baker.read_back().unwrap();
    for texel in floor() {
        let [one, other] = [&before, &after].map(|map| map.pixels[texel][0]);
        assert!((one / other - 1.0).abs() < 0.5 && other > 0.0, "texel {texel} was {one} and is {other}");
    }
    // The first frames find out what things cost; nothing is black meanwhile.
    for _ in 0..20 {
        live.frame(0.0, crate::live::AMPLE);
        assert!(live.irradiance(&floor()).iter().all(|light| *light > 0.0), "a texel is black");
    }
    live.frames(80, 0.1);
    let reached = channels(&mut live, watched);
    let Some(mut made_so) = self::live(backend, with) else { return };
    let wanted = channels(&mut made_so, watched);
    let was = channels_of(&before, watched);
    println!("{with:?}: {was:.4} was, {reached:.4} is reached, {wanted:.4} wanted");
    assert!(
        (reached - wanted).abs().max_element() < 0.02 * wanted.max_element(),
        "{reached} is reached, {wanted} wanted"
    );
    assert!((was - wanted).abs().max_element() > 0.1 * wanted.max_element(), "nothing is to be seen of {with:?}");
    made_so.finish();
    live.finish();
}

fn a_first_light(backend: BackendChoice) {
    comes_to_need(backend, With::Nothing, With::Light, Features::LIGHTS, &floor());
}

/// Beside a light that was there.
fn a_first_emitter(backend: BackendChoice) {
    comes_to_need(backend, With::LightAlone, With::Light, Features::empty(), &floor());
}

fn a_first_texture(backend: BackendChoice) {
    comes_to_need(backend, With::Nothing, With::TexturedLamp, Features::EMISSION_TEXTURES, &floor());
}

/// What the lamp sees is the floor.
fn a_first_texture_of_albedo(backend: BackendChoice) {
    let lamp: Vec<usize> = Chart::new(0).texels().map(|(texel, _)| texel).collect();
    comes_to_need(backend, With::Nothing, With::TexturedFloor, Features::ALBEDO_TEXTURES, &lamp);
}

/// It may be moved from then on, and shades the floor.
fn a_first_moving_object(backend: BackendChoice) {
    let Some(mut live) = live(backend, With::Nothing) else { return };
    let refused = live.baker.set_transform(1, at(0.0)).unwrap_err();
    assert!(refused.to_string().contains("declared static"), "{refused}");
    live.baker.set_scene(&scene(With::MovingSquare)).unwrap();
    let before = live.mean(&floor());
    live.baker.set_transform(1, at(0.0)).unwrap();
    live.frames(60, 0.1);
    assert!(live.mean(&floor()) < 0.95 * before, "the square casts no shadow");
    live.finish();
}

/// The same scene again: frames go on as if nothing had been.
fn nothing_changes(backend: BackendChoice) {
    same_bits_with(backend, With::Nothing);
}

/// Light from a lamp's own pass stays too.
fn nothing_changes_under_a_light(backend: BackendChoice) {
    same_bits_with(backend, With::Light);
}

fn same_bits_with(backend: BackendChoice, with: With) {
    let run = |renews: bool| {
        let mut live = live(backend, with)?;
        let sweeps = live.baker.light_map().sweeps;
        if renews {
            let before = live.baker.read_back().unwrap();
            live.baker.set_scene(&scene(with)).unwrap();
            assert_eq!(bits(&live.baker.read_back().unwrap()), bits(&before));
        }
        while live.baker.light_map().sweeps < sweeps + 8 {
            live.frame(0.0, crate::live::AMPLE);
        }
        let (map, reached) = (live.baker.read_back().unwrap(), live.baker.light_map().sweeps);
        live.finish();
        Some((map, reached))
    };
    let (Some((through, reached)), Some((renewed, as_far))) = (run(false), run(true)) else { return };
    assert_eq!(reached, as_far);
    let differ = bits(&through).iter().zip(bits(&renewed)).filter(|(one, other)| *one != other).count();
    assert_eq!(differ, 0, "texels differ");
}

/// Texels under a block that stands on the floor show their neighbours' light, whichever of the maps is on show when the scene is
/// renewed.
fn what_is_inside_stays_filled(backend: BackendChoice) {
    let block = || {
        let mut stage = Stage::new();
        let (grey, lamp) = (stage.material(0.5, 0.0), stage.material(0.0, 5.0));
        let light = level_square(2.0, 1.5, Facing::Down, Chart::new(0), lamp);
        let mut quads = vec![level_square(1.0, 0.0, Facing::Up, Chart::large(0), grey), light];
        // A lid and a floor of its own: what lies between them sees backs alone.
        quads.push(Quad { chart: None, ..level_square(0.3, 0.2, Facing::Up, Chart::new(1), grey) });
        quads.extend(stage_sides(grey));
        stage.place(&quads, DAffine3::IDENTITY);
        stage.build()
    };
    let frames = FrameSettings { quanta: Some(1), ..FrameSettings::default() };
    let Some(mut live) = Live::sampled(backend, &block(), frames, Sampling::Cosine) else { return };
    live.warm_up();
    live.frames(40, 0.1);
    assert!(live.baker.statistics().invalid_texels > 10, "{:?}", live.baker.statistics());
    for _ in 0..3 {
        live.baker.set_scene(&block()).unwrap();
        let generation = live.baker.light_map().generation;
        while live.baker.light_map().generation < generation + 1 {
            live.frame(0.1, crate::live::AMPLE);
        }
        let dark = live.irradiance(&floor()).iter().filter(|light| **light <= 0.0).count();
        assert_eq!(dark, 0, "texels are black after generation {generation}");
    }
    live.finish();
}

/// The sides of a block of .3 by .3 by .2 that stands on the floor's middle.
fn stage_sides(material: usize) -> Vec<Quad> {
    let (half, height) = (0.15, 0.2);
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let side = |index: usize| Quad {
        corner: corners[index],
        u: corners[(index + 1) % 4] - corners[index],
        v: Vec3::Z * height,
        chart: None,
        material,
    };
    (0..4).map(side).collect()
}

/// Mean irradiance of the floor.
fn channels(live: &mut Live, texels: &[usize]) -> DVec3 {
    channels_of(&live.baker.read_back().unwrap(), texels)
}

fn channels_of(map: &LightMap, texels: &[usize]) -> DVec3 {
    let sum: DVec3 = texels.iter().map(|texel| Vec4::from(map.pixels[*texel]).truncate().as_dvec3()).sum();
    sum / texels.len() as f64
}

/// And everything is as it was.
fn what_does_not_fit_is_refused(backend: BackendChoice) {
    let Some(mut live) = live(backend, With::Nothing) else { return };
    let before = live.baker.read_back().unwrap();
    let mut other = Stage::new();
    other.material(0.5, 1.0);
    let other = other.with(&[level_square(1.0, 0.0, Facing::Up, Chart::large(3), 0)]);
    let error = live.baker.set_scene(&other).unwrap_err();
    assert!(error.kind() == ErrorKind::InvalidScene && error.to_string().contains("another layout"), "{error}");
    assert_eq!(bits(&live.baker.read_back().unwrap()), bits(&before));
    live.frames(5, 0.1);
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let mut still = Baker::new(live.engine.gpu(), &scene(With::Nothing), &settings).unwrap();
    let error = still.set_scene(&scene(With::Light)).unwrap_err();
    assert!(
        error.kind() == ErrorKind::InvalidSettings && error.to_string().contains("one within frames does"),
        "{error}"
    );
    drop(still);
    live.finish();
}

macro_rules! on_both_back_ends {
    ($($test:ident),+ $(,)?) => {$(
        mod $test {
            #[test]
            fn software() {
                super::$test(super::BackendChoice::Software);
            }

            #[test]
            fn ray_query() {
                super::$test(super::BackendChoice::RayQuery);
            }
        }
    )+};
}
on_both_back_ends!(
    a_first_light,
    a_first_texture,
    a_first_texture_of_albedo,
    a_first_moving_object,
    a_first_emitter,
    nothing_changes,
    nothing_changes_under_a_light,
    what_is_inside_stays_filled,
    what_does_not_fit_is_refused,
);

/// What a baker for frames takes of the device's memory was told before: within 5 %, and 10 % where the driver alone knows how
/// large its acceleration structures are.
fn memory_is_as_estimated(backend: BackendChoice) {
    let Some(engine) = Engine::new(backend) else { return };
    for with in [With::Nothing, With::Light, With::MovingSquare, With::TexturedLamp, With::SkyMap] {
        for sampling in [Sampling::Cosine, Sampling::Auto] {
            let mode = Mode::Frames(FrameSettings::default());
            let resolution = Resolution::Texels(256);
            let settings = BakeSettings { resolution, sampling, mode, ..BakeSettings::default() };
            let (scene, before) = (scene(with), engine.gpu().allocated_bytes());
            let estimate = estimate_memory(&scene, &settings).unwrap().1;
            let baker = Baker::new(engine.gpu(), &scene, &settings).unwrap();
            let taken = engine.gpu().allocated_bytes() - before;
            let off = estimate.total() as f64 / taken as f64 - 1.0;
            let allowed = if backend == BackendChoice::Software { 0.05 } else { 0.1 };
            println!("{with:?}, {sampling}: {taken} bytes, told {:+.2} %", 100.0 * off);
            assert!(off.abs() < allowed, "{with:?}, {sampling}: {off:+.3} of {taken}: {:?}", estimate.parts);
            drop(baker);
        }
    }
    engine.finish();
}

#[test]
fn memory_is_as_estimated_software() {
    memory_is_as_estimated(BackendChoice::Software);
}

#[test]
fn memory_is_as_estimated_ray_query() {
    memory_is_as_estimated(BackendChoice::RayQuery);
}
