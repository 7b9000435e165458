//! The smoother against one least-squares problem for all states at once, and its likelihood against the density of all
//! measurements.

use std::f64::consts::TAU;

use faer::linalg::solvers::DenseSolveCore;
use faer::prelude::Solve;
use faer::{Mat, mat};
use fitting::smoothing::{Belief, NoisySystem, likeliest};
use fitting::{Bounds, IdentError, least_squares};
use lti::StateSpace;
use signal::excitation::Random;

const SAMPLES: usize = 30;
const PROCESS: [f64; 3] = [0.3, 0.05, 1.2];
const MEASURED: [f64; 2] = [0.4, 2.0];
const START_MEAN: [f64; 3] = [0.5, -1.0, 0.2];
const START_VARIANCE: [f64; 3] = [4.0, 1.0, 0.5];

fn diagonal(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), values.len(), |i, j| if i == j { values[i] } else { 0.0 })
}

fn system() -> NoisySystem {
    let a = mat![[0.9, 0.3, 0.0], [-0.2, 0.8, 0.1], [0.0, 0.4, 0.7]];
    let b = mat![[1.0], [0.0], [-0.5]];
    let c = mat![[1.0, 0.0, 0.5], [0.0, 1.0, -1.0]];
    let d = mat![[0.0], [0.3]];
    NoisySystem::new(StateSpace::discrete(a, b, c, d, 0.1).unwrap(), diagonal(&PROCESS), MEASURED.to_vec()).unwrap()
}

fn start() -> Belief {
    Belief { mean: START_MEAN.to_vec(), covariance: diagonal(&START_VARIANCE) }
}

/// Inputs, and measurements of which some are missing.
fn data() -> (Mat<f64>, Mat<f64>) {
    let mut random = Random::new(5);
    let inputs = Mat::from_fn(SAMPLES, 1, |_, _| random.normal());
    let outputs = Mat::from_fn(SAMPLES, 2, |k, i| {
        let value = 2.0 * random.normal();
        if i == 1 && k % 4 != 0 || (10..14).contains(&k) { f64::NAN } else { value }
    });
    (inputs, outputs)
}

/// Rows that say with unit variance what start, transitions and measurements know of all states.
fn stacked(system: &NoisySystem, inputs: &Mat<f64>, outputs: &Mat<f64>) -> (Vec<Vec<f64>>, Vec<f64>) {
    let s = system.system();
    let columns = 3 * SAMPLES;
    let (mut rows, mut target) = (Vec::new(), Vec::new());
    let mut push = |entries: &[(usize, f64)], value: f64, variance: f64| {
        let mut row = vec![0.0; columns];
        entries.iter().for_each(|(at, weight)| row[*at] += weight / variance.sqrt());
        rows.push(row);
        target.push(value / variance.sqrt());
    };
    for i in 0..3 {
        push(&[(i, 1.0)], START_MEAN[i], START_VARIANCE[i]);
    }
    for k in 0..SAMPLES {
        for i in 0..2 {
            if outputs[(k, i)].is_nan() {
                continue;
            }
            let entries: Vec<(usize, f64)> = (0..3).map(|j| (3 * k + j, s.c()[(i, j)])).collect();
            push(&entries, outputs[(k, i)] - s.d()[(i, 0)] * inputs[(k, 0)], MEASURED[i]);
        }
        if k + 1 == SAMPLES {
            continue;
        }
        for i in 0..3 {
            let mut entries: Vec<(usize, f64)> = (0..3).map(|j| (3 * k + j, -s.a()[(i, j)])).collect();
            entries.push((3 * (k + 1) + i, 1.0));
            push(&entries, s.b()[(i, 0)] * inputs[(k, 0)], PROCESS[i]);
        }
    }
    (rows, target)
}

#[test]
fn exact_the_smoother_is_the_least_squares_solution_for_all_states() {
    let (inputs, outputs) = data();
    let system = system();
    let (rows, target) = stacked(&system, &inputs, &outputs);
    let phi = Mat::from_fn(rows.len(), 3 * SAMPLES, |i, j| rows[i][j]);
    let direct = least_squares(phi.as_ref(), &target).unwrap();
    let smoothed = system.smooth(&start(), inputs.as_ref(), outputs.as_ref()).unwrap();
    for k in 0..SAMPLES {
        let covariance = smoothed.covariance(k).unwrap();
        for i in 0..3 {
            assert!((smoothed.states[(k, i)] - direct.parameters[3 * k + i]).abs() < 1e-11, "{k} {i}");
            for j in 0..3 {
                let expected = direct.unscaled_covariance[(3 * k + i, 3 * k + j)];
                assert!((covariance[(i, j)] - expected).abs() < 1e-11, "{k} {i} {j}");
            }
        }
    }
    let (values, deviations) = smoothed.combination(&[1.0, 0.0, -2.0]).unwrap();
    let p = smoothed.covariance(7).unwrap();
    assert!((values[7] - smoothed.states[(7, 0)] + 2.0 * smoothed.states[(7, 2)]).abs() < 1e-14);
    assert!((deviations[7].powi(2) - p[(0, 0)] + 4.0 * p[(0, 2)] - 4.0 * p[(2, 2)]).abs() < 1e-12);
    assert!(smoothed.covariance(SAMPLES).is_none());
}

