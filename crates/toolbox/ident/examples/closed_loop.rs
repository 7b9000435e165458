//! Which estimators can be trusted on data that were taken under feedback?
//!
//! The noise of the plant reaches its input through the controller. An output-error model has no noise model that could
//! describe it, and is biased; ARMAX has one.
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use signal::excitation::Random;

/// The plant: `y(t) = 0.9 y(t−1) + 0.5 u(t−1) + e(t) + 0.6 e(t−1)`.
const POLE: f64 = 0.9;

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let armax = closed_loop::direct(&data, 3, |plant| Armax::new(1, 1, 1, 1).fit(plant))?;
    let output_error = closed_loop::direct(&data, 3, |plant| OutputError::new(1, 1, 1).fit(plant))?;

    println!("{armax}\n\n{output_error}\n");
    let poles = [("ARMAX", &armax, 0), ("output error", &output_error, 1)].map(|(name, fit, index)| {
        let (pole, error) = (-fit.parameters()[index], fit.standard_errors()[index]);
        println!("{name:<13} pole {pole:.3} ± {error:.3}, the plant's is {POLE}");
        (pole - POLE).abs() / error
    });
    let plant = data.channels(&[0], &[0])?;
    let report = ResidualTest::default().run(&output_error, &plant, TestData::Own)?;
    println!("Residuals of the output-error model are white: {}", report.whiteness[0].joint.passes(0.99));
    assert!(poles[0] < 4.0, "ARMAX is consistent");
    assert!(poles[1] > 4.0, "the output error is biased");
    Ok(())
}

/// The inputs are `u` and the set point `r`; `u = r − 0.8 y`.
fn record() -> Result<Dataset, IdentError> {
    let (mut random, samples) = (Random::new(3), 4000);
    let (mut u, mut r, mut y, mut e) = (vec![0.0; samples], vec![0.0; samples], vec![0.0; samples], 0.0);
    for t in 1..samples {
        let before = std::mem::replace(&mut e, random.normal());
        y[t] = POLE * y[t - 1] + 0.5 * u[t - 1] + e + 0.6 * before;
        r[t] = if t % 40 == 0 { random.normal() } else { r[t - 1] };
        u[t] = r[t] - 0.8 * y[t];
    }
    Dataset::from_channels(0.1, &[&u, &r], &[&y])
}
