//! Excitation designed for the least variance of chosen parameters under limits on what the bench may bear.
//!
//! A linear model says how much every line of a demand shows about the parameters (Fisher's information, M) and how far
//! it drives shaft torque, air-gap torque and speed. The best spectrum follows from that by a convex optimisation whose
//! distance from the best is known; phases are then chosen so that the limited responses, not the demand, have low
//! peaks; and a simulation scales the demand until the first limit is met. A binary demand is sought by trial among
//! many. [`design`] does it all.
//!
//! M(Φ) = T Σ_k p_k Re(G_θ(jω_k)ᴴ Λ(jω_k)⁻¹ G_θ(jω_k)), with T the length, p_k the power of line k, G_θ the derivatives
//! of the measured signals (T_d*, T_d, T_shaft, N_d, N_e as far as they are measured) by the parameters, and Λ the
//! two-sided spectral density of noise and disturbances on them. Where nothing is known of T_e, what it could have done
//! does not count: only what agrees with T_d and both speeds whatever T_e is, as in `part_shaft::shaft`. That
//! estimator looks through a window and reaches 1.25 times the variances predicted here for K and B, 2.6 times for J_d
//! (measured, without an engine that fires).
//!
//! # What it gains
//!
//! Variance after white noise over variance after the design, at the same realised peak of T_shaft (60 Nm) and the same
//! length (12 s): predicted on the nominal bench, and measured with the shaft's estimator on virtual benches with
//! skewed rasters, a fired engine at 1500 rpm and encoders with noise, rounding and a once-a-turn error, the resonance
//! known within 5 %, as a first study leaves it, or within 15 %; T_d within 250 Nm and N_d within 100 rpm of the
//! operating point. Limits and resolution were chosen on other benches. Intervals are of 95 %, from 480 benches each
//! (15 %: 240):
//!
//! | demand | resonance within | K predicted | K measured | B predicted | B measured |
//! | --- | --- | --- | --- | --- | --- |
//! | multisine | 5 % | 5.5 | 4.0 (3.3 … 4.7) | 5.8 | 4.3 (3.6 … 5.2) |
//! | binary | 5 % | 3.4 | 2.2 (1.8 … 2.7) | 3.4 | 2.3 (2.0 … 2.8) |
//! | multisine | 15 % | 4.4 | 3.1 | 5.2 | 2.8 |
//! | binary | 15 % | 3.3 | 2.0 | 3.3 | 2.2 |
//!
//! Benches that differ from the nominal one gain less: the demand is scaled to the peak that it reaches there, and its
//! phases and its spectrum are those of other resonances. Firing gives information about B with any demand: without it
//! white noise leaves a third more variance of B, which a prediction does not know.
//!
//! Limits hold for deviations from the operating point, from rest on, the engine at a constant torque. A fired engine
//! adds its own shaft torque.
//!
//! # Source
//! Ljung, *System Identification*, 2nd ed. 1999, ch. 13; Goodwin & Payne, *Dynamic System Identification*, 1977, ch. 6;
//! Pintelon & Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed. 2012, ch. 5.

mod binary;
mod error;
mod goal;
mod information;
mod peaks;
mod phases;
mod signals;
mod spectrum;
mod task;
mod trial;
mod unknown;
mod white;

use bench_model::document::ResultFormat;
use bench_model::model::ModelParameter;
use numerics::null::nan_if_null;
use rig::experiment::{ControlMode, Excitation, ExperimentPlan, Sine, Test, Waveform};
use serde::{Deserialize, Serialize};
use units::RPM_RAD_S;

pub use error::DesignError;
pub use goal::{Goal, OperatingPoint, UnknownGoal};
use information::{Line, lines, not_determined};
pub use peaks::{LimitedQuantity, Peaks};
use phases::Responses;
use spectrum::{bands, optimise, power_of};
pub use task::{Criterion, DesignTask, ExcitedDemand, Measurements, Nuisance, PeakLimits, Robustness, SampleNoise};
use trial::{HeldDemand, Trials};
pub use unknown::Unknown;

/// Lines with less than this part of the power of the strongest are left out.
const WEAKEST: f64 = 1e-6;