/// Mean and covariance of all states, before any measurement.
fn prior(system: &NoisySystem, inputs: &Mat<f64>, process: &Mat<f64>) -> (Vec<f64>, Mat<f64>) {
    let s = system.system();
    let n = s.states();
    let belief = start();
    let mut mean = belief.mean.clone();
    let mut covariance = Mat::<f64>::zeros(n * SAMPLES, n * SAMPLES);
    covariance.submatrix_mut(0, 0, n, n).copy_from(&belief.covariance);
    for k in 1..SAMPLES {
        for i in 0..n {
            let before: f64 = (0..n).map(|j| s.a()[(i, j)] * mean[n * (k - 1) + j]).sum();
            mean.push(before + s.b()[(i, 0)] * inputs[(k - 1, 0)]);
        }
        let across = s.a() * covariance.submatrix(n * (k - 1), 0, n, n * k);
        covariance.submatrix_mut(n * k, 0, n, n * k).copy_from(&across);
        covariance.submatrix_mut(0, n * k, n * k, n).copy_from(across.transpose());
        let own = s.a() * covariance.submatrix(n * (k - 1), n * (k - 1), n, n) * s.a().transpose() + process;
        covariance.submatrix_mut(n * k, n * k, n, n).copy_from(&own);
    }
    (mean, covariance)
}

#[test]
fn exact_likelihood_and_states_are_those_of_the_joint_density_where_noise_does_not_reach_every_state() {
    let (inputs, outputs) = data();
    let process = diagonal(&[0.0, 0.0, 1.2]);
    let system = NoisySystem::new(system().system().clone(), process.clone(), MEASURED.to_vec()).unwrap();
    let (mean, covariance) = prior(&system, &inputs, &process);
    let s = system.system();
    let measured: Vec<(usize, usize)> =
        (0..SAMPLES).flat_map(|k| [(k, 0), (k, 1)]).filter(|(k, i)| !outputs[(*k, *i)].is_nan()).collect();
    let h = Mat::from_fn(measured.len(), 3 * SAMPLES, |row, column| {
        let (k, i) = measured[row];
        if column / 3 == k { s.c()[(i, column % 3)] } else { 0.0 }
    });
    let noise = diagonal(&measured.iter().map(|(_, i)| MEASURED[*i]).collect::<Vec<_>>());
    let spread = &h * &covariance * h.transpose() + noise;
    let surprise = Mat::from_fn(measured.len(), 1, |row, _| {
        let (k, i) = measured[row];
        let expected: f64 = (0..3).map(|j| s.c()[(i, j)] * mean[3 * k + j]).sum();
        outputs[(k, i)] - expected - s.d()[(i, 0)] * inputs[(k, 0)]
    });
    let weighted = spread.partial_piv_lu().solve(&surprise);
    let log_determinant = spread.determinant().ln();
    let square = (surprise.transpose() * &weighted)[(0, 0)];
    let expected = -0.5 * (measured.len() as f64 * TAU.ln() + log_determinant + square);
    let found = system.log_likelihood(&start(), inputs.as_ref(), outputs.as_ref()).unwrap();
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    let gain = &covariance * h.transpose() * spread.partial_piv_lu().inverse();
    let posterior = &covariance - &gain * &h * &covariance;
    let moved = &gain * &surprise;
    let smoothed = system.smooth(&start(), inputs.as_ref(), outputs.as_ref()).unwrap();
    assert!((smoothed.log_likelihood - expected).abs() < 1e-9);
    for (row, mean) in mean.iter().enumerate() {
        assert!((smoothed.states[(row / 3, row % 3)] - mean - moved[(row, 0)]).abs() < 1e-10);
        let variance = smoothed.covariance(row / 3).unwrap()[(row % 3, row % 3)];
        assert!((variance - posterior[(row, row)]).abs() < 1e-10);
    }
}

