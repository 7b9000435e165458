//! EMPS, an electro-mechanical positioning system with friction (nonlinearbenchmark.org): the inverse dynamic model by
//! least squares, `F = M a + F_v v + F_c sign(v) + F_0`, with the filters of its authors.

use faer::Mat;
use ident::least_squares;
use signal::filter::{Section, Sos};

use super::channels;

const SAMPLE_TIME_S: f64 = 1e-3;
const FORCE_PER_VOLT: f64 = 35.150_651_882_485_47;

/// Chebyshev low-pass of the first kind, by the bilinear transform; gain `−ripple` at rest, for an even order.
fn chebyshev(order: usize, ripple_db: f64, cutoff: f64) -> Sos {
    let width = ((1.0 / (10_f64.powf(0.1 * ripple_db) - 1.0).sqrt()).asinh()) / order as f64;
    let warped = (0.5 * std::f64::consts::PI * cutoff).tan();
    let gain = 10_f64.powf(-ripple_db / (10.0 * order as f64));
    let section = |k: usize| {
        let angle = std::f64::consts::PI * (2 * k + 1) as f64 / (2 * order) as f64;
        let pole = signal::Complex64::new(-width.sinh() * angle.sin(), width.cosh() * angle.cos()) * warped;
        let z = (1.0 + pole) / (1.0 - pole);
        let a = [-2.0 * z.re, z.norm_sqr()];
        let scale = 0.25 * gain * (1.0 + a[0] + a[1]);
        Section { b: [scale, 2.0 * scale, scale], a }
    };
    Sos::new((0..order / 2).map(section).collect(), SAMPLE_TIME_S).unwrap()
}

/// Both ways, with `pad` samples of odd reflection at either end: fewer than [`Sos::filtfilt`] takes, and the last
/// rows, which the authors keep, feel it.
fn both_ways(filter: &Sos, x: &[f64], pad: usize) -> Vec<f64> {
    let last = x.len() - 1;
    let before = (1..=pad).rev().map(|i| 2.0 * x[0] - x[i]);
    let after = (1..=pad).map(|i| 2.0 * x[last] - x[last - i]);
    let mut y: Vec<f64> = before.chain(x.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        y = filter.filter(&y, &mut filter.state_at_level(y[0]));
        y.reverse();
    }
    y[pad..pad + x.len()].to_vec()
}

/// Central differences, one-sided and of first order at the ends.
fn difference(x: &[f64]) -> Vec<f64> {
    let last = x.len() - 1;
    let at = |i: usize| match i {
        0 => x[1] - x[0],
        i if i == last => x[i] - x[i - 1],
        i => 0.5 * (x[i + 1] - x[i - 1]),
    };
    (0..x.len()).map(|i| at(i) / SAMPLE_TIME_S).collect()
}

#[test]
fn ref_positioning_system_mass_and_friction() {
    let Some([position, voltage]) = channels("emps/DATA_EMPS.mat", ["qm", "vir"]) else { return };
    let smooth = both_ways(&Sos::butterworth_lowpass(4, 100.0, SAMPLE_TIME_S).unwrap(), &position, 12);
    let velocity = difference(&smooth);
    let acceleration = difference(&velocity);
    let sign = velocity.iter().map(|v| v.signum()).collect();
    let force = voltage.iter().map(|v| FORCE_PER_VOLT * v).collect();
    // The ends are left out, then every column passes the same low-pass and every tenth row stays.
    let decimation = chebyshev(8, 0.05, 0.08);
    let thinned =
        |x: Vec<f64>| -> Vec<f64> { both_ways(&decimation, &x[49..], 24).into_iter().skip(1).step_by(10).collect() };
    let columns = [acceleration, velocity, sign, vec![1.0; position.len()]].map(thinned);
    let target = thinned(force);
    let regressors = Mat::from_fn(target.len(), 4, |i, j| columns[j][i]);
    let fit = least_squares(regressors.as_ref(), &target).unwrap();
    let errors: Vec<f64> = (0..4).map(|j| fit.covariance()[(j, j)].sqrt()).collect();
    let relative = 100.0 * (fit.cost / target.iter().map(|f| f * f).sum::<f64>()).sqrt();
    // The published digits; half of the last one is 1.1 % of the last error.
    let published = [(95.1089, 0.1085), (203.5034, 1.146), (20.3935, 0.101), (-3.1648, 0.044)];
    for (j, (value, error)) in published.into_iter().enumerate() {
        assert!((fit.parameters[j] - value).abs() < 1e-4, "{j}: {}", fit.parameters[j]);
        assert!((errors[j] / error - 1.0).abs() < 0.012, "{j}: {}", errors[j]);
    }
    assert!((relative - 4.0834).abs() < 1e-4, "{relative}");
}
