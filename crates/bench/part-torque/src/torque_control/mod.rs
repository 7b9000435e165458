//! Torque control: the closed loop from T_d* to T_d (thesis §6.3.4; (6.3), (6.8) and the delay with
//! lag, the best found there).
//!
//! T_d,calc is compared with the exact response of the model to the held demand, at the stamps of T_d,calc itself.
//! The ripple of the drive, which multiplies the torque as well as adding to it, is found in the residual spectrum and
//! estimated jointly: left out, it biases the lag.

mod bounds;
mod held;
mod model;
mod observed;
mod pure_delay;
mod ripple;
mod rippled;
mod search;
mod second_order;
mod validation;

use faer::Mat;
use ident::distributions::interval;
use ident::{Bounds, IdentError, Minimum};
use numerics::vector;
use rig::estimation::{ESTIMATION_SHARE, EstimateError, liveliest_part, timing_floor_s};
use rig::experiment::Sought;
use rig::results::{Estimate, Parameter, Part, Quantity, Stretch, TorqueControl};
use rig::{Diagnostic, Excitation, Experiment, Finding, Place, Role, Severity};
use serde::{Deserialize, Serialize};
use signal::Signal;

pub use bench_model::drive_ripple::{DriveRipple, RippleLine};
use bounds::{EARLIEST_S, LAG_RAD_S, LONGEST_DELAY_S};
pub use held::HeldDemand;
pub use model::{AirGapTorqueModel, ResidualStatistics};
pub(super) use observed::Observed;
use observed::check_finite;
pub(crate) use observed::usable_samples;
pub use ripple::OF_MAINS_HZ;
use ripple::folded_to_zero_hz;
use rippled::{DelayAndLag, RippledModel};
pub use search::batches;
use search::fit_with_ripple;
pub(super) use search::robust_covariance;
pub use second_order::{CRITICALLY_DAMPED, SecondOrderTest};
pub(crate) use second_order::{SecondOrder, distance_from_lag, lag_errors, term_error};

/// Shortest usable recording, s.
const SHORTEST_S: f64 = 4.0;
/// A demand that varies less than this (standard deviation) excites nothing, Nm.
const WEAK_NM: f64 = 0.1;
/// Largest share of the samples that may be lost to the torque limit.
const MOST_SATURATED: f64 = 0.5;
/// A delay that is negative by this many standard errors is no accident.
const EARLY: f64 = 4.0;
/// A lag that is known to no better than this part of itself may be even less certain than the slopes at the minimum
/// say.
const WEAK_LAG: f64 = 0.02;
/// Parts of a weak lag from which another minimum is looked for.
const RIVAL_LAGS: [f64; 3] = [0.5, 2.0, 4.0];
/// Samples of T_d,calc this far apart, s, may miss what separates delay and lag.
const COARSE_S: f64 = 5e-3;
/// Delay, s, and bandwidth, rad/s, in the middle of what drives of test benches have.
const USUAL: [f64; 2] = [1.25e-3, 600.0];
/// Residuals larger by less than this factor are as good.
const AS_GOOD: f64 = 1.1;
/// How far beside a delay its uncertainty is looked at, in samples of the demand.
const BESIDE: f64 = 0.02;
/// Level at which the gain is tested against one.
const GAIN_LEVEL: f64 = 0.99;
/// A gain this near to one matters to nobody: torque flanges are specified to no better.
const GAIN_MATTERS: f64 = 0.005;

/// The estimate of the torque control and the model made of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TorqueControlFit {
    /// Parameters and validation.
    pub result: TorqueControl,
    /// The model at the estimate, with the ripple of the estimation part of the recording.
    pub model: AirGapTorqueModel,
    /// Gain when it is left free; the estimate has it at one.
    pub gain: Parameter,
    /// Doubts.
    pub diagnostics: Vec<Diagnostic>,
}

impl TorqueControlFit {
    /// Tells whether a lag was found: one that is known to no better than half of itself, or rests on a bound, is as
    /// good as none.
    pub fn has_lag(&self) -> bool {
        let lag = self.result.delay_and_lag.parameter(Quantity::TorqueControlBandwidth);
        let is_known = lag.is_some_and(|a| a.standard_error < 0.5 * a.value);
        is_known && (1.01 * LAG_RAD_S.start()..0.99 * LAG_RAD_S.end()).contains(&self.model.lag_rad_s)
    }
}

/// The experiment to estimate the torque control from: WhiteNoise_T_TN, else Multisine_T_TN, Binary_T_TN, Step_T_TN,
/// BS_T_NT.
pub fn choose<'a>(experiments: &[&'a Experiment]) -> Option<&'a Experiment> {
    Sought::TorqueControl.candidates(experiments).into_iter().find(|e| e.label.excitation == Excitation::Torque)
}