/// A torque that walks turns a speed, which is read to 10⁻⁵ of what is thought possible at the start.
#[test]
fn exact_the_first_states_after_a_start_that_is_wide_beside_the_noise() {
    let (step, walk, start) = (1e-3, 1.0, [1.0, 1e6]);
    for noise in [1e-8, 1e-10, 1e-12_f64] {
        let outputs = Mat::from_fn(SAMPLES, 1, |k, _| (0.3 * k as f64).sin() * noise.sqrt());
        let shaft = StateSpace::discrete(
            mat![[1.0, step], [0.0, 1.0]],
            Mat::zeros(2, 0),
            mat![[1.0, 0.0]],
            Mat::zeros(1, 0),
            step,
        )
        .unwrap();
        let system = NoisySystem::new(shaft, diagonal(&[0.0, walk]), vec![noise]).unwrap();
        let belief = Belief { mean: vec![0.0; 2], covariance: diagonal(&start) };
        let smoothed = system.smooth(&belief, Mat::zeros(SAMPLES, 0).as_ref(), outputs.as_ref()).unwrap();
        // The unknowns: the speed at the start, and every torque.
        let mut rows = vec![(vec![(0, 1.0)], 0.0, start[0]), (vec![(1, 1.0)], 0.0, start[1])];
        for k in 0..SAMPLES {
            let speed: Vec<(usize, f64)> = std::iter::once((0, 1.0)).chain((0..k).map(|j| (1 + j, step))).collect();
            rows.push((speed, outputs[(k, 0)], noise));
            if k > 0 {
                rows.push((vec![(1 + k, 1.0), (k, -1.0)], 0.0, walk));
            }
        }
        let mut phi = Mat::<f64>::zeros(rows.len(), SAMPLES + 1);
        for (i, (entries, _, variance)) in rows.iter().enumerate() {
            entries.iter().for_each(|(j, weight)| phi[(i, *j)] = weight / variance.sqrt());
        }
        let target: Vec<f64> = rows.iter().map(|(_, value, variance)| value / variance.sqrt()).collect();
        let direct = least_squares(phi.as_ref(), &target).unwrap();
        for k in 0..SAMPLES {
            let covariance = smoothed.covariance(k).unwrap();
            let variance = direct.unscaled_covariance[(1 + k, 1 + k)];
            let off = (smoothed.states[(k, 1)] - direct.parameters[1 + k]) / variance.sqrt();
            assert!(off.abs() < 1e-3, "{noise:e} {k}: {off}");
            assert!((covariance[(1, 1)] / variance - 1.0).abs() < 1e-3, "{noise:e} {k}: {covariance:?} {variance}");
        }
        let first = smoothed.covariance(0).unwrap()[(0, 0)];
        assert!((first / direct.unscaled_covariance[(0, 0)] - 1.0).abs() < 1e-3, "{noise:e}: {first}");
    }
}

#[test]
fn exact_noise_sampled_from_a_wandering_slope() {
    let wandering =
        StateSpace::continuous(mat![[0.0, 1.0], [0.0, 0.0]], Mat::zeros(2, 0), mat![[1.0, 0.0]], Mat::zeros(1, 0))
            .unwrap();
    let (q, t) = (3e7, 1e-3);
    let found = wandering.sampled_noise(diagonal(&[0.0, q]).as_ref(), t).unwrap();
    for (i, j, expected) in [(0, 0, q * t.powi(3) / 3.0), (0, 1, q * t * t / 2.0), (1, 1, q * t)] {
        assert!((found[(i, j)] / expected - 1.0).abs() < 1e-12, "{i} {j}");
    }
    assert!(wandering.sampled_noise(diagonal(&[1.0]).as_ref(), t).is_err());
}

/// A level that wanders by `wander` a sample, seen through noise of `noise`; standard deviations.
fn wandering(wander: f64, noise: f64, seed: u64) -> Mat<f64> {
    let mut random = Random::new(seed);
    let mut level = 10.0;
    Mat::from_fn(2000, 1, |_, _| {
        level += wander * random.normal();
        level + noise * random.normal()
    })
}

fn level(parameters: &[f64]) -> Result<(NoisySystem, Belief), IdentError> {
    let walk = StateSpace::discrete(mat![[1.0]], Mat::zeros(1, 0), mat![[1.0]], Mat::zeros(1, 0), 1.0)?;
    let system = NoisySystem::new(walk, mat![[parameters[0].exp()]], vec![1.0])?;
    Ok((system, Belief { mean: vec![0.0], covariance: mat![[1e6]] }))
}