/// A parameter of interest as the experiment would leave it, on the nominal model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PredictedParameter {
    /// Which.
    pub parameter: ModelParameter,
    /// Its nominal value, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// Standard error, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// Standard error after white noise of the same length and the same peak of T_shaft, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub white_noise_standard_error: f64,
}

impl PredictedParameter {
    /// The variance after white noise of the same length and the same peak of T_shaft, over the variance after this.
    pub fn gain_over_white_noise(&self) -> f64 {
        (self.white_noise_standard_error / self.standard_error).powi(2)
    }
}

/// A demand with what it will do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DesignedExcitation {
    /// The demand over the whole experiment, operating point included.
    pub waveform: Waveform,
    /// Predictions of what it will achieve.
    pub parameters: Vec<PredictedParameter>,
    /// Covariance of the parameters of interest, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub covariance: Vec<Vec<f64>>,
    /// Its largest deviations under any of the models.
    pub peaks: Peaks,
    /// The limit that is met.
    pub binding: LimitedQuantity,
    /// The criterion over all models: the sum of relative variances, or the logarithm of the determinant of the
    /// relative covariance.
    #[serde(deserialize_with = "nan_if_null")]
    pub criterion: f64,
}

impl DesignedExcitation {
    /// The experiment that carries it, labelled by a test, at a speed and with the torque that the bench runs at.
    pub fn plan(&self, test: Test, excited: ExcitedDemand, at: OperatingPoint, duration_s: f64) -> ExperimentPlan {
        let speed_rpm = at.speed_rad_s / RPM_RAD_S;
        match excited {
            ExcitedDemand::Torque => ExperimentPlan {
                dyno_torque_nm: self.waveform.clone(),
                ..ExperimentPlan::new(test, Excitation::Torque, ControlMode::Tn, speed_rpm, duration_s)
            },
            ExcitedDemand::Speed => ExperimentPlan {
                speed_rad_s: self.waveform.clone(),
                engine_torque_nm: Waveform::Constant { value: at.torque_nm },
                ..ExperimentPlan::new(test, Excitation::Speed, ControlMode::Nt, speed_rpm, duration_s)
            },
        }
    }
}

/// A line of the best spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpectralLine {
    /// Hz.
    pub frequency_hz: f64,
    /// Amplitude of the demand, Nm or rad/s.
    pub amplitude: f64,
}

/// Findings of [`design`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExcitationDesign {
    /// The best spectrum with phases that keep peaks low.
    pub multisine: DesignedExcitation,
    /// The best binary demand of the search.
    pub binary: DesignedExcitation,
    /// Lines of the multisine.
    pub spectrum: Vec<SpectralLine>,
    /// By what part the criterion of the spectrum can exceed that of the best one (for a determinant: by how much its
    /// logarithm can), all peaks taken as those of sines one after the other.
    #[serde(deserialize_with = "nan_if_null")]
    pub duality_gap: f64,
    /// Rounds of the spectrum's optimisation.
    pub rounds: usize,
}

impl ExcitationDesign {
    /// Its form as a document.
    pub const DOCUMENT: ResultFormat<ExcitationDesign> = ResultFormat::new("dynoid-excitation-design", 1);
}

