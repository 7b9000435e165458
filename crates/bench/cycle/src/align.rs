//! When a cycle begins in a recording.

use crate::error::CycleError;
use crate::reference::Reference;

/// Steps of the first search, s.
const COARSE_STEP_S: f64 = 1.0;
/// Steps of the second search, s.
const FINE_STEP_S: f64 = 0.05;
/// Reach of the second search, s.
const REACH_S: f64 = 1.5;

/// When the clock of the cycle reads zero, on the clock of the recording, s: where the squared difference between
/// reference and recorded speed, second by second, is least. `speed` has the time of its first sample, the time between
/// samples, and rad/s.
///
/// # Errors
/// [`CycleError::NotCovered`] of a recording that is shorter than the cycle.
pub fn find_start(reference: &Reference, speed: (f64, f64, &[f64])) -> Result<f64, CycleError> {
    let (first_s, sample_time_s, samples) = speed;
    let last_s = first_s + samples.len().saturating_sub(1) as f64 * sample_time_s;
    // A second may be missing at either end.
    let earliest = first_s - reference.start_s - 1.0;
    let latest = last_s - reference.end_s() + 1.0;
    if latest < earliest || samples.is_empty() {
        let (start_s, end_s) = (reference.start_s, reference.end_s());
        return Err(CycleError::NotCovered { first_s, last_s, start_s, end_s });
    }
    let wanted: Vec<(f64, f64)> = reference.seconds().map(|time_s| (time_s, reference.speed_at(time_s))).collect();
    let misfit = |start_s: f64| {
        let squares = wanted.iter().map(|(time_s, speed)| {
            let place = (start_s + time_s - first_s) / sample_time_s;
            (at(samples, place) - speed).powi(2)
        });
        squares.sum::<f64>()
    };
    let best = |from: f64, to: f64, step: f64| {
        let count = ((to - from) / step).ceil().max(0.0) as usize;
        let tried = (0..=count).map(|k| (from + k as f64 * step).min(to));
        tried.map(|start| (misfit(start), start)).fold((f64::INFINITY, from), |a, b| if b.0 < a.0 { b } else { a }).1
    };
    let coarse = best(earliest, latest, COARSE_STEP_S);
    Ok(best((coarse - REACH_S).max(earliest), (coarse + REACH_S).min(latest), FINE_STEP_S))
}

/// A value between samples, straight; beyond them that of the end.
fn at(samples: &[f64], place: f64) -> f64 {
    let place = place.clamp(0.0, (samples.len() - 1) as f64);
    let (low, share) = (place.floor() as usize, place.fract());
    samples[low] + share * (samples[(low + 1).min(samples.len() - 1)] - samples[low])
}