#[test]
fn stat_noise_levels_by_maximum_likelihood() {
    let (wander, noise) = (0.3, 2.0);
    let mut errors = [0.0, 0.0];
    const RUNS: u64 = 20;
    for seed in 0..RUNS {
        let outputs = wandering(wander, noise, seed);
        let inputs = Mat::zeros(2000, 0);
        let bounds = [Bounds::new(-20.0, 10.0)];
        let found = likeliest(&[vec![0.0]], &bounds, level, inputs.as_ref(), outputs.as_ref()).unwrap();
        assert!(found.termination.converged());
        let (system, start) = level(&found.parameters).unwrap();
        // The best of a grid is no likelier.
        let at = |parameter: f64| {
            let (system, start) = level(&[parameter]).unwrap();
            let innovations = system.innovations(&start, inputs.as_ref(), outputs.as_ref()).unwrap();
            let scale = innovations.iter().map(|v| v * v).sum::<f64>() / innovations.len() as f64;
            system.log_likelihood(&start, inputs.as_ref(), outputs.as_ref()).unwrap()
                - 0.5 * innovations.len() as f64 * (scale.ln() + 1.0 - scale)
        };
        let best = at(found.parameters[0]);
        assert!((0..60).all(|i| at(-6.0 + 0.1 * f64::from(i)) < best + 1e-3), "{best}");
        let innovations = system.innovations(&start, inputs.as_ref(), outputs.as_ref()).unwrap();
        let power = innovations.iter().map(|v| v * v).sum::<f64>() / innovations.len() as f64;
        assert!((power / found.scale - 1.0).abs() < 1e-9);
        errors[0] += (found.scale.sqrt() / noise - 1.0) / RUNS as f64;
        errors[1] += ((found.scale * found.parameters[0].exp()).sqrt() / wander - 1.0) / RUNS as f64;
    }
    assert!(errors[0].abs() < 0.01 && errors[1].abs() < 0.05, "{errors:?}");
}

