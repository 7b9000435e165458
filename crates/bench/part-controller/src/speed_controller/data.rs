//! The signals of a speed controller, stretch by stretch.

use rig::estimation::{EstimateError, liveliest, longest_unsaturated, need, noise_floor};
use rig::results::{DemandLags, Stretch};
use rig::{Experiment, Role};
use signal::Signal;
use signal::spline::UniformSpline;
use signal::updates::{Stale, Staleness, find_stale};

use super::inverse::{self, InverseController};

/// Shortest usable stretch, s.
const SHORTEST_S: f64 = 2.0;
/// Where the estimate's low-pass lies, as a part of the sample rate, and its order (run both ways).
const CUTOFF_PART: f64 = 0.1;
const CUTOFF_ORDER: usize = 4;
/// Rounding of T_d* that reaches this part of the encoder's noise hides the gate.
const COARSE: f64 = 0.4;
/// Rounding that reaches this part of it may look like some of the gate.
const NOTICEABLE: f64 = 0.1;
/// An N_d* whose standard deviation is smaller is constant, rad/s.
pub(super) const LEAST_SPREAD: f64 = 1.0;
/// Time stamps within this part of a sample are of one instant.
const SAME_INSTANT: f64 = 1e-3;

/// One stretch of a recording with the signals the controller sees.
#[derive(Clone)]
pub(super) struct Data {
    pub(super) demand: Signal,
    pub(super) reference: Signal,
    pub(super) speed: Signal,
    pub(super) phase_rad: Vec<f64>,
    /// Terms of the feed-forward beside N_d* and its change, on the clock of `reference`.
    pub(super) further: Vec<Signal>,
    pub(super) stretch: Stretch,
}

impl Data {
    /// The longest stretch below the torque limit; of a long one the minutes in which N_d* moves most, or T_d* where
    /// N_d* is constant.
    pub(super) fn of(experiment: &Experiment, torque_limit_nm: Option<f64>) -> Result<Self, EstimateError> {
        let demand = &at_updates(need(experiment, Role::DynoTorqueDemand)?);
        let reference = need(experiment, Role::DynoSpeedDemand)?;
        let speed = need(experiment, Role::DynoSpeed)?;
        let unsaturated = longest_unsaturated(experiment, torque_limit_nm, SHORTEST_S)?;
        let (from, to) = liveliest(if spread(reference) > LEAST_SPREAD { reference } else { demand }, unsaturated);
        let phase = phase_of(speed);
        let reference = held_on_the_clock_of(demand, reference);
        Ok(Data::cut(&experiment.file, demand, &reference, speed, &phase, (from, to)))
    }

    fn cut(
        file: &str,
        demand: &Signal,
        reference: &Signal,
        speed: &Signal,
        phase_rad: &[f64],
        (from, to): (f64, f64),
    ) -> Self {
        let cut = speed.slice(from, to);
        let first = ((cut.start_s - speed.start_s) / speed.sample_time_s).round() as usize;
        Data {
            demand: demand.slice(from, to),
            reference: reference.slice(from, to),
            phase_rad: phase_rad[first..first + cut.len()].to_vec(),
            speed: cut,
            further: Vec::new(),
            stretch: Stretch { file: file.to_owned(), start_s: from, end_s: to },
        }
    }

    /// The part of this stretch from `from` to `to`.
    pub(super) fn part(&self, window: (f64, f64)) -> Self {
        Data::cut(&self.stretch.file, &self.demand, &self.reference, &self.speed, &self.phase_rad, window)
    }

    /// The middle of this stretch, of at most so many samples of T_d*.
    pub(super) fn middle(&self, samples: usize) -> Self {
        let (from, to) = self.window();
        let half_s = 0.5 * samples as f64 * self.demand.sample_time_s;
        if to - from <= 2.0 * half_s {
            return self.clone();
        }
        let centre = 0.5 * (from + to);
        self.part((centre - half_s, centre + half_s))
    }

    /// The same stretch with all its signals below [`CUTOFF_PART`] of the sample rate, in phase. The model is linear,
    /// so it holds between the filtered signals; what is gone is the noise that rounding puts onto T_d*, which would
    /// otherwise make smoother interpolation, a longer gate, look better.
    pub(super) fn smoothed(&self) -> Result<Self, EstimateError> {
        // One low-pass for all: of signals that went through different ones the model would not hold.
        let cutoff = CUTOFF_PART / self.demand.sample_time_s.max(self.speed.sample_time_s);
        let smooth = |signal: &Signal| -> Result<Signal, EstimateError> {
            let filter = signal::Sos::butterworth_lowpass(CUTOFF_ORDER, cutoff, signal.sample_time_s)
                .map_err(|e| signal_error(&self.stretch.file, e))?;
            Ok(signal.with_samples(filter.filtfilt(&signal.samples).map_err(|e| signal_error(&self.stretch.file, e))?))
        };
        Ok(Data {
            demand: smooth(&self.demand)?,
            reference: smooth(&self.reference)?,
            speed: smooth(&self.speed)?,
            phase_rad: self.phase_rad.clone(),
            further: self.further.iter().map(smooth).collect::<Result<_, _>>()?,
            stretch: self.stretch.clone(),
        })
    }

