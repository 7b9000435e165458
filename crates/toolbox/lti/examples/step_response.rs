//! How fast and how well damped does a two-mass drive answer to a step of torque?
#![allow(clippy::print_stdout, reason = "an example prints")]

use faer::mat;
use lti::{LtiError, StateSpace, StepCharacteristics};

fn main() -> Result<(), LtiError> {
    // Two inertias, a spring with damping, and friction; states: twist, both speeds.
    let (j1, j2, stiffness, damping, friction) = (0.1, 0.2, 50.0, 0.1, 0.2);
    let a = mat![
        [0.0, 1.0, -1.0],
        [-stiffness / j1, -(damping + friction) / j1, damping / j1],
        [stiffness / j2, damping / j2, -(damping + friction) / j2]
    ];
    let drive = StateSpace::continuous(a, mat![[0.0], [1.0 / j1], [0.0]], mat![[0.0, 0.0, 1.0]], mat![[0.0]])?;
    println!("{drive}\n");

    for mode in drive.modes()? {
        println!("mode at {:6.2} rad/s, damping {:.3}", mode.natural_frequency_rad_s, mode.damping);
    }
    let grid = drive.time_grid()?;
    let response = drive.step_response(0, &grid)?;
    let end = drive.dc_gain()?[(0, 0)];
    let Some(step) = StepCharacteristics::new(&grid.times(), response.col_as_slice(0), end) else { return Ok(()) };
    println!("settles at {end:.3} rad/s after {:.2} s", step.settling_time_s.unwrap_or(f64::NAN));
    assert!((end - 2.5).abs() < 1e-9, "both frictions carry the torque at rest");
    Ok(())
}
