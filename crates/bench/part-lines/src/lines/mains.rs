//! One mains for all recordings of a bench.

use super::cause::Cause;
use super::reference::{MAINS_HZ, RIPPLE};
use crate::lines::found::{Line, RecordingLines};

/// Leaves what hangs on the mains that most of the recorded time shows, and takes back what was named by another: a
/// bench hangs on one, and a short part may show a line where another's would be.
#[must_use]
pub fn on_one_mains(mut looks: Vec<RecordingLines>) -> Vec<RecordingLines> {
    let Some(mains_hz) = mains_hz(&looks) else { return looks };
    let signals = looks.iter_mut().flat_map(|look| &mut look.parts).flat_map(|part| &mut part.signals);
    signals.flat_map(|signal| &mut signal.lines).for_each(|line| line.cause = on(&line.cause, mains_hz));
    looks
}

/// The mains, Hz, whose ripple is in signals for the longest; none where no ripple is found.
fn mains_hz(looks: &[RecordingLines]) -> Option<f64> {
    let shown_s = |mains_hz: f64| {
        let is_ripple = |line: &&Line| match line.cause {
            Cause::Mains { multiple, mains_hz: hz } => hz == mains_hz && f64::from(multiple) == RIPPLE,
            _ => false,
        };
        let parts = looks.iter().flat_map(|look| &look.parts);
        let shown = parts.map(|part| {
            let count = part.signals.iter().flat_map(|signal| &signal.lines).filter(is_ripple).count();
            (part.end_s - part.start_s) * count as f64
        });
        shown.sum::<f64>()
    };
    MAINS_HZ.into_iter().filter(|hz| shown_s(*hz) > 0.0).max_by(|a, b| shown_s(*a).total_cmp(&shown_s(*b)))
}

/// A cause on a bench that hangs on a mains.
fn on(cause: &Cause, mains_hz: f64) -> Cause {
    let is_possible = |cause: &Cause| match *cause {
        Cause::Mains { mains_hz: hz, .. } => hz == mains_hz,
        Cause::RippleSideband { ripple_hz, .. } => ripple_hz == RIPPLE * mains_hz,
        _ => true,
    };
    match cause {
        Cause::Undecided { between, repeat_at_rpm } => {
            let mut between: Vec<Cause> = between.iter().filter(|cause| is_possible(cause)).cloned().collect();
            match between.len() {
                0 => Cause::Unknown,
                1 => between.remove(0),
                _ => Cause::Undecided { between, repeat_at_rpm: *repeat_at_rpm },
            }
        }
        one if is_possible(one) => one.clone(),
        _ => Cause::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_what_another_mains_would_make_is_taken_back() {
        let order = Cause::Order { order: 3.0, is_firing: false };
        let [fifty, sixty] = MAINS_HZ.map(|mains_hz| Cause::Mains { multiple: 1, mains_hz });
        let undecided = |between: &[&Cause]| Cause::Undecided {
            between: between.iter().map(|cause| (*cause).clone()).collect(),
            repeat_at_rpm: Some(1150.0),
        };
        assert_eq!(on(&undecided(&[&order, &sixty]), 50.0), order);
        assert_eq!(on(&undecided(&[&order, &fifty, &sixty]), 50.0), undecided(&[&order, &fifty]));
        assert_eq!(on(&sixty, 50.0), Cause::Unknown);
        assert_eq!(on(&fifty, 50.0), fifty);
    }
}
