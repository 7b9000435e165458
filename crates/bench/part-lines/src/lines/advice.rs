//! A speed at which lines that cannot be separated lie apart.

use super::reference::{Reference, folded_hz};

/// Speeds are tried every so many rpm, this share of the present speed away at most.
const STEP_RPM: f64 = 50.0;
const FARTHEST: f64 = 0.4;
/// Lines this far apart are separated, Hz.
const APART_HZ: f64 = 2.0;

/// The speed nearest to the present one, rpm, at which all of these show apart from each other at a sample rate.
pub(super) fn repeat_at_rpm(causes: &[Reference], turns_hz: f64, rate_hz: f64) -> Option<f64> {
    let speed_rpm = 60.0 * turns_hz;
    let steps = (FARTHEST * speed_rpm / STEP_RPM).floor() as i32;
    let nearest = (speed_rpm / STEP_RPM).round();
    let tried = (1..=steps).flat_map(|k| [nearest - f64::from(k), nearest + f64::from(k)]).map(|k| STEP_RPM * k);
    let is_apart = |rpm: &f64| {
        let shown = |cause: &Reference| folded_hz(cause.law.at_hz(rpm / 60.0), rate_hz);
        let parts = |a: &Reference, b: &Reference| (shown(a) - shown(b)).abs() >= APART_HZ || both_stay(a, b);
        (1..causes.len()).all(|i| causes[..i].iter().all(|other| parts(other, &causes[i])))
    };
    let follows = causes.iter().any(|cause| cause.law.order != 0.0);
    tried.into_iter().filter(|_| follows).find(is_apart)
}

/// No speed parts what does not follow it.
fn both_stay(a: &Reference, b: &Reference) -> bool {
    a.law.order == b.law.order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::Cause;
    use crate::lines::reference::PhaseLaw;

    #[test]
    fn exact_firing_and_mains_part_at_another_speed() {
        let firing = PhaseLaw { order: 2.0, frequency_hz: 0.0, tolerance_hz: 0.0 };
        let order = Reference { cause: Cause::Order { order: 2.0, is_firing: true }, law: firing };
        let mains = Reference::fixed(Cause::Mains { multiple: 2, mains_hz: 50.0 }, 100.0);
        let found = repeat_at_rpm(&[order, mains.clone()], 50.0, 500.0).unwrap();
        assert!((found - 2900.0).abs() < 1e-9 || (found - 3100.0).abs() < 1e-9, "{found}");
        assert_eq!(repeat_at_rpm(&[mains.clone(), mains], 50.0, 500.0), None);
    }
}
