//! Invariants over random systems.

use faer::{Mat, mat};
use lti::{Complex64, StateSpace, TransferFunction, polynomial};
use proptest::prelude::*;

/// Stable continuous systems: poles and numerators of a few orders, time constants from 1 ms to 1 s.
fn transfer_functions() -> impl Strategy<Value = TransferFunction> {
    let poles = prop::collection::vec((1.0_f64..1000.0, 0.05_f64..1.5), 1..3);
    (poles, prop::collection::vec(0.2_f64..2.0, 1..4)).prop_map(|(modes, numerator)| {
        let den = modes
            .iter()
            .fold(vec![1.0], |p, (w, zeta)| polynomial::multiply(&p, &[1.0 / (w * w), 2.0 * zeta / w, 1.0]));
        let keep = numerator.len().min(den.len());
        let num = numerator[..keep].iter().zip(&den[den.len() - keep..]).map(|(n, d)| n * d).collect();
        TransferFunction::continuous(num, den).unwrap()
    })
}

fn nearest(points: &[Complex64], wanted: Complex64) -> f64 {
    points.iter().map(|p| (p - wanted).norm()).fold(f64::INFINITY, f64::min)
}

proptest! {
    #[test]
    fn prop_state_space_and_back_keeps_the_response(tf in transfer_functions(), w in 0.1_f64..3000.0) {
        let system = tf.to_state_space().unwrap();
        let point = Complex64::new(0.0, w);
        let truth = tf.evaluate(point);
        let scale = truth.norm() + 1e-6;
        prop_assert!((system.evaluate(point)[(0, 0)] - truth).norm() < 1e-8 * scale);
        let back = system.to_transfer_function().unwrap();
        prop_assert!((back.evaluate(point) - truth).norm() < 1e-6 * scale, "{tf:?} {back:?}");
        prop_assert!((system.dc_gain().unwrap()[(0, 0)] - tf.dc_gain()).abs() < 1e-9 * tf.dc_gain().abs());
    }

    #[test]
    fn prop_discrete_poles_are_exponentials(tf in transfer_functions(), ts in 1e-4_f64..1e-2) {
        let system = tf.to_state_space().unwrap();
        let discrete = system.to_discrete_zoh(ts).unwrap().poles().unwrap();
        for pole in system.poles().unwrap() {
            // Double poles lose half the digits.
            prop_assert!(nearest(&discrete, (pole * ts).exp()) < 1e-6);
        }
    }

    #[test]
    fn prop_coarse_steps_equal_fine_ones(tf in transfer_functions(), ts in 1e-4_f64..1e-2, inputs in prop::collection::vec(-1.0_f64..1.0, 8)) {
        const FINE: usize = 5;
        let system = tf.to_state_space().unwrap();
        let start = vec![0.1; system.states()];
        let coarse = Mat::from_fn(8, 1, |k, _| inputs[k]);
        let held = Mat::from_fn(8 * FINE, 1, |k, _| inputs[k / FINE]);
        let fine_step = ts / FINE as f64;
        let y = system.to_discrete_zoh(ts).unwrap().simulate(coarse.as_ref(), &start).unwrap();
        let z = system.to_discrete_zoh(fine_step).unwrap().simulate(held.as_ref(), &start).unwrap();
        let straight = Mat::from_fn(7 * FINE + 1, 1, |k, _| {
            let (i, f) = (k / FINE, (k % FINE) as f64 / FINE as f64);
            inputs[i] + f * (inputs.get(i + 1).unwrap_or(&0.0) - inputs[i])
        });
        let p = system.to_discrete_foh(ts).unwrap().simulate(coarse.as_ref(), &start).unwrap();
        let q = system.to_discrete_foh(fine_step).unwrap().simulate(straight.as_ref(), &start).unwrap();
        let size = z.norm_max() + 1.0;
        for k in 0..8 {
            prop_assert!((y[(k, 0)] - z[(k * FINE, 0)]).abs() < 1e-8 * size);
            prop_assert!((p[(k, 0)] - q[(k * FINE, 0)]).abs() < 1e-8 * size);
        }
    }

    #[test]
    fn prop_held_simulation_equals_runge_kutta(w in 1.0_f64..30.0, zeta in 0.05_f64..2.0, u in -2.0_f64..2.0) {
        let system = StateSpace::continuous(mat![[0.0, 1.0], [-w * w, -2.0 * zeta * w]], mat![[0.0], [w * w]], mat![[1.0, 0.0]], mat![[0.0]]).unwrap();
        let y = system.to_discrete_zoh(0.05).unwrap().simulate(Mat::full(2, 1, u).as_ref(), &[0.3, -1.0]).unwrap();
        let slope = |x: [f64; 2]| [x[1], w * w * (u - x[0]) - 2.0 * zeta * w * x[1]];
        let (mut x, h) = ([0.3, -1.0], 0.05 / 2000.0);
        let ahead = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
        for _ in 0..2000 {
            let k1 = slope(x);
            let k2 = slope(ahead(x, k1, h / 2.0));
            let k3 = slope(ahead(x, k2, h / 2.0));
            let k4 = slope(ahead(x, k3, h));
            x = [0, 1].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        prop_assert!((y[(1, 0)] - x[0]).abs() < 1e-10);
    }

    #[test]
    fn prop_roots_give_their_polynomial_back(roots in prop::collection::vec(-5.0_f64..5.0, 1..6)) {
        let points: Vec<Complex64> = roots.iter().map(|r| Complex64::new(*r, 0.0)).collect();
        let p = polynomial::from_roots(&points);
        let q = polynomial::from_roots(&polynomial::roots(&p).unwrap());
        prop_assert!(p.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-8 * (1.0 + a.abs())));
    }
}
