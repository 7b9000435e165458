//! Systems with known truth, and data made from them.

use faer::{Mat, mat};
use ident::{Dataset, Experiment, IdentError, Intersample, LinearModel};
use lti::{Innovations, LtiError, PolynomialEquation, PolynomialModel, StateSpace};
use signal::excitation::Random;

/// Sample time of every discrete system here, in seconds.
pub const SAMPLE_TIME_S: f64 = 0.1;

fn siso(nk: usize, equation: PolynomialEquation, noise_variance: f64) -> Result<PolynomialModel, LtiError> {
    PolynomialModel::siso(SAMPLE_TIME_S, nk, equation)?.with_noise_covariance(Mat::full(1, 1, noise_variance))
}

/// `y(t) − 1.5 y(t−1) + 0.7 y(t−2) = u(t−1) + 0.5 u(t−2) + e(t)`, `Var e = 0.04`.
///
/// # Errors
/// None: the numbers are given.
pub fn arx() -> Result<PolynomialModel, LtiError> {
    let (a, b) = (vec![vec![-1.5, 0.7]], vec![vec![1.0, 0.5]]);
    siso(1, PolynomialEquation { a, b, ..Default::default() }, 0.04)
}

/// [`arx`] with `C = 1 − 0.8 q⁻¹ + 0.2 q⁻²` and `nk = 2`.
///
/// # Errors
/// None.
pub fn armax() -> Result<PolynomialModel, LtiError> {
    let (a, b) = (vec![vec![-1.5, 0.7]], vec![vec![1.0, 0.5]]);
    siso(2, PolynomialEquation { a, b, c: vec![-0.8, 0.2], ..Default::default() }, 0.04)
}

/// [`arx`] with the noise `1/D`, `D = 1 − 0.7 q⁻¹`.
///
/// # Errors
/// None.
pub fn ararx() -> Result<PolynomialModel, LtiError> {
    let (a, b) = (vec![vec![-1.5, 0.7]], vec![vec![1.0, 0.5]]);
    siso(1, PolynomialEquation { a, b, d: vec![-0.7], ..Default::default() }, 0.04)
}

/// `B = q⁻¹ + 0.5 q⁻²`, `F = 1 − 1.5 q⁻¹ + 0.7 q⁻²`, white noise of variance 0.25 on the output.
///
/// # Errors
/// None.
pub fn output_error() -> Result<PolynomialModel, LtiError> {
    let (b, f) = (vec![vec![1.0, 0.5]], vec![vec![-1.5, 0.7]]);
    siso(1, PolynomialEquation { b, f, ..Default::default() }, 0.25)
}

/// [`output_error`] with the noise `C/D = (1 + 0.5 q⁻¹)/(1 − 0.85 q⁻¹)`, `Var e = 0.04`.
///
/// # Errors
/// None.
pub fn box_jenkins() -> Result<PolynomialModel, LtiError> {
    let (b, f) = (vec![vec![1.0, 0.5]], vec![vec![-1.5, 0.7]]);
    siso(1, PolynomialEquation { b, f, c: vec![0.5], d: vec![-0.85], ..Default::default() }, 0.04)
}

/// Two inputs and two outputs that depend on each other, ARX, with noises that depend on each other.
///
/// # Errors
/// None.
pub fn arx_two_by_two() -> Result<PolynomialModel, LtiError> {
    let first = PolynomialEquation {
        a: vec![vec![-1.2, 0.5], vec![0.2, 0.1]],
        b: vec![vec![1.0, 0.4], vec![0.5, -0.3]],
        nk: vec![1, 1],
        f: vec![vec![], vec![]],
        ..Default::default()
    };
    let second = PolynomialEquation {
        a: vec![vec![0.1, -0.1], vec![-0.8, 0.3]],
        b: vec![vec![0.3, 0.2], vec![1.5, 0.6]],
        nk: vec![1, 1],
        f: vec![vec![], vec![]],
        ..Default::default()
    };
    PolynomialModel::new(SAMPLE_TIME_S, vec![first, second], mat![[0.04, 0.01], [0.01, 0.09]])
}

