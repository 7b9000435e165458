use ident::validate::{fit_percent, residual_correlations, rms_error};

use crate::noise::Noise;

#[test]
fn exact_fit_of_mean_is_zero_and_of_truth_hundred() {
    let y = [1.0, 2.0, 3.0, 6.0];
    assert_eq!(fit_percent(&y, &y).unwrap(), 100.0);
    assert!(fit_percent(&y, &[3.0; 4]).unwrap().abs() < 1e-12);
    assert!((rms_error(&y, &[2.0, 3.0, 4.0, 7.0]).unwrap() - 1.0).abs() < 1e-15);
    assert!(fit_percent(&y, &[1.0]).is_err());
}

#[test]
fn exact_cross_correlation_finds_a_missed_lag() {
    let mut noise = Noise::new(4);
    let input = noise.normals(2000);
    let residuals: Vec<f64> = (0..2000).map(|t: usize| if t >= 3 { input[t - 3] } else { 0.0 }).collect();
    let test = residual_correlations(&residuals, &input, 25, 0.99).unwrap();
    let peak = (0..test.cross.len()).max_by(|a, b| test.cross[*a].total_cmp(&test.cross[*b])).unwrap();
    assert_eq!(peak as isize - 25, 3);
}

#[test]
fn stat_regions_hold_ninety_nine_percent_of_lags_under_independence() {
    let mut noise = Noise::new(5);
    let (mut outside_cross, mut outside_auto, mut total) = (0, 0, 0);
    for _ in 0..200 {
        let residuals = noise.normals(1000);
        let mut state = 0.0;
        let input: Vec<f64> = (0..1000)
            .map(|_| {
                state = 0.8 * state + noise.normal();
                state
            })
            .collect();
        let test = residual_correlations(&residuals, &input, 25, 0.99).unwrap();
        outside_cross += test.cross.iter().filter(|c| c.abs() > test.cross_bound).count();
        outside_auto += test.auto[1..].iter().filter(|c| c.abs() > test.auto_bound).count();
        total += 25;
    }
    let cross = outside_cross as f64 / (2.0 * f64::from(total) + 200.0);
    let auto = outside_auto as f64 / f64::from(total);
    assert!((0.003..0.02).contains(&cross), "{cross}");
    assert!((0.003..0.02).contains(&auto), "{auto}");
}

#[test]
fn regress_constant_signals_are_refused() {
    assert!(residual_correlations(&[0.0; 500], &[1.0; 500], 25, 0.99).is_err());
    assert!(residual_correlations(&[0.0; 10], &[1.0; 10], 25, 0.99).is_err());
}
