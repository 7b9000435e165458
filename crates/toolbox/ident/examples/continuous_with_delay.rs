//! Estimates gain, time constant and dead time of a process, in continuous time and with confidence intervals.
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use signal::excitation::Random;

/// `2 e^(−0.37 s)/(1 + 0.8 s)`: a delay that is no multiple of the sample time.
const TRUTH: [f64; 3] = [2.0, 0.8, 0.37];

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let process = ProcessFit::named("P1D")?.with_delay_between(&[(0.0, 2.0)]).fit(&data)?;
    let rational = ContinuousTransferFunction::new(0, 1).with_delay_between(&[(0.0, 2.0)]).fit(&data)?;
    println!("{process}\n\n{rational}\n");

    for ((name, (low, high)), truth) in
        ["gain", "time constant", "delay"].iter().zip(process.intervals(0.99)).zip(TRUTH)
    {
        println!("{name:<14} 99 % interval {low:.4} to {high:.4}, true value {truth}");
        assert!(low < truth && truth < high);
    }
    let step = process.step()?.remove(0);
    let after = step.time_s.iter().position(|t| *t >= 5.0).unwrap_or(0);
    println!("Step response after {:.1} s: {:.3}", step.time_s[after], step.response[after]);
    assert!((step.response[after] - 2.0).abs() < 0.05);
    Ok(())
}

/// Exact samples of the response to steps, every 0.1 s, with noise.
fn record() -> Result<Dataset, IdentError> {
    let mut random = Random::new(5);
    let u: Vec<f64> = (0..500).map(|t| if (t / 40) % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let [gain, time_constant_s, delay_s] = TRUTH;
    let unit_step = |t_s: f64| if t_s > 0.0 { gain * (1.0 - (-t_s / time_constant_s).exp()) } else { 0.0 };
    let before = |t: usize| if t == 0 { 0.0 } else { u[t - 1] };
    let edges: Vec<(usize, f64)> = (0..500).map(|t| (t, u[t] - before(t))).filter(|(_, jump)| *jump != 0.0).collect();
    let exact = |t: usize| -> f64 {
        edges
            .iter()
            .take_while(|(at, _)| *at <= t)
            .map(|(at, jump)| jump * unit_step(0.1 * (t - at) as f64 - delay_s))
            .sum()
    };
    let y: Vec<f64> = (0..500).map(|t| exact(t) + 0.05 * random.normal()).collect();
    Dataset::siso(0.1, &u, &y)
}