/// Two masses and a spring, torques to speeds in continuous time: motor 0.02 kg m², load 0.05 kg m², 400 N m/rad,
/// 0.05 N m s/rad in the shaft, 0.1 and 0.2 N m s/rad at the bearings. States are the twist and both speeds; the
/// anti-resonance is at 14.2 Hz, the resonance at 26.6 Hz.
///
/// # Errors
/// None.
pub fn two_mass() -> Result<StateSpace, LtiError> {
    let (motor, load, stiffness, damping) = (0.02, 0.05, 400.0, 0.05);
    let (drag_motor, drag_load) = (0.1, 0.2);
    let a = mat![
        [0.0, 1.0, -1.0],
        [-stiffness / motor, -(damping + drag_motor) / motor, damping / motor],
        [stiffness / load, damping / load, -(damping + drag_load) / load]
    ];
    let b = mat![[0.0, 0.0], [1.0 / motor, 0.0], [0.0, -1.0 / load]];
    StateSpace::continuous(a, b, mat![[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], Mat::zeros(2, 2))
}

/// [`two_mass`] sampled at 1 kHz with held torques and white noise of 0.01 rad/s on both speeds.
///
/// # Errors
/// None.
pub fn two_mass_sampled() -> Result<Innovations, LtiError> {
    let noise = Mat::from_fn(2, 2, |i, j| if i == j { 1e-4 } else { 0.0 });
    Innovations::output_error(two_mass()?.to_discrete_zoh(1e-3)?, noise)
}

/// White normal inputs of variance one.
#[must_use]
pub fn white(samples: usize, inputs: usize, seed: u64) -> Mat<f64> {
    let mut random = Random::new(seed);
    let mut table = Mat::zeros(samples, inputs);
    for t in 0..samples {
        for k in 0..inputs {
            table[(t, k)] = random.normal();
        }
    }
    table
}

/// Response of a system: white inputs of variance one, and its own noise times `noise` (a factor on the deviation; zero
/// for none), from rest.
///
/// # Errors
/// Those of the model's innovations form and of [`Dataset::new`].
pub fn data<M: LinearModel + ?Sized>(
    system: &M,
    sample_time_s: f64,
    samples: usize,
    noise: f64,
    seed: u64,
) -> Result<Dataset, IdentError> {
    let inputs = white(samples, system.inputs(), seed);
    let outputs = outputs(system, sample_time_s, &inputs, noise, seed)?;
    Dataset::new(sample_time_s, inputs, outputs)
}

/// [`data`] in as many experiments as there are lengths, each from rest.
///
/// # Errors
/// Those of [`data`].
pub fn experiments<M: LinearModel + ?Sized>(
    system: &M,
    sample_time_s: f64,
    lengths: &[usize],
    noise: f64,
    seed: u64,
) -> Result<Dataset, IdentError> {
    let mut whole = data(system, sample_time_s, lengths.first().copied().unwrap_or(0), noise, seed)?;
    for (number, length) in lengths.iter().enumerate().skip(1) {
        let part = data(system, sample_time_s, *length, noise, seed.wrapping_add(1000 * number as u64))?;
        let record = &part.experiments()[0];
        whole = whole.with_experiment(Experiment { name: (number + 1).to_string(), ..record.clone() })?;
    }
    Ok(whole)
}

/// The outputs of a system for inputs held between samples, from rest, with its own noise times `noise`.
///
/// # Errors
/// Those of the model's innovations form.
pub fn outputs<M: LinearModel + ?Sized>(
    system: &M,
    sample_time_s: f64,
    inputs: &Mat<f64>,
    noise: f64,
    seed: u64,
) -> Result<Mat<f64>, IdentError> {
    let form = system.innovations(sample_time_s, Intersample::ZeroOrderHold)?;
    // The noise must not be the numbers of the input.
    let white = white(inputs.nrows(), form.system().outputs(), seed ^ 0xa5a5_5a5a_f0f0_0f0f);
    let root = cholesky(&form.noise_covariance().to_owned());
    let e = faer::Scale(noise) * (white * root.transpose());
    let rest = vec![0.0; form.system().states()];
    Ok(form.system().simulate(inputs.as_ref(), &rest)? + form.noise_system()?.simulate(e.as_ref(), &rest)?)
}

/// The lower Cholesky factor; a pivot that is not positive counts as zero.
fn cholesky(m: &Mat<f64>) -> Mat<f64> {
    let n = m.nrows();
    let mut l = Mat::<f64>::zeros(n, n);
    for j in 0..n {
        let pivot = m[(j, j)] - (0..j).map(|k| l[(j, k)] * l[(j, k)]).sum::<f64>();
        l[(j, j)] = pivot.max(0.0).sqrt();
        for i in j + 1..n {
            let rest = m[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
            l[(i, j)] = if l[(j, j)] > 0.0 { rest / l[(j, j)] } else { 0.0 };
        }
    }
    l
}
