use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const THRESHOLD: f64 = 0.1;
const LATENCY_S: f64 = 0.5;

fn average(latency_s: f64) -> Average {
    Average::new(Duration::from_secs_f64(latency_s), THRESHOLD).expect("valid")
}

fn endless() -> Average {
    Average::new(Duration::MAX, THRESHOLD).expect("valid")
}

/// What the shader does with one visit in which every quantum has this value.
fn merge(light: &mut f64, kept: f64, quanta: u32, value: f64) {
    for k in 1..=quanta {
        *light += (value - *light) / (kept + f64::from(k));
    }
}

/// A history that has been still for so many quanta.
fn still(quanta: u32) -> History {
    let mut history = History::default();
    history.visit(&average(LATENCY_S), 0.01, quanta, World::Still);
    history
}

/// Share of the old light after these steps, if all light goes out before the first.
fn share_left(mut history: History, average: &Average, quanta: u32, steps_s: impl IntoIterator<Item = f64>) -> f64 {
    let mut light = 1.0;
    for dt_s in steps_s {
        let kept = history.visit(average, dt_s, quanta, World::Changing);
        merge(&mut light, kept, quanta, 0.0);
    }
    light
}

fn close(found: f64, wanted: f64, relative: f64) -> bool {
    (found - wanted).abs() <= relative * wanted.abs()
}

#[test]
fn the_slide_at_60_frames_a_second() {
    let average = average(LATENCY_S);
    assert!(close(average.decay(1.0 / 60.0), 0.92612, 1e-5));
    assert!(close(average.weight(1.0 / 60.0), 0.07388, 1e-4));
}

/// Both wrong readings of the slide's formula leave something else than the threshold after the latency.
#[test]
fn other_readings_of_the_slide_are_wrong() {
    let leaves_threshold = |decay: f64| close(decay.powi(30), THRESHOLD, 1e-5);
    assert!(leaves_threshold(average(LATENCY_S).decay(1.0 / 60.0)));
    let divided_late = (THRESHOLD.ln() / LATENCY_S * 60.0).exp();
    assert!(divided_late < 1e-119 && !leaves_threshold(divided_late));
    let multiplied_outside = (THRESHOLD.ln() / LATENCY_S).exp() * 60.0;
    assert!(!leaves_threshold(multiplied_outside));
    // At this threshold it is .6; at a milder one it is no share at all.
    assert!((0.5_f64.ln() / LATENCY_S).exp() * 60.0 > 1.0);
}

#[test]
fn a_small_weight_is_precise() {
    let exponent = THRESHOLD.ln() / 60.0 / 1000.0;
    let series = -exponent * (1.0 + exponent / 2.0 * (1.0 + exponent / 3.0));
    assert!(close(average(60.0).weight(1e-3), series, 1e-12));
    let in_f32 = f64::from(1.0 - (exponent as f32).exp());
    assert!(!close(in_f32, series, 1e-4), "f32 would do: {in_f32}");
}

#[test]
fn edges_of_the_input() {
    let (finite, none, endless) = (average(LATENCY_S), average(0.0), endless());
    for (average, dt_s, decay) in [
        (&finite, 0.0, 1.0),
        (&finite, -1.0, 1.0),
        (&finite, f64::NAN, 1.0),
        (&finite, f64::NEG_INFINITY, 1.0),
        (&finite, 1e300, 0.0),
        (&finite, f64::INFINITY, 0.0),
        (&none, 0.0, 0.0),
        (&none, 1e-9, 0.0),
        (&none, f64::NAN, 0.0),
        (&endless, 0.0, 1.0),
        (&endless, 1e300, 1.0),
        (&endless, f64::INFINITY, 1.0),
    ] {
        assert_eq!(average.decay(dt_s), decay, "{average:?} after {dt_s}");
        assert_eq!(average.weight(dt_s), 1.0 - decay, "{average:?} after {dt_s}");
    }
}

#[test]
fn a_threshold_outside_is_refused_by_name() {
    for threshold in [0.0, 1.0, -0.1, 2.0, f64::NAN, f64::INFINITY] {
        let error = Average::new(Duration::from_secs(1), threshold).expect_err("refused");
        assert!(error.context().contains("decay threshold"), "{error}");
        assert!(error.context().contains(&threshold.to_string()), "{error}");
    }
}

#[test]
fn a_long_still_history_leaves_within_the_latency() {
    let average = average(LATENCY_S);
    for rate in [1.0, 2.0, 7.0, 30.0, 60.0, 144.0, 1000.0, 10_000.0] {
        let frames = (LATENCY_S * rate).ceil() as usize;
        for quanta in [1, 16] {
            let left = share_left(still(1_000_000), &average, quanta, vec![1.0 / rate; frames]);
            assert!(left <= THRESHOLD * (1.0 + 1e-5), "{rate} frames a second: {left}");
        }
    }
    // What a history of 1e6 quanta would hold without the cut.
    let plain = share_left(still(1_000_000), &endless(), 1, vec![1.0 / 60.0; 30]);
    assert!(plain > 0.99);
}