/// Designs a multisine and a binary demand.
///
/// # Errors
/// [`DesignError::Task`] and [`DesignError::MissingPart`] for what cannot be designed; [`DesignError::NotDetermined`]
/// where what is measured does not separate the parameters.
///
/// # Example
/// ```
/// use design::excitation_design::{DesignTask, PeakLimits, design};
/// use bench_model::model::{BenchModel, TorqueControlModel, Mechanics};
/// use units::RPM_RAD_S;
///
/// let model = BenchModel {
///     mechanics: Mechanics {
///         dyno_inertia_kg_m2: 0.6,
///         engine_inertia_kg_m2: 0.28,
///         stiffness_nm_per_rad: 2437.7,
///         damping_nm_s_per_rad: 5.8,
///     },
///     speed_controller: None,
///     feed_forward: None,
///     torque_control: Some(TorqueControlModel { delay_s: 1.25e-3, bandwidth_rad_s: Some(565.0) }),
///     torque_limit_nm: Some(400.0),
///     encoder_gate_s: 1e-3,
/// };
/// let limits = PeakLimits {
///     shaft_torque_nm: Some(30.0),
///     air_gap_torque_nm: Some(100.0),
///     speed_rad_s: Some(60.0 * RPM_RAD_S),
///     ..PeakLimits::default()
/// };
/// let task = DesignTask::shaft(model, 60.0, 1500.0 * RPM_RAD_S, limits).with_uncertain_resonance(0.1);
/// let found = design(&task)?;
/// assert!(found.duality_gap < 0.01);
/// assert!(found.multisine.peaks.shaft_torque_nm < 30.0 * (1.0 + 1e-9));
/// assert!(found.multisine.parameters.iter().all(|p| p.gain_over_white_noise() > 2.0));
/// # Ok::<(), design::excitation_design::DesignError>(())
/// ```
pub fn design(task: &DesignTask) -> Result<ExcitationDesign, DesignError> {
    task.check()?;
    let mut trials = Trials::new(task);
    let spectrum = BestSpectrum::new(task, &trials)?;
    let white = white::variances(task, &mut trials)?;
    let amplitudes = &spectrum.amplitudes;
    let phases = spectrum.phases(task)?;
    let steps = task.steps();
    let period = HeldDemand::of_lines(steps, &spectrum.harmonics, amplitudes, &phases)?;
    let Some(nominal) = task.models.first() else { return Err(DesignError::Task { requirement: "a model is needed" }) };
    let start = period.quietest_step(task, nominal)?;
    let (demand, factor) = at_the_limit(task, period.started_at(start))?;
    let turned = |(k, phase): (&usize, &f64)| phase + std::f64::consts::TAU * (*k * start) as f64 / steps as f64;
    let phases: Vec<f64> = spectrum.harmonics.iter().zip(&phases).map(turned).collect();
    let spectral: Vec<SpectralLine> = (spectrum.harmonics.iter().zip(amplitudes))
        .map(|(k, a)| SpectralLine { frequency_hz: *k as f64 / task.period_s, amplitude: factor * a })
        .collect();
    let sines = spectral.iter().zip(&phases).map(|(line, phase)| Sine {
        frequency_hz: line.frequency_hz,
        amplitude: line.amplitude,
        phase_rad: phase % std::f64::consts::TAU,
    });
    let waveform = Waveform::Multisine { mean: task.mean_demand, sines: sines.collect() };
    let multisine = described(task, &mut trials, &demand, waveform, &white)?;
    let binary = binary::search(task, &mut trials, &demand)?;
    let start = binary.quietest_step(task, nominal)?;
    let (binary, _) = at_the_limit(task, binary.started_at(start))?;
    let waveform = sampled(task, &binary);
    let binary = described(task, &mut trials, &binary, waveform, &white)?;
    Ok(ExcitationDesign { multisine, binary, spectrum: spectral, duality_gap: spectrum.gap, rounds: spectrum.rounds })
}

/// A demand whose values are repeated to the end of the experiment; it starts at the mean.
fn sampled(task: &DesignTask, demand: &HeldDemand) -> Waveform {
    let later = demand.values.iter().cycle().skip(1).take(task.all_steps() - 1).map(|v| task.mean_demand + v);
    let values = std::iter::once(task.mean_demand).chain(later).collect();
    Waveform::Sampled { sample_time_s: task.hold_s, values }
}

/// The demand scaled until the first limit is met under the model that bears it worst, and the factor.
fn at_the_limit(task: &DesignTask, demand: HeldDemand) -> Result<(HeldDemand, f64), DesignError> {
    let (peak, _) = demand.peaks(task, repeats(task, &demand))?.binding(task);
    let factor = 1.0 / peak;
    if !factor.is_finite() {
        return Err(DesignError::Task { requirement: "the loop must be stable and the demand must move the bench" });
    }
    Ok((demand.scaled(factor), factor))
}

/// Periods in the experiment.
fn repeats(task: &DesignTask, demand: &HeldDemand) -> usize {
    task.all_steps().div_ceil(demand.values.len()).max(1)
}

