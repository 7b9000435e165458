//! A rotary flexible link under a pseudo-random binary signal, four periods of it, the first with a drift (EPFL).
//!
//! The published models have six coefficients a polynomial and a delay of three, come from the first half, and are
//! simulated on the second, the mean of each half removed.
//!
//! The drift is what sets the structures apart: a pole near one, which the first half barely determines, makes most of
//! what a simulation misses. Figures of models whose criterion is the prediction are therefore sensitive to the first
//! rows.

use ident::validate::judge;
use ident::{
    Armax, Arx, BoxJenkins, Dataset, Fit, Focus, InitialState, Iv4, LinearModel, OutputError, StateSpacePem, Subspace,
    Weighting,
};

use super::{centred, channels};

const HALF: usize = 1000;
const SAMPLE_TIME_S: f64 = 0.015;

/// The two halves, the first after `lead` samples in which the input is zero and the output unknown.
fn halves(lead: usize) -> Option<(Dataset, Dataset)> {
    let [u, y] = channels("torsional-three-disk/CE.mat", ["u", "y"])?;
    let part = |first: usize, lead: usize| {
        let before = |value: f64| vec![value; lead];
        let u = [before(0.0), centred(&u[first..first + HALF])].concat();
        let y = [before(f64::NAN), centred(&y[first..first + HALF])].concat();
        Dataset::siso(SAMPLE_TIME_S, &u, &y).unwrap()
    };
    Some((part(0, lead), part(HALF, 0)))
}

fn simulated<M: LinearModel>(fit: &Fit<M>, data: &Dataset) -> f64 {
    judge(&fit.model, data, None, &InitialState::Estimated).unwrap().fit_percent[0][0]
}

/// 86.32 % rests on rows from the seventh on, with an input of zero before the record.
#[test]
fn ref_flexible_link_arx() {
    let Some((first, second)) = halves(2) else { return };
    let found = simulated(&Arx::new(6, 6, 3).fit(&first).unwrap(), &second);
    // The published simulation has six initial states, ours eight, which is worth 0.007.
    assert!((found - 86.32).abs() < 0.01, "{found}");
    let (whole, _) = halves(0).unwrap();
    let found = simulated(&Arx::new(6, 6, 3).fit(&whole).unwrap(), &second);
    // Whole rows alone, which is the rule here.
    assert!((found - 86.19).abs() < 0.01, "{found}");
}

/// The order of the prefilter and the first rows move a four-step estimate of these data between 86.8 and 88.7 %; 88.69
/// % lies at the upper end, and the band of two around it holds them all.
#[test]
fn ref_flexible_link_instrumental_variables() {
    let Some((first, second)) = halves(0) else { return };
    let found = simulated(&Iv4::new(6, 6, 3).fit(&first).unwrap(), &second);
    assert!((found - 88.69).abs() < 2.0, "{found}");
}

#[test]
fn ref_flexible_link_armax() {
    let Some((first, second)) = halves(0) else { return };
    let found = simulated(&Armax::new(6, 6, 6, 3).fit(&first).unwrap(), &second);
    assert!((found - 90.6).abs() < 0.05, "{found}");
}

/// The published 86.56 % is exceeded at the same orders: a second pole close to one takes up the drift. It lies beyond
/// the unit circle by 1e-4, and the way to it leads through growth that is not let through at the end.
#[test]
fn ref_flexible_link_output_error() {
    let Some((first, second)) = halves(0) else { return };
    let fit = OutputError::new(6, 6, 3).fit(&first).unwrap();
    assert!(simulated(&fit, &second) > 95.7 && fit.loss < 0.00265, "{}", fit.loss);
}

/// At a delay that is too short, and at an order that is too low, the slow poles would push out the second resonance,
/// which moves the output by some hundredths only.
#[test]
fn ref_flexible_link_output_error_of_other_orders() {
    let Some((first, second)) = halves(0) else { return };
    for (order, delay, loss, percent) in
        [(6, 1, 0.0074, 93.6), (6, 2, 0.0032, 95.4), (5, 1, 0.0153, 91.3), (5, 3, 0.0132, 91.9)]
    {
        let fit = OutputError::new(order, order, delay).fit(&first).unwrap();
        assert!(fit.loss < loss && fit.condition < 1e8, "{order} {delay}: {} {:e}", fit.loss, fit.condition);
        assert!(simulated(&fit, &second) > percent, "{order} {delay}: {}", simulated(&fit, &second));
    }
}

/// The published 95.6 % is that of a simulation. What predicts best simulates the second half to 91 %; dynamics that
/// simulate best come to more, and predict worse.
#[test]
fn ref_flexible_link_box_jenkins() {
    let Some((first, second)) = halves(0) else { return };
    let orders = BoxJenkins::new(6, 6, 6, 6, 3);
    let predicts = orders.clone().fit(&first).unwrap();
    let simulates = orders.with_focus(Focus::Simulation).fit(&first).unwrap();
    assert!(simulated(&simulates, &second) > 95.6);
    assert!(simulated(&predicts, &second) > 91.0 && predicts.loss < 5.93e-4 && 0.95 * simulates.loss > predicts.loss);
}

/// 88.95 % by N4SID, with nine states in the script and six in the text.
#[test]
fn ref_flexible_link_state_space() {
    let Some((first, second)) = halves(0) else { return };
    for order in [6, 9] {
        let subspace = Subspace::new(order).with_weighting(Weighting::N4sid).fit(&first).unwrap();
        let found = simulated(&subspace, &second);
        assert!(found > 88.95, "{order}: {found}");
    }
    let refined = StateSpacePem::new(6).fit(&first).unwrap();
    assert!(simulated(&refined, &second) > 88.95);
}
