//! Estimates the inertia and the friction of a DC motor whose electrical constants are known.
//!
//! A grey box: the state matrices are formulas of physical parameters, and only two of these are estimated.
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::prelude::*;
use ident::{FormulaParts, GreyParameter};
use signal::excitation::Random;

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let formula = |text: &str| text.parse();
    let structure = FormulaStructure::new(FormulaParts {
        parameters: vec![
            GreyParameter::new("inertia", 1e-3),
            GreyParameter::new("friction", 1e-3),
            GreyParameter::new("torque_constant", 0.05).fixed(),
            GreyParameter::new("resistance", 1.0).fixed(),
        ],
        // States: angle and speed. The back-EMF brakes beside the friction.
        a: vec![
            vec![formula("0")?, formula("1")?],
            vec![formula("0")?, formula("-(friction + torque_constant^2 / resistance) / inertia")?],
        ],
        b: vec![vec![formula("0")?], vec![formula("torque_constant / (resistance * inertia)")?]],
        c: vec![vec![formula("1")?, formula("0")?]],
        ..Default::default()
    })?;

    let fit = GreyBox::new(structure).fit(&data)?;
    println!("{fit}");
    let [inertia, friction, ..] = fit.parameters()[..] else { return Ok(()) };
    assert!((inertia / 2e-3 - 1.0).abs() < 0.02, "the inertia is 2 g m², found {inertia}");
    assert!((friction / 5e-4 - 1.0).abs() < 0.1, "the friction is 0.5 mNm s, found {friction}");
    Ok(())
}

/// The angle of the motor under a random voltage, every 20 ms.
fn record() -> Result<Dataset, IdentError> {
    let (rate, drive) = (-(5e-4 + 0.05 * 0.05) / 2e-3, 0.05 / 2e-3);
    let (decay, mut random) = ((0.02_f64 * rate).exp(), Random::new(6));
    let (mut voltage, mut angle, mut state) = (Vec::new(), Vec::new(), [0.0, 0.0]);
    let mut u = 0.0;
    for t in 0..1500 {
        if t % 10 == 0 {
            u = 12.0 * (2.0 * random.uniform() - 1.0);
        }
        voltage.push(u);
        angle.push(state[0] + 0.02 * random.normal());
        let settled = -drive / rate * u;
        let rest = state[1] - settled;
        state = [state[0] + 0.02 * settled + rest * (decay - 1.0) / rate, settled + rest * decay];
    }
    Dataset::siso(0.02, &voltage, &angle)
}
