//! Subspace estimates of data that were taken under feedback.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;

use ident::{Dataset, Doubt, Fit, IdentError, StateSpaceModel, StateSpacePem, Subspace, Weighting};
use lti::Complex64;

use crate::noise::Noise;
use crate::polynomials::binary;

const A: [f64; 2] = [-1.5, 0.7];
const B: [f64; 2] = [1.0, 0.5];
const C: [f64; 2] = [-0.3, 0.2];
const OMEGA: [f64; 5] = [0.05, 0.2, 0.45, 0.8, 1.5];

/// `A y = B u + C e`, `u = r − k y` with a binary reference: an input may follow the output of the same instant.
fn record(count: usize, k: f64, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let (r, e) = (binary(&mut noise, count, 3), noise.normals(count));
    let (mut u, mut y) = (vec![0.0; count], vec![0.0; count]);
    for t in 0..count {
        let before = |x: &[f64], lag: usize| if t >= lag { x[t - lag] } else { 0.0 };
        let part = |l: usize| B[l - 1] * before(&u, l) + C[l - 1] * before(&e, l) - A[l - 1] * before(&y, l);
        y[t] = e[t] + part(1) + part(2);
        u[t] = r[t] - k * y[t];
    }
    Dataset::siso(1.0, &u, &y).unwrap()
}

fn truth(w: f64) -> Complex64 {
    let z = Complex64::cis(-w);
    (z * B[0] + z * z * B[1]) / (z * A[0] + z * z * A[1] + 1.0)
}

fn is_warned<M>(fit: &Fit<M>) -> bool {
    fit.doubts.contains(&Doubt::Feedback { output: 0, input: 0 })
}

type Estimate<'a> = &'a dyn Fn(&Dataset) -> Result<Fit<StateSpaceModel>, IdentError>;

/// How often the 95 % bands hold the gain, the root mean square of its relative error, and its mean.
struct Gains {
    held: [usize; 5],
    error: [f64; 5],
    bias: [f64; 5],
}

fn gains(runs: u64, count: usize, k: f64, estimate: Estimate<'_>) -> Gains {
    let (mut held, mut squares, mut mean) = ([0; 5], [0.0; 5], [Complex64::ZERO; 5]);
    for seed in 0..runs {
        let fit = estimate(&record(count, k, seed)).unwrap();
        let band = fit.frequency_band(0, 0, &OMEGA).unwrap().ellipses(0.95);
        let found = fit.model.system().gains(&OMEGA);
        for (i, w) in OMEGA.into_iter().enumerate() {
            let error = found[i][(0, 0)] / truth(w) - 1.0;
            held[i] += usize::from(band[i].contains(truth(w)));
            squares[i] += error.norm_sqr() / runs as f64;
            mean[i] += error / runs as f64;
        }
    }
    Gains { held, error: squares.map(f64::sqrt), bias: mean.map(|m| m.norm()) }
}

fn with(weighting: Weighting) -> impl Fn(&Dataset) -> Result<Fit<StateSpaceModel>, IdentError> {
    move |data| Subspace::new(2).with_weighting(weighting).fit(data)
}

/// The other weightings are 12 to 30 % off here, and 0 of 20 of their bands hold the gain.
#[test]
fn regress_feedback_is_seen_and_does_not_bias_the_gain() {
    let automatic = gains(20, 2000, 0.3, &with(Weighting::Automatic));
    assert!(automatic.held.iter().all(|held| *held >= 15), "{:?} {:?}", automatic.held, automatic.error);
    let data = record(2000, 0.3, 1);
    for weighting in [Weighting::N4sid, Weighting::Moesp, Weighting::Cva] {
        assert!(is_warned(&with(weighting)(&data).unwrap()), "{weighting:?}");
    }
    let chosen = with(Weighting::Automatic)(&data).unwrap();
    assert!(!is_warned(&chosen) && chosen.origin.unwrap().method.contains("SSARX"));
    let simulated = Subspace::new(2).with_weighting(Weighting::Ssarx).without_noise_model().fit(&data).unwrap();
    assert!(is_warned(&simulated));
}

