//! Values on the command line, from text. Errors say what is allowed; clap puts the option and the value before them.

use lightoven::scene::atlas::MAX_RESOLUTION;
use std::time::Duration;

/// Ten times what a frame at 1 Hz could spare.
const MAX_BUDGET_MS: f64 = 10_000.0;
const MAX_BUDGETS: usize = 16;
const MAX_FRAMES: u32 = 1_000_000;
/// Every Vulkan device can draw images this large.
const MAX_SIDE: u32 = 4096;

pub(crate) fn frames(text: &str) -> Result<u32, String> {
    whole(text, 1, MAX_FRAMES)
}

pub(crate) fn warm_up(text: &str) -> Result<u32, String> {
    whole(text, 0, MAX_FRAMES)
}

pub(crate) fn side(text: &str) -> Result<u32, String> {
    whole(text, 1, MAX_SIDE)
}

pub(crate) fn resolution(text: &str) -> Result<u32, String> {
    whole(text, 1, MAX_RESOLUTION)
}

pub(crate) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("allowed is a whole number from 0 to {}", u64::MAX))
}

/// Budgets as they are asked for, in this order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Budgets(pub(crate) Vec<Duration>);

pub(crate) fn budgets(text: &str) -> Result<Budgets, String> {
    let allowed =
        || format!("allowed are 1 to {MAX_BUDGETS} different numbers over 0 and up to {MAX_BUDGET_MS}, as in 2,4,8,16");
    let one = |part: &str| {
        let ms: f64 = part.trim().parse().ok()?;
        let inside = ms > 0.0 && ms <= MAX_BUDGET_MS;
        inside.then(|| Duration::from_secs_f64(ms * 1e-3)).filter(|budget| !budget.is_zero())
    };
    let budgets: Vec<Duration> = text.split(',').map(one).collect::<Option<_>>().ok_or_else(allowed)?;
    let distinct = budgets.iter().enumerate().all(|(index, budget)| !budgets[..index].contains(budget));
    if budgets.len() <= MAX_BUDGETS && distinct { Ok(Budgets(budgets)) } else { Err(allowed()) }
}

fn whole(text: &str, least: u32, most: u32) -> Result<u32, String> {
    let inside = |value: &u32| (least..=most).contains(value);
    text.parse().ok().filter(inside).ok_or_else(|| format!("allowed is a whole number from {least} to {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_a_list() {
        let ms = |text| budgets(text).map(|budgets| budgets.0.iter().map(Duration::as_micros).collect::<Vec<_>>());
        assert_eq!(ms("2,4"), Ok(vec![2000, 4000]));
        assert_eq!(ms(" 0.5 "), Ok(vec![500]));
        for bad in [
            "",
            ",",
            "2,",
            "0",
            "-1",
            "nan",
            "inf",
            "1e9",
            "2;4",
            "2,2",
            "1e-30",
            "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17",
        ] {
            assert!(budgets(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_have_ranges() {
        assert_eq!((frames("1"), warm_up("0"), side("4096"), resolution("16384")), (Ok(1), Ok(0), Ok(4096), Ok(16384)));
        assert!(["0", "-1", "1.5", "1000001", "x"].iter().all(|bad| frames(bad).is_err()));
        assert!(["0", "4097"].iter().all(|bad| side(bad).is_err()));
        assert!(["-1", "18446744073709551616"].iter().all(|bad| seed(bad).is_err()));
    }
}
