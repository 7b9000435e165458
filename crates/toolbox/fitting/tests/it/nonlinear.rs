use faer::{Mat, MatMut, mat};
use fitting::{Bounds, IdentError, NonlinearOptions, ResidualModel, Termination, minimise};

/// y = a exp(−b t) + c.
struct Decay {
    times: Vec<f64>,
    data: Vec<f64>,
}

impl ResidualModel for Decay {
    fn parameter_count(&self) -> usize {
        3
    }

    fn residual_count(&self) -> usize {
        self.times.len()
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        for (i, t) in self.times.iter().enumerate() {
            residuals[i] = p[0] * (-p[1] * t).exp() + p[2] - self.data[i];
        }
        if let Some(mut j) = jacobian {
            for (i, t) in self.times.iter().enumerate() {
                let decay = (-p[1] * t).exp();
                (j[(i, 0)], j[(i, 1)], j[(i, 2)]) = (decay, -p[0] * t * decay, 1.0);
            }
        }
        Ok(())
    }
}

fn decay() -> Decay {
    let times: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.05).collect();
    let data = times.iter().map(|t| 4.0 * (-0.7 * t).exp() - 1.5).collect();
    Decay { times, data }
}

/// Rosenbrock's valley as residuals.
struct Valley;

impl ResidualModel for Valley {
    fn parameter_count(&self) -> usize {
        2
    }

    fn residual_count(&self) -> usize {
        3
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        residuals.copy_from_slice(&[10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0], 0.0]);
        if let Some(mut j) = jacobian {
            j.copy_from(Mat::from_fn(3, 2, |i, k| [[-20.0 * p[0], 10.0], [-1.0, 0.0], [0.0, 0.0]][i][k]));
        }
        Ok(())
    }
}

#[test]
fn exact_noise_free_decay_is_found_from_afar() {
    let fit = minimise(&mut decay(), &[1.0, 5.0, 0.0], &[Bounds::NONE; 3], NonlinearOptions::default()).unwrap();
    for (estimate, truth) in fit.parameters.iter().zip([4.0, 0.7, -1.5]) {
        assert!((estimate - truth).abs() < 1e-9, "{:?}", fit.parameters);
    }
    assert!(fit.termination.converged());
}

#[test]
fn exact_valley_is_followed_to_its_end() {
    let fit = minimise(&mut Valley, &[-1.2, 1.0], &[Bounds::NONE; 2], NonlinearOptions::default()).unwrap();
    assert!((fit.parameters[0] - 1.0).abs() < 1e-8 && (fit.parameters[1] - 1.0).abs() < 1e-8);
}

#[test]
fn exact_active_bound_is_kept_and_reported() {
    let bounds = [Bounds::NONE, Bounds::new(1.0, 10.0), Bounds::NONE];
    let fit = minimise(&mut decay(), &[1.0, 5.0, 0.0], &bounds, NonlinearOptions::default()).unwrap();
    assert_eq!(fit.parameters[1], 1.0);
    assert_eq!(fit.at_bound, [false, true, false]);
    assert_eq!(fit.unscaled_covariance[(1, 1)], 0.0);
    assert!(fit.unscaled_covariance[(0, 0)] > 0.0);
}

/// x + y = −1 is seen sharply, x − y = 2000 dimly: the step to both leads far beyond any bounds, into their wrong
/// corner.
struct Slanted;

impl ResidualModel for Slanted {
    fn parameter_count(&self) -> usize {
        2
    }

    fn residual_count(&self) -> usize {
        3
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        residuals.copy_from_slice(&[p[0] + p[1] + 1.0, 1e-3 * (p[0] - p[1]) - 2.0, 0.0]);
        if let Some(mut j) = jacobian {
            j.copy_from(mat![[1.0, 1.0], [1e-3, -1e-3], [0.0, 0.0]]);
        }
        Ok(())
    }
}

#[test]
fn regress_a_step_that_bounds_bend_uphill_does_not_end_the_search() {
    let bounds = [Bounds::new(-10.0, 10.0), Bounds::new(-5.0, 5.0)];
    let fit = minimise(&mut Slanted, &[0.0, 0.0], &bounds, NonlinearOptions::default()).unwrap();
    // On the bound y = −5 the least of (x − 4)² + (0.001 (x + 5) − 2)².
    let x = (4.0 + 1e-3 * (2.0 - 0.005)) / (1.0 + 1e-6);
    assert!(fit.termination.converged() && (fit.parameters[0] - x).abs() < 1e-6, "{fit:?}");
    assert_eq!((fit.parameters[1], fit.at_bound.as_slice()), (-5.0, [false, true].as_slice()));
}

#[test]
fn regress_bad_starts_and_limits_are_reported() {
    let outside = minimise(&mut decay(), &[1.0, -1.0, 0.0], &[Bounds::new(0.0, 9.0); 3], NonlinearOptions::default());
    assert!(matches!(outside, Err(IdentError::StartOutsideBounds { index: 1, .. })));
    let options = NonlinearOptions { iteration_limit: 1, ..Default::default() };
    let fit = minimise(&mut decay(), &[1.0, 5.0, 0.0], &[Bounds::NONE; 3], options).unwrap();
    assert_eq!(fit.termination, Termination::IterationLimit);
    let wrong = minimise(&mut decay(), &[1.0, 5.0], &[Bounds::NONE; 2], NonlinearOptions::default());
    assert!(matches!(wrong, Err(IdentError::Length { .. })));
}

/// Residuals `x − 2` and `x − 3`, for x below one only.
struct Fenced;

impl ResidualModel for Fenced {
    fn parameter_count(&self) -> usize {
        1
    }

    fn residual_count(&self) -> usize {
        2
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        if p[0] >= 1.0 {
            return Err(fitting::StructureError::GivenUp.into());
        }
        residuals.copy_from_slice(&[p[0] - 2.0, p[0] - 3.0]);
        if let Some(mut j) = jacobian {
            j.fill(1.0);
        }
        Ok(())
    }
}

#[test]
fn regress_a_search_stopped_where_the_model_ends_has_not_converged() {
    let fit = minimise(&mut Fenced, &[0.0], &[Bounds::NONE], NonlinearOptions::default()).unwrap();
    assert!(fit.parameters[0] > 1.0 - 1e-6 && fit.termination == Termination::Edge, "{:?}", fit.termination);
    assert!(!fit.termination.converged());
}