#[test]
fn a_still_world_gives_the_mean() {
    let mut history = History::default();
    let (mut light, mut sum, mut count) = (0.0, 0.0, 0.0);
    for visit in 0..1000_u32 {
        let (quanta, value) = (visit % 5 + 1, f64::from(visit * visit % 17));
        let kept = history.visit(&average(LATENCY_S), 0.01, quanta, World::Still);
        assert_eq!(kept, count);
        merge(&mut light, kept, quanta, value);
        (sum, count) = (sum + value * f64::from(quanta), count + f64::from(quanta));
    }
    assert_eq!(history.quanta(), count);
    assert!(close(light, sum / count, 1e-12));
}

#[test]
fn splitting_a_still_visit_changes_nothing() {
    let (mut whole, mut split) = (still(3), still(3));
    let kept = whole.visit(&average(LATENCY_S), 0.1, 4, World::Still);
    for k in 0..4 {
        let elapsed_s = if k == 0 { 0.1 } else { 0.0 };
        assert_eq!(split.visit(&average(LATENCY_S), elapsed_s, 1, World::Still), kept + f64::from(k));
    }
    assert_eq!(whole, split);
}

/// Day turns to night: what is left is what was said, and goes on leaving.
#[test]
fn strong_old_light_leaves_in_the_end() {
    let average = average(LATENCY_S);
    let (mut history, mut light) = (still(1000), 1.0);
    let (dt_s, mut shares) = (1.0 / 60.0, Vec::new());
    for frame in 1..=60 * 40 {
        let age_s = f64::from(frame) * dt_s;
        let kept = history.visit(&average.after(age_s), dt_s, 1, World::Changing);
        merge(&mut light, kept, 1, 0.0);
        if [30, 60, 480, 1080, 2400].contains(&frame) {
            shares.push(light);
        }
    }
    // Of a latency, two, eight seconds, eighteen, forty: th, th^2, then as age^-4.6.
    for (share, expected) in shares.iter().zip([0.1, 0.01, 7e-7, 1.7e-8, 4.3e-10]) {
        assert!((share / expected - 1.0).abs() < 0.15, "{shares:?}");
    }
    let age_s = average.age_of(1e-9);
    assert!(age_s > 18.0 && age_s < 40.0, "{age_s}");
    assert_eq!(Average::new(Duration::MAX, 0.5).expect("is allowed").age_of(1e-9), 0.0);
}

/// Two in five samples count while the memory grows.
#[test]
fn noise_falls_while_old_light_leaves() {
    let average = average(LATENCY_S);
    let (mut history, mut squares) = (History::default(), 0.0);
    for frame in 1..=60 * 30 {
        let kept = history.visit(&average.after(f64::from(frame) / 60.0), 1.0 / 60.0, 1, World::Changing);
        let weight = 1.0 / (kept + 1.0);
        squares = squares * (1.0 - weight) * (1.0 - weight) + weight * weight;
    }
    let effective = 1.0 / squares / (60.0 * 30.0);
    assert!((effective - 0.39).abs() < 0.03, "{effective}");
}

/// With constant steps: `N <- d * N + s`, also where still samples came before.
#[test]
fn constant_steps_follow_the_recurrence() {
    let (average, quanta) = (average(LATENCY_S), 3.0);
    let (decay, weight) = (average.decay(0.02), average.weight(0.02));
    for before in [0, 5, 1000] {
        let mut history = if before == 0 { History::default() } else { still(before) };
        let mut wanted = f64::from(before).min(quanta / weight);
        for _ in 0..200 {
            let kept = history.visit(&average, 0.02, 3, World::Changing);
            assert!(close(kept, decay * wanted, 1e-9), "{kept} instead of {}", decay * wanted);
            wanted = decay * wanted + quanta;
        }
        assert!(close(history.quanta(), quanta / weight, 1e-6));
    }
}

#[test]
fn the_steady_variance_is_that_of_the_formula() {
    let (average, quanta) = (average(LATENCY_S), 4);
    let mut history = History::default();
    // Sum of the squares of the weights of all quanta, which is the variance for quanta of variance 1.
    let mut variance = 0.0;
    for _ in 0..2000 {
        let kept = history.visit(&average, 1.0 / 60.0, quanta, World::Changing);
        for k in 1..=quanta {
            let weight = 1.0 / (kept + f64::from(k));
            variance = (1.0 - weight).powi(2) * variance + weight * weight;
        }
    }
    let weight = average.weight(1.0 / 60.0);
    assert!(close(variance, weight / (2.0 - weight) / f64::from(quanta), 1e-9));
}

/// A short step gives the few new samples little weight, but makes no history out of nothing.
#[test]
fn a_history_is_not_longer_than_what_was_given() {
    let mut history = History::default();
    for dt_s in [1.0, 1e-9, 1e-12, 0.0, 1e-3, 1e-300, 5e-324] {
        assert!(history.visit(&average(LATENCY_S), dt_s, 1, World::Changing).is_finite());
    }
    assert!(history.quanta() <= 7.0);
}