/// Estimates T_d = e^{−sτ} a/(s + a) T_d* from one experiment, with T_d* held between its samples.
///
/// Needs T_d* and T_d,calc in Nm, each on its own clock. Samples within 0.1 s of |T_d*| ≥ `torque_limit_nm` are left
/// out. Of a long recording the four minutes are used in which T_d* changes most. Their first 70 % are estimated from,
/// the rest validates. Offset and ripple lines are estimated jointly (see [`AirGapTorqueModel`]); the gain is one, and
/// a gain that differs from one by more than its 99 % interval is reported in the diagnostics, and the intervals reach
/// to the estimates beside a free gain. Covariances are robust to coloured residuals.
///
/// τ is as recorded: it holds by how much the clocks of the two signals are apart, and is negative where T_d,calc is
/// dated before the demand (at most 5 ms).
///
/// Returns τ in s, a in rad/s and the total delay τ + 1/a in s (by the delta method), the same for a delay alone, and
/// the model.
///
/// # Errors
/// A signal that is missing, too short, constant, not finite, or too often at the limit; data that do not determine the
/// parameters.
///
/// # Source
/// Glans & Kärnell 2018, §6.3.4; Ljung 1999, ch. 7 and 9 (prediction error, robust covariance).
pub fn estimate(experiment: &Experiment, torque_limit_nm: Option<f64>) -> Result<TorqueControlFit, EstimateError> {
    let (fit, is_separated) = estimate_unseparated(experiment, torque_limit_nm)?;
    if is_separated { Ok(fit) } else { Err(EstimateError::Inseparable { file: experiment.file.clone() }) }
}

/// As [`estimate`], and whether delay and lag were separated. Where not, the torque at the samples is still that of the
/// model, but neither number is worth anything by itself.
///
/// # Errors
/// Those of [`estimate`].
pub fn estimate_unseparated(
    experiment: &Experiment,
    torque_limit_nm: Option<f64>,
) -> Result<(TorqueControlFit, bool), EstimateError> {
    let experiment = &*liveliest_part(experiment, Role::DynoTorqueDemand);
    let (demand, torque) = signals(experiment)?;
    let usable = usable_samples(demand, torque, torque_limit_nm);
    let split = (ESTIMATION_SHARE * torque.len() as f64) as usize;
    let observed = Observed::new(torque, &usable, 0..split);
    let mut diagnostics = check_saturation(experiment, torque_limit_nm, &usable)?;
    let held = HeldDemand::new(demand, torque_limit_nm);
    let failed = |source: IdentError| EstimateError::Ident { file: experiment.file.clone(), source };
    let mut lagged = fit_lagged(&held, &observed, torque_limit_nm).map_err(failed)?;
    let has_no_lag = lagged.fit.at_bound[1] && torque.sample_time_s > COARSE_S;
    let is_separated = lagged.delay_error_s() <= LONGEST_DELAY_S && !lagged.covariance[(1, 1)].is_nan();
    let is_separated = is_separated && !has_no_lag;
    if let Some(quantity) = lagged.slow_limit() {
        let file = experiment.file.clone();
        let at_limit = EstimateError::AtLimit { file: file.clone(), quantity };
        return Err(if is_separated { at_limit } else { EstimateError::Inseparable { file } });
    }
    if !is_separated && let Some(usual) = usual_drive(&held, &observed, &lagged.model) {
        lagged.model = usual;
    }
    let stretch = stretch_of(experiment, torque, 0..split);
    let mut delay_and_lag = lagged.estimate(&stretch);
    let (mut pure_delay, delayed) = pure_delay::fit(&held, &observed, &lagged.model, &stretch).map_err(failed)?;
    let held_out = Observed::new(torque, &usable, split..torque.len());
    let judge =
        |modelled: &[f64], seen: &Observed| validation::judge(experiment, &held, seen, modelled).map_err(failed);
    let seen = held_out.part(held_out.longest_run());
    let delay_and_lag_validation = judge(&lagged.model.torque_at(&held, &seen.times_s), &seen)?;
    let pure_delay_validation = judge(&delayed.torque_at(&held, &seen.times_s), &seen)?;
    diagnostics.extend(doubts(
        experiment,
        &lagged,
        &delay_and_lag_validation,
        demand.sample_time_s,
        torque.sample_time_s,
    ));
    if lagged.is_gain_contradicted(torque.sample_time_s) {
        delay_and_lag.add_moves(&lagged.moves_with_gain());
    }
    // Both delays are read off the same two clocks.
    let floor = timing_floor_s(demand.sample_time_s);
    delay_and_lag.add_systematic(&[Quantity::TorqueControlDelay, Quantity::TorqueControlTotalDelay], floor);
    pure_delay.add_systematic(&[Quantity::TorqueControlDelay], floor);
    let fit = TorqueControlFit {
        result: TorqueControl {
            pure_delay,
            delay_and_lag,
            pure_delay_validation,
            delay_and_lag_validation,
            torque_skew: None,
        },
        model: lagged.model,
        gain: lagged.gain,
        diagnostics,
    };
    Ok((fit, is_separated))
}

