//! Which of two inputs moves which of two outputs, and by how much?
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use signal::excitation::Random;

/// Gains at rest of the system below, `[output][input]`.
const GAINS: [[f64; 2]; 2] = [[2.0, 0.0], [1.0, -1.5]];

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let fit = Subspace::auto(8).fit(&data)?;
    println!("{fit}\n");

    for chart in fit.bode()? {
        let ChannelPair { output, input } = chart.channel;
        let (low, high) = chart.magnitude_band_db[0];
        println!(
            "{}: {:7.2} dB at low frequency, 95 % band {low:.2} to {high:.2} dB",
            chart.channel, chart.magnitude_db[0]
        );
        let gain = Features::of_fit(&fit, output, input).dc_gain()?.map_or(f64::NAN, |gain| gain.value);
        assert!((gain - GAINS[output][input]).abs() < 0.1, "{}: {gain}", chart.channel);
    }
    let fits = fit.fit_percent();
    assert!(fits.iter().all(|percent| *percent > 80.0), "{fits:?}");
    Ok(())
}

/// Two lags; the first output sees the first input only.
fn record() -> Result<Dataset, IdentError> {
    let (mut random, samples) = (Random::new(10), 3000);
    let mut binary = |hold: usize| {
        let mut level = 1.0;
        let draw = |t: usize| {
            if t.is_multiple_of(hold) {
                level = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
            }
            level
        };
        (0..samples).map(draw).collect::<Vec<f64>>()
    };
    let (u1, u2) = (binary(7), binary(11));
    let (mut x, mut y1, mut y2) = ([0.0; 2], Vec::new(), Vec::new());
    let mut noise = Random::new(11);
    for t in 0..samples {
        y1.push(x[0] + 0.1 * noise.normal());
        y2.push(x[1] + 0.1 * noise.normal());
        x = [0.8 * x[0] + 0.4 * u1[t], 0.7 * x[1] + 0.3 * u1[t] - 0.45 * u2[t]];
    }
    Dataset::from_channels(0.1, &[&u1, &u2], &[&y1, &y2])
}
