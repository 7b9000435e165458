//! Test that a broad peak is that of two masses on a shaft: they swing against each other, each the more the lighter it
//! is.

use std::f64::consts::{PI, TAU};

use numerics::order::lower_median;
use signal::{Complex64, Signal};

/// Length of the averaged parts, s; they overlap by half.
const PART_S: f64 = 2.0;
const FEWEST: usize = 8;
/// Frequencies about the peak that are averaged, in steps of a part's resolution.
const BESIDE: i32 = 2;
/// The speeds have at least this coherence, and are within this angle of opposition, rad: rasters may be some
/// milliseconds apart.
const COHERENT: f64 = 0.5;
const APART_RAD: f64 = PI / 3.0;
/// The ratio of the speeds is that of the inertias within this factor. Where an engine shakes the bench, it is off by
/// this factor where a peak lies some 15 % beside the resonance.
const OF_THE_MASSES: f64 = 1.5;

/// Tells whether two speeds show the mode of their masses about a frequency: ω_d : ω_e = −J_e : J_d, whatever excites
/// it.
pub(super) fn is_of_two_masses(
    dynamometer: &Signal,
    engine: &Signal,
    inertias_kg_m2: [f64; 2],
    frequency_hz: f64,
) -> bool {
    let expected = (inertias_kg_m2[1] / inertias_kg_m2[0]).ln();
    let of = |step: i32| ratio(dynamometer, engine, frequency_hz + f64::from(step) / PART_S);
    let found: Vec<Complex64> = (-BESIDE..=BESIDE).filter_map(of).collect();
    if found.len() <= BESIDE as usize {
        return false;
    }
    let mut sizes: Vec<f64> = found.iter().map(|ratio| ratio.norm().ln()).collect();
    let opposed = found.iter().filter(|ratio| (-**ratio).arg().abs() < APART_RAD).count();
    2 * opposed > found.len()
        && lower_median(&mut sizes).is_some_and(|size| (size - expected).abs() < OF_THE_MASSES.ln())
}

/// ω_d over ω_e at a frequency; none where they have little in common.
fn ratio(dynamometer: &Signal, engine: &Signal, frequency_hz: f64) -> Option<Complex64> {
    let from_s = dynamometer.start_s.max(engine.start_s);
    let to_s = dynamometer.end_s().min(engine.end_s());
    let parts = (2.0 * (to_s - from_s) / PART_S - 1.0).floor().max(0.0) as usize;
    if parts < FEWEST {
        return None;
    }
    let (mut own, mut other, mut cross) = (0.0, 0.0, Complex64::ZERO);
    for k in 0..parts {
        let start_s = from_s + 0.5 * PART_S * k as f64;
        let [d, e] = [dynamometer, engine].map(|signal| line_of(signal, start_s, frequency_hz));
        own += d.norm_sqr();
        other += e.norm_sqr();
        cross += d * e.conj();
    }
    let coherence = cross.norm_sqr() / (own * other);
    (coherence > COHERENT).then(|| Complex64::from_polar((own / other).sqrt(), cross.arg()))
}

/// The Fourier transform of a part at a frequency, under a Hann window, its mean removed, by its own time stamps.
fn line_of(signal: &Signal, start_s: f64, frequency_hz: f64) -> Complex64 {
    let part = signal.slice(start_s, start_s + PART_S);
    let mean = part.mean().unwrap_or(0.0);
    let turn = Complex64::cis(-TAU * frequency_hz * part.sample_time_s);
    let mut wave = Complex64::cis(-TAU * frequency_hz * part.start_s);
    let mut sum = Complex64::ZERO;
    for (k, value) in part.samples.iter().enumerate() {
        let window = (PI * (part.time_s(k) - start_s) / PART_S).sin().powi(2);
        sum += wave * (window * (value - mean));
        wave *= turn;
    }
    sum * part.sample_time_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::excitation::Random;

    /// Two masses on a shaft, shaken at the engine by noise about a frequency: their speeds there by the equations of
    /// motion.
    fn is_mode_at(shaken_hz: f64) -> bool {
        let (inertias, resonance_hz) = ([0.6_f64, 0.3_f64], 20.0);
        // K = ω₀² J_d J_e/(J_d + J_e); ω_d : ω_e = K : (K − J_d ω²).
        let stiffness = (TAU * resonance_hz).powi(2) * 0.6 * 0.3 / 0.9;
        let ratio = stiffness / (stiffness - inertias[0] * (TAU * shaken_hz).powi(2));
        let mut random = Random::new(3);
        let waves: Vec<(f64, f64)> =
            (0..60).map(|k| (shaken_hz + 0.1 * f64::from(k - 30), TAU * random.uniform())).collect();
        let speed = |sample_time_s: f64, gain: f64| {
            let at = |t: f64| gain * waves.iter().map(|(hz, phase)| (TAU * hz * t + phase).sin()).sum::<f64>();
            let samples = (0..(20.0 / sample_time_s) as usize).map(|k| at(k as f64 * sample_time_s)).collect();
            Signal { start_s: 0.0, sample_time_s, samples }
        };
        is_of_two_masses(&speed(0.001, ratio), &speed(0.004, 1.0), inertias, shaken_hz)
    }

    #[test]
    fn exact_only_the_resonance_has_the_ratio_of_the_masses() {
        assert!(is_mode_at(20.0) && is_mode_at(19.5) && is_mode_at(21.0));
        // Above the resonance the masses swing against each other too, but the dynamometer too little; below, together.
        assert!(!is_mode_at(27.0) && !is_mode_at(33.0) && !is_mode_at(10.0));
    }
}
