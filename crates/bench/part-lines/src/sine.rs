//! Gains measured by sine tests, and the engine's part in them.

use std::f64::consts::{PI, TAU};

use bench_model::analysis::SinePoint;
use bench_model::model::BenchModel;
use bench_model::skews::SignalSkews;
use faer::Mat;
use rig::estimation::EstimateError;
use rig::facts::Engine;
use rig::{Experiment, Role};
use signal::resample::{Interpolation, fractional_delay, interpolate_at};
use signal::{Complex64, Signal, Sos};

use crate::segments::{Segment, steady_sines};

/// Left out at the start of a sine while the bench settles: this part of it, at least so many seconds.
const SETTLING_PART: f64 = 0.25;
const SETTLING_S: f64 = 0.3;
/// Left out at its end, whose instant is known to a window's hop.
const END_S: f64 = 0.2;
/// Frequencies on each side, in bins of the stretch, whose noise gives the standard error.
const NEIGHBOURS: std::ops::RangeInclusive<i32> = 2..=6;
/// A sine is at an engine order when closer than this many bins.
const ORDER_BINS: f64 = 1.0;
/// Edges of the band-pass of (7.1), as factors of the frequency.
const BAND: f64 = 1.189_207_115_002_721; // 2^(1/4)

/// A recording of sines of T_d* in torque control.
#[derive(Debug, Clone, Copy)]
pub struct SineTest<'a> {
    /// The recording.
    pub experiment: &'a Experiment,
    /// T_d, reconstructed more finely than T_d,calc was recorded; T_d,calc where `None`.
    pub air_gap_torque: Option<&'a Signal>,
    /// Skews.
    pub skews: SignalSkews,
}

/// Gains T_shaft/T_d at each steady sine of T_d*, with what (7.2) says and what the engine did.
///
/// Amplitudes are by least squares on cos, sin, constant and slope over whole periods, and on cos and sin of the engine
/// orders that can be separated from the sine, which would leak into it; T_shaft = J_d dω_d/dt + T_d (6.1)
/// with N_d freed of its gate, or the flange's torque where there is one. The standard error comes from the noise of
/// T_shaft − G T_d at frequencies beside the sine (its median, so that a stray line does no harm).
///
/// (7.2) takes T_e as constant. It is not when the engine's governor answers the changing speed or when the sine meets
/// an engine order. T_e = J_e dω_e/dt + T_shaft (6.4) shows what acted, and
/// T_shaft/T_d = (H_d H_s + H_e H_s T_e/T_d)/(1 + H_s (H_d + H_e)) what the model makes of it; the measured gain less
/// the second term can be drawn on the curve of (7.2). What remains between the two tests shaft and inertias, not the
/// engine.
///
/// # Errors
/// N_d, T_d* or T_d is missing, or a signal cannot be processed.
pub fn sine_points(model: &BenchModel, engine: Engine, test: &SineTest<'_>) -> Result<Vec<SinePoint>, EstimateError> {
    let signals = Signals::new(model, test)?;
    let demand = needed(test.experiment, Role::DynoTorqueDemand)?;
    let mut points = Vec::new();
    for segment in steady_sines(demand) {
        let Some(stretch) = settled(&segment) else { continue };
        if signals.covers(&stretch) {
            points.push(signals.point(engine, &segment, &stretch)?);
        }
    }
    Ok(points)
}

fn needed(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    let missing = || EstimateError::MissingSignal { file: experiment.file.clone(), role };
    experiment.signal(role).ok_or_else(missing)
}

/// The settled part, of whole periods, that ends where the sine does.
fn settled(segment: &Segment) -> Option<Segment> {
    let end_s = segment.end_s - END_S;
    let start_s = segment.start_s + (SETTLING_PART * (segment.end_s - segment.start_s)).max(SETTLING_S);
    let periods = ((end_s - start_s) * segment.frequency_hz + 1e-6).floor();
    (periods >= 1.0).then(|| Segment { start_s: end_s - periods / segment.frequency_hz, end_s, ..*segment })
}

struct Signals<'a> {
    model: &'a BenchModel,
    file: &'a str,
    dyno: &'a Signal,
    engine: Option<&'a Signal>,
    torque: &'a Signal,
    flange: Option<&'a Signal>,
    skews: SignalSkews,
}

/// Complex amplitudes at one frequency, all on the clock of N_d's middle of the gate.
struct Amplitudes {
    torque: Complex64,
    shaft: Complex64,
    engine_torque: Option<Complex64>,
}

impl<'a> Signals<'a> {
    fn new(model: &'a BenchModel, test: &SineTest<'a>) -> Result<Self, EstimateError> {
        let torque = match test.air_gap_torque {
            Some(torque) => torque,
            None => needed(test.experiment, Role::AirGapTorque)?,
        };
        Ok(Signals {
            model,
            file: &test.experiment.file,
            dyno: needed(test.experiment, Role::DynoSpeed)?,
            engine: test.experiment.signal(Role::EngineSpeed),
            torque,
            flange: test.experiment.signal(Role::FlangeTorque),
            skews: test.skews,
        })
    }

