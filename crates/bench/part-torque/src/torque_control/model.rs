//! The air-gap torque as a model that other estimates use.

use bench_model::drive_ripple::{DriveRipple, RippleLine};
use faer::Mat;
use ident::validate::ResidualTest;
use ident::{Bounds, Dataset, IdentError};
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};
use signal::spectrum::fft_real;
use signal::{Complex64, Signal};

use super::held::{HeldDemand, Mode};
use super::observed::{Observed, demand_at, usable_samples};
use super::ripple::stands_still;
use super::rippled::{DelayAndLag, RippledModel};
use super::search::fit_with_lines;

/// Lags of the residual tests.
pub(super) const LAGS: usize = 25;
/// Level of the residual tests.
pub(super) const LEVEL: f64 = 0.99;
/// A line is looked for again within this distance of where it was, Hz: drives and mains drift.
const DRIFT_HZ: f64 = 0.5;

/// Residuals of a model of T_d,calc.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ResidualStatistics {
    /// Standard deviation, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_deviation_nm: f64,
    /// Sample time, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// True where the residuals pass Ljung and Box's test of whiteness at 99 % over lags 1 to 25.
    pub white: bool,
}

/// T_d = o + m (1 + Σ_l (p_l cos φ_l + q_l sin φ_l)) + Σ_l (v_l cos φ_l + w_l sin φ_l), m = e^{−sτ} a/(s + a) T_d*.
///
/// T_d* is held between its samples and limited to the torque limit; φ_l = 2πf_l(t − t_ref). The model is exact at
/// every instant, not only at those of T_d,calc. The ripple holds for one recording only, since its phase is arbitrary:
/// see [`AirGapTorqueModel::refit_ripple`]. Lines beyond half the sample rate of T_d,calc appear at their alias.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AirGapTorqueModel {
    /// τ, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub delay_s: f64,
    /// a, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub lag_rad_s: f64,
    /// Offset and ripple.
    #[serde(flatten)]
    pub ripple: DriveRipple,
    /// Limit of the demand, Nm.
    pub torque_limit_nm: Option<f64>,
    /// Residuals of T_d,calc on the data the model was fitted to.
    pub residual: ResidualStatistics,
}

impl AirGapTorqueModel {
    /// The model of a torque control that is known, with the lines of a ripple that has no size yet: a recording gives
    /// it ([`AirGapTorqueModel::refit_ripple`]).
    pub fn known(delay_s: f64, lag_rad_s: f64, ripple_hz: &[f64], torque_limit_nm: Option<f64>) -> Self {
        let line =
            |frequency_hz: &f64| RippleLine { frequency_hz: *frequency_hz, additive_nm: [0.0; 2], relative: [0.0; 2] };
        AirGapTorqueModel {
            delay_s,
            lag_rad_s,
            ripple: DriveRipple { lines: ripple_hz.iter().map(line).collect(), ..DriveRipple::default() },
            torque_limit_nm,
            residual: ResidualStatistics { standard_deviation_nm: 0.0, sample_time_s: 0.0, white: true },
        }
    }

    /// The model's T_d at the instants of the demand, ripple included, from the present and the past of the demand. The
    /// demand's first value is taken to have stood before.
    ///
    /// Returns as many samples as given; Nm in, Nm out.
    pub fn air_gap_torque(&self, demand: &Signal) -> Signal {
        self.finer_air_gap_torque(demand, 1)
    }

    /// [`AirGapTorqueModel::air_gap_torque`] at `finer` times as many instants. Behind a demand that jumps, T_d holds
    /// frequencies beyond half the demand's rate, which fold back where it is taken at the demand's instants alone.
    pub fn finer_air_gap_torque(&self, demand: &Signal, finer: usize) -> Signal {
        let sample_time_s = demand.sample_time_s / finer as f64;
        let times: Vec<f64> = (0..demand.len() * finer).map(|i| demand.start_s + i as f64 * sample_time_s).collect();
        let samples = self.torque_at(&HeldDemand::new(demand, self.torque_limit_nm), &times);
        Signal { start_s: demand.start_s, sample_time_s, samples }
    }

    /// The same delay and lag with offset and ripple (amplitudes, phases, and frequencies within 0.5 Hz) fitted to
    /// another recording, where T_d* is `demand` and T_d,calc is `t_calc`, Nm.
    ///
    /// # Errors
    /// Samples that are not finite, or too few that are usable.
    pub fn refit_ripple(&self, demand: &Signal, t_calc: &Signal) -> Result<AirGapTorqueModel, IdentError> {
        crate::torque_control::observed::check_finite("T_d*", &demand.samples)?;
        crate::torque_control::observed::check_finite("T_d,calc", &t_calc.samples)?;
        let usable = usable_samples(demand, t_calc, self.torque_limit_nm);
        let observed = Observed::new(t_calc, &usable, 0..t_calc.len());
        let held = HeldDemand::new(demand, self.torque_limit_nm);
        let response = [self.delay_s, self.lag_rad_s];
        let fixed = response.map(|p| Bounds::new(p, p));
        let mut model = RippledModel::new(DelayAndLag::new(&held), &observed);
        let frequencies = self.find_lines_again(&held, &observed)?;
        let fit = fit_with_lines(&mut model, &response, &fixed, &frequencies)?;
        let residual = statistics(&fit.residuals, &observed)?;
        Ok(AirGapTorqueModel { ripple: model.ripple(&fit.parameters), residual, ..self.clone() })
    }

