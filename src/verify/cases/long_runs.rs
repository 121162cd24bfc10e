//! More samples than 32 bits count in a sum. Extreme 5.

use super::{Case, Checks};
use crate::baker::{BakeSettings, Baker, Stop};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::scene::Resolution;
use crate::verify::random::Random;
use crate::verify::stage::{Chart, Stage, room};
use glam::Vec3;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::Duration;

pub(super) const CASES: [Case; 2] = [
    Case::extreme(5, "ten million samples of a furnace, arithmetic", arithmetic),
    Case::extreme(5, "a long bake of a furnace", furnace),
];

const SAMPLES: u32 = 10_000_000;
/// Rays of a quantum that is kept.
const QUANTUM: u32 = 64;

/// A texel's halves as the shader keeps them: quanta are merged into a running mean, in 32 bits.
#[derive(Default)]
struct Texel {
    /// Mean and number of samples of the even and of the odd quanta.
    halves: [(f32, f32); 2],
}

impl Texel {
    fn accumulate(&mut self, quantum: u32, mean: f32, samples: u32) {
        let (light, count) = &mut self.halves[quantum as usize % 2];
        *count += samples as f32;
        *light += (mean - *light) * (samples as f32 / *count);
    }

    fn mean(&self) -> f64 {
        let [(even, count), (odd, others)] = self.halves;
        f64::from(even + (odd - even) * (others / (count + others).max(1.0)))
    }
}

/// Quanta that all have the furnace's light, quanta whose light scatters, and single rays; against sums in 64 bits.
fn arithmetic(_: &Gpu, checks: &mut Checks) -> Result<()> {
    let light = (PI / 0.1) as f32;
    for (name, quantum, spread) in [("even light", 64, 0.0), ("quanta that scatter", 64, 1.0), ("single rays", 1, 1.0)]
    {
        let (mut texel, mut sum, mut random) = (Texel::default(), 0.0_f64, Random(5));
        let mut frames = 0.0_f32;
        let count = SAMPLES / quantum;
        for index in 0..count {
            let value = light * (1.0 + spread * (2.0 * random.unit() - 1.0));
            texel.accumulate(index, value, quantum);
            // The average of frames, of a scene that is still.
            frames += (value - frames) / (f64::from(index) as f32 + 1.0);
            sum += f64::from(value);
        }
        let expected = sum / f64::from(count);
        checks.relative(format!("mean of a bake, {name}"), texel.mean(), expected, 1e-4);
        checks.relative(format!("mean of frames, {name}"), f64::from(frames), expected, 1e-4);
    }
    // What a plain sum of single rays comes to, for comparison: it stands still when it outgrows them.
    let sum = (0..SAMPLES).fold(0.0_f32, |sum, _| sum + light);
    let drift = (f64::from(sum) / f64::from(SAMPLES) / f64::from(light) - 1.0).abs();
    checks.at_least("drift of a plain sum", drift, 1e-3);
    Ok(())
}

/// As many of the ten million as the device traces in a second and a half: texels of four by six walls.
fn furnace(gpu: &Gpu, checks: &mut Checks) -> Result<()> {
    const SIDE: u32 = 16;
    let mut stage = Stage::new();
    let wall = stage.material(0.5, 0.5);
    let chart = |index: u32| Chart::at([index % 4 * 4 + 1, index / 4 * 4 + 1], 2).on(SIDE).inset(0.01);
    let scene = stage.with(&room(Vec3::ZERO, Vec3::ONE, chart, wall))?;
    let settings = BakeSettings { resolution: Resolution::Texels(SIDE), ..BakeSettings::default() };
    let mut baker = Baker::new(gpu, &scene, &settings)?;
    let first = Stop { samples: Some(QUANTUM), ..Stop::default() };
    baker.bake(&first, &mut |_| ControlFlow::Continue(()))?;
    let time = Some(Duration::from_millis(1500));
    baker.bake(&Stop { samples: Some(SAMPLES), time, ..Stop::default() }, &mut |_| ControlFlow::Continue(()))?;
    let map = baker.read_back()?;
    let values: Vec<f64> = map.pixels.iter().filter(|pixel| pixel[3] == 1.0).map(|pixel| pixel[0].into()).collect();
    checks.count("texels", values.len() as u64, 24);
    checks.at_least("samples of a texel", baker.statistics().samples_per_texel, 10_000.0);
    checks.relative("least light", values.iter().copied().fold(f64::INFINITY, f64::min), PI, 1e-4);
    checks.relative("most light", values.iter().copied().fold(0.0, f64::max), PI, 1e-4);
    Ok(())
}
