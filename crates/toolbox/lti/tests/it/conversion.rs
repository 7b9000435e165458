//! Connections, zeros, delays, refusals.

use faer::{Mat, mat};
use lti::{Complex64, LtiError, StateSpace, TransferFunction};

use crate::{assert_close, column};

fn lag(time_constant: f64) -> StateSpace {
    TransferFunction::continuous(vec![1.0], vec![time_constant, 1.0]).unwrap().to_state_space().unwrap()
}

#[test]
fn exact_connections_have_the_gains_of_their_formulas() {
    let with_feed_through =
        TransferFunction::continuous(vec![0.3, 2.0], vec![1.0, 5.0]).unwrap().to_state_space().unwrap();
    let (p, q) = (with_feed_through, lag(0.2));
    let point = Complex64::new(0.1, 3.0);
    let at = |s: &StateSpace| s.evaluate(point)[(0, 0)];
    let (gp, gq) = (at(&p), at(&q));
    assert!((at(&p.series(&q).unwrap()) - gp * gq).norm() < 1e-14);
    assert!((at(&p.parallel(&q).unwrap()) - gp - gq).norm() < 1e-14);
    assert!((at(&p.feedback(&q).unwrap()) - gp / (gp * gq + 1.0)).norm() < 1e-14);
    assert!((at(&p.feedback(&p).unwrap()) - gp / (gp * gp + 1.0)).norm() < 1e-14);
}

#[test]
fn exact_transfer_function_loop_equals_state_space_loop() {
    let plant = TransferFunction::continuous(vec![2.0, 1.0], vec![1.0, 3.0, 2.0]).unwrap();
    let back = TransferFunction::continuous(vec![4.0], vec![1.0, 7.0]).unwrap();
    let one = plant.feedback(&back).unwrap();
    let two = plant.to_state_space().unwrap().feedback(&back.to_state_space().unwrap()).unwrap();
    let point = Complex64::new(0.0, 1.7);
    assert!((one.evaluate(point) - two.evaluate(point)[(0, 0)]).norm() < 1e-13);
}

#[test]
fn exact_algebraic_loops_are_refused() {
    let gain = |d: f64| StateSpace::gain(mat![[d]], None).unwrap();
    assert_eq!(gain(2.0).feedback(&gain(-0.5)), Err(LtiError::AlgebraicLoop));
    assert_eq!(gain(2.0).feedback(&gain(1.0)).unwrap().d()[(0, 0)], 2.0 / 3.0);
    let discrete = StateSpace::gain(mat![[1.0]], Some(0.1)).unwrap();
    assert!(matches!(gain(1.0).series(&discrete), Err(LtiError::SampleTimesDiffer { .. })));
}

/// Whatever the form, a loop that is one of gains alone at infinite frequency has no solution, rounding or not.
#[test]
fn regress_algebraic_loops_are_refused_in_both_forms() {
    let rational = |num: Vec<f64>, den: Vec<f64>| TransferFunction::continuous(num, den).unwrap();
    let gain = |k: f64| rational(vec![k], vec![1.0]);
    let pairs = [
        (rational(vec![1.0, 2.0], vec![1.0, 1.0]), gain(-1.0)),
        (rational(vec![3e7, 2.0], vec![1e8, 1.0]), gain(-10.0 / 3.0)),
        (rational(vec![0.1, 5.0], vec![0.3, 1.0]), rational(vec![-9.0, 1.0], vec![3.0, 7.0])),
    ];
    for (forward, back) in pairs {
        assert_eq!(forward.feedback(&back), Err(LtiError::AlgebraicLoop), "{forward:?}");
        let (forward, back) = (forward.to_state_space().unwrap(), back.to_state_space().unwrap());
        assert_eq!(forward.feedback(&back), Err(LtiError::AlgebraicLoop), "{forward:?}");
    }
    let nearly = rational(vec![1.0, 2.0], vec![1.0, 1.0]).feedback(&gain(-1.0 + 1e-9)).unwrap();
    assert_eq!(nearly.den().len(), 2);
}

#[test]
fn exact_a_loop_takes_whole_samples_of_delay_in() {
    let late = TransferFunction::discrete(vec![0.5], vec![1.0, -0.8], 0.1).unwrap().with_delay(0.2).unwrap();
    let gain = TransferFunction::discrete(vec![0.3], vec![1.0], 0.1).unwrap();
    for (forward, back) in [(&late, &gain), (&gain, &late)] {
        let closed = forward.feedback(back).unwrap();
        let w = 4.0;
        let at = |system: &TransferFunction| system.frequency_response(&[w]).unwrap().response[0];
        let expected = at(forward) / (1.0 + at(forward) * at(back));
        assert!((at(&closed) - expected).norm() < 1e-14 && closed.delay_s() == 0.0);
    }
    let between = late.clone().with_delay(0.25).unwrap();
    assert!(matches!(between.feedback(&gain), Err(LtiError::FractionalDelay { .. })));
    let continuous = |num: f64| TransferFunction::continuous(vec![num], vec![1.0, 1.0]).unwrap();
    let delayed = continuous(1.0).with_delay(0.2).unwrap();
    assert!(matches!(continuous(1.0).feedback(&delayed), Err(LtiError::DelayPresent { .. })));
}

