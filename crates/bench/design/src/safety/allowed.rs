//! Amplitudes at which a bench stays within its limits.

use bench_model::model::BenchModel;
use bench_model::prediction::{Prediction, PredictionError, PredictionInputs, predict};

use super::ladder::Ladder;
use super::quantity::{largest, slew, speed_samples};
use crate::safety::ladder::demand_samples;

/// The largest amplitude of each sine that keeps the limits on one bench. The bench is linear short of the torque
/// limit, so what a sine adds to the rest grows with its amplitude; onset and the decay of the sine before are part of
/// it.
pub(crate) fn allowed_nm(
    inputs: &PredictionInputs<'_>,
    ladder: &Ladder<'_>,
    prediction: &Prediction,
) -> Result<Vec<f64>, PredictionError> {
    // What a sine adds is compared with a rest that stands still; its pulses are in the probabilities.
    if prediction.response.limited_share > 0.0 || inputs.firing_seed.is_some() {
        let linear = BenchModel { torque_limit_nm: None, ..inputs.model.clone() };
        let inputs = &PredictionInputs { firing_seed: None, ..*inputs };
        return match predict(&PredictionInputs { model: &linear, ..*inputs }) {
            Ok(free) => Ok(allowed_of(inputs, ladder, &free)),
            Err(PredictionError::Unstable) => Ok(vec![0.0; ladder.frequencies_hz.len()]),
            Err(error) => Err(error),
        };
    }
    Ok(allowed_of(inputs, ladder, prediction))
}

/// The largest f for which (a + f Δa)(b + f Δb) keeps a limit. Both are largest at once at the worst.
fn of_product([a, b]: [f64; 2], [change_a, change_b]: [f64; 2], limit: f64) -> f64 {
    let (room, slope, square) = ((limit - a * b).max(0.0), a * change_b + b * change_a, change_a * change_b);
    2.0 * room / (slope + (slope * slope + 4.0 * square * room).sqrt())
}

pub(super) fn allowed_of(inputs: &PredictionInputs<'_>, ladder: &Ladder<'_>, prediction: &Prediction) -> Vec<f64> {
    let (response, limits) = (&prediction.response, &inputs.limits);
    let hold = demand_samples(prediction.sample_time_s);
    let peaks = [
        (&response.shaft_torque_nm, limits.shaft_torque_nm),
        (&response.torque_demand_nm, limits.torque_nm),
        (&response.dyno_speed_rad_s, limits.speed_rad_s),
        (&response.engine_speed_rad_s, limits.speed_rad_s),
    ];
    let slews = [
        (&response.shaft_torque_nm, 1, limits.shaft_torque_slew_nm_per_s),
        (&response.torque_demand_nm, hold, limits.torque_slew_nm_per_s),
        (&response.dyno_speed_rad_s, speed_samples(prediction.sample_time_s), limits.speed_gradient_rad_s2),
    ];
    let bounds = ladder.bounds(response.shaft_torque_nm.len());
    let allowed = |pair: &[usize]| {
        let (from, to) = (pair[0], pair[1]);
        let change_of = |values: &[f64]| {
            let change: Vec<f64> = values[from..to].iter().map(|value| value - values[0]).collect();
            largest(&change)
        };
        let of_peaks =
            peaks.iter().filter_map(|(values, limit)| Some(((*limit)? - values[0].abs()).max(0.0) / change_of(values)));
        let of_slews = slews.iter().filter_map(|(values, apart, limit)| {
            let rate = slew(&values[from.saturating_sub(*apart)..to], *apart, prediction.sample_time_s);
            Some((*limit)? / rate)
        });
        // A limit of nothing over a change of nothing says nothing.
        let (torque, speed) = (&response.torque_demand_nm, &response.dyno_speed_rad_s);
        let of_power = limits.power_w.map(|limit| {
            of_product([torque, speed].map(|values| values[0].abs()), [torque, speed].map(|of| change_of(of)), limit)
        });
        let factor =
            of_peaks.chain(of_slews).chain(of_power).filter(|factor| !factor.is_nan()).fold(f64::INFINITY, f64::min);
        factor * ladder.amplitude_nm
    };
    bounds.windows(2).map(allowed).collect()
}
