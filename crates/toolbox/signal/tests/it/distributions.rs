use signal::distributions::{
    chi_squared_quantile, chi_squared_tail, f_quantile, f_tail, holm, interval, normal_quantile, student_t_quantile,
};

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} is not {b}");
}

/// scipy.stats.t.ppf(p, n), SciPy 1.x.
#[test]
fn ref_student_t_quantiles_equal_scipy() {
    close(student_t_quantile(0.975, 1.0), 12.706204736174694, 1e-12);
    close(student_t_quantile(0.975, 5.0), 2.5705818356363146, 1e-12);
    close(student_t_quantile(0.995, 39.0), 2.707913183517662, 1e-12);
    close(student_t_quantile(0.975, 1e3), 1.9623390808264078, 1e-12);
    close(student_t_quantile(0.975, 1e5), 1.9599877075346095, 1e-12);
    close(student_t_quantile(0.975, 1e7), 1.959964221767205, 1e-12);
}

#[test]
fn ref_normal_and_chi_squared_quantiles_equal_scipy() {
    close(normal_quantile(0.995), 2.5758293035489004, 1e-12);
    close(chi_squared_quantile(0.99, 2.0), 9.210340371976182, 1e-10);
}

#[test]
fn prop_student_t_is_continuous_where_the_method_changes() {
    close(student_t_quantile(0.975, 9.999e3), student_t_quantile(0.975, 1.0001e4), 1e-7);
}

#[test]
fn exact_interval_is_symmetric() {
    let (low, high) = interval(3.0, 0.5, 1e9, 0.95);
    close(3.0 - low, high - 3.0, 1e-12);
    close(high - 3.0, 0.5 * 1.959963984540054, 1e-8);
}

/// scipy.stats.f.ppf, f.sf and chi2.sf.
#[test]
fn ref_f_and_chi_squared_equal_scipy() {
    close(f_quantile(0.95, 2.0, 10.0), 4.1028210151304, 1e-10);
    close(f_quantile(0.99, 3.0, 1e5), 3.7818178515912035, 1e-8);
    close(f_quantile(0.95, 2.0, 9e6), 2.995733270711084, 1e-9);
    close(f_quantile(0.95, 2.0, 2e7), 2.995732722274628, 1e-9);
    close(f_tail(f_quantile(0.99, 3.0, 1e5), 3.0, 1e5), 0.01, 1e-9);
    close(f_quantile(0.99, 3.0, 2.9999e4), f_quantile(0.99, 3.0, 3.0001e4), 1e-7);
    close(f_tail(3.5, 4.0, 50.0), 0.013507380248756947, 1e-12);
    close(chi_squared_tail(30.0, 12.0), 0.0027924293327009145, 1e-12);
    assert_eq!(chi_squared_tail(0.0, 0.0), 1.0);
}

/// SciPy 1.17: `chi2.ppf(p, nu)`.
#[test]
fn ref_chi_squared_quantiles_of_few_and_many_degrees() {
    let cases = [
        (0.025, 1.0, 0.0009820691171752555),
        (0.975, 1.0, 5.023886187314888),
        (0.025, 2.0, 0.05063561596857975),
        (0.975, 2.0, 7.377758908227871),
        (0.005, 37.3, 18.796328107425605),
        (0.995, 37.3, 63.2731793264587),
        (0.025, 2400.0, 2266.113830823127),
        (0.999, 200000.0, 201960.13558391845),
    ];
    for (p, freedom, expected) in cases {
        close(chi_squared_quantile(p, freedom), expected, 1e-9);
    }
}

#[test]
fn exact_holm_raises_probabilities_of_several_tests() {
    let raised = holm(&[0.01, 0.04, 0.03, 0.005]);
    for (found, expected) in raised.iter().zip([0.03, 0.06, 0.06, 0.02]) {
        assert!((found - expected).abs() < 1e-12, "{raised:?}");
    }
    assert_eq!(holm(&[0.6, 0.7]), [1.0, 1.0]);
}
