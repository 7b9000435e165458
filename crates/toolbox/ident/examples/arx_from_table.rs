//! Which difference equation links two columns of a table?
//!
//! The table is the text of a CSV file: a valve position in percent and a temperature in °C, every 2 s.
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use signal::excitation::Random;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let columns = read(&table())?;
    let [valve, temperature] = &columns[..] else { return Err("the table needs two columns".into()) };
    let data = Dataset::siso(2.0, valve, temperature)?;
    let operating_point = Trend::estimate(&data, TrendShape::Mean, TrendScope::Common)?;
    let parts = operating_point.remove(&data)?.split(0.7)?;

    let fit = Arx::new(2, 2, 1).fit(&parts.estimation)?;
    println!("{fit}");

    let unseen = compare(&[&fit], &parts.validation);
    println!("\nSimulated on the rest of the table: {unseen}");
    let gain = fit.model.transfer_function(0, 0)?.dc_gain();
    println!("One percent of valve changes the temperature by {gain:.3} °C.");
    assert!((gain - 0.5).abs() < 0.02, "the gain of the process is 0.5 °C/%, found {gain}");
    Ok(())
}

/// The numbers of a table with a header, column by column.
fn read(text: &str) -> Result<Vec<Vec<f64>>, std::num::ParseFloatError> {
    let mut columns = vec![Vec::new(); 2];
    for line in text.lines().skip(1) {
        for (column, field) in columns.iter_mut().zip(line.split(',')) {
            column.push(field.trim().parse()?);
        }
    }
    Ok(columns)
}

/// A process of second order with a gain of 0.5 °C/% about 60 °C.
fn table() -> String {
    let (mut random, mut valve) = (Random::new(1), 40.0);
    let (mut rows, mut x) = (String::from("valve,temperature\n"), [0.0; 2]);
    for t in 0..600 {
        rows += &format!("{valve},{:.4}\n", 60.0 + x[0] + 0.02 * random.normal());
        x = [1.5 * x[0] - 0.56 * x[1] + 0.03 * (valve - 40.0), x[0]];
        if t % 15 == 0 {
            valve = 30.0 + 20.0 * random.uniform();
        }
    }
    rows
}
