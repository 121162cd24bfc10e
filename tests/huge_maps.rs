//! One texel of a huge light map shines, all others are black: what `lightoven::verify` does at 1024 texels a side.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "common/device.rs"]
mod device;

use lightoven::baker::{BakeSettings, Baker, Sampling, Stop};
use lightoven::gpu::{BackendChoice, Gpu};
use lightoven::scene::Resolution;
use lightoven::verify::stage::{Chart, Facing, Stage, level_square};
use std::f64::consts::PI;
use std::ops::ControlFlow;

device::on_both_back_ends!(not_yet_huge);

/// What a point gets of a unit square at a distance of 1.
const FACTOR: f64 = 0.239_456;

/// The map alone takes seconds, so that few texels and rays must do: the texels of the point are the randomisations.
fn one_of_many(gpu: &Gpu, side: u32) {
    let chart = |first: u32, size| Chart::at([first; 2], size).on(side).inset(0.01);
    let mut stage = Stage::new();
    let (black, shining) = (stage.material(0.0, 0.0), stage.material(0.0, 1.0));
    let point = level_square(1e-4, 0.0, Facing::Up, chart(0, 6), black);
    let lamp = level_square(1.0, 1.0, Facing::Down, chart(side - 1, 1), shining);
    let scene = stage.with(&[point, lamp]).unwrap();
    let (resolution, sampling) = (Resolution::Texels(side), Sampling::Mixture { cosine: 0.5 });
    let settings = BakeSettings { resolution, sampling, ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, &scene, &settings).unwrap();
    assert!(baker.atlas().shared);
    let stop = Stop { samples: Some(256), ..Stop::default() };
    baker.bake(&stop, &mut |_| ControlFlow::Continue(())).unwrap();
    let map = baker.read_back().unwrap();
    assert!(map.pixels.iter().flatten().all(|value| value.is_finite()));
    let factors: Vec<f64> = chart(0, 6)
        .texels()
        .map(|(texel, _)| {
            assert_eq!(map.pixels[texel][3], 1.0);
            f64::from(map.pixels[texel][0]) / PI
        })
        .collect();
    let count = factors.len() as f64;
    let mean = factors.iter().sum::<f64>() / count;
    let squares = factors.iter().map(|factor| (factor - mean).powi(2)).sum::<f64>();
    let bound = 4.0 * (squares / (count * (count - 1.0))).sqrt();
    println!("one bright texel of {side} x {side}: {mean:.6} is within {bound:.1e} of {FACTOR}");
    assert!(bound <= 5e-3 && (mean - FACTOR).abs() <= bound + 1e-6);
}

/// That it is no fault of the test where the others fail.
fn not_yet_huge(gpu: &Gpu) {
    one_of_many(gpu, 256);
}

#[test]
#[ignore = "half a minute and 4 GB"]
fn very_large() {
    device::on(BackendChoice::Software, |gpu| one_of_many(gpu, 4096));
}

#[test]
#[ignore = "two minutes and 12 GB"]
fn huge() {
    device::on(BackendChoice::Software, |gpu| one_of_many(gpu, 8192));
}
