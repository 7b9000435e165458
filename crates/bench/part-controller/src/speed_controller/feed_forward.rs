//! The feed-forward, from a recording in which N_d* moves, beside a controller that is known.
//!
//! K_p, K_i and τ are those of the recording with constant N_d*: beside a moving N_d* a wrong feed-forward would bend
//! them. Their uncertainty is part of that of k and k_a.

use faer::Mat;
use ident::covariance::at_least_white;
use ident::{Minimum, ResidualModel, least_squares};
use rig::align::split_window;
use rig::estimation::{ESTIMATION_SHARE, EstimateError, ReadOut, transformed};
use rig::results::{DelayPlace, DemandLags, Estimate, FeedForward, Quantity};
use rig::{Experiment, Role};
use signal::Signal;

use super::data::{Data, LEAST_SPREAD, ident_error, spread};
use super::demand_lags::{Candidate, Reading, is_same, scan};
use super::fit::{BATCHES, SpeedControllerFit, run, validate};
use super::inverse;

/// Parameters estimated here.
const OWN: [usize; 5] = [inverse::FIRST_ERROR, inverse::COSINE, inverse::SINE, inverse::K, inverse::K_A];
/// Parameters of the controller that are known.
const KNOWN: [usize; 3] = [inverse::P, inverse::Q, inverse::LEAD];
/// Excess χ² below which lags cannot be excluded: chance exceeds it once in 10⁶.
const DECISIVE: f64 = 24.0;
/// Gains of two recordings this many standard errors of their difference apart contradict each other.
pub const GAINS_APART_STANDARD_ERRORS: f64 = 8.0;
/// The controller's gains are only contradicted where they are apart by this share, too.
const CONTRADICTED_SHARE: f64 = 0.05;

/// Estimates the feed-forward from a recording in which N_d* moves (Levels_N_NT, Ramp_N_NT), and where the controller's
/// delay acts on N_d*.
///
/// `judge` is another such recording, on which the estimate is judged; without one the last part of the first serves.
///
/// # Errors
/// A missing signal, a constant N_d*, too short a stretch below the torque limit, data that do not determine the
/// parameters, or gains of the controller that contradict those of `controller`.
pub fn estimate_feed_forward(
    experiment: &Experiment,
    judge: Option<&Experiment>,
    controller: &SpeedControllerFit,
    torque_limit_nm: Option<f64>,
) -> Result<FeedForward, EstimateError> {
    MovingDemand::of(experiment, judge, controller, torque_limit_nm)?.feed_forward
}

/// Feed-forward and gains of a recording in which N_d* moves, beside a controller that is known.
#[derive(Debug)]
pub(super) struct MovingDemand {
    /// K_p and K_i as they come out here.
    pub(super) gains: Estimate,
    pub(super) feed_forward: Result<FeedForward, EstimateError>,
}

impl MovingDemand {
    pub(super) fn of(
        experiment: &Experiment,
        judge: Option<&Experiment>,
        controller: &SpeedControllerFit,
        torque_limit_nm: Option<f64>,
    ) -> Result<Self, EstimateError> {
        let data = Data::of(experiment, torque_limit_nm)?;
        let (known, unseen) = match judge.map(|other| Data::of(other, torque_limit_nm)) {
            Some(Ok(other)) => (data, other),
            Some(Err(_)) | None => {
                let (estimation, validation) = split_window(data.window(), ESTIMATION_SHARE);
                (data.part(estimation), data.part(validation))
            }
        };
        check_moves(experiment, &known.reference)?;
        let delay = controller.delay_samples();
        let candidates = scan(&known, &controller.theta, delay).map_err(|e| ident_error(&known, e))?;
        let best = candidates.first().map_or(controller.lags, |best| best.lags);
        let lags = Reading::of(best, delay).first().map_or(best, |reading| reading.lags);
        let smooth = known.smoothed()?;
        let fit = fit_with_lags(&smooth, lags, controller, &OWN)?;
        let gains = gains(&smooth, lags, controller)?;
        let feed_forward = check_gains(&smooth, &gains, controller)
            .and_then(|()| Found { data: &smooth, lags, fit, controller }.feed_forward(&candidates, &unseen));
        Ok(MovingDemand { gains, feed_forward })
    }
}

/// Each place once, in the order of the readings.
fn places(readings: &[Reading]) -> Vec<DelayPlace> {
    let mut places = Vec::new();
    for reading in readings {
        if !places.contains(&reading.place) {
            places.push(reading.place);
        }
    }
    places
}

