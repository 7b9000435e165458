//! From records on three clocks to transforms on one grid of frequencies.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use ident::IdentError;
use ident::frequency::{Equation, Modulated, NoisySpectrum, Samples, ShapedError, Window, samples_in};
use rig::estimation::EstimateError;
use signal::{Complex64, Signal};

use super::equation::{Dating, ShaftEquation};
use super::inputs::{LARGEST_SKEW_S, ShaftInputs};
use super::places::{DYNO_TURN, ENGINE_TURN};

/// Lowest frequency used, Hz: below it the recording holds too few periods.
pub(super) const LOWEST_HZ: f64 = 1.0;
/// Highest frequency used, Hz: above it the equation weighs encoder noise more than motion.
pub(crate) const HIGHEST_HZ: f64 = 110.0;
/// Part of the slowest sample rate that is free of folding.
pub(crate) const CLEAN_PART: f64 = 0.44;
/// Half-width of the band left out of the traces about the rotational frequency, Hz: the encoders' once-a-turn error.
const TURN_MARGIN_HZ: f64 = 3.0;
/// How far about a line that the torque's record does not show the frequencies are left out, Hz.
const UNSEEN_MARGIN_HZ: f64 = 2.0;
/// A speed sampled more slowly than this, s, folds pulses of the engine into the band.
const SLOW_S: f64 = 1.1e-3;
/// Multiples of the firing frequency that move a speed.
const HARMONICS: u32 = 5;
/// How far about a folded pulse the frequencies are left out, Hz.
const PULSE_MARGIN_HZ: f64 = 1.5;
/// Length of the means that follow the firing frequency, s.
const PULSE_MEAN_S: f64 = 0.25;
/// Least part of the frequencies that must be free of folded pulses.
const LEAST_SHARE: f64 = 0.3;
/// Length of the moving mean that follows the rotational frequency, s.
const TURN_MEAN_S: f64 = 0.5;

/// Transforms over one window.
#[derive(Debug, Clone)]
pub(super) struct Spectra {
    pub(super) window: Window,
    /// By their places in [`equation`](super::equation).
    pub(super) signals: Vec<NoisySpectrum>,
    /// Bins that may be used.
    pub(super) bins: Vec<usize>,
    /// How the signals were dated.
    pub(super) dating: Dating,
}

impl Spectra {
    /// Transforms the part of the inputs from `from_s` to `to_s`, with N_e and torque dated earlier by `dating`, for a
    /// band of frequencies within that of [`whole_band_hz`].
    pub(super) fn new(
        inputs: &ShaftInputs<'_>,
        (from_s, to_s): (f64, f64),
        dating: Dating,
        (low_hz, high_hz): (f64, f64),
    ) -> Result<Self, EstimateError> {
        let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
        let window = even_window(inputs, from_s, to_s);
        let whole = whole_band_hz(inputs);
        let bins = window.bins(low_hz.max(whole.0), high_hz.min(whole.1));
        let last = *bins.end();
        let transform = |signal: &Signal, earlier_s: f64| {
            let dated = Signal { start_s: signal.start_s - earlier_s, ..signal.clone() };
            Modulated::new(&dated, window, last).map_err(of)
        };
        let mut torque = transform(&inputs.torque[0].signal, dating.torque_s)?;
        for part in &inputs.torque[1..] {
            torque = torque.plus(&transform(&part.signal, dating.torque_s)?);
        }
        let density = |noise: f64, signal: &Signal| noise * noise * signal.sample_time_s;
        let encoder = inputs.encoder_noise_rad_s;
        let torque_density = inputs.torque.iter().map(|t| density(t.noise_nm, &t.signal)).sum();
        let speeds = [(inputs.dyno_speed, 0.0, DYNO_TURN), (inputs.engine_speed, dating.engine_s, ENGINE_TURN)];
        let mut signals = Vec::with_capacity(ShaftEquation::SIGNALS);
        for (speed, earlier_s, turn) in speeds {
            let error =
                |(parameter, wave): (usize, Signal)| Ok(ShapedError { parameter, shape: transform(&wave, earlier_s)? });
            signals.push(NoisySpectrum {
                modulated: transform(speed, earlier_s)?,
                errors: turn.into_iter().zip(once_a_turn(speed)).map(error).collect::<Result<_, EstimateError>>()?,
                noise_density: density(encoder, speed),
            });
        }
        signals.push(NoisySpectrum { modulated: torque, errors: Vec::new(), noise_density: torque_density });
        let unseen: Vec<f64> = inputs.torque.iter().flat_map(|t| t.unseen_hz.iter().copied()).collect();
        let folded = folded_pulses(inputs, window, last);
        let is_seen = |k: &usize| unseen.iter().all(|line| (window.frequency_hz(*k) - line).abs() > UNSEEN_MARGIN_HZ);
        let all = bins.clone().count();
        let bins: Vec<usize> = bins.filter(is_seen).filter(|k| !folded[*k]).collect();
        if (bins.len() as f64) < LEAST_SHARE * all as f64 {
            return Err(EstimateError::FoldedPulses { file: inputs.file.to_owned() });
        }
        Ok(Spectra { window, signals, bins, dating })
    }

