//! Systems at the edges: no states, no channels, nothing to reduce, numbers written and read.

use faer::{Mat, mat};
use lti::{Complex64, Discretisation, LtiError, Reduction, StateSpace, TransferFunction, ZeroPoleGain};

const METHODS: [Discretisation; 5] = [
    Discretisation::ZeroOrderHold,
    Discretisation::FirstOrderHold,
    Discretisation::Tustin { prewarp_rad_s: Some(3.0) },
    Discretisation::ImpulseInvariant,
    Discretisation::Matched,
];

#[test]
fn exact_mere_gains_stay_gains() {
    let gain = StateSpace::gain(mat![[2.0]], None).unwrap();
    let ratio = TransferFunction::continuous(vec![2.0], vec![1.0]).unwrap();
    for method in METHODS.into_iter().filter(|m| *m != Discretisation::ImpulseInvariant) {
        assert_eq!(gain.to_discrete(method, 0.1).unwrap().d()[(0, 0)], 2.0);
        let sampled = ratio.to_discrete(method, 0.1).unwrap();
        assert!(sampled.dc_gain() == 2.0 && sampled.to_continuous(method).unwrap().dc_gain() == 2.0, "{method:?}");
        assert_eq!(sampled.resampled(method, 0.2).unwrap().dc_gain(), 2.0);
    }
    assert!(gain.hankel_singular_values().unwrap().is_empty());
    assert_eq!(gain.reduced(0, Reduction::SingularPerturbation).unwrap(), gain);
    assert_eq!(gain.minimal(1e-10).unwrap(), gain);
    assert!(gain.modes().unwrap().is_empty());
    let y = gain.step_response(0, &gain.time_grid().unwrap()).unwrap();
    assert!((0..y.nrows()).all(|k| y[(k, 0)] == 2.0));
    let zero = TransferFunction::continuous(vec![0.0], vec![1.0, 1.0]).unwrap();
    for method in METHODS {
        assert_eq!(zero.to_discrete(method, 0.1).unwrap().dc_gain(), 0.0, "{method:?}");
    }
    assert_eq!(zero.to_zero_pole_gain().unwrap().gain(), 0.0);
}

#[test]
fn exact_systems_without_inputs_or_outputs_pass() {
    let closed = StateSpace::continuous(mat![[-1.0]], Mat::zeros(1, 0), Mat::zeros(0, 1), Mat::zeros(0, 0)).unwrap();
    for method in METHODS.into_iter().filter(|m| *m != Discretisation::Matched) {
        let back = closed.to_discrete(method, 0.1).unwrap().to_continuous(method).unwrap();
        assert!((back.a()[(0, 0)] + 1.0).abs() < 1e-14);
    }
    assert!(matches!(closed.to_discrete(Discretisation::Matched, 0.1), Err(LtiError::NotSiso { .. })));
    assert_eq!(closed.hankel_singular_values().unwrap(), [0.0]);
    assert_eq!(closed.balanced().unwrap().states(), 0);
    assert_eq!(closed.minimal(1e-10).unwrap().states(), 0);
}

#[test]
fn exact_roots_that_are_no_real_system_are_refused() {
    let c = Complex64::new;
    let refused = |roots: Vec<Complex64>| ZeroPoleGain::continuous(vec![], roots, 1.0).unwrap_err();
    assert!(matches!(refused(vec![c(-1.0, 1.0)]), LtiError::NotConjugate { .. }));
    assert!(matches!(refused(vec![c(-1.0, 1.0), c(-1.0, -2.0)]), LtiError::NotConjugate { .. }));
    assert!(matches!(refused(vec![c(-1.0, 1.0), c(-1.0, 1.0)]), LtiError::NotConjugate { .. }));
    assert!(matches!(refused(vec![c(f64::NAN, 0.0)]), LtiError::NonFinite { .. }));
    let improper = ZeroPoleGain::continuous(vec![c(1.0, 0.0)], vec![], 1.0).unwrap();
    assert!(matches!(improper.to_state_space(), Err(LtiError::Improper { .. })));
    let double = vec![c(-1.0, 2.0), c(-1.0, 2.0), c(-1.0, -2.0), c(-1.0, -2.0)];
    assert_eq!(ZeroPoleGain::continuous(vec![], double, 1.0).unwrap().poles().len(), 4);
}

#[test]
fn exact_models_are_written_and_read() {
    let c = Complex64::new;
    let model = ZeroPoleGain::discrete(vec![c(0.5, 0.0)], vec![c(0.25, 0.5), c(0.25, -0.5)], 2.0, 0.1).unwrap();
    let model = model.with_delay(0.25).unwrap();
    let text = serde_json::to_string(&model).unwrap();
    assert_eq!(serde_json::from_str::<ZeroPoleGain>(&text).unwrap(), model);
    assert!(serde_json::from_str::<ZeroPoleGain>(&text.replace("-0.5", "-0.75")).is_err());
    for method in METHODS {
        let text = serde_json::to_string(&method).unwrap();
        assert_eq!(serde_json::from_str::<Discretisation>(&text).unwrap(), method);
    }
}

/// Twelve poles of a drive train sampled at 20 kHz: the polynomial would lose them, matrices and roots do not.
#[test]
fn exact_many_poles_near_the_unit_circle_come_back() {
    let modes = [(3.0, 0.5), (7.0, 0.05), (40.0, 0.02), (90.0, 0.01), (300.0, 0.02), (900.0, 0.03)];
    let poles: Vec<Complex64> = modes
        .iter()
        .map(|(w, zeta): &(f64, f64)| Complex64::new(-w * zeta, w * (1.0 - zeta * zeta).sqrt()))
        .flat_map(|p| [p, p.conj()])
        .collect();
    let gain = poles.iter().map(|p| p.norm()).product::<f64>();
    let system = ZeroPoleGain::continuous(vec![], poles.clone(), gain).unwrap();
    let matrices = system.to_state_space().unwrap();
    for method in [Discretisation::ZeroOrderHold, Discretisation::FirstOrderHold, METHODS[2]] {
        let back = matrices.to_discrete(method, 5e-5).unwrap().to_continuous(method).unwrap().poles().unwrap();
        for pole in &poles {
            let nearest = back.iter().map(|p| (p - pole).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-8 * pole.norm(), "{method:?}: {pole} by {nearest:e}");
        }
    }
}

/// The units of an input change nothing but the size of what it does.
#[test]
fn exact_holds_do_not_depend_on_units() {
    let system = |unit: f64| {
        let (a, b) = (mat![[0.0, 1.0], [-40.0, -3.0]], mat![[0.3 * unit], [2.0 * unit]]);
        StateSpace::continuous(a, b, mat![[1.0, 0.5]], mat![[0.0]]).unwrap()
    };
    for unit in [2_f64.powi(60), 2_f64.powi(-60)] {
        for method in [Discretisation::ZeroOrderHold, Discretisation::FirstOrderHold] {
            let (plain, other) = (system(1.0).to_discrete(method, 0.05), system(unit).to_discrete(method, 0.05));
            let (plain, other) = (plain.unwrap(), other.unwrap());
            assert_eq!((plain.a(), plain.b() * faer::Scale(unit)), (other.a(), other.b().to_owned()), "{method:?}");
            let back = other.to_continuous(method).unwrap();
            assert!((back.a() - system(unit).a()).norm_max() < 1e-11);
            assert!((back.b() - system(unit).b()).norm_max() < 1e-12 * unit);
        }
    }
}
