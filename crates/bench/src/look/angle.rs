//! The angle of the crankshaft at any instant, from the speed.

use std::f64::consts::TAU;

use signal::Signal;

/// The crank angle over time, the speed straight between its samples.
pub(super) struct Angle<'a> {
    speed: &'a Signal,
    /// At each sample, rad.
    at: Vec<f64>,
}

impl<'a> Angle<'a> {
    pub(super) fn of(speed: &'a Signal) -> Self {
        let mut at = Vec::with_capacity(speed.len());
        let mut angle = 0.0;
        for (k, omega) in speed.samples.iter().enumerate() {
            if k > 0 {
                angle += 0.5 * speed.sample_time_s * (omega + speed.samples[k - 1]);
            }
            at.push(angle);
        }
        Angle { speed, at }
    }

    /// The angle at an instant, rad; beyond the recording as the speed was at its end.
    pub(super) fn at(&self, time_s: f64) -> f64 {
        let last = self.at.len() - 1;
        let place = (time_s - self.speed.start_s) / self.speed.sample_time_s;
        let below = (place.floor().max(0.0) as usize).min(last);
        let after_s = time_s - self.speed.time_s(below);
        let slope = match below < last && after_s >= 0.0 {
            true => (self.speed.samples[below + 1] - self.speed.samples[below]) / self.speed.sample_time_s,
            false => 0.0,
        };
        self.at[below] + after_s * (self.speed.samples[below] + 0.5 * slope * after_s)
    }

    /// Mean speed between two instants, Hz.
    pub(super) fn mean_hz(&self, from_s: f64, until_s: f64) -> f64 {
        (self.at(until_s) - self.at(from_s)) / (TAU * (until_s - from_s))
    }

    /// Twice the standard deviation of the speed between two instants, Hz.
    pub(super) fn spread_hz(&self, from_s: f64, until_s: f64) -> f64 {
        let part = self.speed.slice(from_s, until_s);
        let mean = part.mean().unwrap_or(0.0);
        let variance = part.samples.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / part.len().max(1) as f64;
        2.0 * variance.sqrt() / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_the_angle_of_a_ramp() {
        let samples = (0..101).map(|k| 100.0 + 0.5 * f64::from(k)).collect();
        let speed = Signal::new(2.0, 0.01, samples).unwrap();
        let angle = Angle::of(&speed);
        let exact = |t: f64| 100.0 * t + 25.0 * t * t;
        for t in [0.0, 0.013, 0.5, 0.999] {
            assert!((angle.at(2.0 + t) - exact(t)).abs() < 1e-9, "{t}");
        }
        assert!((angle.at(1.9) + 10.0).abs() < 1e-9);
        assert!((angle.mean_hz(2.0, 3.0) * TAU - 125.0).abs() < 1e-9);
    }
}
