//! Which transfer function belongs to a measured frequency response, and does it explain all of it but the noise?
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use signal::excitation::{Multisine, Phases, Random, Timing};

const SAMPLE_TIME_S: f64 = 0.01;
const PERIOD: usize = 500;

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let channel = ChannelPair { output: 0, input: 0 };
    let harmonics: Vec<usize> = (1..=80).collect();
    let spectra = ident::SpectralData::from_periods(&data, channel, PERIOD, &harmonics)?;

    let small = FrequencyTransferFunction::continuous(0, 1).fit(&spectra)?;
    let right = FrequencyTransferFunction::continuous(0, 2).fit(&spectra)?;
    println!("{small}\n\n{right}\n");
    println!("first order explains all but the noise: {}; second order: {}", small.cost.passed(), right.cost.passed());

    let resonance = right.fit.model.transfer_function()?.modes()?[0];
    println!("resonance at {:.3} rad/s with damping {:.4}", resonance.natural_frequency_rad_s, resonance.damping);
    assert!(!small.cost.passed());
    assert!((resonance.natural_frequency_rad_s - 20.0).abs() < 0.1 && (resonance.damping - 0.1).abs() < 0.01);
    Ok(())
}

/// Eight periods of a multisine and the steady response of `400/(s² + 4 s + 400)` to it, with noise on both.
fn record() -> Result<Dataset, IdentError> {
    let multisine = Multisine::flat(PERIOD, (1..=80).collect(), 1.0, Phases::Schroeder);
    let input = multisine.generate(Timing { sample_time_s: SAMPLE_TIME_S, length: PERIOD })?.samples;
    let plant = TransferFunction::continuous(vec![400.0], vec![1.0, 4.0, 400.0])?;
    let mut spectrum = signal::spectrum::fft_real(&input)?;
    let omega: Vec<f64> =
        (0..spectrum.len()).map(|k| std::f64::consts::TAU * k as f64 / (PERIOD as f64 * SAMPLE_TIME_S)).collect();
    for (line, gain) in spectrum.iter_mut().zip(plant.frequency_response(&omega)?.response) {
        *line *= gain;
    }
    let output = signal::spectrum::inverse_fft_real(spectrum, PERIOD)?;
    let mut random = Random::new(7);
    let mut noisy = |x: &[f64]| (0..8 * PERIOD).map(|t| x[t % PERIOD] + 0.05 * random.normal()).collect::<Vec<f64>>();
    Dataset::siso(SAMPLE_TIME_S, &noisy(&input), &noisy(&output))
}
