use signal::spline::UniformSpline;

#[test]
fn exact_straight_lines_are_kept_with_their_slope() {
    let spline = UniformSpline::new((0..9).map(|i| 2.0 * f64::from(i) - 1.0).collect()).unwrap();
    for position in [0.0, 0.3, 4.5, 8.0, 9.5] {
        assert!((spline.value(position) - (2.0 * position - 1.0)).abs() < 1e-12);
        assert!((spline.slope(position) - 2.0).abs() < 1e-12);
    }
}

#[test]
fn exact_sinusoid_is_met_to_fourth_order_away_from_the_ends() {
    let omega = 0.2_f64;
    let spline = UniformSpline::new((0..400).map(|i| (omega * f64::from(i)).sin()).collect()).unwrap();
    for i in 0..100 {
        let t = 100.0 + 1.37 * f64::from(i);
        assert!((spline.value(t) - (omega * t).sin()).abs() < omega.powi(4) / 300.0);
        assert!((spline.slope(t) - omega * (omega * t).cos()).abs() < omega.powi(4) / 50.0);
        assert!((spline.curvature(t) + omega * omega * (omega * t).sin()).abs() < omega.powi(4) / 6.0);
    }
}

#[test]
fn prop_derivatives_equal_differences() {
    let values: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17)).collect();
    let spline = UniformSpline::new(values).unwrap();
    let h = 1e-5;
    for i in 0..40 {
        let t = 1.31 + 1.07 * f64::from(i);
        assert!(((spline.value(t + h) - spline.value(t - h)) / (2.0 * h) - spline.slope(t)).abs() < 1e-6);
        assert!(((spline.slope(t + h) - spline.slope(t - h)) / (2.0 * h) - spline.curvature(t)).abs() < 1e-6);
        assert!(((spline.curvature(t + h) - spline.curvature(t - h)) / (2.0 * h) - spline.jerk(t)).abs() < 1e-6);
    }
}

#[test]
fn regress_too_few_samples_are_refused() {
    assert!(UniformSpline::new(vec![1.0, 2.0]).is_err());
}