fn described(
    task: &DesignTask,
    trials: &mut Trials<'_>,
    demand: &HeldDemand,
    waveform: Waveform,
    white: &white::White,
) -> Result<DesignedExcitation, DesignError> {
    let judged = trials.judged(demand, 0)?;
    let Some(nominal) = task.models.first() else { return Err(DesignError::Task { requirement: "a model is needed" }) };
    let scale: Vec<f64> = task.of_interest.iter().map(|p| Unknown::Model(*p).scale(nominal)).collect();
    let entry = |i: usize, j: usize| judged.covariance[(i, j)] * scale[i] * scale[j];
    let count = scale.len();
    let shaft = demand.peaks_on(task, nominal, repeats(task, demand))?.shaft_torque_nm;
    let parameter = |(i, parameter): (usize, &ModelParameter)| PredictedParameter {
        parameter: *parameter,
        value: nominal.value(*parameter).unwrap_or(f64::NAN),
        standard_error: entry(i, i).sqrt(),
        white_noise_standard_error: white.relative_variance(i, shaft).sqrt() * scale[i],
    };
    let peaks = demand.peaks(task, repeats(task, demand))?;
    Ok(DesignedExcitation {
        waveform,
        parameters: task.of_interest.iter().enumerate().map(parameter).collect(),
        covariance: (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect(),
        binding: peaks.binding(task).1,
        peaks,
        criterion: trials.criterion(demand)?,
    })
}

/// Lines with power, and what the search for it says of itself.
struct BestSpectrum {
    harmonics: Vec<usize>,
    amplitudes: Vec<f64>,
    gap: f64,
    rounds: usize,
}

impl BestSpectrum {
    fn new(task: &DesignTask, trials: &Trials<'_>) -> Result<Self, DesignError> {
        let all = lines(task, task.period_s, task.band_hz).ok_or(DesignError::MissingPart { part: "demand" })?;
        let bands = bands(task, &all);
        if bands.is_empty() {
            return Err(DesignError::Task { requirement: "the band holds no line that the estimator uses" });
        }
        let shares = optimise(&trials.judges, &bands, task.robustness).map_err(|i| not_determined(task, i))?;
        let power = |(band, share): (&spectrum::Band, &f64)| {
            let of = |k: &usize| (harmonic(task, &all[*k]), power_of(&all[*k], *share, band.lines.len()));
            band.lines.iter().map(of).collect::<Vec<(usize, f64)>>()
        };
        let powers: Vec<(usize, f64)> = bands.iter().zip(&shares.share).flat_map(power).collect();
        let strongest = powers.iter().fold(0.0_f64, |m, p| m.max(p.1));
        let kept: Vec<(usize, f64)> = powers.into_iter().filter(|p| p.1 > WEAKEST * strongest).collect();
        Ok(BestSpectrum {
            harmonics: kept.iter().map(|p| p.0).collect(),
            amplitudes: kept.iter().map(|p| (2.0 * p.1).sqrt()).collect(),
            gap: shares.gap,
            rounds: shares.rounds,
        })
    }

    /// Phases under which the limited responses of all models have low peaks.
    fn phases(&self, task: &DesignTask) -> Result<Vec<f64>, DesignError> {
        let limits = task.limits.in_order();
        let mut gains = Vec::new();
        for model in &task.models {
            let mut of_model = vec![Vec::with_capacity(self.harmonics.len()); limits.len()];
            for harmonic in &self.harmonics {
                let omega = std::f64::consts::TAU * *harmonic as f64 / task.period_s;
                let of = signals::limited(task, model, omega).ok_or(DesignError::MissingPart { part: "demand" })?;
                for ((gains, gain), limit) in of_model.iter_mut().zip(of).zip(limits) {
                    gains.extend(limit.map(|l| gain / l));
                }
            }
            gains.extend(of_model.into_iter().filter(|g| !g.is_empty()));
        }
        let responses = Responses { harmonics: self.harmonics.clone(), amplitudes: self.amplitudes.clone(), gains };
        Ok(responses.optimise()?.phases_rad)
    }
}

fn harmonic(task: &DesignTask, line: &Line) -> usize {
    (line.frequency_hz * task.period_s).round() as usize
}