pub(super) fn check_moves(experiment: &Experiment, reference: &Signal) -> Result<(), EstimateError> {
    let standard_deviation = spread(reference);
    if standard_deviation > LEAST_SPREAD {
        return Ok(());
    }
    Err(EstimateError::WeakExcitation {
        file: experiment.file.clone(),
        role: Role::DynoSpeedDemand,
        standard_deviation,
    })
}

fn fit_with_lags(
    data: &Data,
    lags: DemandLags,
    controller: &SpeedControllerFit,
    free: &[usize],
) -> Result<Minimum, EstimateError> {
    let mut start = controller.theta.clone();
    start[inverse::FIRST_ERROR] = data.speed.samples[0] - data.reference.samples[0];
    (start[inverse::COSINE], start[inverse::SINE]) = (0.0, 0.0);
    run(data, lags, &start, |j| free.contains(&j))
}

/// K_p and K_i as they come out here.
fn gains(data: &Data, lags: DemandLags, controller: &SpeedControllerFit) -> Result<Estimate, EstimateError> {
    let free = [&OWN[..], &KNOWN[..2]].concat();
    let fit = fit_with_lags(data, lags, controller, &free)?;
    let (covariance, _) = at_least_white(&fit, BATCHES).map_err(|e| ident_error(data, e))?;
    let t = data.demand.sample_time_s;
    let gains: [ReadOut<'_>; 2] = [
        (Quantity::ProportionalGain, &|g| 1.0 / g[inverse::P]),
        (Quantity::IntegralGain, &|g| g[inverse::Q] / (g[inverse::P] * t)),
    ];
    Ok(transformed(&gains, &fit, &covariance, f64::INFINITY, &data.stretch))
}

/// Refuses a recording in which the controller's gains come out far from what they are known to be.
fn check_gains(data: &Data, here: &Estimate, controller: &SpeedControllerFit) -> Result<(), EstimateError> {
    for own in &here.parameters {
        let Some(known) = controller.result.estimate.parameter(own.quantity) else { continue };
        let (apart, error) = ((own.value - known.value).abs(), own.standard_error.hypot(known.standard_error));
        if apart > GAINS_APART_STANDARD_ERRORS * error && apart > CONTRADICTED_SHARE * known.value.abs() {
            return Err(EstimateError::Contradiction {
                file: data.stretch.file.clone(),
                quantity: own.quantity,
                here: (own.value, own.standard_error),
                known: (known.value, known.standard_error),
            });
        }
    }
    Ok(())
}

/// k and k_a with what they were found from.
struct Found<'a> {
    data: &'a Data,
    lags: DemandLags,
    fit: Minimum,
    controller: &'a SpeedControllerFit,
}

