use cycle::Regression;
use proptest::prelude::*;

use crate::support::assert_close;

/// NIST StRD, data set Norris: reference and feedback.
const NORRIS: [(f64, f64); 36] = [
    (0.2, 0.1),
    (337.4, 338.8),
    (118.2, 118.1),
    (884.6, 888.0),
    (10.1, 9.2),
    (226.5, 228.1),
    (666.3, 668.5),
    (996.3, 998.5),
    (448.6, 449.1),
    (777.0, 778.9),
    (558.2, 559.2),
    (0.4, 0.3),
    (0.6, 0.1),
    (775.5, 778.1),
    (666.9, 668.8),
    (338.0, 339.3),
    (447.5, 448.9),
    (11.6, 10.8),
    (556.0, 557.7),
    (228.1, 228.3),
    (995.8, 998.0),
    (887.6, 888.8),
    (120.2, 119.6),
    (0.3, 0.3),
    (0.3, 0.6),
    (556.8, 557.6),
    (339.1, 339.3),
    (887.2, 888.0),
    (999.0, 998.5),
    (779.0, 778.9),
    (11.1, 10.2),
    (118.3, 117.6),
    (229.2, 228.9),
    (669.1, 668.4),
    (448.9, 449.2),
    (0.5, 0.2),
];

#[test]
fn ref_norris_to_all_certified_digits() {
    // Tenths are no binary numbers: in units of a tenth the data are exact.
    let tenths = NORRIS.map(|(r, y)| ((10.0 * r).round(), (10.0 * y).round()));
    let line = Regression::of(&tenths).unwrap();
    let certified = |value: f64| format!("{value:.14e}");
    assert_eq!(certified(line.slope), "1.00211681802045e0");
    assert_eq!(certified(line.intercept / 10.0), "-2.62323073774029e-1");
    assert_close(line.standard_error, 8.84796396144373, 1e-15);
    assert_eq!(certified(line.determination), "9.99993745883712e-1");
    let line = Regression::of(&NORRIS).unwrap();
    assert_close(line.slope, 1.00211681802045, 3e-14);
    assert_close(line.intercept, -0.262323073774029, 3e-14);
}

#[test]
fn ref_intercept_of_the_regulations_example() {
    // 40 CFR 1065.602: means 1050.1 and 1055.3, slope 1.0110.
    let pairs: Vec<(f64, f64)> =
        [-300.0, -20.0, 20.0, 300.0].iter().map(|d| (1055.3 + d, 1050.1 + 1.0110 * d)).collect();
    assert_close(Regression::of(&pairs).unwrap().intercept, -16.8083, 1e-6);
}

#[test]
fn exact_what_has_no_line_gives_none() {
    assert_eq!(Regression::of(&[(1.0, 1.0), (2.0, 2.0)]), None);
    assert_eq!(Regression::of(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]), None);
}

proptest! {
    #[test]
    fn prop_a_line_far_from_zero_keeps_its_digits(slope in 0.5_f64..2.0, offset in 1e3_f64..1e7) {
        let pairs: Vec<(f64, f64)> = (0..50).map(|k| offset + f64::from(k)).map(|r| (r, slope * (r - offset))).collect();
        let line = Regression::of(&pairs).unwrap();
        prop_assert!((line.slope - slope).abs() < 1e-8);
        prop_assert!((line.intercept + slope * offset).abs() < 1e-8 * offset);
    }
}

#[test]
fn ref_scipy_linregress() {
    let Some(python) = testdata::python() else { return };
    let script = "import numpy as np\nfrom scipy.stats import linregress\nk=np.arange(600)\nr=150+100*np.sin(0.37*k)\ny=3+0.97*r+5*np.cos(1.1*k)\n\
                  a=linregress(r,y)\nn=y-a.intercept-a.slope*r\nprint(repr(float(a.slope)),repr(float(a.intercept)),repr(float(np.sqrt((n**2).sum()/598))),repr(float(a.rvalue**2)))";
    let output = std::process::Command::new(python).args(["-c", script]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let theirs: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
    assert_eq!(theirs.len(), 4, "{}", String::from_utf8_lossy(&output.stderr));
    let pairs: Vec<(f64, f64)> = (0..600)
        .map(|k| {
            let k = f64::from(k);
            let r = 150.0 + 100.0 * (0.37 * k).sin();
            (r, 3.0 + 0.97 * r + 5.0 * (1.1 * k).cos())
        })
        .collect();
    let ours = Regression::of(&pairs).unwrap();
    for (ours, theirs) in [ours.slope, ours.intercept, ours.standard_error, ours.determination].into_iter().zip(theirs)
    {
        assert_close(ours, theirs, 1e-11);
    }
}
