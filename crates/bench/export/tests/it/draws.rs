//! Draws of a bench model.

use bench_model::model::ModelParameter;

use crate::model::document;

#[test]
fn exact_the_same_seed_gives_the_same_draws() {
    let (first, second) = (export::draws(&document(), 5, 1), export::draws(&document(), 5, 1));
    assert_eq!(first, second);
    assert_ne!(first, export::draws(&document(), 5, 2));
    assert_eq!(first[..3], export::draws(&document(), 3, 1)[..], "more draws begin with the same");
}

#[test]
fn stat_draws_spread_as_the_covariance_says() {
    let drawn = export::draws(&document(), 4000, 3);
    let values: Vec<f64> = drawn.iter().filter_map(|model| model.value(ModelParameter::Integral)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
    // Standard deviation 0.02, its own standard error 1.1 % at 4000 draws.
    assert!((variance.sqrt() / 0.02 - 1.0).abs() < 0.045, "{}", variance.sqrt());
    assert!(drawn.iter().all(|model| model.value(ModelParameter::DynoInertia) == Some(0.6)), "J_d is exact");
}
