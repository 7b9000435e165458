//! How does a system respond to an impulse, without choosing any order, from 300 noisy samples?
//!
//! Least squares for 60 coefficients scatters widely. A prior that expects a smooth decay, tuned to the data, does not.
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use signal::excitation::Random;

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let plain = ImpulseResponse::new(60).delay(1).unregularised().fit(&data)?.impulse(0, 0)?;
    let tuned = ImpulseResponse::new(60).delay(1).fit(&data)?.impulse(0, 0)?;

    let truth: Vec<f64> = (0..60).map(|k| response(k + 1)).collect();
    println!("lag   truth    least squares      with a prior");
    for k in (0..40).step_by(5) {
        let show = |value: f64, error: f64| format!("{value:+.3} ± {error:.3}");
        let (a, b) = (show(plain.value[k], plain.standard_error[k]), show(tuned.value[k], tuned.standard_error[k]));
        println!("{:3}  {:+.3}   {a}   {b}", k + 1, truth[k]);
    }
    let distance = |x: &[f64]| x.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let (without, with) = (distance(&plain.value), distance(&tuned.value));
    println!("distance to the truth: {without:.3} by least squares, {with:.3} with a prior");
    assert!(with < 0.7 * without);
    Ok(())
}

/// A decaying oscillation.
fn response(lag: usize) -> f64 {
    0.9_f64.powi(lag as i32 - 1) * (0.3 * (lag - 1) as f64).cos()
}

fn record() -> Result<Dataset, IdentError> {
    let mut random = Random::new(9);
    let u: Vec<f64> = (0..300).map(|_| random.normal()).collect();
    let exact = |t: usize| (1..=t.min(150)).map(|lag| response(lag) * u[t - lag]).sum::<f64>();
    let y: Vec<f64> = (0..300).map(|t| exact(t) + 0.8 * random.normal()).collect();
    Dataset::siso(0.1, &u, &y)
}
