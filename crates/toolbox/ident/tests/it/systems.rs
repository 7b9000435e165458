//! State-space systems with known truth for the tests.

use faer::{Mat, mat};
use ident::Dataset;
use lti::{Complex64, Innovations, StateSpace};

use crate::noise::Noise;

/// Order 4, one input, one output: a resonance and a pair of lags.
pub(crate) fn siso(noise: f64) -> Innovations {
    let a = mat![
        [0.9 * 0.6_f64.cos(), 0.9 * 0.6_f64.sin(), 0.0, 0.0],
        [-0.9 * 0.6_f64.sin(), 0.9 * 0.6_f64.cos(), 0.3, 0.0],
        [0.0, 0.0, 0.7, 0.2],
        [0.0, 0.0, 0.0, 0.4]
    ];
    let b = mat![[0.5], [1.0], [-0.6], [1.0]];
    let c = mat![[1.0, 0.3, 0.5, 0.2]];
    let system = StateSpace::discrete(a, b, c, mat![[0.0]], 0.1).unwrap();
    Innovations::new(system, mat![[0.3], [-0.2], [0.1], [0.15]], mat![[noise * noise]]).unwrap()
}

/// Order 3, two inputs, two outputs, with feed-through.
pub(crate) fn mimo(noise: f64) -> Innovations {
    let a = mat![[0.8, 0.4, 0.0], [-0.4, 0.8, 0.1], [0.0, 0.0, 0.5]];
    let b = mat![[1.0, 0.2], [0.0, 0.5], [0.7, -1.0]];
    let c = mat![[1.0, 0.0, 0.4], [0.2, 0.8, 0.0]];
    let d = mat![[0.0, 0.3], [0.1, 0.0]];
    let system = StateSpace::discrete(a, b, c, d, 0.1).unwrap();
    let k = mat![[0.2, 0.1], [0.0, 0.3], [0.1, 0.0]];
    let v = noise * noise;
    Innovations::new(system, k, mat![[v, 0.3 * v], [0.3 * v, 0.5 * v]]).unwrap()
}

/// Outputs of `model` for inputs, from the state `x0`, with Gaussian innovations of its covariance.
pub(crate) fn outputs(model: &Innovations, u: &Mat<f64>, x0: &[f64], noise: &mut Noise) -> Mat<f64> {
    let (m, p) = (model.system().inputs(), model.system().outputs());
    let l = model.noise_covariance();
    // Cholesky by hand for one or two outputs; zero covariance gives zero noise.
    let l11 = l[(0, 0)].sqrt();
    let mixed = |e: &[f64], i: usize| -> f64 {
        if i == 0 || l11 == 0.0 {
            return l11 * e[0];
        }
        let l21 = l[(1, 0)] / l11;
        l21 * e[0] + (l[(1, 1)] - l21 * l21).sqrt() * e[1]
    };
    let innovations: Vec<Vec<f64>> = (0..u.nrows())
        .map(|_| {
            let white = noise.normals(p);
            (0..p).map(|i| mixed(&white, i)).collect()
        })
        .collect();
    let joint = Mat::from_fn(u.nrows(), m + p, |t, j| if j < m { u[(t, j)] } else { innovations[t][j - m] });
    let (system, n) = (model.system(), model.system().states());
    let b = Mat::from_fn(n, m + p, |i, j| if j < m { system.b()[(i, j)] } else { model.k()[(i, j - m)] });
    let d = Mat::from_fn(p, m + p, |i, j| if j < m { system.d()[(i, j)] } else { f64::from(i == j - m) });
    let whole = StateSpace::discrete(system.a().to_owned(), b, system.c().to_owned(), d, 0.1).unwrap();
    whole.simulate(joint.as_ref(), x0).unwrap()
}

pub(crate) fn white_inputs(samples: usize, inputs: usize, noise: &mut Noise) -> Mat<f64> {
    let values = noise.normals(samples * inputs);
    Mat::from_fn(samples, inputs, |i, j| values[j * samples + i])
}

pub(crate) fn data(model: &Innovations, samples: usize, x0: &[f64], seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = white_inputs(samples, model.system().inputs(), &mut noise);
    let y = outputs(model, &u, x0, &mut noise);
    Dataset::new(0.1, u, y).unwrap()
}

/// Largest difference of the gains at a grid of frequencies, over the largest gain of `truth`.
pub(crate) fn gain_error(found: &StateSpace, truth: &StateSpace) -> f64 {
    let omega: Vec<f64> = (0..60).map(|k| f64::from(k) * 0.5).collect();
    let (a, b) = (found.gains(&omega), truth.gains(&omega));
    let (mut error, mut size) = (0.0_f64, 0.0_f64);
    for (a, b) in a.iter().zip(&b) {
        for (i, j) in (0..a.nrows()).flat_map(|i| (0..a.ncols()).map(move |j| (i, j))) {
            error = error.max((a[(i, j)] - b[(i, j)]).norm());
            size = size.max(b[(i, j)].norm());
        }
    }
    error / size
}

/// The pole nearest to a point.
pub(crate) fn pole_near(system: &StateSpace, point: Complex64) -> Complex64 {
    let poles = system.poles().unwrap();
    poles.into_iter().min_by(|a, b| (a - point).norm().total_cmp(&(b - point).norm())).unwrap()
}
