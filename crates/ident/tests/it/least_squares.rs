use faer::Mat;
use ident::{IdentError, least_squares};

use crate::noise::Noise;

#[test]
fn exact_badly_scaled_columns_are_solved() {
    let mut noise = Noise::new(1);
    let truth = [3e-9, -2.0, 5e8];
    let phi = Mat::from_fn(10_000, 3, |_, j| noise.normal() * [1e9, 1.0, 1e-8][j]);
    let y: Vec<f64> = (0..10_000).map(|i| (0..3).map(|j| phi[(i, j)] * truth[j]).sum()).collect();
    let fit = least_squares(phi.as_ref(), &y).unwrap();
    for (estimate, truth) in fit.parameters.iter().zip(truth) {
        assert!((estimate / truth - 1.0).abs() < 1e-12);
    }
    assert!(fit.condition < 2.0);
}

#[test]
fn stat_intervals_cover_the_truth_as_often_as_they_claim() {
    let (runs, mut covered) = (2000, 0);
    let mut noise = Noise::new(2);
    for _ in 0..runs {
        let phi = Mat::from_fn(30, 2, |_, _| noise.normal());
        let y: Vec<f64> = (0..30).map(|i| 1.5 * phi[(i, 0)] - 0.5 * phi[(i, 1)] + 0.3 * noise.normal()).collect();
        let fit = least_squares(phi.as_ref(), &y).unwrap();
        let se = fit.covariance()[(0, 0)].sqrt();
        let (low, high) = ident::distributions::interval(fit.parameters[0], se, fit.degrees_of_freedom(), 0.95);
        covered += usize::from(low < 1.5 && 1.5 < high);
    }
    // Binomial: 0.95 ± 3 standard deviations of 2000 draws.
    let share = covered as f64 / runs as f64;
    assert!((share - 0.95).abs() < 3.0 * (0.95 * 0.05 / runs as f64).sqrt(), "coverage {share}");
}

#[test]
fn regress_bad_data_are_named() {
    let twins = Mat::from_fn(10, 2, |i, _| i as f64);
    assert!(matches!(
        least_squares(twins.as_ref(), &[1.0; 10]),
        Err(IdentError::RankDeficient { rank: 1, parameters: 2, .. })
    ));
    let short = Mat::from_fn(2, 2, |i, j| (i + j) as f64);
    assert!(matches!(least_squares(short.as_ref(), &[1.0; 2]), Err(IdentError::TooFewSamples { .. })));
    let broken = Mat::from_fn(10, 1, |i, _| if i == 7 { f64::NAN } else { 1.0 });
    assert_eq!(least_squares(broken.as_ref(), &[1.0; 10]), Err(IdentError::NotFinite { what: "regressors", index: 7 }));
    assert!(matches!(least_squares(broken.as_ref(), &[1.0; 9]), Err(IdentError::Length { .. })));
}
