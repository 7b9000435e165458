//! Records of a million samples.

use faer::Mat;
use ident::delay::{ArxDelay, ImpulseDelay, PeakDelay};
use ident::recursive::{Adaptation, Recursive, RecursiveStructure};
use ident::{Advice, Channel, Dataset, ExcitationOptions, Trend, TrendScope, TrendShape, advise, least_squares};

use crate::noise::Noise;

const ROWS: usize = 1_000_000;

/// `y = 0.9 y(t−1) + 3e−6 u(t−4) + e` about a large level, u of the order of a million.
fn long() -> Dataset {
    let mut noise = Noise::new(1);
    let u: Vec<f64> = (0..ROWS).map(|_| 1e6 * noise.normal()).collect();
    let mut y = vec![0.0; ROWS];
    (4..ROWS).for_each(|t| y[t] = 0.9 * y[t - 1] + 3e-6 * u[t - 4] + noise.normal());
    y.iter_mut().for_each(|v| *v += 5e4);
    Dataset::siso(1e-3, &u, &y).unwrap()
}

#[test]
#[ignore = "slow"]
fn stat_a_million_badly_scaled_samples_are_handled() {
    let raw = long();
    let found = advise(&raw);
    assert!(found.iter().any(|a| matches!(a, Advice::Offset { channel: Channel::Output(0), .. })), "{found:?}");
    assert!(!found.iter().any(|a| matches!(a, Advice::Feedback { .. } | Advice::Feedthrough { .. })), "{found:?}");
    let data = Trend::estimate(&raw, TrendShape::Mean, TrendScope::Common).unwrap().remove(&raw).unwrap();
    assert!(ExcitationOptions::default().of_inputs(&data).unwrap().at_least);
    assert_eq!(ArxDelay { na: 1, nb: 1, ..Default::default() }.estimate(&data).unwrap().delays, [4]);
    assert_eq!(ImpulseDelay::default().estimate(&data).unwrap()[0].delay, Some(4));
    assert!(PeakDelay::default().estimate(&data).unwrap().delay.samples > 3.9);
}

#[test]
#[ignore = "slow"]
fn exact_a_million_recursive_steps_equal_least_squares() {
    let raw = long();
    let data = Trend::estimate(&raw, TrendShape::Mean, TrendScope::Common).unwrap().remove(&raw).unwrap();
    let structure = RecursiveStructure::Arx { na: 1, nb: vec![1], nk: vec![4] };
    let mut recursive = Recursive::new(structure, Adaptation::Forgetting(1.0)).unwrap();
    let e = &data.experiments()[0];
    for (u, y) in e.input(0).iter().zip(e.output(0)) {
        recursive.step(&[*u], *y).unwrap();
    }
    let (u, y) = (e.input(0), e.output(0));
    let phi = Mat::from_fn(ROWS - 4, 2, |i, j| [-y[i + 3], u[i]][j]);
    let batch = least_squares(phi.as_ref(), &y[4..]).unwrap();
    for (found, expected) in recursive.parameters().iter().zip(&batch.parameters) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}
