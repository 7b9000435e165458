use faer::Mat;
use fitting::{IdentError, Triangle, least_squares};
use signal::excitation::Random;

#[test]
fn exact_badly_scaled_columns_are_solved() {
    let mut noise = Random::new(1);
    let truth = [3e-9, -2.0, 5e8];
    let phi = Mat::from_fn(10_000, 3, |_, j| noise.normal() * [1e9, 1.0, 1e-8][j]);
    let y: Vec<f64> = (0..10_000).map(|i| (0..3).map(|j| phi[(i, j)] * truth[j]).sum()).collect();
    let fit = least_squares(phi.as_ref(), &y).unwrap();
    for (estimate, truth) in fit.parameters.iter().zip(truth) {
        assert!((estimate / truth - 1.0).abs() < 1e-12);
    }
    assert!(fit.condition < 2.0);
}

fn normals(random: &mut Random) -> Vec<f64> {
    (0..9000).map(|_| random.normal()).collect()
}

/// The factor of `columns`, each a slice, in blocks that are folded as they come.
fn triangle(columns: &[&[f64]]) -> Mat<f64> {
    let mut triangle = Triangle::new(columns.len());
    triangle.push_columns(columns[0].len(), |j, start, slot| {
        slot.copy_from_slice(&columns[j][start..start + slot.len()]);
    });
    triangle.finish()
}

#[test]
fn prop_triangle_has_the_scalar_products_of_its_columns() {
    let mut noise = Random::new(3);
    let x: Vec<Vec<f64>> =
        [1e-6, 1.0, 1e6].iter().map(|s| normals(&mut noise).iter().map(|v| v * s).collect()).collect();
    let columns: Vec<&[f64]> = x.iter().map(Vec::as_slice).collect();
    let r = triangle(&columns);
    let product = |i: usize, j: usize| columns[i].iter().zip(columns[j]).map(|(a, b)| a * b).sum::<f64>();
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let found: f64 = (0..3).map(|k| r[(k, i)] * r[(k, j)]).sum();
        assert!((found - product(i, j)).abs() < 1e-13 * (product(i, i) * product(j, j)).sqrt(), "{i} {j}");
    }
}

/// A Gram matrix would lose the direction in which two columns differ: it would be 1e-18 of its entries.
#[test]
fn exact_triangle_keeps_what_tells_nearly_equal_columns_apart() {
    let mut noise = Random::new(4);
    let (x, w) = (normals(&mut noise), normals(&mut noise));
    let near: Vec<f64> = x.iter().zip(&w).map(|(x, w)| x + 1e-9 * w).collect();
    let (r, apart) = (triangle(&[&x, &near]), triangle(&[&x, &w]));
    assert!((r[(1, 1)].abs() / (1e-9 * apart[(1, 1)].abs()) - 1.0).abs() < 1e-5, "{} {}", r[(1, 1)], apart[(1, 1)]);
}

#[test]
fn stat_intervals_cover_the_truth_as_often_as_they_claim() {
    let (runs, mut covered) = (2000, 0);
    let mut noise = Random::new(2);
    for _ in 0..runs {
        let phi = Mat::from_fn(30, 2, |_, _| noise.normal());
        let y: Vec<f64> = (0..30).map(|i| 1.5 * phi[(i, 0)] - 0.5 * phi[(i, 1)] + 0.3 * noise.normal()).collect();
        let fit = least_squares(phi.as_ref(), &y).unwrap();
        let se = fit.covariance()[(0, 0)].sqrt();
        let (low, high) = signal::distributions::interval(fit.parameters[0], se, fit.degrees_of_freedom(), 0.95);
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
