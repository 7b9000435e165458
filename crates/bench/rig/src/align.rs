//! Common time of several signals: windows, cuts, and parts for estimation and validation.

use signal::Signal;

use crate::experiment::Experiment;
use crate::role::Role;

/// Tolerance when comparing an instant with a window's edge, in sample times.
const EDGE_SAMPLES: f64 = 1e-6;

/// Time of a signal's first and last sample, s.
pub fn window_of(signal: &Signal) -> (f64, f64) {
    (signal.start_s, signal.end_s())
}

/// The time in which every one of `roles` was recorded, s: `None` if one is missing or they share no time.
pub fn common_window(experiment: &Experiment, roles: &[Role]) -> Option<(f64, f64)> {
    let mut window = (f64::NEG_INFINITY, f64::INFINITY);
    for role in roles {
        let (start_s, end_s) = window_of(experiment.signal(*role)?);
        window = (window.0.max(start_s), window.1.min(end_s));
    }
    (window.0 < window.1 && window.0.is_finite()).then_some(window)
}

/// The samples of a signal from `start_s` to `end_s`, both included, on the same clock; empty where none fits.
///
/// # Example
///
/// ```
/// let signal = signal::Signal::new(2.5, 0.5, vec![1.0, 2.0, 3.0, 4.0])?;
/// let part = rig::align::cut(&signal, 2.9, 3.5);
/// assert_eq!((part.start_s, part.samples), (3.0, vec![2.0, 3.0]));
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn cut(signal: &Signal, start_s: f64, end_s: f64) -> Signal {
    signal.slice(start_s, end_s + 2.0 * EDGE_SAMPLES * signal.sample_time_s)
}

/// Two consecutive parts of a window, s: the first holds `fraction` (0…1) of it and serves the estimate, the rest its
/// validation.
pub fn split_window((start_s, end_s): (f64, f64), fraction: f64) -> ((f64, f64), (f64, f64)) {
    let middle_s = start_s + fraction.clamp(0.0, 1.0) * (end_s - start_s);
    ((start_s, middle_s), (middle_s, end_s))
}

impl Experiment {
    /// The experiment's signals inside a window, those with fewer than two samples there left out.
    pub fn within(&self, (start_s, end_s): (f64, f64)) -> Experiment {
        let signals = self.signals.iter().map(|(role, signal)| (*role, cut(signal, start_s, end_s)));
        Experiment {
            file: self.file.clone(),
            label: self.label.clone(),
            signals: signals.filter(|(_, signal)| signal.len() >= 2).collect(),
        }
    }
}
