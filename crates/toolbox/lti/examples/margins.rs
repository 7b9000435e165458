//! How far is a control loop from its stability limit, and does sampling the controller bring it closer?
#![allow(clippy::print_stdout, reason = "an example prints")]

use lti::{Discretisation, LtiError, TransferFunction};

fn main() -> Result<(), LtiError> {
    // A plant with a lag and a delay, and a PI controller.
    let plant = TransferFunction::continuous(vec![2.0], vec![0.5, 1.0])?.with_delay(0.05)?;
    let controller = TransferFunction::continuous(vec![1.0, 3.0], vec![1.0, 0.0])?;
    println!("{plant}\n\n{controller}\n");

    let continuous = controller.series(&plant)?.margins()?;
    let sampled = controller.to_discrete(Discretisation::Tustin { prewarp_rad_s: None }, 0.05)?;
    let held = plant.to_discrete(Discretisation::ZeroOrderHold, 0.05)?;
    let discrete = sampled.series(&held)?.margins()?;
    let phase = |margins: &lti::Margins| margins.phase.first().map_or(f64::NAN, |margin| margin.phase_deg);
    println!(
        "phase margin: {:.1}° in continuous time, {:.1}° sampled every 50 ms",
        phase(&continuous),
        phase(&discrete)
    );
    assert!(phase(&continuous) > phase(&discrete) && phase(&discrete) > 30.0);
    Ok(())
}