    /// The step of T_d* where its rounding puts noise onto the speed error that can be mistaken for a gate.
    pub(super) fn coarse_demand_nm(&self) -> Result<Option<f64>, EstimateError> {
        Ok((self.rounding()? > COARSE).then(|| resolution(&self.demand.samples)))
    }

    /// Tells whether rounding of T_d* may look like some of the gate.
    pub(super) fn is_rounding_noticeable(&self) -> Result<bool, EstimateError> {
        Ok(self.rounding()? > NOTICEABLE)
    }

    /// Noise on the speed error by rounding of T_d*, as a part of the encoder's.
    fn rounding(&self) -> Result<f64, EstimateError> {
        let step = resolution(&self.demand.samples);
        Ok(step / 12f64.sqrt() * starting_point(self)?[inverse::P] / noise_floor(&self.speed))
    }

    pub(super) fn window(&self) -> (f64, f64) {
        (self.stretch.start_s, self.stretch.end_s)
    }

    pub(super) fn model(&self, lags: DemandLags, free: &dyn Fn(usize) -> bool) -> InverseController {
        let (demand, reference, speed) = (&self.demand, &self.reference, &self.speed);
        InverseController::new(demand, reference, &self.further, speed, &self.phase_rad, lags, free)
    }
}

/// The smallest difference between values that are not equal; zero if all are.
fn resolution(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    // Equal register values may differ in the last bits.
    let span = sorted.last().unwrap_or(&0.0) - sorted.first().unwrap_or(&0.0);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-9 * span);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// T_d* at the instants at which the controller computes it: a raster that is faster than the controller holds each
/// value.
pub(super) fn at_updates(demand: &Signal) -> Signal {
    let Some(Stale { how: Staleness::Held { every }, samples }) = find_stale(&demand.samples) else {
        return demand.clone();
    };
    let first = samples.iter().take(every).position(|is_stale| !is_stale).unwrap_or(0);
    Signal {
        start_s: demand.time_s(first),
        sample_time_s: demand.sample_time_s * every as f64,
        samples: demand.samples.iter().skip(first).step_by(every).copied().collect(),
    }
}

/// A demand at the samples of another, each held until its next: both may be recorded on rasters of their own.
pub(super) fn held_on_the_clock_of(other: &Signal, demand: &Signal) -> Signal {
    let last = demand.len().saturating_sub(1);
    let value = |k: usize| {
        let place = (other.time_s(k) - demand.start_s) / demand.sample_time_s;
        demand.samples.get(((place + SAME_INSTANT).max(0.0) as usize).min(last)).copied().unwrap_or_default()
    };
    other.with_samples((0..other.len()).map(value).collect())
}

/// Standard deviation of a signal, in its unit.
pub(super) fn spread(signal: &Signal) -> f64 {
    let mean = signal.mean().unwrap_or(0.0);
    (signal.samples.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / signal.len() as f64).sqrt()
}

/// Shaft angle turned by the end of each sample's gate, zero before the first.
fn phase_of(speed: &Signal) -> Vec<f64> {
    let mut angle = 0.0;
    let advance = |w: &f64| {
        angle += w * speed.sample_time_s;
        angle
    };
    speed.samples.iter().map(advance).collect()
}

/// T_d* regressed on the speed error and its integral: biased by the encoder's noise, good enough to start from.
pub(super) fn starting_point(data: &Data) -> Result<Vec<f64>, EstimateError> {
    let spline = UniformSpline::new(data.speed.samples.clone()).map_err(|e| signal_error(&data.stretch.file, e))?;
    let n = data.demand.len();
    let mut integral = 0.0;
    let mut regressors = faer::Mat::zeros(n, 3);
    for k in 0..n {
        let at = (data.demand.time_s(k) - data.speed.start_s) / data.speed.sample_time_s;
        let error = spline.value(at) - data.reference.samples[k.saturating_sub(1)];
        (regressors[(k, 0)], regressors[(k, 1)], regressors[(k, 2)]) = (error, integral, 1.0);
        integral += error * data.demand.sample_time_s;
    }
    let rough =
        ident::least_squares(regressors.as_ref(), &data.demand.samples).map_err(|source| ident_error(data, source))?;
    let mut start = vec![0.0; inverse::COUNT];
    let k_p = rough.parameters[0].max(1e-3);
    start[inverse::P] = 1.0 / k_p;
    start[inverse::Q] = (rough.parameters[1] * data.demand.sample_time_s / k_p).clamp(1e-6, 0.5);
    start[inverse::FIRST_ERROR] = regressors[(0, 0)];
    start[inverse::LEAD] = 0.5;
    start[inverse::GATE_SQUARED] = 1.0;
    Ok(start)
}

pub(super) fn ident_error(data: &Data, source: ident::IdentError) -> EstimateError {
    EstimateError::Ident { file: data.stretch.file.clone(), source }
}

pub(super) fn signal_error(file: &str, source: signal::SignalError) -> EstimateError {
    EstimateError::Signal { file: file.to_owned(), source }
}
