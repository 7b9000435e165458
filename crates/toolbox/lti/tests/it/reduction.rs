//! Gramians, balanced reduction, minimal realisation.

use faer::{Mat, mat};
use lti::{Complex64, Discretisation, LtiError, Reduction, StateSpace, TransferFunction};
use proptest::prelude::*;

use crate::assert_close;

fn three_states() -> StateSpace {
    StateSpace::continuous(
        mat![[-1.0, 2.0, 0.0], [-3.0, -4.0, 1.0], [0.5, 0.0, -2.0]],
        mat![[1.0, 0.0], [0.0, 2.0], [1.0, 1.0]],
        mat![[1.0, 1.0, 0.0], [0.0, 1.0, -1.0]],
        Mat::zeros(2, 2),
    )
    .unwrap()
}

/// SciPy 1.17 `solve_continuous_lyapunov`, `solve_discrete_lyapunov` of the system held for 0.2 s with `B` and `C`
/// kept.
#[test]
fn ref_gramians_and_hankel_singular_values() {
    let system = three_states();
    let expected = mat![
        [0.5193562418442808, 0.00967812092214018, 0.5347977381470208],
        [0.00967812092214028, 0.5358307959982598, 0.17235754675946074],
        [0.5347977381470209, 0.1723575467594607, 0.6336994345367553],
    ];
    assert_close(system.controllability_gramian().unwrap().as_ref(), expected.as_ref(), 1e-14);
    let values = system.hankel_singular_values().unwrap();
    let expected = [0.6531334379555955, 0.35876928474509906, 0.02679717817870775];
    assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{values:?}");
    let a = lti::expm((system.a() * faer::Scale(0.2)).as_ref()).unwrap();
    let (b, c, d) = (system.b().to_owned(), system.c().to_owned(), system.d().to_owned());
    let sampled = StateSpace::discrete(a, b, c, d, 0.2).unwrap();
    let expected = mat![
        [3.126198444748283, -0.04500850900885565, 3.1516436025536643],
        [-0.0450085090088554, 5.138088479841722, 2.07481030195421],
        [3.1516436025536634, 2.0748103019542103, 4.2835536898643305],
    ];
    assert_close(sampled.controllability_gramian().unwrap().as_ref(), expected.as_ref(), 1e-13);
    let values = sampled.hankel_singular_values().unwrap();
    let expected = [4.273248873602476, 2.9115007805976907, 0.20185369066246742];
    assert!(values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-13), "{values:?}");
}

#[test]
fn exact_unstable_systems_have_no_gramian() {
    let pole = |p: f64, sample_time_s| {
        StateSpace::new(mat![[p]], mat![[1.0]], mat![[1.0]], mat![[0.0]], sample_time_s).unwrap()
    };
    for system in [pole(0.0, None), pole(0.1, None), pole(1.0, Some(0.1)), pole(-1.1, Some(0.1))] {
        assert!(matches!(system.controllability_gramian(), Err(LtiError::Unstable { .. })));
        assert!(matches!(system.reduced(0, Reduction::Truncation), Err(LtiError::Unstable { .. })));
    }
    // Close to the unit circle is not on it: 1/(1 − p²).
    let near = pole(1.0 - 1e-12, Some(0.1)).controllability_gramian().unwrap()[(0, 0)];
    let p: f64 = 1.0 - 1e-12;
    assert!((near * (1.0 - p) * (1.0 + p) - 1.0).abs() < 1e-14);
    assert!(matches!(three_states().reduced(4, Reduction::Truncation), Err(LtiError::Order { .. })));
}

#[test]
fn exact_a_small_singular_value_keeps_its_digits() {
    // Two lags that do not see each other: σ = k/(2p) each, nine decades apart.
    let system = StateSpace::continuous(
        mat![[-1.0, 0.0], [0.0, -3.0]],
        mat![[1.0], [1e-5]],
        mat![[1.0, 0.0], [0.0, 1e-4]],
        Mat::zeros(2, 1),
    )
    .unwrap();
    let (p, q) = (system.controllability_gramian().unwrap(), system.observability_gramian().unwrap());
    let trace = p[(0, 0)] * q[(0, 0)] + p[(1, 1)] * q[(1, 1)] + 2.0 * p[(0, 1)] * q[(0, 1)];
    let determinant = (p[(0, 0)] * p[(1, 1)] - p[(0, 1)] * p[(1, 0)]) * q[(0, 0)] * q[(1, 1)];
    let values = system.hankel_singular_values().unwrap();
    assert!((values[0].powi(2) + values[1].powi(2) - trace).abs() < 1e-15);
    assert!((values[0] * values[1] / determinant.sqrt() - 1.0).abs() < 1e-10, "{values:?}");
}

