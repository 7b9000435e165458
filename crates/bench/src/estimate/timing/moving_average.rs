//! The moving average inside the automation system's own shaft torque.

use signal::derivative::central_difference;
use signal::filter::moving_average;
use signal::resample::{Interpolation, interpolate_at};
use signal::{Signal, SignalError};

/// Longest average tried, samples of N_d.
const LONGEST: usize = 64;
/// Longest further delay tried, samples of N_d.
const LATEST: usize = 4;
/// Samples of N_d left out at either end.
const MARGIN: usize = LONGEST + LATEST + 2;
/// The rule must leave less than this part of the acceleration torque's spread.
const EXPLAINED: f64 = 0.3;

/// The rule that reproduces T_d,shaft,calc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MovingAverage {
    /// N, samples of N_d.
    pub(super) length: usize,
    /// Delay of the averaged acceleration, s.
    pub(super) delay_s: f64,
    /// Standard deviation of what the rule does not reproduce, Nm.
    pub(super) residual_nm: f64,
}

/// How the system differentiates the speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Difference {
    Central,
    Backward,
}

/// Finds N, the differentiation and a whole further delay for which T_d,shaft,calc = T_d,calc + J_d·mean_N(dω_d/dt).
///
/// `None` where no rule leaves less than three tenths of the spread of T_d,shaft,calc − T_d,calc.
///
/// # Errors
/// Signals that are too short or do not overlap.
pub(super) fn detect(
    speed: &Signal,
    torque: &Signal,
    shaft: &Signal,
    inertia_kg_m2: f64,
) -> Result<Option<MovingAverage>, SignalError> {
    let times = common_times(speed, torque, shaft);
    let torque_there = interpolate_at(torque, &times, Interpolation::BandLimited)?;
    let shaft_there = interpolate_at(shaft, &times, Interpolation::Linear)?;
    let target: Vec<f64> = shaft_there.iter().zip(&torque_there).map(|(s, t)| s - t).collect();
    let places: Vec<usize> =
        times.iter().map(|t| ((t - speed.start_s) / speed.sample_time_s).round().max(0.0) as usize).collect();
    let mut best: Option<MovingAverage> = None;
    for rule in [Difference::Central, Difference::Backward] {
        let acceleration = differentiate(speed, rule)?;
        for length in 1..=LONGEST {
            let mean = moving_average(&acceleration, length)?;
            for late in 0..=LATEST {
                let residual_nm = spread(target.iter().zip(&places).map(|(y, p)| y - inertia_kg_m2 * mean[p - late]));
                if best.is_none_or(|b| residual_nm < b.residual_nm) {
                    let half = if rule == Difference::Backward { 0.5 } else { 0.0 };
                    let samples = (length as f64 - 1.0) / 2.0 + late as f64 + half;
                    best = Some(MovingAverage { length, delay_s: samples * speed.sample_time_s, residual_nm });
                }
            }
        }
    }
    let whole = spread(target.iter().copied());
    Ok(best.filter(|b| b.residual_nm < EXPLAINED * whole))
}

/// The instants of the shaft torque at which everything was recorded, with a margin of N_d.
fn common_times(speed: &Signal, torque: &Signal, shaft: &Signal) -> Vec<f64> {
    let margin = MARGIN as f64 * speed.sample_time_s;
    let from = (speed.start_s + margin).max(torque.start_s);
    let to = (speed.end_s() - margin).min(torque.end_s());
    (0..shaft.len()).map(|i| shaft.time_s(i)).filter(|t| *t >= from && *t <= to).collect()
}

fn differentiate(speed: &Signal, rule: Difference) -> Result<Vec<f64>, SignalError> {
    match rule {
        Difference::Central => central_difference(&speed.samples, speed.sample_time_s),
        Difference::Backward => {
            let steps = speed.samples.windows(2).map(|w| (w[1] - w[0]) / speed.sample_time_s);
            Ok(std::iter::once(0.0).chain(steps).collect())
        }
    }
}

/// Standard deviation in one pass.
fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
    for v in values {
        n += 1.0;
        let step = v - mean;
        mean += step / n;
        squares += step * (v - mean);
    }
    if n > 0.0 { (squares / n).sqrt() } else { f64::INFINITY }
}