    /// With what a term multiplies, on the clock of N_d.
    pub(super) fn with_wave(mut self, wave: &Signal) -> Result<Self, ident::IdentError> {
        let last = self.bins.last().copied().unwrap_or(0);
        let modulated = Modulated::new(wave, self.window, last)?;
        self.signals.push(NoisySpectrum { modulated, errors: Vec::new(), noise_density: 0.0 });
        Ok(self)
    }
}

/// ω cos θ and ω sin θ, θ being the angle turned since the first sample: what a once-a-turn error adds to a speed,
/// sidebands about the rotational frequency included, which the swings of the angle throw far where the speed swings
/// slowly.
fn once_a_turn(speed: &Signal) -> [Signal; 2] {
    let mut angle = 0.0;
    let mut before = speed.samples.first().copied().unwrap_or(0.0);
    let waves = speed.samples.iter().map(|omega| {
        angle += 0.5 * (before + omega) * speed.sample_time_s;
        before = *omega;
        let (sin, cos) = f64::sin_cos(angle);
        (omega * cos, omega * sin)
    });
    let (cosine, sine) = waves.unzip();
    [speed.with_samples(cosine), speed.with_samples(sine)]
}

/// Bins onto which a speed's sampling folds pulses of the engine: they look like motion, and no noise level makes up
/// for them.
fn folded_pulses(inputs: &ShaftInputs<'_>, window: Window, last_bin: usize) -> Vec<bool> {
    let mut folded = vec![false; last_bin + 1];
    let speed = inputs.dyno_speed.slice(window.start_s, window.start_s + window.duration_s);
    let length = ((PULSE_MEAN_S / speed.sample_time_s) as usize).max(1);
    let means: Vec<f64> = speed.samples.chunks(length).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect();
    let slow = [inputs.dyno_speed, inputs.engine_speed].into_iter().filter(|s| s.sample_time_s > SLOW_S);
    for rate_hz in slow.map(|s| 1.0 / s.sample_time_s) {
        for pair in means.windows(2) {
            let firing_hz = pair.iter().map(|speed| inputs.firings_per_turn * speed.abs() / TAU).fold(0.0, f64::max);
            let sweep_hz = inputs.firings_per_turn * (pair[1] - pair[0]).abs() / TAU;
            for harmonic in (1..=HARMONICS).map(f64::from).filter(|h| h * firing_hz > 0.5 * rate_hz) {
                let alias_hz = (harmonic * firing_hz - (harmonic * firing_hz / rate_hz).round() * rate_hz).abs();
                let reach_hz = PULSE_MARGIN_HZ + harmonic * sweep_hz;
                let bin = |hz: f64| ((hz * window.duration_s).max(0.0) as usize).min(last_bin);
                folded[bin(alias_hz - reach_hz)..=bin(alias_hz + reach_hz)].fill(true);
            }
        }
    }
    folded
}

