//! Characteristics of a step response.

use serde::{Deserialize, Serialize};

/// Rise, settling and overshoot of a response that starts at zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StepCharacteristics {
    /// From the first passage of 10 % of the final value to that of 90 %, in seconds; `None` where 90 % is not reached.
    pub rise_time_s: Option<f64>,
    /// From when on the response stays within 2 % of the final value, in seconds; `None` where it does not by the end.
    pub settling_time_s: Option<f64>,
    /// How far the response goes beyond its final value, in percent of it.
    pub overshoot_percent: f64,
    /// How far the response goes the wrong way, in percent of the final value.
    pub undershoot_percent: f64,
    /// The value furthest in the direction of the final value.
    pub peak: f64,
    /// When the peak is reached, in seconds.
    pub peak_time_s: f64,
}

const LOW: f64 = 0.1;
const HIGH: f64 = 0.9;
const BAND: f64 = 0.02;

impl StepCharacteristics {
    /// The characteristics of `y` at rising times, on straight lines between the points; `None` for a final value of
    /// zero or one that is not finite, for fewer than two points, for series of different length, or for NaN.
    ///
    /// # Example
    /// ```
    /// let lag = lti::TransferFunction::continuous(vec![3.0], vec![0.5, 1.0])?;
    /// let grid = lag.time_grid()?;
    /// let seen = lti::StepCharacteristics::new(&grid.times(), &lag.step_response(&grid)?, lag.dc_gain()).unwrap();
    /// assert!((seen.rise_time_s.unwrap() - 0.5 * 9.0_f64.ln()).abs() < 1e-3);
    /// assert!((seen.settling_time_s.unwrap() - 0.5 * 50.0_f64.ln()).abs() < 1e-3);
    /// assert_eq!(seen.overshoot_percent, 0.0);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    #[must_use]
    pub fn new(time_s: &[f64], y: &[f64], final_value: f64) -> Option<Self> {
        let usable = final_value.is_finite() && final_value != 0.0 && time_s.len() == y.len() && y.len() > 1;
        if !usable || y.iter().chain(time_s).any(|v| v.is_nan()) {
            return None;
        }
        let share: Vec<f64> = y.iter().map(|v| v / final_value).collect();
        let (peak, highest) = share.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let lowest = share.iter().copied().fold(0.0, f64::min);
        let first_above = |level: f64| {
            let k = share.iter().position(|v| *v >= level)?;
            Some(if k == 0 { time_s[0] } else { passage(time_s, &share, k, level) })
        };
        Some(Self {
            rise_time_s: first_above(LOW).zip(first_above(HIGH)).map(|(low, high)| high - low),
            settling_time_s: settled(time_s, &share),
            overshoot_percent: 100.0 * (highest - 1.0).max(0.0),
            undershoot_percent: -100.0 * lowest,
            peak: y[peak],
            peak_time_s: time_s[peak],
        })
    }
}

/// When a line between the points `k − 1` and `k` passes a level.
fn passage(time_s: &[f64], share: &[f64], k: usize, level: f64) -> f64 {
    let part = (level - share[k - 1]) / (share[k] - share[k - 1]);
    time_s[k - 1] + part * (time_s[k] - time_s[k - 1])
}

fn settled(time_s: &[f64], share: &[f64]) -> Option<f64> {
    let Some(last_outside) = share.iter().rposition(|v| (v - 1.0).abs() > BAND) else { return time_s.first().copied() };
    let inside = last_outside + 1;
    let level = 1.0 + BAND.copysign(share[last_outside] - 1.0);
    (inside < share.len()).then(|| passage(time_s, share, inside, level))
}