impl Found<'_> {
    /// The feed-forward, judged on data that it has not seen.
    fn feed_forward(&self, candidates: &[Candidate], unseen: &Data) -> Result<FeedForward, EstimateError> {
        let others = self.other_lags(candidates)?;
        let delay = self.controller.delay_samples();
        let readings: Vec<Reading> =
            [&self.lags].into_iter().chain(&others).flat_map(|lags| Reading::of(*lags, delay)).collect();
        let of_controller = |j: usize| if j >= inverse::K { 0.0 } else { self.controller.theta[j] };
        let alone: Vec<f64> = (0..inverse::COUNT).map(of_controller).collect();
        Ok(FeedForward {
            estimate: self.estimate(&others)?,
            lags: self.lags,
            delay_places: places(&readings),
            validation: validate(unseen, &self.fit.parameters, self.lags)?,
            pi_alone: validate(unseen, &alone, self.lags)?,
        })
    }

    /// Lags that the data do not exclude, one of those that describe the same sequence.
    fn other_lags(&self, candidates: &[Candidate]) -> Result<Vec<DemandLags>, EstimateError> {
        let (covariance, _) = at_least_white(&self.fit, BATCHES).map_err(|e| ident_error(self.data, e))?;
        let white = self.fit.covariance();
        let inflation = |j: usize| if white[(j, j)] > 0.0 { covariance[(j, j)] / white[(j, j)] } else { 1.0 };
        let limit = DECISIVE * inflation(inverse::K).max(inflation(inverse::K_A)).max(1.0);
        let mut others: Vec<DemandLags> = Vec::new();
        for candidate in candidates.iter().filter(|candidate| candidate.excess < limit) {
            let is_known = others.iter().chain([&self.lags]).any(|lags| is_same(*lags, candidate.lags));
            if !is_known {
                others.push(candidate.lags);
            }
        }
        Ok(others)
    }

    /// k and k_a. Their intervals also hold the values of every other reading that the data do not exclude.
    fn estimate(&self, others: &[DemandLags]) -> Result<Estimate, EstimateError> {
        let covariance = self.covariance()?;
        let freedom = BATCHES as f64 - 1.0;
        let t = self.data.demand.sample_time_s;
        let delay = self.controller.delay_samples();
        let own = Reading::of(self.lags, delay);
        let is_forward = own.first().is_some_and(|reading| reading.is_forward);
        let outputs: [ReadOut<'_>; 2] = [
            (Quantity::SpeedFeedForward, &|g| g[inverse::K]),
            (Quantity::AccelerationFeedForward, &|g| {
                t * (g[inverse::K_A] + if is_forward { g[inverse::K] } else { 0.0 })
            }),
        ];
        let mut estimate = transformed(&outputs, &self.fit, &covariance, freedom, &self.data.stretch);
        let mut values: Vec<[f64; 2]> =
            own.iter().map(|reading| self.as_read(&self.fit, self.lags, *reading)).collect();
        for lags in others {
            let fit = fit_with_lags(self.data, *lags, self.controller, &OWN)?;
            let readings = Reading::of(*lags, delay);
            values.extend(readings.iter().map(|reading| self.as_read(&fit, *lags, *reading)));
            if readings.is_empty() {
                values.push([fit.parameters[inverse::K], t * fit.parameters[inverse::K_A]]);
            }
        }
        for (i, parameter) in estimate.parameters.iter_mut().enumerate() {
            let (low, high) = parameter.interval;
            let apart = values.iter().map(|value| value[i] - parameter.value);
            let (down, up) = apart.fold((0.0, 0.0), |(down, up), d| (f64::min(down, d), f64::max(up, d)));
            parameter.interval = (low + down, high + up);
        }
        Ok(estimate)
    }

    /// k and k_a as a reading has them, from a fit with lags that describe the same sequence.
    fn as_read(&self, fit: &Minimum, lags: DemandLags, reading: Reading) -> [f64; 2] {
        let theta = &fit.parameters;
        let t = self.data.demand.sample_time_s;
        let (k_p, k_i_t) = (1.0 / theta[inverse::P], theta[inverse::Q] / theta[inverse::P]);
        let earlier = f64::from(lags.speed_error - reading.lags.speed_error);
        let k = theta[inverse::K] + earlier * k_i_t;
        let k_a = t * (theta[inverse::K_A] + earlier * (k_p - k_i_t));
        [k, k_a + if reading.is_forward { t * k } else { 0.0 }]
    }

    /// The covariance of this fit, and what the uncertainty of the controller adds: ∂φ/∂η = −J_φ⁺ J_η, φ being
    /// estimated here and η known.
    fn covariance(&self) -> Result<Mat<f64>, EstimateError> {
        let of = |e| ident_error(self.data, e);
        let (mut covariance, _) = at_least_white(&self.fit, BATCHES).map_err(of)?;
        let is_wanted = |j: usize| OWN.contains(&j) || KNOWN.contains(&j);
        let mut model = self.data.model(self.lags, &is_wanted);
        let mut jacobian = Mat::zeros(model.residual_count(), model.parameter_count());
        let mut residuals = vec![0.0; model.residual_count()];
        model.evaluate(&self.fit.parameters, &mut residuals, Some(jacobian.as_mut())).map_err(of)?;
        let own = Mat::from_fn(jacobian.nrows(), OWN.len(), |i, j| jacobian[(i, OWN[j])]);
        let slope = |known: &usize| {
            let column: Vec<f64> = jacobian.col(*known).iter().copied().collect();
            least_squares(own.as_ref(), &column).map(|fit| fit.parameters)
        };
        let slopes = KNOWN.iter().map(slope).collect::<Result<Vec<_>, _>>().map_err(of)?;
        for (a, i) in OWN.iter().enumerate() {
            for (b, j) in OWN.iter().enumerate() {
                for (p, slope) in KNOWN.iter().zip(&slopes) {
                    for (q, other) in KNOWN.iter().zip(&slopes) {
                        covariance[(*i, *j)] += slope[a] * self.controller.covariance[(*p, *q)] * other[b];
                    }
                }
            }
        }
        Ok(covariance)
    }
}