/// Frames until a furnace's light has fallen to the threshold, if bounces read the last frame or the average.
fn frames_to_settle(albedo: f64, reads_average: bool) -> u32 {
    let average = average(LATENCY_S);
    let (mut source, mut published) = (1.0, 1.0);
    let mut history = still(1_000_000);
    for frame in 0.. {
        if published <= THRESHOLD {
            return frame;
        }
        let radiance = albedo * if reads_average { published } else { source };
        let kept = history.visit(&average, 1.0 / 60.0, 1, World::Changing);
        merge(&mut published, kept, 1, radiance);
        source = radiance;
    }
    unreachable!("the light falls in every frame")
}

#[test]
fn bounces_settle_fast_where_they_read_the_last_frame() {
    for (albedo, last_frame, averaged) in [(0.8, 35, 155), (0.9, 44, 311)] {
        assert!(frames_to_settle(albedo, false).abs_diff(last_frame) <= 1, "albedo {albedo}");
        assert!(frames_to_settle(albedo, true).abs_diff(averaged) <= 1, "albedo {albedo}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2), ..ProptestConfig::default() })]

    #[test]
    fn any_steps_leave_the_threshold_at_the_latency(
        steps in prop::collection::vec(1e-4..1.0, 1..300), quanta in 1_u32..65, latency_s in 0.01..100.0,
    ) {
        let scale = latency_s / steps.iter().sum::<f64>();
        let history = still(u32::MAX);
        let left = share_left(history, &average(latency_s), quanta, steps.iter().map(|step| step * scale));
        prop_assert!(close(left, THRESHOLD, 1e-5), "{}", left);
    }

    #[test]
    fn no_start_is_dark(
        steps in prop::collection::vec(0.0..2.0, 1..50), quanta in 1_u32..65, changing in any::<bool>(),
    ) {
        let world = if changing { World::Changing } else { World::Still };
        let (mut history, mut light) = (History::default(), 0.0);
        for dt_s in steps {
            let kept = history.visit(&average(LATENCY_S), dt_s, quanta, world);
            merge(&mut light, kept, quanta, 3.0);
            prop_assert!(close(light, 3.0, 1e-12));
        }
    }

    #[test]
    fn all_is_finite(
        visits in prop::collection::vec((any::<f64>(), any::<u32>(), any::<bool>()), 1..50),
        latency in any::<Duration>(), threshold in 1e-300..1.0,
    ) {
        let average = Average::new(latency, threshold).expect("valid");
        let mut history = History::default();
        for (dt_s, quanta, changing) in visits {
            let world = if changing { World::Changing } else { World::Still };
            let kept = history.visit(&average, dt_s, quanta, world);
            prop_assert!(kept.is_finite() && kept >= 0.0);
            prop_assert!(history.quanta().is_finite() && history.quanta() >= 1.0);
            prop_assert!((0.0..=1.0).contains(&average.weight(dt_s)));
            prop_assert!((0.0..=1.0).contains(&average.decay(dt_s)));
        }
    }

    /// Whatever a clock says, an average lies among what was averaged, and its history is no longer than what it was given.
    #[test]
    fn no_clock_makes_an_average_leave_its_samples(
        visits in prop::collection::vec((time(), time(), 1_u32..65, any::<bool>(), 0.0_f64..100.0), 1..80),
        latency in prop_oneof![Just(Duration::ZERO), Just(Duration::from_nanos(1)), Just(Duration::MAX), any::<Duration>()],
        threshold in prop_oneof![Just(f64::MIN_POSITIVE), Just(1.0 - f64::EPSILON), 0.001..0.999],
    ) {
        let average = Average::new(latency, threshold).expect("valid");
        let (mut history, mut light, mut given) = (History::default(), 0.0, 0.0);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for (dt_s, age_s, quanta, changing, value) in visits {
            let world = if changing { World::Changing } else { World::Still };
            let now = average.after(age_s);
            prop_assert!((0.0..=1.0).contains(&now.weight(dt_s)) && (0.0..=1.0).contains(&now.decay(dt_s)));
            prop_assert!(now.weight(dt_s) <= average.weight(dt_s), "an older change makes the memory shorter");
            let kept = history.visit(&now, dt_s, quanta, world);
            (least, most, given) = (least.min(value), most.max(value), given + f64::from(quanta));
            merge(&mut light, kept, quanta, value);
            prop_assert!(kept.is_finite() && kept >= 0.0);
            prop_assert!((1.0..=given).contains(&history.quanta()), "{} of {given}", history.quanta());
            let slack = 1e-12 * most;
            prop_assert!((least - slack..=most + slack).contains(&light), "{light} of {least} to {most}");
        }
    }
}

/// Seconds that clocks say, true and broken.
fn time() -> impl Strategy<Value = f64> {
    let broken = [0.0, -0.0, -1.0, 5e-324, 1e-9, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    prop_oneof![
        2 => any::<u64>().prop_map(f64::from_bits),
        2 => prop::sample::select(broken.to_vec()),
        4 => (-6.0_f64..4.0).prop_map(|exponent| 10_f64.powf(exponent)),
    ]
}
