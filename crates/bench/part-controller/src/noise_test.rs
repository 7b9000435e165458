//! The study of §7.1: a PI controller that is known runs on recorded speeds, noise is added to the speed it sees, and
//! it is estimated again from its T_d* and the speeds without that noise; many draws instead of one.
//!
//! Noise that the controller sees and nobody logs is in T_d* behind PI, where the estimate that follows the controller
//! forward (as the thesis's does) is right, and the inverted controller, which is made for noise of the logged speed,
//! is biased. The study makes both.
//!
//! The thesis does not say in which bands its noise lay nor how its SNR is defined; here the SNR is the ratio of the
//! variance of the speed error to that of the noise, and every draw is scaled to it exactly.
//!
//! # Source
//! Thesis §7.1, figure 7.1, table 7.1.

use std::ops::RangeInclusive;

use numerics::null::nan_if_null;
use numerics::parallel;
use numerics::random::Stream;
use rig::estimation::{EstimateError, need};
use rig::numbers::unscaled;
use rig::random::Source;
use rig::results::{Estimate, Notation, Quantity};
use rig::{Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;
use signal::proportion::Proportion;
use signal::spline::UniformSpline;
use units::RPM_RAD_S;
use work::Context;

use crate::speed_controller;

/// Order of the noise's Butterworth filters (that of a band-pass is twice this).
const NOISE_ORDER: usize = 4;
/// The integrator starts within this of a middling torque, Nm.
const INITIAL_NM: RangeInclusive<f64> = 20.0..=60.0;

/// A row of table 7.1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PublishedRow {
    /// The noise.
    pub noise: Noise,
    /// K_p, Nm/rpm.
    #[serde(deserialize_with = "nan_if_null")]
    pub k_p: f64,
    /// K_i, Nm/(rpm s).
    #[serde(deserialize_with = "nan_if_null")]
    pub k_i: f64,
}

/// Table 7.1 of the thesis, whose truth was K_p 0.9385 and K_i 1.8650: one draw of each noise.
pub const PUBLISHED: [PublishedRow; 3] = [
    PublishedRow { noise: Noise::None, k_p: 0.9385, k_i: 1.8650 },
    PublishedRow { noise: Noise::LowPass, k_p: 0.9388, k_i: 1.8896 },
    PublishedRow { noise: Noise::BandPass, k_p: 0.9385, k_i: 1.8650 },
];

/// Noise on the speed that the controller sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Noise {
    /// None.
    None,
    /// White noise through a low-pass.
    LowPass,
    /// White noise through a band-pass.
    BandPass,
}

/// How the controller is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// T_d* from N_d, as the thesis does.
    Forward,
    /// N_d from T_d*: what recordings are estimated with.
    Inverse,
}

/// Options of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoiseTestOptions {
    /// K_p, Nm/rpm.
    #[serde(deserialize_with = "nan_if_null")]
    pub k_p: f64,
    /// K_i, Nm/(rpm s).
    #[serde(deserialize_with = "nan_if_null")]
    pub k_i: f64,
    /// τ, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub delay_s: f64,
    /// Corner of the low-pass, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub low_pass_hz: f64,
    /// Variance of the speed error over that of low-pass noise.
    #[serde(deserialize_with = "nan_if_null")]
    pub low_pass_snr: f64,
    /// Corners of the band-pass, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub band_pass_hz: (f64, f64),
    /// Variance of the speed error over that of band-pass noise.
    #[serde(deserialize_with = "nan_if_null")]
    pub band_pass_snr: f64,
    /// Draws of each noise.
    pub draws: usize,
    /// Seed; equal seeds give equal results, however many threads work.
    pub seed: u64,
}

impl Default for NoiseTestOptions {
    fn default() -> Self {
        NoiseTestOptions {
            k_p: 0.9385,
            k_i: 1.8650,
            delay_s: 1e-3,
            low_pass_hz: 1.0,
            low_pass_snr: 13.0,
            band_pass_hz: (100.0, 200.0),
            band_pass_snr: 8.0,
            draws: 200,
            seed: 1,
        }
    }
}

