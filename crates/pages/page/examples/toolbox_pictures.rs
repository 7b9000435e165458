//! Draws the pictures of the toolbox crates' READMEs: `cargo run -p page --example toolbox_pictures`.

// An example is a program, and programs write files.
#![allow(clippy::disallowed_methods)]

use std::error::Error;
use std::path::Path;

use faer::mat;
use ident::prelude::*;
use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded, svg};
use signal::excitation::Random;
use signal::spectrum::{Welch, power_spectrum};

fn main() -> Result<(), Box<dyn Error>> {
    let toolbox = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../toolbox");
    for (file, figure) in [("signal/spectrum.svg", spectrum()?), ("lti/step.svg", step()?), ("ident/bode.svg", bode()?)]
    {
        std::fs::write(toolbox.join(file), svg(&[figure]))?;
    }
    Ok(())
}

/// A band, and what it is of.
fn banded(name: &str, x: &[f64], values: &[f64], band: &[(f64, f64)]) -> Vec<Layer> {
    let (low, high): (Vec<f64>, Vec<f64>) = band.iter().copied().unzip();
    let style = Style::of_model(0);
    let band = Layer::Band {
        name: "95 % interval".to_owned(),
        style,
        x: Abscissa::Values(rounded(x)),
        low: rounded(&low),
        high: rounded(&high),
    };
    vec![band, Layer::curve(name, style, x, values)]
}

/// Two tones in noise.
fn spectrum() -> Result<Figure, Box<dyn Error>> {
    let mut random = Random::new(1);
    let tone = |t: i32, hz: f64| (std::f64::consts::TAU * hz * 1e-3 * f64::from(t)).sin();
    let record: Vec<f64> = (0..20_000).map(|t| 0.3 * tone(t, 50.0) + 0.2 * tone(t, 123.0) + random.normal()).collect();
    let spectrum = power_spectrum(&record, 1e-3, Welch::half_overlapping(1000))?;
    let decibel = |power: f64| 10.0 * power.log10();
    let density: Vec<f64> = spectrum.density.iter().map(|p| decibel(*p)).collect();
    let band: Vec<(f64, f64)> = spectrum.interval(0.95)?.iter().map(|[l, h]| (decibel(*l), decibel(*h))).collect();
    let layers = banded("power density", &spectrum.freq_hz, &density, &band);
    let panel = Panel::new(Axis::linear("power density", "dB/Hz"), 200, layers);
    Ok(Figure::new("Two tones in noise", Axis::linear("frequency", "Hz").within(0.0, 200.0), vec![panel]))
}

/// The two-mass drive of the example `step_response`.
fn step() -> Result<Figure, Box<dyn Error>> {
    let a = mat![[0.0, 1.0, -1.0], [-500.0, -3.0, 1.0], [250.0, 0.5, -1.5]];
    let drive = StateSpace::continuous(
        a,
        mat![[0.0], [10.0], [0.0]],
        mat![[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        mat![[0.0], [0.0]],
    )?;
    let grid = lti::TimeGrid { step_s: 2e-3, points: 1000 };
    let response = drive.step_response(0, &grid)?;
    let curve = |name: &str, output: usize| {
        Layer::curve(name, Style::of_model(output), &grid.times(), response.col_as_slice(output))
    };
    let layers = vec![curve("driven mass", 0), curve("other mass", 1)];
    let panel = Panel::new(Axis::linear("speed", "rad/s"), 200, layers);
    Ok(Figure::new("A two-mass drive after a step of torque", Axis::time(), vec![panel]))
}

/// A resonance from 300 noisy samples.
fn bode() -> Result<Figure, Box<dyn Error>> {
    let mut random = Random::new(3);
    let u: Vec<f64> = (0..300).map(|_| random.normal()).collect();
    let mut x = vec![0.0; 300];
    (2..300).for_each(|t| x[t] = 1.5 * x[t - 1] - 0.8 * x[t - 2] + 0.3 * u[t - 1]);
    let y: Vec<f64> = x.iter().map(|x| x + 0.3 * random.normal()).collect();
    let fit = OutputError::new(2, 2, 1).fit(&Dataset::siso(0.01, &u, &y)?)?;
    let chart = fit.bode()?.remove(0);
    let magnitude = banded("fitted model", &chart.freq_hz, &chart.magnitude_db, &chart.magnitude_band_db);
    let phase = banded("fitted model", &chart.freq_hz, &chart.phase_deg, &chart.phase_band_deg);
    let panels =
        vec![Panel::new(Axis::linear("magnitude", "dB"), 160, magnitude), Panel::new(Axis::angle("phase"), 120, phase)];
    Ok(Figure::new("An output-error model of 300 noisy samples", Axis::frequency(), panels))
}
