//! The shaft as people look at it: frequency response, and torque over time on a held-out stretch.

use std::f64::consts::TAU;

use ident::frequency::ORDERS;
use ident::validate::{fit_percent, rms_error};
use rig::estimation::EstimateError;
use rig::results::{MeasuredResponse, Stretch, Trace, Validation};
use signal::Complex64;

use super::equation::{Corrections, Dating};
use super::inputs::ShaftInputs;
use super::spectra::{LOWEST_HZ, Spectra, TAPERED_PART, even_window, highest_hz, tapered, turn_band_hz};
use crate::shaft::places;

/// Bands of the measured frequency response per octave.
const BANDS_PER_OCTAVE: f64 = 6.0;

/// Δω → T_shaft, averaged over bands, beside (K + Bs)/s.
pub(super) fn measured_response(spectra: &Spectra, theta: &[f64]) -> MeasuredResponse {
    let mut response = MeasuredResponse {
        frequencies_hz: Vec::new(),
        measured_gain_db: Vec::new(),
        measured_phase_deg: Vec::new(),
        modelled_gain_db: Vec::new(),
        modelled_phase_deg: Vec::new(),
    };
    let band_of = |k: usize| (spectra.window.frequency_hz(k).log2() * BANDS_PER_OCTAVE).floor() as i64;
    for bins in spectra.bins.chunk_by(|a, b| band_of(*a) == band_of(*b)) {
        let (mut cross, mut power, mut centre) = (Complex64::default(), 0.0, 0.0);
        for k in bins {
            let (difference, shaft_torque) = difference_and_torque(spectra, theta, *k);
            cross += shaft_torque * difference.conj();
            power += difference.norm_sqr();
            centre += spectra.window.frequency_hz(*k) * difference.norm_sqr();
        }
        let (measured, frequency) = (cross / power, centre / power);
        let s = Complex64::new(0.0, TAU * frequency);
        let modelled = theta[places::K] / s + theta[places::B];
        response.frequencies_hz.push(frequency);
        response.measured_gain_db.push(20.0 * measured.norm().log10());
        response.measured_phase_deg.push(measured.arg().to_degrees());
        response.modelled_gain_db.push(20.0 * modelled.norm().log10());
        response.modelled_phase_deg.push(modelled.arg().to_degrees());
    }
    response
}

fn difference_and_torque(spectra: &Spectra, theta: &[f64], k: usize) -> (Complex64, Complex64) {
    let Motion { dyno, engine, torque } = motion(spectra, theta, k);
    (engine[0] - dyno[0], torque[0] + theta[places::INERTIA] * dyno[1] + theta[places::FRICTION] * dyno[0])
}

/// The two sides of the shaft at one frequency, by order of their derivative: timing and once-a-turn errors taken out.
struct Motion {
    dyno: [Complex64; ORDERS],
    engine: [Complex64; ORDERS],
    torque: [Complex64; ORDERS],
}

fn motion(spectra: &Spectra, theta: &[f64], k: usize) -> Motion {
    let factor = Corrections::at(Complex64::new(0.0, TAU * spectra.window.frequency_hz(k)), theta, spectra.dating);
    let [dyno, engine, torque] =
        [places::DYNO, places::ENGINE, places::TORQUE].map(|signal| spectra.signals[signal].at(theta, k));
    Motion {
        dyno: dyno.map(|x| factor.speed * x),
        engine: engine.map(|x| factor.engine * x),
        torque: torque.map(|x| factor.torque * x),
    }
}

/// The engine's side of the shaft at one frequency.
pub(super) struct EngineSide {
    /// s T_shaft.
    pub(super) torque_rate: Complex64,
    /// s² ω_e, s ω_e, ω_e.
    pub(super) regressors: [Complex64; ORDERS],
}

pub(super) fn engine_side(spectra: &Spectra, theta: &[f64], k: usize) -> EngineSide {
    let Motion { dyno, engine, torque } = motion(spectra, theta, k);
    EngineSide {
        torque_rate: torque[1] + theta[places::INERTIA] * dyno[2] + theta[places::FRICTION] * dyno[1],
        regressors: [engine[2], engine[1], engine[0]],
    }
}

/// T_shaft over time, from torque and acceleration on one side and from twist and its rate on the other, both limited
/// to the band of the estimate, the line of the once-a-turn encoder error left out.
pub(super) fn validate(
    inputs: &ShaftInputs<'_>,
    theta: &[f64],
    (from_s, to_s): (f64, f64),
) -> Result<Validation, EstimateError> {
    let signal_error = |source| EstimateError::Signal { file: inputs.file.to_owned(), source };
    let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
    let window = even_window(inputs, from_s, to_s);
    let used = window.bins(LOWEST_HZ, highest_hz(inputs));
    let last = *used.end();
    let transform = |s: &signal::Signal| tapered(s, window, last).map_err(of);
    let (speed, engine) = (transform(inputs.dyno_speed)?, transform(inputs.engine_speed)?);
    let mut torques = vec![Complex64::default(); last + 1];
    for part in &inputs.torque {
        torques.iter_mut().zip(transform(&part.signal)?).for_each(|(sum, t)| *sum += t);
    }
    let dt = inputs.dyno_speed.sample_time_s;
    let length = (window.duration_s / dt).round() as usize;
    let (mut measured, mut modelled) =
        (vec![Complex64::default(); length / 2 + 1], vec![Complex64::default(); length / 2 + 1]);
    let turn = turn_band_hz(&inputs.dyno_speed.slice(from_s, to_s));
    for k in used.filter(|k| !turn.contains(&window.frequency_hz(*k))) {
        let s = Complex64::new(0.0, TAU * window.frequency_hz(k));
        let factor = Corrections::at(s, theta, Dating::default());
        let braking = theta[places::INERTIA] * s + theta[places::FRICTION];
        measured[k] = (braking * factor.speed * speed[k] + factor.torque * torques[k]) / dt;
        let difference = factor.engine * engine[k] - factor.speed * speed[k];
        modelled[k] = (theta[places::K] / s + theta[places::B]) * difference / dt;
    }
    let edge = (TAPERED_PART * length as f64).ceil() as usize;
    let back = |spectrum| -> Result<Vec<f64>, EstimateError> {
        let values = signal::spectrum::inverse_fft_real(spectrum, length).map_err(signal_error)?;
        Ok(values[edge..length - edge].to_vec())
    };
    let (measured, modelled) = (back(measured)?, back(modelled)?);
    let start_s = window.start_s + edge as f64 * dt;
    let trace = |values| Trace { start_s, sample_time_s: dt, values };
    Ok(Validation {
        stretch: Stretch { file: inputs.file.to_owned(), start_s, end_s: start_s + (length - 2 * edge) as f64 * dt },
        quantity: "T_shaft".to_owned(),
        unit: "Nm".to_owned(),
        fit_percent: fit_percent(&measured, &modelled).map_err(of)?,
        rms_error: rms_error(&measured, &modelled).map_err(of)?,
        measured: trace(measured),
        modelled: trace(modelled),
        residuals: None,
    })
}