#[test]
fn exact_integrators_have_no_gain_at_rest() {
    let integrator = TransferFunction::continuous(vec![1.0], vec![1.0, 2.0, 0.0]).unwrap();
    assert!(matches!(integrator.to_state_space().unwrap().dc_gain(), Err(LtiError::Singular { .. })));
    assert_eq!(integrator.dc_gain(), f64::INFINITY);
    assert!(!integrator.to_state_space().unwrap().is_stable().unwrap());
    assert!(lag(1.0).is_stable().unwrap());
}

#[test]
fn exact_zeros_of_a_two_mass_drive() {
    // Two inertias and a shaft: torque on the first to its speed, and to the second's.
    let (j1, j2, k, b) = (0.1, 0.05, 5e3, 0.4);
    let a = mat![[-b / j1, b / j1, -k / j1], [b / j2, -b / j2, k / j2], [1.0, -1.0, 0.0]];
    let drive = StateSpace::continuous(
        a,
        mat![[1.0 / j1], [0.0], [0.0]],
        mat![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        Mat::zeros(2, 1),
    )
    .unwrap();
    // Collocated: J₂s² + Bs + K. The other: Bs + K.
    let own = drive.channel(0, 0).unwrap().zeros().unwrap();
    assert_eq!(own.len(), 2);
    assert!(own.iter().all(|z| (z.norm() - (k / j2).sqrt()).abs() < 1e-8 && (z.re + b / j2 / 2.0).abs() < 1e-8));
    let far = drive.channel(1, 0).unwrap().zeros().unwrap();
    assert!(far.len() == 1 && (far[0].re + k / b).abs() < 1e-6 * k / b, "{far:?}");
    let tf = drive.channel(1, 0).unwrap().to_transfer_function().unwrap();
    assert!((tf.num()[0] - b / (j1 * j2)).abs() < 1e-9 * tf.num()[0]);
    assert!(matches!(drive.zeros(), Err(LtiError::NotSiso { .. })));
}

#[test]
fn exact_zero_systems_and_gains() {
    let deaf = StateSpace::continuous(mat![[-1.0]], mat![[0.0]], mat![[1.0]], mat![[0.0]]).unwrap();
    assert_eq!(deaf.zeros(), Err(LtiError::ZeroSystem));
    assert_eq!(deaf.to_transfer_function().unwrap().num(), &[0.0]);
    let gain = StateSpace::gain(mat![[3.0]], None).unwrap();
    assert_eq!(gain.to_transfer_function().unwrap().num(), &[3.0]);
    let back = TransferFunction::continuous(vec![3.0], vec![1.0]).unwrap().to_state_space().unwrap();
    assert_eq!((back.states(), back.d()[(0, 0)]), (0, 3.0));
}

#[test]
fn exact_delays_of_parts_of_a_sample() {
    // A lag behind a delay answers a step at 0 with 1 − e^{−(t − delay)/τ}; two inputs, two delays.
    let both = StateSpace::continuous(mat![[-4.0]], mat![[4.0, 8.0]], mat![[1.0]], mat![[0.0, 1.0]]).unwrap();
    let t = 0.01;
    for (first, second) in [(0.0, 0.033), (0.0177, 0.05), (0.004, 0.0999)] {
        let delayed = both.to_discrete_delayed(&[first, second], t).unwrap();
        let u = Mat::full(60, 2, 1.0);
        let y = delayed.simulate(u.as_ref(), &[0.0], &[0.0, 0.0]).unwrap();
        let rise = |time: f64| 1.0 - (-4.0 * time.max(0.0)).exp();
        for k in 0..60 {
            let time = k as f64 * t;
            let through = f64::from(u8::from(time - second > -1e-9));
            let truth = rise(time - first) + 2.0 * rise(time - second) + through;
            assert!((y[(k, 0)] - truth).abs() < 1e-13, "{k}: {} for {truth}", y[(k, 0)]);
        }
        let ordinary = delayed.to_state_space().unwrap();
        let z = ordinary.simulate(u.as_ref(), &vec![0.0; ordinary.states()]).unwrap();
        assert_close(z.as_ref(), y.as_ref(), 1e-13);
    }
    assert!(matches!(both.to_discrete_delayed(&[-0.1, 0.0], t), Err(LtiError::Delay { .. })));
    assert!(matches!(both.to_discrete_delayed(&[1e300, 0.0], t), Err(LtiError::Delay { .. })));
}

#[test]
fn exact_wrong_shapes_and_kinds_are_refused() {
    let bad = StateSpace::continuous(mat![[1.0]], mat![[1.0], [2.0]], mat![[1.0]], mat![[0.0]]);
    assert_eq!(bad, Err(LtiError::shape("B", (1, 1), (2, 1))));
    let u = column(&[1.0]);
    assert_eq!(lag(1.0).simulate(u.as_ref(), &[0.0]), Err(LtiError::NotDiscrete));
    let sampled = lag(1.0).to_discrete_zoh(0.1).unwrap();
    assert!(matches!(sampled.simulate(u.as_ref(), &[]), Err(LtiError::Shape { .. })));
    assert!(matches!(sampled.to_discrete_zoh(0.1), Err(LtiError::NotContinuous)));
    let improper = TransferFunction::continuous(vec![1.0, 0.0, 0.0], vec![1.0, 1.0]).unwrap();
    assert_eq!(improper.to_state_space(), Err(LtiError::Improper { numerator: 2, denominator: 1 }));
    let late = TransferFunction::continuous(vec![1.0], vec![1.0, 1.0]).unwrap().with_delay(0.1).unwrap();
    assert_eq!(late.to_state_space(), Err(LtiError::DelayPresent { delay_s: 0.1 }));
}

#[test]
fn exact_systems_survive_being_written_and_read() {
    let system = lag(0.3);
    let text = serde_json::to_string(&system).unwrap();
    assert_eq!(serde_json::from_str::<StateSpace>(&text).unwrap(), system);
    let gain = StateSpace::gain(mat![[1.0, 2.0]], Some(0.1)).unwrap();
    let text = serde_json::to_string(&gain).unwrap();
    assert_eq!(serde_json::from_str::<StateSpace>(&text).unwrap(), gain);
    assert!(serde_json::from_str::<StateSpace>(&text.replace("\"inputs\":2", "\"inputs\":3")).is_err());
    let h = TransferFunction::continuous(vec![1.0], vec![1.0, 1.0]).unwrap().frequency_response(&[1.0]).unwrap();
    let text = serde_json::to_string(&h).unwrap();
    assert_eq!(serde_json::from_str::<lti::FrequencyResponse>(&text).unwrap(), h);
}

#[test]
fn exact_phase_is_unwrapped_across_a_delay() {
    let delay = TransferFunction::continuous(vec![1.0], vec![1.0]).unwrap().with_delay(1.0).unwrap();
    let grid: Vec<f64> = (0..200).map(|i| 0.1 * f64::from(i)).collect();
    let phase = delay.frequency_response(&grid).unwrap().phase_deg();
    assert!((phase[199] + 19.9_f64.to_degrees()).abs() < 1e-9);
}

/// Units of input and output: zeros stay, with a feed-through and without.
#[test]
fn prop_zeros_do_not_depend_on_the_scale_of_input_and_output() {
    let a = mat![[0.5, 0.3, 0.0], [-0.2, 0.7, 0.1], [0.0, 0.4, -0.3]];
    let (b, c) = (mat![[1.0], [0.5], [-0.3]], mat![[0.7, -0.2, 1.0]]);
    for d in [0.0, 0.4] {
        let zeros = |input: f64, output: f64| {
            let (b, c) = (faer::Scale(input) * &b, faer::Scale(output) * &c);
            let system = StateSpace::discrete(a.clone(), b, c, mat![[d * input * output]], 0.1).unwrap();
            let mut zeros = system.zeros().unwrap();
            zeros.sort_by(|x, y| (x.re, x.im).partial_cmp(&(y.re, y.im)).unwrap());
            zeros
        };
        let wanted = zeros(1.0, 1.0);
        assert_eq!(wanted.len(), if d == 0.0 { 2 } else { 3 });
        for (input, output) in [(1e-15, 1.0), (1e-15, 1e-15), (1e15, 1e-15), (1.0, 1e-30), (1e12, 1e15), (1.0, 1e-15)] {
            let found = zeros(input, output);
            assert_eq!(found.len(), wanted.len(), "{d} {input} {output}");
            assert!(found.iter().zip(&wanted).all(|(f, w)| (f - w).norm() < 1e-12), "{d} {input} {output} {found:?}");
        }
    }
}
