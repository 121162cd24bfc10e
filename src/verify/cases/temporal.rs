//! The running average on the host: what its weights leave of old light, how noisy it is, how fast bounces settle through
//! it. Closed forms 17 to 19, extremes 3 and 4.

use super::{Case, Checks};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::temporal::{Average, History, World};
use crate::verify::estimate::{Estimate, SEEDS};
use crate::verify::random::Random;
use std::time::Duration;

pub(super) const CASES: [Case; 5] = [
    Case::closed_form(17, "step response in any pattern of time", step_response),
    Case::closed_form(18, "steady noise of the running average", steady_noise),
    Case::closed_form(19, "frames to settle, weights alone", frames_to_settle),
    Case::extreme(3, "weights at any frame rate and latency", any_rate_and_latency),
    Case::extreme(4, "weights after a million still samples", long_still_history),
];

const THRESHOLD: f64 = 0.1;
const LATENCY_S: f64 = 0.5;

fn average(latency_s: f64) -> Result<Average> {
    Average::new(Duration::from_secs_f64(latency_s), THRESHOLD)
}

/// What the shader does with a visit all of whose quanta have one value.
fn merge(light: &mut f64, kept: f64, quanta: u32, value: f64) {
    for quantum in 1..=quanta {
        *light += (value - *light) / (kept + f64::from(quantum));
    }
}

/// A history that has been still for so many quanta.
fn still(average: &Average, quanta: u32) -> History {
    let mut history = History::default();
    history.visit(average, 0.01, quanta, World::Still);
    history
}

/// Share of the old light after these steps, if all light goes out before the first.
fn share_left(mut history: History, average: &Average, quanta: u32, steps_s: impl Iterator<Item = f64>) -> f64 {
    let mut light = 1.0;
    for step_s in steps_s {
        let kept = history.visit(average, step_s, quanta, World::Changing);
        merge(&mut light, kept, quanta, 0.0);
    }
    light
}

/// Steps that add up to the latency: so many alike, or of lengths that differ a thousandfold.
fn patterns(latency_s: f64) -> Vec<(String, Vec<f64>)> {
    let alike =
        [1, 3, 30, 72, 500, 5000].map(|count| (format!("{count} steps"), vec![latency_s / count as f64; count]));
    let mut random = Random(17);
    let mut uneven = |round: u32| {
        let times: Vec<f64> = (0..40).map(|_| f64::from(random.unit()).powi(4) + 1e-3).collect();
        let sum: f64 = times.iter().sum();
        (format!("uneven steps {round}"), times.iter().map(|time| time * latency_s / sum).collect())
    };
    let uneven: Vec<_> = (1..=4).map(&mut uneven).collect();
    alike.into_iter().chain(uneven).collect()
}

fn step_response(_: &Gpu, checks: &mut Checks) -> Result<()> {
    for latency_s in [1e-3, LATENCY_S, 60.0] {
        let average = average(latency_s)?;
        for (name, steps_s) in patterns(latency_s) {
            let shares = [1, 7, 64]
                .map(|quanta| share_left(still(&average, u32::MAX), &average, quanta, steps_s.iter().copied()));
            let off = |share: &f64| (share - THRESHOLD).abs();
            let worst = shares.into_iter().max_by(|one, other| off(one).total_cmp(&off(other))).unwrap_or(f64::NAN);
            checks.relative(format!("left after {latency_s} s in {name}"), worst, THRESHOLD, 1e-5);
        }
    }
    Ok(())
}

/// Texels of independent noise, each quantum of variance 1, kept in 32 bits as on the device.
fn steady_noise(_: &Gpu, checks: &mut Checks) -> Result<()> {
    const TEXELS: usize = 2000;
    for (rate, latency_s, quanta) in [(60.0, 0.5, 4), (30.0, 0.2, 1), (144.0, 0.5, 2), (5.0, 0.1, 3)] {
        let average = average(latency_s)?;
        let variance = |seed: u64| {
            let (mut random, mut history, mut texels) = (Random(seed), History::default(), vec![0.0_f32; TEXELS]);
            // After five latencies the beginning is gone: a hundred-thousandth.
            for _ in 0..(5.0 * latency_s * rate) as u32 + 5 {
                let kept = history.visit(&average, 1.0 / rate, quanta, World::Changing) as f32;
                for texel in &mut texels {
                    for quantum in 1..=quanta {
                        let value = (2.0 * random.unit() - 1.0) * 3.0_f32.sqrt();
                        *texel += (value - *texel) / (kept + quantum as f32);
                    }
                }
            }
            texels.iter().map(|texel| f64::from(*texel).powi(2)).sum::<f64>() / TEXELS as f64
        };
        let estimate = Estimate::over(&(0..SEEDS).map(variance).collect::<Vec<_>>());
        let weight = 1.0 - THRESHOLD.powf(1.0 / (rate * latency_s));
        let expected = weight / (2.0 - weight) / f64::from(quanta);
        let what = format!("variance at {rate} frames a second, latency {latency_s} s, {quanta} quanta");
        checks.estimate(what, estimate, expected, 0.0, 0.1 * expected);
    }
    Ok(())
}

/// What bounces read.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reads {
    /// The last frame's radiance.
    LastFrame,
    /// The average that is shown.
    Average,
}

