//! How many past values does a model need, and how long is the delay?
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::Criterion;
use ident::prelude::*;
use signal::excitation::Random;

fn main() -> Result<(), IdentError> {
    let data = record()?.split(0.6)?;
    let table = OrderScan::new(1..=6, 1..=6, 1..=6).run_validated(&data.estimation, &data.validation)?;
    println!("{} structures, each fitted to the same {} rows", table.structures().len(), table.samples());

    println!("criterion   na  nb  nk");
    for criterion in [Criterion::Aic, Criterion::Bic, Criterion::Validation] {
        let best = table.best(criterion);
        println!("{:<10}  {:>2}  {:>2}  {:>2}", format!("{criterion:?}"), best.na, best.nb, best.nk);
    }

    let chosen = table.best(Criterion::Bic);
    let fit = table.arx(chosen).fit(&data.estimation)?;
    println!("\n{fit}");
    let report = ResidualTest::default().run(&fit, &data.validation, TestData::Unseen)?;
    println!("\nOn unseen data:\n{report}");
    assert_eq!((chosen.na, chosen.nb, chosen.nk), (2, 2, 3));
    Ok(())
}

/// `y(t) = 1.5 y(t−1) − 0.7 y(t−2) + u(t−3) + 0.5 u(t−4) + e(t)`.
fn record() -> Result<Dataset, IdentError> {
    let mut random = Random::new(2);
    let u: Vec<f64> = (0..2000).map(|_| random.normal()).collect();
    let mut y = vec![0.0; 2000];
    for t in 4..2000 {
        y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 3] + 0.5 * u[t - 4] + 0.3 * random.normal();
    }
    Dataset::siso(0.01, &u, &y)
}