    fn covers(&self, stretch: &Segment) -> bool {
        let all = [Some(self.dyno), self.engine, Some(self.torque), self.flange];
        all.into_iter().flatten().all(|x| x.start_s <= stretch.start_s && x.end_s() >= stretch.end_s)
    }

    fn point(&self, engine: Engine, segment: &Segment, stretch: &Segment) -> Result<SinePoint, EstimateError> {
        let (f, resolution) = (stretch.frequency_hz, 1.0 / (stretch.end_s - stretch.start_s));
        let omega = TAU * f;
        let cut = self.cut(stretch);
        let turns_hz = cut.dyno.mean().unwrap_or(0.0) / TAU;
        let mut waves = vec![f];
        let (near, lines): (Vec<f64>, Vec<f64>) =
            engine.orders().iter().map(|order| order * turns_hz).partition(|l| (f - l).abs() < ORDER_BINS * resolution);
        waves.extend(lines);
        let at = cut.amplitudes(self, &|x| fitted_amplitude(x, &waves).map_err(|source| self.ident(source)), omega)?;
        let ratio = at.shaft / at.torque;
        let plain = self.model.mechanics.torque_to_shaft(omega);
        let through_engine = at.engine_torque.map(|e| self.model.mechanics.engine_to_shaft(omega) * e / at.torque);
        Ok(SinePoint {
            frequency_hz: f,
            gain: ratio.norm(),
            standard_error: self.standard_error(&cut, stretch, &waves, ratio)? / at.torque.norm(),
            band_pass_gain: self.band_pass_gain(segment, stretch)?,
            model_gain: plain.norm(),
            model_gain_with_engine: through_engine.map(|q| (plain + q).norm()),
            gain_corrected_for_engine: through_engine.map(|q| (ratio - q).norm()),
            at_engine_order: !near.is_empty(),
            file: self.file.to_owned(),
        })
    }

    fn cut(&self, stretch: &Segment) -> Cut {
        let slice = |x: &Signal| x.slice(stretch.start_s, stretch.end_s);
        Cut {
            dyno: slice(self.dyno),
            engine: self.engine.map(slice),
            torque: slice(self.torque),
            flange: self.flange.map(slice),
        }
    }

    /// √(half the mean of |T_shaft − G T_d|²) at the neighbouring frequencies, Nm. The squares are exponentially
    /// distributed, so their mean is their median over ln 2.
    fn standard_error(
        &self,
        cut: &Cut,
        stretch: &Segment,
        waves: &[f64],
        ratio: Complex64,
    ) -> Result<f64, EstimateError> {
        let residual = cut.without_waves(waves).map_err(|source| self.ident(source))?;
        let resolution = 1.0 / (stretch.end_s - stretch.start_s);
        let mut squares = Vec::new();
        for bin in NEIGHBOURS.flat_map(|k| [-k, k]) {
            let f = stretch.frequency_hz + f64::from(bin) * resolution;
            if f < 0.5 * resolution {
                continue;
            }
            let beside = residual.amplitudes(self, &|x| Ok(fourier_amplitude(x, f)), TAU * f)?;
            squares.push((beside.shaft - ratio * beside.torque).norm_sqr());
        }
        squares.sort_by(f64::total_cmp);
        let median = 0.5 * (squares[(squares.len() - 1) / 2] + squares[squares.len() / 2]);
        Ok((0.5 * median / std::f64::consts::LN_2).sqrt())
    }

    /// The thesis's way: both torques through a zero-phase band-pass, A = √2·RMS (7.1), ratio of amplitudes.
    fn band_pass_gain(&self, segment: &Segment, stretch: &Segment) -> Result<f64, EstimateError> {
        let signal_error = |source| EstimateError::Signal { file: self.file.to_owned(), source };
        let filtered = |x: &Signal| {
            let x = x.slice(segment.start_s, segment.end_s);
            let band = Sos::butterworth_bandpass(
                2,
                segment.frequency_hz / BAND,
                segment.frequency_hz * BAND,
                x.sample_time_s,
            )?;
            Ok(x.with_samples(band.filtfilt(&x.samples)?))
        };
        let speed = filtered(self.dyno).map_err(signal_error)?;
        let torque = filtered(self.torque).map_err(signal_error)?;
        let torque =
            fractional_delay(&torque, -self.skews.torque_s, Interpolation::BandLimited).map_err(signal_error)?;
        let slope =
            signal::derivative::central_difference(&speed.samples, speed.sample_time_s).map_err(signal_error)?;
        let used: Vec<usize> = (0..speed.len())
            .filter(|i| speed.time_s(*i) >= stretch.start_s && speed.time_s(*i) < stretch.end_s.min(torque.end_s()))
            .collect();
        let times: Vec<f64> = used.iter().map(|i| speed.time_s(*i)).collect();
        let torque = interpolate_at(&torque, &times, Interpolation::BandLimited).map_err(signal_error)?;
        let inertia = self.model.mechanics.dyno_inertia_kg_m2;
        let shaft = used.iter().zip(&torque).map(|(i, t)| (inertia * slope[*i] + t).powi(2)).sum::<f64>();
        let squares = torque.iter().map(|t| t * t).sum::<f64>();
        Ok((shaft / squares).sqrt())
    }

