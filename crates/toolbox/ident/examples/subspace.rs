//! Estimates the order of a resonant structure and its modes.
#![allow(clippy::print_stdout, reason = "an example prints")]

use ident::Weighting;
use ident::prelude::*;
use ident::uncertainty::Dynamics;
use lti::StateSpace;
use signal::excitation::Random;

/// Natural frequencies in rad/s and damping ratios of two modes.
const MODES: [(f64, f64); 2] = [(6.0, 0.03), (15.0, 0.02)];

fn main() -> Result<(), IdentError> {
    let data = record()?;
    let values = Subspace::new(8).with_weighting(Weighting::N4sid).singular_values(&data)?;
    println!("singular values: {:.3?}", &values[..8]);

    let start = Subspace::new(4).with_weighting(Weighting::N4sid).fit(&data)?;
    let fit = StateSpacePem::new(4).fit(&data)?;
    println!("{fit}\n\n{}", compare(&[&start, &fit], &data).named(&["N4SID", "prediction error"]));

    let mut modes = fit.model.system().modes()?;
    modes.sort_by(|a, b| a.natural_frequency_rad_s.total_cmp(&b.natural_frequency_rad_s));
    modes.dedup_by(|a, b| (a.natural_frequency_rad_s - b.natural_frequency_rad_s).abs() < 1e-6);
    for (mode, (frequency, damping)) in modes.iter().zip(MODES) {
        let (found, ratio) = (mode.natural_frequency_rad_s, mode.damping);
        println!("mode at {found:.3} rad/s with damping {ratio:.4}; true {frequency} and {damping}");
        assert!((found / frequency - 1.0).abs() < 0.01);
    }
    assert!(Dynamics::system(&fit.model)?.is_stable()?);
    Ok(())
}

/// The sum of two modes, sampled every 50 ms, with noise on the output.
fn record() -> Result<Dataset, IdentError> {
    let mode = |(w, zeta): (f64, f64)| TransferFunction::continuous(vec![w * w], vec![1.0, 2.0 * zeta * w, w * w]);
    let whole: StateSpace = mode(MODES[0])?.parallel(&mode(MODES[1])?)?.to_state_space()?.to_discrete_zoh(0.05)?;
    let mut random = Random::new(4);
    let u: Vec<f64> = (0..3000).map(|_| random.normal()).collect();
    let input = faer::Mat::from_fn(3000, 1, |t, _| u[t]);
    let response = whole.simulate(input.as_ref(), &vec![0.0; whole.states()])?;
    let y: Vec<f64> = response.col_as_slice(0).iter().map(|x| x + 0.1 * random.normal()).collect();
    Dataset::siso(0.05, &u, &y)
}
