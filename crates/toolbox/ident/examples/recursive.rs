//! Does the gain of a system change while it runs, and when?
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use ident::recursive::{Adaptation, Recursive, RecursiveStructure};
use signal::excitation::Random;

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let structure = RecursiveStructure::Arx { na: 1, nb: vec![1], nk: vec![1] };
    let mut estimator = Recursive::new(structure, Adaptation::Forgetting(0.98))?;
    let trajectory = estimator.run(&data)?;

    println!("time / s   {}", trajectory.names.join("        "));
    for t in (199..1000).step_by(200) {
        let value = |j: usize| trajectory.parameters[(t, j)];
        println!("{:8.1}   {:+.4}   {:+.4}", 0.1 * (t + 1) as f64, value(0), value(1));
    }
    let gain = |t: usize| trajectory.parameters[(t, 1)];
    // Halfway between the two values, within the memory of fifty samples after the change.
    let change = (300..1000).find(|t| gain(*t) > 0.75).unwrap_or(0);
    println!("The gain passes 0.75 at {:.1} s; it doubled at 60 s.", 0.1 * change as f64);
    assert!((600..650).contains(&change));
    assert!((gain(590) - 0.5).abs() < 0.05 && (gain(999) - 1.0).abs() < 0.05);
    Ok(())
}

/// `y(t) = 0.9 y(t−1) + b u(t−1) + e(t)`, whose `b` jumps from 0.5 to 1 at 60 s.
fn record() -> Result<Dataset, IdentError> {
    let mut random = Random::new(8);
    let u: Vec<f64> = (0..1000).map(|_| random.normal()).collect();
    let mut y = vec![0.0; 1000];
    for t in 1..1000 {
        let b = if t < 600 { 0.5 } else { 1.0 };
        y[t] = 0.9 * y[t - 1] + b * u[t - 1] + 0.1 * random.normal();
    }
    Dataset::siso(0.1, &u, &y)
}