    /// The frequencies near the known ones at which the residuals without ripple have most power.
    fn find_lines_again(&self, held: &HeldDemand, observed: &Observed) -> Result<Vec<f64>, IdentError> {
        let smooth = AirGapTorqueModel { ripple: DriveRipple::default(), ..self.clone() };
        let modelled = smooth.torque_at(held, &observed.times_s);
        let mut errors: Vec<f64> = observed.values.iter().zip(&modelled).map(|(y, m)| y - m).collect();
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        errors.iter_mut().for_each(|e| *e -= mean);
        let (Some(first), Some(last)) = (observed.places.first(), observed.places.last()) else {
            return Err(IdentError::TooFewSamples { samples: 0, parameters: 1 });
        };
        // Without the samples that may not be used, on a grid of a quarter of the resolution or finer.
        let mut raster = vec![0.0; (4 * (last - first + 1)).next_power_of_two()];
        observed.places.iter().zip(&errors).for_each(|(place, error)| raster[place - first] = *error);
        let bins_per_hz = raster.len() as f64 * observed.sample_time_s;
        let spectrum = fft_real(&raster)?;
        let known = self.ripple.lines.iter().map(|line| line.frequency_hz);
        let seen = known.filter(|frequency_hz| !stands_still(*frequency_hz, observed.sample_time_s));
        Ok(seen.map(|frequency_hz| strongest_near(&spectrum, bins_per_hz, frequency_hz)).collect())
    }

    /// Lines of the ripple that samples of T_d,calc so far apart fold to zero frequency: what the torque does there by
    /// itself, they do not show.
    pub(crate) fn unseen_lines_hz(&self, sample_time_s: f64) -> Vec<f64> {
        let lines = self.ripple.lines.iter().map(|line| line.frequency_hz);
        lines.filter(|frequency_hz| stands_still(*frequency_hz, sample_time_s)).collect()
    }

    /// T_d at any instants.
    pub(crate) fn torque_at(&self, held: &HeldDemand, times_s: &[f64]) -> Vec<f64> {
        let mut mode = Mode::new(held);
        mode.set_rate(Complex64::from(self.lag_rad_s));
        times_s.iter().map(|t| self.with_ripple(mode.at(*t, self.delay_s).value.re, *t)).collect()
    }

    /// Offset and ripple upon a torque without them.
    pub(super) fn with_ripple(&self, torque_nm: f64, time_s: f64) -> f64 {
        let (relative, added_nm) = self.ripple.at(time_s);
        torque_nm + (added_nm + torque_nm * relative)
    }

    /// A torque with offset and ripple taken off.
    pub(crate) fn without_ripple(&self, torque_nm: f64, time_s: f64) -> f64 {
        let (relative, added_nm) = self.ripple.at(time_s);
        (torque_nm - added_nm) / (1.0 + relative)
    }
}

/// The frequency within [`DRIFT_HZ`] of `about_hz` where a spectrum, that of a raster of even length, has most power;
/// it may be beyond half the raster's rate.
fn strongest_near(spectrum: &[Complex64], bins_per_hz: f64, about_hz: f64) -> f64 {
    let length = 2 * (spectrum.len() - 1);
    let power = |bin: &i64| {
        let within = bin.rem_euclid(length as i64) as usize;
        spectrum[within.min(length - within)].norm_sqr()
    };
    let (middle, reach) = ((about_hz * bins_per_hz).round() as i64, (DRIFT_HZ * bins_per_hz).ceil() as i64);
    let bins = middle - reach..=middle + reach;
    // Mirrored at half the rate, two have the same power.
    let nearer = |a: &i64, b: &i64| (b - middle).abs().cmp(&(a - middle).abs());
    bins.max_by(|a, b| power(a).total_cmp(&power(b)).then_with(|| nearer(a, b)))
        .map_or(about_hz, |bin| bin as f64 / bins_per_hz)
}

/// Statistics of residuals; whiteness is tested on the longest stretch without a missing sample.
///
/// # Errors
/// Fewer samples than the test needs.
pub(super) fn statistics(residuals: &[f64], observed: &Observed) -> Result<ResidualStatistics, IdentError> {
    let run = observed.longest_run();
    let part = &residuals[run];
    let alone =
        Dataset::new(observed.sample_time_s, Mat::zeros(part.len(), 0), Mat::from_fn(part.len(), 1, |t, _| part[t]))?;
    let report = ResidualTest { lags: LAGS, level: LEVEL, ..Default::default() }.run_on_residuals(&alone)?;
    let mean_square = residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len().max(1) as f64;
    Ok(ResidualStatistics {
        standard_deviation_nm: mean_square.sqrt(),
        sample_time_s: observed.sample_time_s,
        white: report.joint_whiteness.passes(LEVEL),
    })
}

/// A torque that follows the demand after a pure delay, with offset and ripple.
#[derive(Debug, Clone)]
pub(super) struct PureDelay {
    pub(super) delay_s: f64,
    pub(super) dressing: AirGapTorqueModel,
}

impl PureDelay {
    pub(super) fn torque_at(&self, held: &HeldDemand, times_s: &[f64]) -> Vec<f64> {
        let late: Vec<f64> = times_s.iter().map(|t| t - self.delay_s).collect();
        demand_at(held, &late).iter().zip(times_s).map(|(u, t)| self.dressing.with_ripple(*u, *t)).collect()
    }
}
