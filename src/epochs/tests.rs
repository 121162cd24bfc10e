use super::*;

const PILOT: Epoch = Epoch::Bounce(Stage::Pilot);
const LAST: Epoch = Epoch::Bounce(Stage::Last);

/// Runs the bounces of a closed furnace of this albedo; returns their number and the error that is left.
fn furnace(albedo: f64) -> (u32, f64) {
    run(albedo, |radiance| radiance)
}

fn run(albedo: f64, rounded: fn(f64) -> f64) -> (u32, f64) {
    let mut epochs = Epochs::new(Bounces::Auto, Stage::Last, albedo, 1.0);
    let mut radiance = 1.0;
    while epochs.next() == LAST {
        radiance = rounded(1.0 + albedo * radiance);
        epochs.bounced(radiance).expect("converges");
    }
    (epochs.bounces_done(), 1.0 - radiance * (1.0 - albedo))
}

#[test]
fn a_furnace_converges_to_the_tolerance() {
    for albedo in [0.1, 0.5, 0.9, 0.99] {
        let (bounces, error) = furnace(albedo);
        assert!(error <= Bounces::TOLERANCE * 1.01, "albedo {albedo}: {error} left after {bounces}");
        let expected = Bounces::TOLERANCE.ln() / albedo.ln();
        assert!(f64::from(bounces) <= expected + 3.0, "albedo {albedo}: {bounces} bounces, {expected} are enough");
    }
}

/// The device's sums are of 32-bit floats: near the end a change is a few of their steps.
#[test]
fn rounding_does_not_look_like_convergence() {
    for albedo in [0.95, 0.98, 0.99, 0.998, 0.999] {
        let (bounces, error) = run(albedo, |radiance| f64::from(radiance as f32));
        assert!(error <= 2.0 * Bounces::TOLERANCE, "albedo {albedo}: {error} left after {bounces}");
    }
}

/// A limit that automatic bounces never reach refuses nobody who knows what for.
#[test]
fn no_sensible_limit_is_refused() {
    let largest = f64::from(crate::scene::MAX_ALBEDO);
    for rounded in [|radiance| radiance, |radiance| f64::from(radiance as f32)] {
        let (bounces, _) = run(largest, rounded);
        assert!((8000..Bounces::MAX_LIMIT).contains(&bounces), "{bounces} bounces");
    }
    assert!(largest.powi(Bounces::MAX_LIMIT as i32) < 2.0 * f64::from(f32::EPSILON));
    for fine in [Bounces::Auto, Bounces::Limit(0), Bounces::Limit(Bounces::MAX_LIMIT)] {
        assert!(fine.check().is_ok(), "{fine:?}");
    }
    for endless in [Bounces::MAX_LIMIT + 1, 4_000_000_000, u32::MAX] {
        let refused = Bounces::Limit(endless).check().expect_err("must be refused").to_string();
        assert!(refused.contains(&endless.to_string()) && refused.contains("0 to 16384"), "{refused}");
    }
}

#[test]
fn kept_epochs_double_and_limits_are_kept() {
    let mut black = Epochs::new(Bounces::Auto, Stage::Pilot, 0.0, 1.0);
    let quanta: Vec<_> = (0..5).map(|_| black.next()).collect();
    assert_eq!(quanta, [1, 1, 2, 4, 8].map(|quanta| Epoch::Keep { quanta }));
    for (limit, stages) in
        [(1, vec![LAST]), (2, vec![PILOT, LAST, LAST]), (4, vec![PILOT, PILOT, LAST, LAST, LAST, LAST])]
    {
        let mut limited = Epochs::new(Bounces::Limit(limit), Stage::Pilot, 0.5, 1.0);
        for (bounce, stage) in stages.into_iter().enumerate() {
            assert_eq!(limited.next(), stage, "bounce {bounce} of {limit}");
            limited.bounced(1.5 - 0.1_f64.powi(bounce as i32 + 1)).expect("converges");
        }
        assert_eq!(limited.next(), Epoch::Keep { quanta: 1 });
        assert!(!limited.updates_source());
    }
}

/// The second stage begins where the first has ended; other rays find a little more or less light, by which the change
/// may be small by chance.
#[test]
fn the_last_stage_converges_from_the_pilots_source() {
    let albedo = 0.8;
    for emitted in [0.9, 1.0, 1.02] {
        let mut epochs = Epochs::new(Bounces::Auto, Stage::Pilot, albedo, 1.0);
        let (mut radiance, mut pilots) = (1.0, 0);
        while let Epoch::Bounce(stage) = epochs.next() {
            assert_eq!(epochs.rays_are_new(), pilots == epochs.bounces_done() && (pilots == 0 || stage == Stage::Last));
            pilots += u32::from(stage == Stage::Pilot);
            let shines = if stage == Stage::Pilot { 1.0 } else { emitted };
            radiance = shines + albedo * radiance;
            epochs.bounced(radiance).expect("converges");
        }
        let wanted = emitted / (1.0 - albedo);
        assert!((radiance / wanted - 1.0).abs() < 2.0 * Bounces::TOLERANCE, "{radiance} is not {wanted}");
        assert!((2..epochs.bounces_done()).contains(&pilots), "{pilots} of {}", epochs.bounces_done());
    }
}

#[test]
fn light_beyond_all_bounces_grows() {
    let mut epochs = Epochs::new(Bounces::Auto, Stage::Last, 0.5, 0.1);
    // Light from lamps that are no surfaces comes with the first bounce.
    for radiance in [2.0, 3.0, 2.5, 15.0] {
        epochs.bounced(radiance).expect("converges");
        assert!(!epochs.grows(), "{radiance}");
    }
    epochs.bounced(17.0).expect("is not yet an error");
    assert!(epochs.grows());
    epochs.start_over();
    assert!(!epochs.grows());
}

#[test]
fn a_scene_without_light_stops_bouncing() {
    let mut epochs = Epochs::new(Bounces::Auto, Stage::Pilot, 0.5, 0.0);
    for stage in [PILOT, PILOT, LAST, LAST] {
        assert_eq!(epochs.next(), stage);
        epochs.bounced(0.0).expect("converges");
    }
    assert!(matches!(epochs.next(), Epoch::Keep { .. }));
}