#[test]
fn exact_hidden_states_are_dropped() {
    // (s + 1)(s + 2) / ((s + 1)(s + 3)(s + 4)), and an unreachable state of its own.
    let seen = TransferFunction::continuous(vec![1.0, 3.0, 2.0], vec![1.0, 8.0, 19.0, 12.0]).unwrap();
    let seen = seen.to_state_space().unwrap();
    let unreachable = StateSpace::continuous(mat![[-5.0]], mat![[0.0]], mat![[1.0]], mat![[0.0]]).unwrap();
    let system = seen.parallel(&unreachable).unwrap();
    let w = [0.1, 1.0, 10.0];
    let truth = system.frequency_response(0, 0, &w).unwrap().response;
    for small in [system.minimal(1e-10).unwrap(), system.balanced().unwrap()] {
        assert_eq!(small.states(), 2);
        let got = small.frequency_response(0, 0, &w).unwrap().response;
        assert!(truth.iter().zip(&got).all(|(a, b)| (a - b).norm() < 1e-12));
    }
    let ratio = system.to_transfer_function().unwrap().cancelled(1e-6).unwrap();
    assert_eq!((ratio.num().len(), ratio.den().len()), (2, 3));
    let nothing = StateSpace::continuous(mat![[1.0]], mat![[0.0]], mat![[1.0]], mat![[2.0]]).unwrap();
    assert_eq!(nothing.minimal(1e-10).unwrap(), StateSpace::gain(mat![[2.0]], None).unwrap());
}

/// Stable systems of two inputs and outputs; a random matrix moved left of the imaginary axis.
fn stable() -> impl Strategy<Value = StateSpace> {
    let values = prop::collection::vec(-1.0_f64..1.0, 100);
    (2_usize..8, values, 0.001_f64..0.5, prop::bool::ANY).prop_map(|(n, values, margin, discrete)| {
        let a = Mat::from_fn(n, n, |i, j| 3.0 * values[8 * i + j]);
        let b = Mat::from_fn(n, 2, |i, j| values[64 + 2 * i + j]);
        let c = Mat::from_fn(2, n, |i, j| values[80 + 8 * i + j]);
        let right = a.eigenvalues().unwrap().iter().map(|p: &Complex64| p.re).fold(f64::NEG_INFINITY, f64::max);
        let moved = Mat::from_fn(n, n, |i, j| a[(i, j)] - if i == j { right + margin } else { 0.0 });
        let system = StateSpace::continuous(moved, b, c, Mat::full(2, 2, 0.3)).unwrap();
        if discrete { system.to_discrete(Discretisation::ZeroOrderHold, 0.1).unwrap() } else { system }
    })
}

fn largest_difference(a: &StateSpace, b: &StateSpace) -> f64 {
    let w: Vec<f64> = (0..60).map(|i| 0.001 * 1.17_f64.powi(i)).collect();
    let pairs = a.gains(&w).into_iter().zip(b.gains(&w));
    pairs.map(|(a, b)| (a - b).singular_values().unwrap()[0]).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn prop_gramians_solve_their_equations(system in stable()) {
        let (a, p) = (system.a(), system.controllability_gramian().unwrap());
        let q = system.observability_gramian().unwrap();
        let (bb, cc) = (system.b() * system.b().transpose(), system.c().transpose() * system.c());
        let (left, right) = match system.sample_time_s() {
            None => (a * &p + &p * a.transpose() + bb, a.transpose() * &q + &q * a + cc),
            Some(_) => (a * &p * a.transpose() - &p + bb, a.transpose() * &q * a - &q + cc),
        };
        let size = a.norm_l2() + 1.0;
        prop_assert!(left.norm_l2() < 1e-12 * size * p.norm_l2(), "{:e}", left.norm_l2() / p.norm_l2());
        prop_assert!(right.norm_l2() < 1e-12 * size * q.norm_l2());
    }

    #[test]
    fn prop_balanced_gramians_are_equal_and_diagonal(system in stable()) {
        let values = system.hankel_singular_values().unwrap();
        // A state that is all but hidden costs digits.
        prop_assume!(values[values.len() - 1] > 1e-6 * values[0]);
        let balanced = system.balanced().unwrap();
        let expected = Mat::from_fn(values.len(), values.len(), |i, j| if i == j { values[i] } else { 0.0 });
        for gramian in [balanced.controllability_gramian().unwrap(), balanced.observability_gramian().unwrap()] {
            prop_assert!((gramian - &expected).norm_max() < 1e-7 * values[0]);
        }
        prop_assert!(largest_difference(&system, &balanced) < 1e-8 * values[0]);
    }

    #[test]
    fn prop_reduction_keeps_its_bound(system in stable(), left_out in 1_usize..3) {
        let order = system.states().saturating_sub(left_out);
        let values = system.hankel_singular_values().unwrap();
        let bound = 2.0 * values[order..].iter().sum::<f64>() + 1e-9 * values[0];
        for reduction in [Reduction::Truncation, Reduction::SingularPerturbation] {
            let small = system.reduced(order, reduction).unwrap();
            prop_assert!(small.is_stable().unwrap());
            prop_assert!(largest_difference(&system, &small) <= bound);
        }
        let at_rest = system.reduced(order, Reduction::SingularPerturbation).unwrap().dc_gain().unwrap();
        let truth = system.dc_gain().unwrap();
        prop_assert!((at_rest - &truth).norm_max() < 1e-7 * (truth.norm_max() + values[0]));
    }
}