/// In open loop nothing changes.
#[test]
fn prop_without_feedback_canonical_variates_stay() {
    for seed in 0..20 {
        let data = record(1000, 0.0, seed);
        let (chosen, plain) = (with(Weighting::Automatic)(&data).unwrap(), with(Weighting::Cva)(&data).unwrap());
        assert!(!is_warned(&plain) && chosen == plain);
    }
}

#[test]
#[ignore = "slow"]
fn stat_bands_under_feedback() {
    let pem = |data: &Dataset| StateSpacePem::new(2).fit(data);
    for (k, count) in [(0.0, 1000), (0.3, 500), (0.3, 2000)] {
        let (found, searched) = (gains(1000, count, k, &with(Weighting::Ssarx)), gains(1000, count, k, &pem));
        let plain = gains(200, count, k, &with(Weighting::Cva));
        println!("{k} {count}: SSARX {:?} {:?} {:?}", found.held, found.error, found.bias);
        println!("{k} {count}: PEM {:?} {:?} {:?}", searched.held, searched.error, searched.bias);
        println!("{k} {count}: CVA {:?} of 200 {:?} {:?}", plain.held, plain.error, plain.bias);
        assert!(searched.held.iter().all(|held| (925..=975).contains(held)), "{k} {count} {:?}", searched.held);
        // Subspace intervals are lower bounds.
        assert!(found.held.iter().all(|held| (880..=975).contains(held)), "{k} {count} {:?}", found.held);
        let unbiased = found.bias.iter().zip(found.error).all(|(bias, error)| *bias < 0.3 * error);
        assert!(unbiased, "{k} {count} {:?} {:?}", found.bias, found.error);
        assert!(k > 0.0 || found.error.iter().zip(plain.error).all(|(s, c)| *s < 1.05 * c));
    }
}

/// Inputs of many kinds in open loop, noise without and with memory, orders too low, right, too high and chosen.
#[test]
#[ignore = "slow"]
fn stat_feedback_is_not_seen_in_open_loop() {
    for (kind, memory) in (0..4).flat_map(|kind| [(kind, 0.0), (kind, 0.9)]) {
        for count in [500, 5000] {
            let mut warned = [0; 4];
            let runs = if count == 500 { 1000 } else { 200 };
            for seed in 0..runs {
                let data = open_loop(kind, memory, count, seed);
                let orders = [Subspace::new(1), Subspace::new(2), Subspace::new(4), Subspace::auto(8)];
                for (order, warned) in orders.into_iter().zip(&mut warned) {
                    let fit = order.with_weighting(Weighting::Cva).fit(&data);
                    *warned += usize::from(fit.is_ok_and(|fit| is_warned(&fit)));
                }
            }
            println!("input {kind}, memory {memory}, {count} samples: {warned:?} of {runs}");
            // One in a thousand is asked for; six are three deviations more.
            assert!(warned.iter().all(|count| *count <= 6), "{kind} {memory} {count}: {warned:?} of {runs}");
        }
    }
}

/// White, held, slow and periodic inputs of a system with poles at 0.93 ± 0.01i.
fn open_loop(kind: usize, memory: f64, count: usize, seed: u64) -> Dataset {
    let mut noise = Noise::new(10_000 + seed);
    let u = match kind {
        0 => noise.normals(count),
        1 => binary(&mut noise, count, 7),
        2 => noise.coloured(count, 1.0, 0.95),
        _ => {
            let phases: Vec<f64> = (0..30).map(|_| TAU * noise.uniform()).collect();
            let tone = |t: usize, k: usize| (0.02 * (k + 1) as f64 * t as f64 + phases[k]).cos() / 4.0;
            (0..count).map(|t| (0..30).map(|k| tone(t, k)).sum()).collect()
        }
    };
    let v = noise.coloured(count, 1.0, memory);
    let mut x = vec![0.0; count];
    for t in 2..count {
        x[t] = 1.85 * x[t - 1] - 0.86 * x[t - 2] + 0.1 * u[t - 1];
    }
    let y: Vec<f64> = x.iter().zip(&v).map(|(x, v)| x + v).collect();
    Dataset::siso(1.0, &u, &y).unwrap()
}
