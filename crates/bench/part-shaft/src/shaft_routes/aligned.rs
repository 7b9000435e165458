//! Speeds and torque on one clock, that of N_d, as the encoder of N_d sees all of them.

use rig::estimation::EstimateError;
use rig::results::Stretch;
use signal::Signal;
use signal::resample::{Interpolation, interpolate_at};

use crate::shaft::ShaftInputs;

/// Left out at each end of a recording, s: room for the skews and for the interpolation.
const MARGIN_S: f64 = 0.1;
/// A torque record is taken as straight between instants no further apart than this, s.
const FINE_S: f64 = 0.25e-3;
/// Instants a sample over which the torque's mean is taken.
const INSTANTS: usize = 8;

/// By how much signals are dated earlier than recorded, s, and the encoders' gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clocks {
    pub(super) engine_s: f64,
    pub(super) torque_s: f64,
    pub(super) gate_s: f64,
}

/// ω_d, ω_e and T_d at the instants of N_d.
///
/// A speed is the mean over a gate that ends at its time stamp. The torque is given the same mean, so that every linear
/// equation between the motion and the torque holds between what is here, without any correction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Aligned {
    pub(super) start_s: f64,
    pub(super) sample_time_s: f64,
    pub(super) dyno: Vec<f64>,
    pub(super) engine: Vec<f64>,
    pub(super) torque: Vec<f64>,
}

/// Meaning of a torque's sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TorqueSample {
    /// Its value at the instant.
    Momentary,
    /// Its mean until the next instant, samples being about so many seconds apart.
    HeldFor(f64),
}

impl Aligned {
    /// The signals over a stretch.
    ///
    /// # Errors
    /// Signals that cannot be interpolated.
    pub(super) fn new(
        inputs: &ShaftInputs<'_>,
        stretch: &Stretch,
        clocks: Clocks,
        kind: TorqueSample,
    ) -> Result<Self, EstimateError> {
        let error = |source| EstimateError::Signal { file: inputs.file.to_owned(), source };
        let mut dyno = inputs.dyno_speed.slice(stretch.start_s, stretch.end_s);
        if let TorqueSample::HeldFor(sample_time_s) = kind {
            let every = (sample_time_s / dyno.sample_time_s).round().max(1.0) as usize;
            dyno.samples = dyno.samples.into_iter().step_by(every).collect();
            dyno.sample_time_s *= every as f64;
        }
        let times: Vec<f64> = (0..dyno.len()).map(|i| dyno.time_s(i)).collect();
        let late = |by: f64| times.iter().map(|t| t + by).collect::<Vec<f64>>();
        let engine =
            interpolate_at(inputs.engine_speed, &late(clocks.engine_s), Interpolation::BandLimited).map_err(error)?;
        let mut torque = vec![0.0; times.len()];
        for record in &inputs.torque {
            let means = Means::of(&record.signal).map_err(error)?;
            for (sum, t) in torque.iter_mut().zip(late(clocks.torque_s)) {
                *sum += match kind {
                    TorqueSample::Momentary => means.gated(t, clocks.gate_s),
                    TorqueSample::HeldFor(_) => means.held(t, dyno.sample_time_s, clocks.gate_s),
                };
            }
        }
        Ok(Aligned { start_s: dyno.start_s, sample_time_s: dyno.sample_time_s, dyno: dyno.samples, engine, torque })
    }
}

/// The stretch that all signals share, without its ends.
///
/// # Errors
/// It is too short.
pub(super) fn inner_stretch(inputs: &ShaftInputs<'_>) -> Result<Stretch, EstimateError> {
    let stretch = inputs.stretch()?;
    Ok(Stretch { start_s: stretch.start_s + MARGIN_S, end_s: stretch.end_s - MARGIN_S, ..stretch })
}

/// ω cos θ and ω sin θ: what a once-a-turn error of its encoder adds to a speed.
pub(super) fn once_a_turn(speed: &[f64], sample_time_s: f64) -> [Vec<f64>; 2] {
    let mut angle = 0.0;
    let waves = speed.iter().map(|omega| {
        angle += omega * sample_time_s;
        let (sin, cos) = f64::sin_cos(angle);
        (omega * cos, omega * sin)
    });
    let (cosine, sine) = waves.unzip();
    [cosine, sine]
}

/// The integral of a record that is straight between its samples.
struct Means {
    record: Signal,
    integral: Vec<f64>,
}

impl Means {
    fn of(torque: &Signal) -> Result<Self, signal::SignalError> {
        let parts = (torque.sample_time_s / FINE_S).ceil().max(1.0) as usize;
        let record = if parts == 1 { torque.clone() } else { finer(torque, parts)? };
        let mut integral = vec![0.0; record.len()];
        for i in 1..record.len() {
            let step = 0.5 * (record.samples[i - 1] + record.samples[i]) * record.sample_time_s;
            integral[i] = integral[i - 1] + step;
        }
        Ok(Means { record, integral })
    }

    fn integral_to(&self, time_s: f64) -> f64 {
        let last = self.record.len().saturating_sub(2) as f64;
        let position = (time_s - self.record.start_s) / self.record.sample_time_s;
        let i = position.floor().clamp(0.0, last) as usize;
        let (x, left, right) = (position - i as f64, self.record.samples[i], self.record.samples[i + 1]);
        self.integral[i] + self.record.sample_time_s * x * (left + 0.5 * x * (right - left))
    }

    /// The mean over the gate before an instant.
    fn gated(&self, time_s: f64, gate_s: f64) -> f64 {
        let gate_s = gate_s.max(1e-2 * self.record.sample_time_s);
        (self.integral_to(time_s) - self.integral_to(time_s - gate_s)) / gate_s
    }

    /// The mean of [`Means::gated`] over the sample after an instant.
    fn held(&self, time_s: f64, sample_time_s: f64, gate_s: f64) -> f64 {
        let instant = |i: usize| time_s + sample_time_s * (i as f64 + 0.5) / INSTANTS as f64;
        (0..INSTANTS).map(|i| self.gated(instant(i), gate_s)).sum::<f64>() / INSTANTS as f64
    }
}

/// A band-limited record at more instants.
fn finer(torque: &Signal, parts: usize) -> Result<Signal, signal::SignalError> {
    let sample_time_s = torque.sample_time_s / parts as f64;
    let count = (torque.len().saturating_sub(1)) * parts + 1;
    let times: Vec<f64> = (0..count).map(|i| torque.start_s + i as f64 * sample_time_s).collect();
    Signal::new(torque.start_s, sample_time_s, interpolate_at(torque, &times, Interpolation::BandLimited)?)
}
