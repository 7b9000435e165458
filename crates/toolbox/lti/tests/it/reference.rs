//! Agreement with SciPy 1.17.

use faer::{Mat, mat};
use lti::{Complex64, StateSpace, expm};

use crate::assert_close;

/// Two masses, a stiff shaft and 0.05 s: from mpmath's `expm` with 60 digits, rounded. `scipy.linalg.expm` is within
/// 8e-14 of it.
#[test]
fn ref_exponential_of_a_two_mass_drive() {
    let a = mat![[0.0, 1.0, 0.0, 0.0], [-1e4, -2.0, 1e4, 2.0], [0.0, 0.0, 0.0, 1.0], [5e5, 100.0, -5e5, -1100.0],];
    let expected = mat![
        [0.36936417559219914, 0.031977860994043386, 0.6306358244078009, 0.0006244787710591351],
        [-7.539224410866292, 0.3678563307100259, 7.539224410866292, 0.007664898230839015],
        [0.3848158342916098, 0.031223938552956756, 0.6151841657083902, 0.0006087695435625447],
        [-7.8546137482952005, 0.3832449115419508, 7.8546137482952005, 0.007985544895504515],
    ];
    assert_close(expm((a * faer::Scale(0.05)).as_ref()).unwrap().as_ref(), expected.as_ref(), 4e-13);
}

/// Eigenvalues near −0.01, −1, −100 and −10 000; made as above. `scipy.linalg.expm` is within 2e-12 of it.
#[test]
fn ref_exponential_of_a_stiff_matrix() {
    let a = mat![
        [-3847.226, 2307.538, -6922.613, 5384.915],
        [-3754.385, 2192.231, -6876.692, 5315.538],
        [-7661.534, 4576.922, -13830.767, 10746.145],
        [-3846.683, 2307.614, -6922.842, 5384.752],
    ];
    let expected = mat![
        [-0.06056319738158694, 0.13277462707592633, -0.39831911318797913, 0.7244267580212158],
        [0.19798706958180287, 0.02835788789624671, -0.08507051808720448, -0.05620388737409377],
        [-0.45652035736915564, 0.07605368572488144, -0.2281625803759354, 0.8367917258810771],
        [-0.7150657311800174, 0.18046894291684235, -0.5414067295242412, 1.6174100682079144],
    ];
    assert_close(expm(a.as_ref()).unwrap().as_ref(), expected.as_ref(), 1e-11);
}

fn oscillator() -> StateSpace {
    StateSpace::continuous(mat![[0.0, 1.0], [-40.0, -3.0]], mat![[0.0], [2.0]], mat![[1.0, 0.5]], mat![[0.1]]).unwrap()
}

/// `cont2discrete(…, 0.05, 'zoh')` and `'foh'`.
#[test]
fn ref_discretisation() {
    let a = mat![[0.9528002711206536, 0.04566097794324584], [-1.826439117729834, 0.815817337290916]];
    let zoh = oscillator().to_discrete_zoh(0.05).unwrap();
    assert_close(zoh.a(), a.as_ref(), 1e-14);
    assert_close(zoh.b(), mat![[0.002359986443967322], [0.0913219558864917]].as_ref(), 1e-14);
    let foh = oscillator().to_discrete_foh(0.05).unwrap().to_state_space().unwrap();
    assert_close(foh.a(), a.as_ref(), 1e-14);
    assert_close(foh.b(), mat![[0.004477457639045329], [0.08116918186305953]].as_ref(), 1e-14);
    assert_close(foh.d(), mat![[0.1243989068304764]].as_ref(), 1e-14);
}

/// `freqresp` at 1, 6 and 30 rad/s; `ss2tf`; `ss2zpk`.
#[test]
fn ref_response_zeros_and_transfer_function() {
    let h = oscillator().frequency_response(0, 0, &[1.0, 6.0, 30.0]).unwrap();
    let expected = [(0.15294118, 0.02156863), (0.44117647, -0.03529412), (0.10131069, -0.03474656)];
    for (got, (re, im)) in h.response.iter().zip(expected) {
        assert!((got - Complex64::new(re, im)).norm() < 1e-8);
    }
    let tf = oscillator().to_transfer_function().unwrap();
    let close = |got: &[f64], expected: &[f64]| {
        got.len() == expected.len() && got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12)
    };
    assert!(close(tf.num(), &[0.1, 1.3, 6.0]), "{tf:?}");
    assert!(close(tf.den(), &[1.0, 3.0, 40.0]), "{tf:?}");
    let zeros = oscillator().zeros().unwrap();
    assert!(zeros.iter().all(|z| (z.re + 6.5).abs() < 1e-8 && (z.im.abs() - 4.21307489).abs() < 1e-8));
}

#[test]
fn exact_exponential_of_a_nilpotent_and_of_a_badly_scaled_matrix() {
    let n = mat![[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0_f64]];
    let expected = mat![[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0_f64]];
    assert_close(expm(n.as_ref()).unwrap().as_ref(), expected.as_ref(), 1e-15);
    // A rotation in units a million apart.
    let e = expm(mat![[0.0, 1e6], [-1e-6, 0.0_f64]].as_ref()).unwrap();
    assert!((e[(0, 1)] / 1e6 - 1.0_f64.sin()).abs() < 1e-14);
    assert!(expm(Mat::<f64>::zeros(2, 3).as_ref()).is_err());
    assert!(expm(mat![[f64::NAN]].as_ref()).is_err() && expm(mat![[1e4]].as_ref()).is_err());
}
