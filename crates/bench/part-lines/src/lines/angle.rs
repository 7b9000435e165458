//! The angle of the crankshaft at any instant, from the speed.

use std::f64::consts::TAU;

use signal::Signal;

/// Over so long, s, a speed is looked at for its orders.
const MOMENT_S: f64 = 0.25;
/// Turns of a working cycle of four strokes.
const CYCLE_TURNS: f64 = 2.0;

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

    /// The share of the time between two instants at which a multiple of an order is within a reach of a frequency,
    /// which may itself depend on how fast it turns.
    pub(super) fn share_at(
        &self,
        [from_s, until_s]: [f64; 2],
        order: f64,
        frequency_hz: impl Fn(f64) -> f64,
        reach_hz: f64,
    ) -> f64 {
        let count = ((until_s - from_s) / MOMENT_S).floor().max(1.0) as usize;
        let moment_s = (until_s - from_s) / count as f64;
        let shows = |k: &usize| {
            let start_s = from_s + *k as f64 * moment_s;
            let turns_hz = self.mean_hz(start_s, start_s + moment_s);
            let (frequency_hz, step_hz) = (frequency_hz(turns_hz), order * turns_hz);
            let nearest = (frequency_hz / step_hz).round().max(1.0);
            (frequency_hz - nearest * step_hz).abs() < reach_hz
        };
        (0..count).filter(shows).count() as f64 / count as f64
    }

    /// Twice the standard deviation of the speed between two instants, Hz: of its means over a working cycle, whose
    /// firings move the speed without spreading an order.
    pub(super) fn spread_hz(&self, from_s: f64, until_s: f64) -> f64 {
        let turns = (self.at(until_s) - self.at(from_s)) / TAU;
        let count = (turns / CYCLE_TURNS).floor().max(1.0);
        let cycle_s = (until_s - from_s) / count;
        let means: Vec<f64> = (0..count as usize)
            .map(|k| from_s + k as f64 * cycle_s)
            .map(|start_s| self.mean_hz(start_s, start_s + cycle_s))
            .collect();
        let mean = means.iter().sum::<f64>() / count;
        2.0 * (means.iter().map(|hz| (hz - mean).powi(2)).sum::<f64>() / count).sqrt()
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
        // In quarters of a second order 2 is at 33.8, 37.8, 41.8 and 45.8 Hz.
        assert_eq!(angle.share_at([2.0, 3.0], 2.0, |_| 40.0, 2.5), 0.5);
    }
}