/// The result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoiseTest {
    /// The recording whose speeds were used.
    pub file: String,
    /// Standard deviation of its speed error, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub error_rad_s: f64,
    /// Options of the study.
    pub options: NoiseTestOptions,
    /// Without noise, with low-pass noise, with band-pass noise, each by both estimators.
    pub cases: Vec<Case>,
}

/// One kind of noise, estimated one way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Case {
    /// The noise.
    pub noise: Noise,
    /// The estimator.
    pub estimator: Estimator,
    /// Standard deviation of the noise, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub noise_rad_s: f64,
    /// Draws from which nothing could be estimated.
    pub failed: usize,
    /// K_p, K_i and τ over all draws.
    pub summaries: Vec<Summary>,
}

/// One parameter over all draws, SI; written in the unit people read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "WrittenSummary"))]
#[serde(into = "WrittenSummary", from = "ReadSummary")]
pub struct Summary {
    /// Which.
    pub quantity: Quantity,
    /// Truth.
    pub truth: f64,
    /// Each draw.
    pub values: Vec<f64>,
    /// Mean of the draws.
    pub mean: f64,
    /// Mean less truth.
    pub bias: f64,
    /// Standard deviation of the draws; zero for one.
    pub standard_deviation: f64,
    /// Mean of the standard errors that the estimates claim.
    pub claimed: f64,
    /// How many of the 95 % intervals hold the truth.
    pub coverage: Proportion,
}

/// A summary as people read it, and as JSON has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WrittenSummary {
    /// The parameter, by which a summary is read again.
    pub key: Quantity,
    /// Symbol of the parameter.
    pub symbol: &'static str,
    /// The unit of all that follows.
    pub unit: &'static str,
    /// Truth.
    pub truth: f64,
    /// Each draw.
    pub values: Vec<f64>,
    /// Mean of the draws.
    pub mean: f64,
    /// Mean less truth.
    pub bias: f64,
    /// Standard deviation of the draws; zero for one.
    pub standard_deviation: f64,
    /// Mean of the standard errors that the estimates claim.
    pub claimed: f64,
    /// How many of the 95 % intervals hold the truth.
    pub coverage: Proportion,
}

/// A summary as it is read; null is read as NaN.
#[derive(Deserialize)]
struct ReadSummary {
    key: Quantity,
    #[serde(deserialize_with = "nan_if_null")]
    truth: f64,
    #[serde(deserialize_with = "nan_if_null")]
    values: Vec<f64>,
    #[serde(deserialize_with = "nan_if_null")]
    mean: f64,
    #[serde(deserialize_with = "nan_if_null")]
    bias: f64,
    #[serde(deserialize_with = "nan_if_null")]
    standard_deviation: f64,
    #[serde(deserialize_with = "nan_if_null")]
    claimed: f64,
    coverage: Proportion,
}

impl From<ReadSummary> for Summary {
    fn from(read: ReadSummary) -> Self {
        let si = |written: f64| unscaled(written, &[read.key.notation().per_si]);
        Summary {
            quantity: read.key,
            truth: si(read.truth),
            values: read.values.into_iter().map(si).collect(),
            mean: si(read.mean),
            bias: si(read.bias),
            standard_deviation: si(read.standard_deviation),
            claimed: si(read.claimed),
            coverage: read.coverage,
        }
    }
}

impl Summary {
    /// In the unit people read.
    #[must_use]
    pub fn written(&self) -> WrittenSummary {
        let Notation { symbol, unit, per_si, .. } = self.quantity.notation();
        WrittenSummary {
            key: self.quantity,
            symbol,
            unit,
            truth: per_si * self.truth,
            values: self.values.iter().map(|value| per_si * value).collect(),
            mean: per_si * self.mean,
            bias: per_si * self.bias,
            standard_deviation: per_si * self.standard_deviation,
            claimed: per_si * self.claimed,
            coverage: self.coverage,
        }
    }
}