/// Tests on the estimation part of the experiment that `fit` comes from whether more than delay and lag is found.
///
/// # Errors
/// Those of [`estimate`].
pub fn second_order(
    experiment: &Experiment,
    fit: &TorqueControlFit,
    torque_limit_nm: Option<f64>,
) -> Result<SecondOrderTest, EstimateError> {
    let experiment = &*liveliest_part(experiment, Role::DynoTorqueDemand);
    let (demand, torque) = signals(experiment)?;
    let usable = usable_samples(demand, torque, torque_limit_nm);
    let split = (ESTIMATION_SHARE * torque.len() as f64) as usize;
    let seen = Observed::new(torque, &usable, 0..split);
    let smooth = seen.times_s.iter().zip(&seen.values).map(|(t, y)| fit.model.without_ripple(*y, *t)).collect();
    let observed = Observed { values: smooth, ..seen };
    let held = HeldDemand::new(demand, torque_limit_nm);
    second_order::test(&held, &observed, fit.model.delay_s, fit.model.lag_rad_s)
        .map_err(|source| EstimateError::Ident { file: experiment.file.clone(), source })
}

/// T_d* and T_d,calc, checked.
fn signals(experiment: &Experiment) -> Result<(&Signal, &Signal), EstimateError> {
    let demand = usable_signal(experiment, Role::DynoTorqueDemand)?;
    let torque = usable_signal(experiment, Role::AirGapTorque)?;
    let standard_deviation = vector::standard_deviation(&demand.samples);
    if standard_deviation.is_nan() || standard_deviation < WEAK_NM {
        let role = Role::DynoTorqueDemand;
        return Err(EstimateError::WeakExcitation { file: experiment.file.clone(), role, standard_deviation });
    }
    Ok((demand, torque))
}

/// The signal of a role, present, finite and long enough.
pub(super) fn usable_signal(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    let file = || experiment.file.clone();
    let signal = experiment.signal(role).ok_or_else(|| EstimateError::MissingSignal { file: file(), role })?;
    check_finite(role.symbol(), &signal.samples).map_err(|source| EstimateError::Ident { file: file(), source })?;
    if signal.duration_s() < SHORTEST_S {
        let duration_s = signal.duration_s();
        return Err(EstimateError::TooShort { file: file(), duration_s, needed_s: SHORTEST_S });
    }
    Ok(signal)
}

pub(super) fn stretch_of(experiment: &Experiment, signal: &Signal, range: std::ops::Range<usize>) -> Stretch {
    let end = range.end.saturating_sub(1).max(range.start);
    Stretch { file: experiment.file.clone(), start_s: signal.time_s(range.start), end_s: signal.time_s(end) }
}

fn check_saturation(
    experiment: &Experiment,
    limit: Option<f64>,
    usable: &[bool],
) -> Result<Vec<Diagnostic>, EstimateError> {
    let Some(limit_nm) = limit else { return Ok(Vec::new()) };
    let Some(demand) = experiment.signal(Role::DynoTorqueDemand) else { return Ok(Vec::new()) };
    let share = demand.samples.iter().filter(|u| u.abs() >= limit_nm).count() as f64 / demand.len().max(1) as f64;
    let lost = usable.iter().filter(|u| !**u).count() as f64 / usable.len().max(1) as f64;
    if share > 0.0 && lost > MOST_SATURATED {
        let role = Role::DynoTorqueDemand;
        return Err(EstimateError::Saturated { file: experiment.file.clone(), role, share });
    }
    Ok(if share > 0.0 { vec![warning(experiment, Finding::Saturated { share, limit_nm })] } else { Vec::new() })
}

fn warning(experiment: &Experiment, finding: Finding) -> Diagnostic {
    let place = Place { file: Some(experiment.file.clone()), ..Place::default() };
    Diagnostic { severity: Severity::Warning, place, finding }
}

/// The fit of delay and lag.
struct Lagged {
    model: AirGapTorqueModel,
    /// Of τ and a.
    covariance: Mat<f64>,
    freedom: f64,
    gain: Parameter,
    /// τ and a with the gain free.
    beside_gain: [f64; 2],
    fit: Minimum,
}