/// The frequencies that may be used, Hz.
pub(super) fn whole_band_hz(inputs: &ShaftInputs<'_>) -> (f64, f64) {
    (LOWEST_HZ, highest_hz(inputs))
}

/// Highest frequency at which every signal is free of folding.
pub(super) fn highest_hz(inputs: &ShaftInputs<'_>) -> f64 {
    HIGHEST_HZ.min(CLEAN_PART / slowest_sample_time(inputs))
}

fn slowest_sample_time(inputs: &ShaftInputs<'_>) -> f64 {
    inputs.signals().map(|s| s.sample_time_s).fold(0.0, f64::max)
}

/// The longest window between two instants that holds a whole number of samples of the slowest signal, a number without
/// large prime factors (which would slow the transform).
pub(super) fn even_window(inputs: &ShaftInputs<'_>, from_s: f64, to_s: f64) -> Window {
    // The margins leave room for dating the signals anew.
    let start = inputs.signals().map(|s| s.start_s).fold(from_s, f64::max) + LARGEST_SKEW_S;
    let end = inputs.signals().map(|s| s.start_s + s.len() as f64 * s.sample_time_s).fold(to_s, f64::min);
    let slowest = slowest_sample_time(inputs);
    // One sample less, so that a raster that starts late in the window still fills it.
    let most = ((end - LARGEST_SKEW_S - start) / slowest - 1.0 + 1e-6).floor().max(1.0) as usize;
    let count = (1..=most).rev().find(|n| is_smooth(*n)).unwrap_or(most);
    Window { start_s: start, duration_s: count as f64 * slowest }
}

fn is_smooth(mut n: usize) -> bool {
    for prime in [2, 3, 5] {
        while n.is_multiple_of(prime) {
            n /= prime;
        }
    }
    n == 1
}

/// Lowest and highest rotational frequency of the shaft, Hz, with the margin.
pub(super) fn turn_band_hz(speed: &Signal) -> RangeInclusive<f64> {
    let length = ((TURN_MEAN_S / speed.sample_time_s) as usize).clamp(1, speed.len().max(1));
    let means = speed.samples.chunks(length).filter(|c| 2 * c.len() > length);
    let hertz = means.map(|c| c.iter().sum::<f64>() / c.len() as f64 / TAU);
    let (low, high) = hertz.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), f| (l.min(f), h.max(f)));
    low - TURN_MARGIN_HZ..=high + TURN_MARGIN_HZ
}

/// Fourier transform of a signal over a window with cosine edges, bins 0…`last_bin`; its mean is removed.
pub(super) fn tapered(signal: &Signal, window: Window, last_bin: usize) -> Result<Vec<Complex64>, IdentError> {
    let Samples { values, offset_s, sample_time_s } = samples_in(signal, window)?;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let weigh = |(i, value): (usize, &f64)| {
        let position = (offset_s + i as f64 * sample_time_s) / window.duration_s;
        sample_time_s * (value - mean) * taper(position)
    };
    let weighted: Vec<f64> = values.iter().enumerate().map(weigh).collect();
    let mut spectrum = ::signal::spectrum::fft_real(&weighted)?;
    spectrum.truncate(last_bin + 1);
    for (k, value) in spectrum.iter_mut().enumerate() {
        *value *= Complex64::cis(-TAU * window.frequency_hz(k) * offset_s);
    }
    Ok(spectrum)
}

/// Part of a tapered window at each end in which the taper acts.
pub(super) const TAPERED_PART: f64 = 0.1;

fn taper(position: f64) -> f64 {
    let edge = position.min(1.0 - position) / TAPERED_PART;
    if edge >= 1.0 { 1.0 } else { 0.5 * (1.0 - (std::f64::consts::PI * edge.max(0.0)).cos()) }
}