impl From<Summary> for WrittenSummary {
    fn from(summary: Summary) -> Self {
        summary.written()
    }
}

/// Runs the study on the speeds of a recording; Its draws are a step of the work.
///
/// # Errors
/// A missing signal, noise whose band does not fit the sample rate, or an estimate that fails without noise.
pub fn noise_test(
    experiment: &Experiment,
    options: &NoiseTestOptions,
    context: &Context,
) -> Result<NoiseTest, EstimateError> {
    let known = Known::new(experiment, options)?;
    let plan: Vec<(Noise, u64)> = std::iter::once((Noise::None, 0))
        .chain((0..options.draws as u64).flat_map(|draw| [(Noise::LowPass, draw), (Noise::BandPass, draw)]))
        .collect();
    let outcomes =
        parallel::map_as_step(context, "estimating draw after draw", &plan, |(noise, draw)| known.draw(*noise, *draw));
    let case = |(noise, estimator): (Noise, Estimator)| {
        let of_noise = plan.iter().zip(&outcomes).filter(|((of, _), _)| *of == noise);
        let all: Vec<_> = of_noise
            .map(|(_, [forward, inverse])| if estimator == Estimator::Forward { forward } else { inverse })
            .collect();
        let found: Vec<&Estimate> = all.iter().filter_map(|outcome| outcome.as_ref().ok()).collect();
        let noise_rad_s = known.noise_rad_s(noise);
        Case { noise, estimator, noise_rad_s, failed: all.len() - found.len(), summaries: summaries(&found, options) }
    };
    if let Some(Err(error)) =
        outcomes.first().and_then(|[forward, inverse]| [forward, inverse].into_iter().find(|o| o.is_err()))
    {
        return Err(error.clone());
    }
    let noises = [Noise::None, Noise::LowPass, Noise::BandPass];
    let both = |noise| [(noise, Estimator::Forward), (noise, Estimator::Inverse)];
    Ok(NoiseTest {
        file: experiment.file.clone(),
        error_rad_s: known.error_rad_s,
        options: options.clone(),
        cases: noises.into_iter().flat_map(both).map(case).collect(),
    })
}

/// The speeds, and what the controller makes of them.
struct Known<'a> {
    experiment: &'a Experiment,
    options: &'a NoiseTestOptions,
    /// N_d − N_d* at the controller's updates, τ late, rad/s.
    error: Vec<f64>,
    error_rad_s: f64,
    clock: Signal,
    low_pass: signal::Sos,
    band_pass: signal::Sos,
}

impl<'a> Known<'a> {
    fn new(experiment: &'a Experiment, options: &'a NoiseTestOptions) -> Result<Self, EstimateError> {
        let of = |source| EstimateError::Signal { file: experiment.file.clone(), source };
        let reference = need(experiment, Role::DynoSpeedDemand)?;
        let speed = need(experiment, Role::DynoSpeed)?;
        let t = reference.sample_time_s;
        let spline = UniformSpline::new(speed.samples.clone()).map_err(of)?;
        let lag = (options.delay_s / t).round() as usize;
        let error = |k: usize| {
            let at = (reference.time_s(k) - options.delay_s - speed.start_s) / speed.sample_time_s;
            spline.value(at.clamp(0.0, speed.len() as f64 - 1.0)) - reference.samples[k.saturating_sub(lag)]
        };
        let error: Vec<f64> = (0..reference.len()).map(error).collect();
        let (low, high) = options.band_pass_hz;
        Ok(Known {
            experiment,
            options,
            error_rad_s: standard_deviation(&error),
            error,
            clock: reference.clone(),
            low_pass: signal::Sos::butterworth_lowpass(NOISE_ORDER, options.low_pass_hz, t).map_err(of)?,
            band_pass: signal::Sos::butterworth_bandpass(NOISE_ORDER, low, high, t).map_err(of)?,
        })
    }