fn fit_lagged(held: &HeldDemand, observed: &Observed, limit: Option<f64>) -> Result<Lagged, IdentError> {
    let bounds = [Bounds::new(-EARLIEST_S, LONGEST_DELAY_S), Bounds::new(*LAG_RAD_S.start(), *LAG_RAD_S.end())];
    let mut model = RippledModel::new(DelayAndLag::new(held), observed);
    let fit = fit_with_ripple(&mut model, &starts(held.sample_time_s()), &bounds)?;
    let reach_s = BESIDE * held.sample_time_s();
    let (covariance, freedom) = search::covariance_beside_kinks(&mut model, &fit, &bounds, reach_s)?;
    let covariance = widened(&mut model, &fit, &bounds, covariance);
    let ripple = model.ripple(&fit.parameters);
    let (gain, beside_gain) = free_gain(&mut model, &fit, &bounds, observed.sample_time_s)?;
    let model = AirGapTorqueModel {
        delay_s: fit.parameters[0],
        lag_rad_s: fit.parameters[1],
        ripple,
        torque_limit_nm: limit,
        residual: model::statistics(&fit.residuals, observed)?,
    };
    let covariance =
        Mat::from_fn(2, 2, |i, j| if fit.at_bound[i] && i == j { f64::INFINITY } else { covariance[(i, j)] });
    Ok(Lagged { model, covariance, freedom, gain, beside_gain, fit })
}

/// A usual drive, where it explains the samples as well as the one found: among delays and lags that the samples cannot
/// separate, the one found is any.
fn usual_drive(held: &HeldDemand, observed: &Observed, found: &AirGapTorqueModel) -> Option<AirGapTorqueModel> {
    let mut model = RippledModel::new(DelayAndLag::new(held), observed);
    let fit = fit_with_ripple(&mut model, &[USUAL.to_vec()], &USUAL.map(|value| Bounds::new(value, value))).ok()?;
    let residual = model::statistics(&fit.residuals, observed).ok()?;
    let is_as_good = residual.standard_deviation_nm < AS_GOOD * found.residual.standard_deviation_nm;
    let [delay_s, lag_rad_s] = USUAL;
    let ripple = model.ripple(&fit.parameters);
    is_as_good.then_some(AirGapTorqueModel { delay_s, lag_rad_s, ripple, residual, ..found.clone() })
}

/// The covariance, wider where the cost about the minimum is flatter than its slopes say.
fn widened(
    model: &mut RippledModel<'_, DelayAndLag<'_>>,
    fit: &Minimum,
    bounds: &[Bounds],
    covariance: Mat<f64>,
) -> Mat<f64> {
    let variance = covariance[(1, 1)];
    let is_weak = variance.sqrt() > WEAK_LAG * fit.parameters[1];
    if !is_weak || !variance.is_finite() || fit.at_bound[1] {
        return covariance;
    }
    let factor = search::flatness(model, fit, bounds, variance).powi(2);
    let mut covariance = covariance * faer::Scale(factor);
    for rival in RIVAL_LAGS.iter().filter_map(|factor| search::rival(model, fit, bounds, *factor)) {
        let apart = [rival[0] - fit.parameters[0], rival[1] - fit.parameters[1]];
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            covariance[(i, j)] += apart[i] * apart[j];
        }
    }
    covariance
}

/// The gain with its standard error, and τ and a beside it.
fn free_gain(
    model: &mut RippledModel<'_, DelayAndLag<'_>>,
    fit: &Minimum,
    bounds: &[Bounds],
    sample_time_s: f64,
) -> Result<(Parameter, [f64; 2]), IdentError> {
    let free = search::free_the_gain(model, fit, bounds)?;
    let (covariance, freedom) = robust_covariance(&free, sample_time_s)?;
    let at = model.response_count();
    let error = covariance[(at, at)].sqrt();
    let gain = Parameter::new(Quantity::TorqueControlGain, free.parameters[at], error, freedom);
    Ok((gain, [free.parameters[0], free.parameters[1]]))
}

/// A grid of delays (in halves of the demand's sample) and lags, lag by lag: a mode is computed once for all delays.
fn starts(sample_time_s: f64) -> Vec<Vec<f64>> {
    let delays = (0..).map(|j| 0.5 * j as f64 * sample_time_s - EARLIEST_S).take_while(|d| *d < LONGEST_DELAY_S);
    let lags = [60.0, 150.0, 400.0, 1000.0, 2500.0];
    lags.into_iter().flat_map(|a| delays.clone().map(move |d| vec![d, a])).collect()
}

