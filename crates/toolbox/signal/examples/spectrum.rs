//! Which tones are hidden in a noisy record, and which peaks are chance?
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::TAU;

use signal::SignalError;
use signal::excitation::Random;
use signal::spectrum::{Welch, peaks, power_spectrum};

const SAMPLE_TIME_S: f64 = 1e-3;

fn main() -> Result<(), SignalError> {
    let mut random = Random::new(1);
    let tones = [(50.0, 0.3), (123.0, 0.2)];
    let at = |t: usize| tones.iter().map(|(f, a)| a * (TAU * f * SAMPLE_TIME_S * t as f64).sin()).sum::<f64>();
    let record: Vec<f64> = (0..20_000).map(|t| at(t) + random.normal()).collect();

    let spectrum = power_spectrum(&record, SAMPLE_TIME_S, Welch::half_overlapping(1000))?;
    let intervals: Vec<(f64, f64)> = spectrum.interval(0.9999)?.iter().map(|[low, high]| (*low, *high)).collect();
    let found = peaks(&spectrum.freq_hz, &spectrum.density, &intervals, 3, 4.0);
    for peak in &found {
        println!("{:6.1} Hz stands out by {:.1} dB", spectrum.freq_hz[peak.index], 10.0 * peak.excess.log10());
    }
    let frequencies: Vec<f64> = found.iter().map(|peak| spectrum.freq_hz[peak.index].round()).collect();
    assert_eq!(frequencies, [50.0, 123.0]);
    Ok(())
}