/// Frames until a furnace's light, all of which goes out, has fallen to the threshold.
fn settle(albedo: f64, reads: Reads) -> Result<u32> {
    let average = average(LATENCY_S)?;
    let (mut source, mut shown, mut history) = (1.0, 1.0, still(&average, 1_000_000));
    let mut frames = 0;
    while shown > THRESHOLD && frames < 100_000 {
        let radiance = albedo * if reads == Reads::Average { shown } else { source };
        let kept = history.visit(&average, 1.0 / 60.0, 1, World::Changing);
        merge(&mut shown, kept, 1, radiance);
        source = radiance;
        frames += 1;
    }
    Ok(frames)
}

/// Against what a host's simulation of the recurrence gave: the first is how it is done, the second how it is not.
fn frames_to_settle(_: &Gpu, checks: &mut Checks) -> Result<()> {
    for (albedo, reads, frames) in [
        (0.8, Reads::LastFrame, 35.0),
        (0.9, Reads::LastFrame, 44.0),
        (0.5, Reads::Average, 62.0),
        (0.8, Reads::Average, 155.0),
        (0.9, Reads::Average, 311.0),
        (0.99, Reads::Average, 3115.0),
    ] {
        checks.within(format!("albedo {albedo}, {reads:?}"), f64::from(settle(albedo, reads)?), frames, 1.0);
    }
    Ok(())
}

/// Frames of any length, and lengths that are none.
fn any_rate_and_latency(_: &Gpu, checks: &mut Checks) -> Result<()> {
    let rates = [1.0, 7.0, 60.0, 144.0, 1000.0, 10_000.0].map(f64::recip);
    let strange = [0.0, -1.0, f64::NAN, 5e-324, 1e-12, 1e6, 1e300, f64::INFINITY, f64::NEG_INFINITY];
    let latencies =
        [Duration::ZERO, Duration::from_nanos(1), Duration::from_millis(1), Duration::from_secs(60), Duration::MAX];
    for latency in latencies {
        let average = Average::new(latency, THRESHOLD)?;
        let (mut outside, mut random) = (0, Random(3));
        let mut check = |is_so: bool| outside += u64::from(!is_so);
        let (mut history, mut light) = (History::default(), 0.0_f32);
        for step_s in rates.into_iter().chain(strange).cycle().take(3000) {
            let world = if random.unit() < 0.2 { World::Still } else { World::Changing };
            let quanta = 1 + (random.unit() * 64.0) as u32;
            let kept = history.visit(&average, step_s, quanta, world);
            check((0.0..=1.0).contains(&average.weight(step_s)) && (0.0..=1.0).contains(&average.decay(step_s)));
            check(kept >= 0.0 && kept.is_finite() && (kept as f32).is_finite());
            // Light of 2 to 3: the average is never beyond them, nor beside them at the beginning.
            for quantum in 1..=quanta {
                light += (2.0 + random.unit() - light) / (kept as f32 + quantum as f32);
            }
            check((1.999..=3.001).contains(&light));
        }
        checks.count(format!("latency {latency:?}: weights and light out of range"), outside, 0);
    }
    let finite = average(LATENCY_S)?;
    let (none, endless) = (average(0.0)?, Average::new(Duration::MAX, THRESHOLD)?);
    checks.within("weight long after the latency", finite.weight(1e300), 1.0, 0.0);
    checks.within("weight of no time at all", finite.weight(0.0), 0.0, 0.0);
    checks.within("weight without latency", none.weight(0.0), 1.0, 0.0);
    checks.within("weight with an endless latency", endless.weight(1e300), 0.0, 0.0);
    let mut history = still(&finite, 9);
    let kept = history.visit(&finite, 0.0, 1, World::Changing);
    checks.within("what ten quanta keep against one more in no time", kept, 9.0, 1e-12);
    // At 1,000 frames a second and a minute's latency a difference of 32-bit numbers is off by 8e-4.
    let exponent = THRESHOLD.ln() / 60.0 / 1000.0;
    let series = -exponent * (1.0 + exponent / 2.0 * (1.0 + exponent / 3.0));
    checks.relative("weight of a thousandth of a second in a minute", average(60.0)?.weight(1e-3), series, 1e-12);
    let refused = |threshold: &f64| Average::new(Duration::from_secs(1), *threshold).is_err();
    checks.holds("thresholds that are none are refused", [0.0, 1.0, -0.1, 2.0, f64::NAN].iter().all(refused));
    Ok(())
}

fn long_still_history(_: &Gpu, checks: &mut Checks) -> Result<()> {
    let average = average(LATENCY_S)?;
    for rate in [2.0, 7.0, 30.0, 60.0, 144.0, 1000.0, 10_000.0_f64] {
        let frames = (LATENCY_S * rate).ceil() as usize;
        let steps_s = || std::iter::repeat_n(rate.recip(), frames);
        let shares = [1, 16].map(|quanta| share_left(still(&average, 1_000_000), &average, quanta, steps_s()));
        checks.at_most(format!("left at {rate} frames a second"), shares[0].max(shares[1]), THRESHOLD * (1.0 + 1e-5));
    }
    let endless = Average::new(Duration::MAX, THRESHOLD)?;
    let plain = share_left(still(&endless, 1_000_000), &endless, 1, std::iter::repeat_n(1.0 / 60.0, 30));
    checks.at_least("what the plain mean would hold", plain, 0.99);
    Ok(())
}
