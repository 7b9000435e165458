//! Delays of long data.

use ident::Dataset;
use signal::excitation::Random;
use toolbox_report::delay::{DelayFacts, Delays, Known};

const SAMPLES: usize = 60_000;
const STEP_S: f64 = 1e-3;

/// An input that is held for twenty samples, and noise.
fn signals() -> (Vec<f64>, Vec<f64>) {
    let mut random = Random::new(4);
    let levels: Vec<f64> = (0..SAMPLES / 20).map(|_| random.normal()).collect();
    ((0..SAMPLES).map(|t| levels[t / 20]).collect(), (0..SAMPLES).map(|_| random.normal()).collect())
}

fn found(u: &[f64], y: &[f64]) -> DelayFacts {
    let known = Known { adjustments: &[], spacing: Some(1), clock_is_given: false, between_is_given: true };
    Delays::of(Dataset::siso(STEP_S, u, y).unwrap(), &known, 30, &work::Context::new()).unwrap().facts()
}

fn is_of_a_part(found: &DelayFacts) -> bool {
    found.notes.iter().any(|note| note.contains("25000 of 60000 samples"))
}

fn holds(found: &DelayFacts, delay_s: f64) -> bool {
    let [low, high] = found.delay[0].interval_95_s.unwrap();
    low <= delay_s && delay_s <= high
}

/// A lag of ten samples after a delay of seven: with little noise a part is enough, with much it is not.
#[test]
fn regress_a_part_of_long_data_serves_where_more_would_not_sharpen_the_interval() {
    let (u, noise) = signals();
    let keep = (-0.1_f64).exp();
    let mut lag = vec![0.0; SAMPLES];
    for t in 8..SAMPLES {
        lag[t] = keep * lag[t - 1] + (1.0 - keep) * u[t - 8];
    }
    for (size, is_enough) in [(0.005, true), (0.5, false)] {
        let y: Vec<f64> = lag.iter().zip(&noise).map(|(y, e)| y + size * e).collect();
        let found = found(&u, &y);
        assert_eq!(is_of_a_part(&found), is_enough, "{found:?}");
        assert!(holds(&found, 7.0 * STEP_S), "{found:?}");
    }
}

/// A gain under a held input leaves a sample open, of however many data.
#[test]
fn regress_a_part_of_long_data_serves_for_a_gain() {
    let (u, noise) = signals();
    let y: Vec<f64> = (0..SAMPLES).map(|t| if t < 3 { 0.0 } else { 2.0 * u[t - 3] } + 0.1 * noise[t]).collect();
    let found = found(&u, &y);
    assert!(is_of_a_part(&found), "{found:?}");
    for (end, samples) in found.delay[0].interval_95_s.unwrap().into_iter().zip([2.0, 3.0]) {
        assert!((end / STEP_S - samples).abs() < 0.1, "{found:?}");
    }
}

/// Two clocks that start at different times: the input of an instant stands 20 rows behind its answer.
#[test]
fn regress_an_output_ahead_of_its_input_is_named_with_its_interval() {
    let mut random = Random::new(9);
    let mut state = 0.0;
    let next = |_| {
        state = 0.8 * state + random.normal();
        state
    };
    let u: Vec<f64> = (0..3020).map(next).collect();
    let y: Vec<f64> = (0..3000).map(|k| u[k + 20] + 0.05 * random.normal()).collect();
    let found = found(&u[..3000], &y);
    let reason = found.delay[0].unclaimed.as_deref().unwrap();
    assert!(reason.contains("ahead of the input by 0.0"), "{reason}");
    assert!(found.delay[0].range_of_methods_s.is_none() && found.doubts.is_empty(), "{found:?}");
}