    fn noise_rad_s(&self, noise: Noise) -> f64 {
        match noise {
            Noise::None => 0.0,
            Noise::LowPass => self.error_rad_s / self.options.low_pass_snr.sqrt(),
            Noise::BandPass => self.error_rad_s / self.options.band_pass_snr.sqrt(),
        }
    }

    /// T_d* of one draw, and the controller that is estimated from it, forward and inverse.
    fn draw(&self, noise: Noise, draw: u64) -> [Result<Estimate, EstimateError>; 2] {
        let mut random = Source::NoiseTest.stream(self.options.seed.wrapping_add(draw << 20));
        let initial_nm = random.between(*INITIAL_NM.start(), *INITIAL_NM.end());
        let added = self.noise(noise, &mut random);
        let t = self.clock.sample_time_s;
        let (k_p, step) = (self.options.k_p / RPM_RAD_S, self.options.k_i / RPM_RAD_S * t);
        let mut integral_nm = initial_nm;
        let torque = |(e, n): (&f64, f64)| {
            let seen = e + n;
            let torque_nm = k_p * seen + integral_nm;
            integral_nm += step * seen;
            torque_nm
        };
        let demand = self.error.iter().zip(added).map(torque).collect();
        let mut experiment = self.experiment.clone();
        experiment.signals.insert(Role::DynoTorqueDemand, self.clock.with_samples(demand));
        [speed_controller::estimate_forward(&experiment), speed_controller::estimate_alone(&experiment, None)]
    }

    /// Noise in rad/s, as long as the recording; what its filter does at the start is left out.
    fn noise(&self, noise: Noise, random: &mut Stream) -> Vec<f64> {
        let count = self.error.len();
        let filter = match noise {
            Noise::None => return vec![0.0; count],
            Noise::LowPass => &self.low_pass,
            Noise::BandPass => &self.band_pass,
        };
        let settling =
            (10.0 / (self.options.low_pass_hz.min(self.options.band_pass_hz.0) * self.clock.sample_time_s)) as usize;
        let white: Vec<f64> = (0..settling + count).map(|_| random.normal()).collect();
        let coloured = filter.filter(&white, &mut filter.state_at_rest()).split_off(settling);
        let scale = self.noise_rad_s(noise) / standard_deviation(&coloured);
        coloured.into_iter().map(|n| scale * n).collect()
    }
}

fn summaries(found: &[&Estimate], options: &NoiseTestOptions) -> Vec<Summary> {
    let truths = [
        (Quantity::ProportionalGain, options.k_p / RPM_RAD_S),
        (Quantity::IntegralGain, options.k_i / RPM_RAD_S),
        (Quantity::ControllerDelay, options.delay_s),
    ];
    truths.into_iter().filter_map(|(quantity, truth)| summary(found, quantity, truth)).collect()
}

fn summary(found: &[&Estimate], quantity: Quantity, truth: f64) -> Option<Summary> {
    let parameters: Vec<_> = found.iter().filter_map(|estimate| estimate.parameter(quantity)).collect();
    if parameters.is_empty() {
        return None;
    }
    let values: Vec<f64> = parameters.iter().map(|p| p.value).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let covered = parameters.iter().filter(|p| p.interval.0 <= truth && truth <= p.interval.1).count();
    let standard_deviation = if values.len() > 1 { standard_deviation(&values) } else { 0.0 };
    Some(Summary {
        quantity,
        truth,
        mean,
        bias: mean - truth,
        standard_deviation,
        claimed: parameters.iter().map(|p| p.standard_error).sum::<f64>() / count,
        coverage: Proportion::new(covered, parameters.len()),
        values,
    })
}

fn standard_deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()
}