impl Lagged {
    /// Tells whether T_d differs from T_d* by a factor that matters.
    fn is_gain_contradicted(&self, torque_sample_time_s: f64) -> bool {
        // Ripple that the samples fold to zero frequency is a gain of theirs, and none of T_d.
        let is_expected = folded_to_zero_hz(torque_sample_time_s).is_some();
        let gain = &self.gain;
        let (low, high) = interval(gain.value, gain.standard_error, gain.degrees_of_freedom, GAIN_LEVEL);
        let matters = (gain.value - 1.0).abs() > GAIN_MATTERS;
        !is_expected && matters && !(low..=high).contains(&1.0)
    }

    /// By how much τ, a and τ + 1/a change with the gain free.
    fn moves_with_gain(&self) -> [f64; 3] {
        let ([delay, lag], model) = (self.beside_gain, &self.model);
        let moves = [delay - model.delay_s, lag - model.lag_rad_s];
        [moves[0], moves[1], moves[0] + 1.0 / lag - 1.0 / model.lag_rad_s]
    }

    /// Quantity that ended at the slow limit of the search, where no drive is.
    fn slow_limit(&self) -> Option<Quantity> {
        let [delay, lag] = [0, 1].map(|at| self.fit.at_bound[at]);
        if lag && self.model.lag_rad_s < 2.0 * LAG_RAD_S.start() {
            return Some(Quantity::TorqueControlBandwidth);
        }
        (delay && self.model.delay_s > 0.5 * LONGEST_DELAY_S).then_some(Quantity::TorqueControlDelay)
    }

    /// Standard error of τ, s; none where τ is at a bound.
    fn delay_error_s(&self) -> f64 {
        if self.fit.at_bound[0] { 0.0 } else { self.covariance[(0, 0)].sqrt() }
    }

    /// τ, a and τ + 1/a with their joint covariance.
    fn estimate(&self, stretch: &Stretch) -> Estimate {
        let (delay, lag) = (self.model.delay_s, self.model.lag_rad_s);
        let rows = [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0 / (lag * lag)]];
        let joint = |i: usize, j: usize| -> f64 {
            let pairs = (0..2).flat_map(|k| (0..2).map(move |l| (k, l)));
            let terms = pairs.map(|(k, l)| (rows[i][k] * rows[j][l], self.covariance[(k, l)]));
            terms.filter(|t| t.0 != 0.0).map(|(weight, c)| weight * c).sum()
        };
        let covariance: Vec<Vec<f64>> = (0..3).map(|i| (0..3).map(|j| joint(i, j)).collect()).collect();
        let values = [
            (Quantity::TorqueControlDelay, delay),
            (Quantity::TorqueControlBandwidth, lag),
            (Quantity::TorqueControlTotalDelay, delay + 1.0 / lag),
        ];
        let parameter = |(i, (quantity, value)): (usize, &(Quantity, f64))| {
            Parameter::new(*quantity, *value, covariance[i][i].sqrt(), self.freedom)
        };
        Estimate {
            parameters: values.iter().enumerate().map(parameter).collect(),
            covariance,
            stretches: vec![stretch.clone()],
            iterations: self.fit.iterations,
            condition: self.fit.condition,
        }
    }
}

fn doubts(
    experiment: &Experiment,
    lagged: &Lagged,
    validation: &rig::results::Validation,
    demand_sample_time_s: f64,
    torque_sample_time_s: f64,
) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let submodel = Part::TorqueControl;
    if !lagged.fit.termination.converged() || lagged.fit.at_bound[..2].contains(&true) {
        found.push(warning(experiment, Finding::NotConverged { submodel }));
    }
    let (advance_s, uncertainty_s) = (-lagged.model.delay_s, lagged.covariance[(0, 0)].sqrt());
    if advance_s > EARLY * uncertainty_s.max(timing_floor_s(demand_sample_time_s)) {
        found.push(warning(experiment, Finding::EarlySignal { role: Role::AirGapTorque, advance_s }));
    }
    let gain = &lagged.gain;
    if lagged.is_gain_contradicted(torque_sample_time_s) {
        let quantity = Quantity::TorqueControlGain;
        let (first, second) = ((gain.value, gain.standard_error), (1.0, 0.0));
        found.push(warning(experiment, Finding::RoutesDisagree { quantity, first, second }));
    }
    if let Some(test) = validation.residuals.as_ref().filter(|test| test.depends_on_input()) {
        let share_outside = test.share_outside();
        found.push(warning(experiment, Finding::ResidualsCorrelated { submodel, share_outside }));
    }
    found
}