    fn ident(&self, source: fitting::IdentError) -> EstimateError {
        EstimateError::Ident { file: self.file.to_owned(), source }
    }
}

/// The signals over one stretch.
struct Cut {
    dyno: Signal,
    engine: Option<Signal>,
    torque: Signal,
    flange: Option<Signal>,
}

impl Cut {
    /// Amplitudes at `omega_rad_s`, each signal's by `measure`, aligned and freed of the gate.
    fn amplitudes(
        &self,
        signals: &Signals<'_>,
        measure: &dyn Fn(&Signal) -> Result<Complex64, EstimateError>,
        omega_rad_s: f64,
    ) -> Result<Amplitudes, EstimateError> {
        let mechanics = signals.model.mechanics;
        let half = 0.5 * omega_rad_s * signals.model.encoder_gate_s;
        let gate = if half > 0.0 && half < PI { half.sin() / half } else { 1.0 };
        let earlier = |skew_s: f64| Complex64::cis(omega_rad_s * skew_s);
        let derivative = Complex64::new(0.0, omega_rad_s) / gate;
        let torque = measure(&self.torque)? * earlier(signals.skews.torque_s);
        let shaft = match &self.flange {
            Some(flange) => measure(flange)?,
            None => derivative * mechanics.dyno_inertia_kg_m2 * measure(&self.dyno)? + torque,
        };
        let engine_torque = match &self.engine {
            Some(engine) => {
                let speed = measure(engine)? * earlier(signals.skews.engine_speed_s);
                Some(derivative * mechanics.engine_inertia_kg_m2 * speed + shaft)
            }
            None => None,
        };
        Ok(Amplitudes { torque, shaft, engine_torque })
    }

    /// Rest of the signals when the waves, constant and slope are taken away.
    fn without_waves(&self, waves: &[f64]) -> Result<Cut, fitting::IdentError> {
        let rest = |x: &Signal| {
            let regressors = regressors(x, waves);
            let fit = fitting::least_squares(regressors.as_ref(), &x.samples)?;
            let value = |i: usize| fit.parameters.iter().enumerate().map(|(j, p)| regressors[(i, j)] * p).sum::<f64>();
            Ok::<_, fitting::IdentError>(x.with_samples((0..x.len()).map(|i| x.samples[i] - value(i)).collect()))
        };
        Ok(Cut {
            dyno: rest(&self.dyno)?,
            engine: None,
            torque: rest(&self.torque)?,
            flange: self.flange.as_ref().map(rest).transpose()?,
        })
    }
}

/// cos ωt and −sin ωt of each wave below the Nyquist frequency, 1, t − t̄: the first two coefficients are real and
/// imaginary part of Y in Re(Y e^{jωt}) of the first wave.
fn regressors(x: &Signal, waves_hz: &[f64]) -> Mat<f64> {
    let middle = 0.5 * (x.start_s + x.end_s());
    let waves: Vec<f64> = waves_hz.iter().copied().filter(|f| *f < 0.9 * x.nyquist_hz()).collect();
    Mat::from_fn(x.len(), 2 * waves.len() + 2, |i, j| {
        let t = x.time_s(i);
        match waves.get(j / 2) {
            Some(f) if j % 2 == 0 => (TAU * f * t).cos(),
            Some(f) => -(TAU * f * t).sin(),
            None if j % 2 == 0 => 1.0,
            None => t - middle,
        }
    })
}

fn fitted_amplitude(x: &Signal, waves_hz: &[f64]) -> Result<Complex64, fitting::IdentError> {
    let fit = fitting::least_squares(regressors(x, waves_hz).as_ref(), &x.samples)?;
    Ok(Complex64::new(fit.parameters[0], fit.parameters[1]))
}

/// (2/N) Σ x e^{−jωt}.
fn fourier_amplitude(x: &Signal, frequency_hz: f64) -> Complex64 {
    let sum: Complex64 =
        x.samples.iter().enumerate().map(|(i, v)| Complex64::cis(-TAU * frequency_hz * x.time_s(i)) * *v).sum();
    sum * (2.0 / x.len() as f64)
}
