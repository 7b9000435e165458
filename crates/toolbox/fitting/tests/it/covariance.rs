use faer::{Mat, MatMut};
use fitting::covariance::{batched_sandwich, delta_variance};
use fitting::{Bounds, IdentError, NonlinearOptions, ResidualModel, minimise};
use signal::distributions::interval;

use signal::excitation::Random;

/// A constant in noise.
struct Level(Vec<f64>);

impl ResidualModel for Level {
    fn parameter_count(&self) -> usize {
        1
    }

    fn residual_count(&self) -> usize {
        self.0.len()
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        for (r, y) in residuals.iter_mut().zip(&self.0) {
            *r = p[0] - y;
        }
        if let Some(mut j) = jacobian {
            j.fill(1.0);
        }
        Ok(())
    }
}

/// Random of a first-order lag: ε(t) = 0.9 ε(t − 1) + e(t).
fn coloured(noise: &mut Random, count: usize) -> Vec<f64> {
    let mut state = 0.0;
    (0..count + 100)
        .map(|_| {
            state = 0.9 * state + noise.normal();
            state
        })
        .skip(100)
        .collect()
}

#[test]
fn stat_batched_sandwich_covers_under_coloured_noise_where_the_plain_covariance_fails() {
    let runs = 1000;
    let (mut sandwich, mut plain) = (0, 0);
    let mut noise = Random::new(3);
    for _ in 0..runs {
        let mut model = Level(coloured(&mut noise, 4000));
        let fit = minimise(&mut model, &[1.0], &[Bounds::NONE], NonlinearOptions::default()).unwrap();
        let covers = |se: f64, dof: f64| {
            let (low, high) = interval(fit.parameters[0], se, dof, 0.95);
            usize::from(low < 0.0 && 0.0 < high)
        };
        let (covariance, dof) = batched_sandwich(&fit, 20).unwrap();
        sandwich += covers(covariance[(0, 0)].sqrt(), dof);
        plain += covers(fit.covariance()[(0, 0)].sqrt(), fit.degrees_of_freedom());
    }
    let share = sandwich as f64 / f64::from(runs);
    assert!((share - 0.95).abs() < 3.0 * (0.95f64 * 0.05 / f64::from(runs)).sqrt(), "coverage {share}");
    assert!(plain < 600, "the plain covariance should fail here, it covered {plain} of {runs}");
}

#[test]
fn exact_delta_method_of_a_ratio() {
    let covariance = Mat::from_fn(2, 2, |i, j| [[0.04, 0.01], [0.01, 0.09]][i][j]);
    let variance = delta_variance(&[10.0, 2.0], &covariance, |p| p[0] / p[1]);
    // Gradient (1/2, −10/4).
    let exact = 0.25 * 0.04 + 2.0 * 0.5 * -2.5 * 0.01 + 6.25 * 0.09;
    assert!((variance / exact - 1.0).abs() < 1e-4, "{variance} against {exact}");
}