/// A level that wanders and a lightly damped line, in sum; a second output has the level alone, at every third sample.
fn level_and_line(parameters: &[f64]) -> Result<(NoisySystem, Belief), IdentError> {
    let (omega, damping) = (0.7_f64, 0.003);
    let (c, s) = ((-damping * omega).exp() * omega.cos(), (-damping * omega).exp() * omega.sin());
    let a = mat![[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]];
    let outputs = mat![[1.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let system = StateSpace::discrete(a, Mat::zeros(3, 0), outputs, Mat::zeros(2, 0), 1.0)?;
    let (level, line) = (parameters[0].exp(), parameters[1].exp());
    let system = NoisySystem::new(system, diagonal(&[level, line, line]), vec![1.0, 4.0])?;
    Ok((system, Belief { mean: vec![0.0; 3], covariance: diagonal(&[1e6, 1e4, 1e4]) }))
}

#[test]
fn stat_the_likeliest_levels_of_a_lightly_damped_line() {
    let (truth, samples) = ([-3.0, -4.0], 4000);
    for seed in 0..5 {
        let mut random = Random::new(seed);
        let (system, _) = level_and_line(&truth).unwrap();
        let mut x = [3.0, 2.0, 0.0];
        let mut outputs = Mat::from_fn(samples, 2, |k, _| if k.is_multiple_of(3) { 0.0 } else { f64::NAN });
        for k in 0..samples {
            outputs[(k, 0)] = x[0] + x[1] + random.normal();
            outputs[(k, 1)] += x[0] + 2.0 * random.normal();
            let a = system.system().a();
            let next = |i: usize| (0..3).map(|j| a[(i, j)] * x[j]).sum::<f64>();
            let noise = [truth[0], truth[1], truth[1]].map(|q: f64| (0.5 * q).exp());
            x = [0, 1, 2].map(|i| next(i) + noise[i] * random.normal());
        }
        let inputs = Mat::zeros(samples, 0);
        let bounds = [Bounds::new(-20.0, 10.0); 2];
        let found = likeliest(&[vec![0.0, 0.0]], &bounds, level_and_line, inputs.as_ref(), outputs.as_ref()).unwrap();
        assert!(found.termination.converged());
        let at = |moved: [f64; 2]| {
            let (system, start) = level_and_line(&[0, 1].map(|i| found.parameters[i] + moved[i])).unwrap();
            let innovations = system.innovations(&start, inputs.as_ref(), outputs.as_ref()).unwrap();
            let scale = innovations.iter().map(|v| v * v).sum::<f64>() / innovations.len() as f64;
            system.log_likelihood(&start, inputs.as_ref(), outputs.as_ref()).unwrap()
                - 0.5 * innovations.len() as f64 * (scale.ln() + 1.0 - scale)
        };
        // The exact likelihood of the levels around it is no greater, and falls away from it.
        let best = at([0.0, 0.0]);
        for moved in [[0.03, 0.0], [-0.03, 0.0], [0.0, 0.03], [0.0, -0.03]] {
            assert!(at(moved) < best + 2e-3, "{moved:?}: {} for {best}", at(moved));
            assert!(at(moved.map(|by| 10.0 * by)) < best - 0.5);
        }
        assert!((found.parameters[0] - truth[0]).abs() < 0.6 && (found.parameters[1] - truth[1]).abs() < 0.6);
    }
}

#[test]
fn regress_starts_without_a_model_are_passed_over() {
    let outputs = wandering(0.3, 2.0, 1);
    let inputs = Mat::zeros(outputs.nrows(), 0);
    // No model there: the logarithm of a level may not be as large.
    let fenced = |parameters: &[f64]| {
        if parameters[0] > 5.0 { Err(IdentError::Constant { what: "the level" }) } else { level(parameters) }
    };
    let bounds = [Bounds::new(-20.0, 10.0)];
    let found = |starts: &[f64]| {
        let starts: Vec<Vec<f64>> = starts.iter().map(|start| vec![*start]).collect();
        likeliest(&starts, &bounds, fenced, inputs.as_ref(), outputs.as_ref())
    };
    let alone = found(&[0.0]).unwrap();
    for starts in [[8.0, 0.0], [0.0, 8.0], [-15.0, 0.0]] {
        let several = found(&starts).unwrap();
        assert!((several.parameters[0] - alone.parameters[0]).abs() < 1e-2, "{starts:?}: {several:?} {alone:?}");
    }
    assert!(found(&[8.0, 9.0]).is_err() && found(&[]).is_err());
}

/// A plateau below the maximum of the likelihood: a search that begins there stays there.
#[test]
fn regress_of_several_starts_the_least_likely_is_left() {
    let outputs = wandering(0.3, 2.0, 1);
    let inputs = Mat::zeros(outputs.nrows(), 0);
    let best = (0.3_f64 / 2.0).powi(2).ln();
    let folded = |parameters: &[f64]| {
        let above = if parameters[0] < 0.0 { 2.0 } else { (parameters[0] - 1.0).powi(2) };
        level(&[best + above])
    };
    let found = |starts: &[f64]| {
        let starts: Vec<Vec<f64>> = starts.iter().map(|start| vec![*start]).collect();
        let bounds = [Bounds::new(-3.0, 3.0)];
        likeliest(&starts, &bounds, folded, inputs.as_ref(), outputs.as_ref()).unwrap().parameters[0]
    };
    let (lower, higher) = (found(&[-1.0]), found(&[0.7]));
    assert!(lower < 0.0 && higher > 0.5, "{lower} {higher}");
    for starts in [[-1.0, 0.7], [0.7, -1.0]] {
        assert!(found(&starts) > 0.5, "{starts:?}");
    }
}

#[test]
fn regress_what_cannot_be_smoothed_is_refused() {
    let (inputs, outputs) = data();
    let system = system();
    let smooth = |start: &Belief, inputs: &Mat<f64>| system.smooth(start, inputs.as_ref(), outputs.as_ref());
    let short = Belief { mean: vec![0.0], covariance: mat![[1.0]] };
    assert!(matches!(smooth(&short, &inputs), Err(IdentError::Length { .. })));
    assert!(matches!(smooth(&start(), &Mat::zeros(3, 1)), Err(IdentError::Length { .. })));
    let mut broken = inputs.clone();
    broken[(4, 0)] = f64::NAN;
    assert!(matches!(smooth(&start(), &broken), Err(IdentError::NotFinite { index: 4, .. })));
    let negative = NoisySystem::new(system.system().clone(), diagonal(&[-1.0, 0.0, 0.0]), MEASURED.to_vec());
    assert!(matches!(negative, Err(IdentError::Structure { .. })));
    let still = NoisySystem::new(system.system().clone(), diagonal(&[0.0; 3]), vec![0.0; 2]).unwrap();
    let known = Belief { mean: vec![0.0; 3], covariance: diagonal(&[0.0; 3]) };
    assert!(matches!(still.smooth(&known, inputs.as_ref(), outputs.as_ref()), Err(IdentError::Structure { .. })));
}
