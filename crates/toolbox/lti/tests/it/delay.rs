//! Delays as rational systems; systems beside each other and in loops.

use faer::{Mat, mat};
use lti::{Complex64, LtiError, StateSpace, TransferFunction};

#[test]
fn exact_pade_is_an_all_pass_with_the_delays_phase() {
    for (order, tolerance) in [(1, 1e-2), (3, 1e-6), (5, 1e-10), (8, 1e-12), (10, 1e-12)] {
        let delay = TransferFunction::pade(0.2, order).unwrap();
        let system = delay.to_state_space().unwrap();
        // 0.1 of a radian a pole.
        for w in [0.1, 0.5 * order as f64] {
            let truth = Complex64::cis(-0.2 * w);
            let (ratio, matrices) = (delay.evaluate(Complex64::new(0.0, w)), system.evaluate(Complex64::new(0.0, w)));
            assert!((ratio - truth).norm() < tolerance, "order {order} at {w}: {:e}", (ratio - truth).norm());
            assert!((matrices[(0, 0)] - truth).norm() < tolerance.max(1e-9), "order {order} in state space");
        }
        assert!(delay.poles().unwrap().iter().all(|p| p.re < 0.0));
        assert!((delay.evaluate(Complex64::new(0.0, 500.0)).norm() - 1.0).abs() < 1e-12);
    }
    assert!(matches!(TransferFunction::pade(1.0, 21), Err(LtiError::Order { .. })));
    assert!(matches!(TransferFunction::pade(-1.0, 2), Err(LtiError::Delay { .. })));
    let late = TransferFunction::continuous(vec![2.0], vec![1.0, 1.0]).unwrap().with_delay(0.3).unwrap();
    let (rational, w) = (late.with_pade_delay(4).unwrap(), [2.0]);
    let difference =
        rational.frequency_response(&w).unwrap().response[0] - late.frequency_response(&w).unwrap().response[0];
    assert!(rational.delay_s() == 0.0 && difference.norm() < 1e-9);
}

#[test]
fn exact_thiran_is_an_all_pass_with_a_flat_delay() {
    for (delay_s, order) in [(0.26, 1), (0.26, 2), (0.26, 3), (0.05, 1), (0.74, 4), (0.3, 3)] {
        let filter = TransferFunction::thiran(delay_s, 0.1, order).unwrap();
        assert!(filter.poles().unwrap().iter().all(|p| p.norm() < 1.0));
        for w in [0.01, 1.0, 20.0] {
            let h = filter.frequency_response(&[w]).unwrap().response[0];
            assert!((h.norm() - 1.0).abs() < 1e-13);
            if w <= 1.0 {
                assert!((h * Complex64::cis(delay_s * w) - 1.0).norm() < 1e-3 * w, "{delay_s} {order} {w}");
            }
        }
    }
    assert_eq!(TransferFunction::thiran(0.3, 0.1, 0).unwrap().delay_s(), 3.0 * 0.1);
    assert!(matches!(TransferFunction::thiran(0.26, 0.1, 4), Err(LtiError::Delay { .. })));
    assert!(matches!(TransferFunction::thiran(0.26, 0.1, 0), Err(LtiError::Delay { .. })));
}

#[test]
fn exact_absorbed_delays_and_systems_beside_each_other() {
    let of = |num: Vec<f64>, delay: f64| {
        TransferFunction::discrete(num, vec![1.0, -0.5], 0.1).unwrap().with_delay(delay).unwrap()
    };
    let z = Complex64::new(0.3, 0.9);
    let (p, q) = (of(vec![1.0], 0.2), of(vec![2.0, 1.0], 0.3));
    assert!((p.with_delay_absorbed().unwrap().evaluate(z) - p.evaluate(z)).norm() < 1e-14);
    let sum = p.parallel(&q).unwrap();
    assert!(sum.delay_s() == 0.2 && (sum.evaluate(z) - p.evaluate(z) - q.evaluate(z)).norm() < 1e-13);
    assert!(matches!(p.parallel(&of(vec![1.0], 0.25)), Err(LtiError::FractionalDelay { .. })));
    let continuous =
        |delay: f64| TransferFunction::continuous(vec![1.0], vec![1.0]).unwrap().with_delay(delay).unwrap();
    assert!(matches!(continuous(0.1).parallel(&continuous(0.2)), Err(LtiError::DelayPresent { .. })));
    assert_eq!(continuous(0.1).parallel(&continuous(0.1)).unwrap().num(), [2.0]);
}

#[test]
fn exact_loop_of_several_channels_with_feed_through() {
    let forward = StateSpace::continuous(
        mat![[-1.0, 0.4], [0.0, -2.0]],
        mat![[1.0, 0.0, 0.5], [0.2, 1.0, 0.0]],
        mat![[1.0, 0.0], [0.3, 2.0]],
        mat![[0.5, 0.0, 1.0], [0.0, 0.2, 0.1]],
    )
    .unwrap();
    let back = StateSpace::continuous(
        mat![[-3.0]],
        mat![[1.0, 0.7]],
        mat![[1.0], [0.0], [2.0]],
        mat![[0.1, 0.0], [0.4, 0.3], [0.0, 0.6]],
    )
    .unwrap();
    let s = Complex64::new(0.2, 1.1);
    let (g, h) = (forward.evaluate(s), back.evaluate(s));
    let y = forward.feedback(&back).unwrap().evaluate(s);
    // y = G (u − H y)
    let one: Mat<Complex64> = Mat::identity(2, 2);
    assert!(((one + &g * &h) * y - g).norm_max() < 1e-14);
    // A loop that is singular in one direction only.
    let d = mat![[1.0, 0.0], [0.0, 2.0]];
    let gain = StateSpace::gain(d, None).unwrap();
    let closing = StateSpace::gain(mat![[3.0, 1.0], [0.0, -0.5]], None).unwrap();
    assert_eq!(gain.feedback(&closing), Err(LtiError::AlgebraicLoop));
}
