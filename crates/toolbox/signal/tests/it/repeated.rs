//! Responses to inputs that repeat: which lines, which periods, how sure.
#![allow(clippy::print_stdout, reason = "what was found is for whoever reads the test run")]

use std::f64::consts::TAU;

use signal::excitation::Random;
use signal::filter::Section;
use signal::frf::{RepeatedResponse, Repetition, repeated_response, resonance};
use signal::resample::{Interpolation, interpolate_at};
use signal::{Complex64, Signal, SignalError, Sos};

const T: f64 = 1e-3;
/// Samples in a period of 1 s.
const PERIOD: usize = 1000;
/// Lines every 2 Hz.
const LINES: [usize; 2] = [1, 149];

/// Of a gain of 0.4 at rest with a resonance of 76.26 Hz and a damping of 1.72 %, sampled with a held input.
fn system() -> Sos {
    let (gain, damping, omega) = (0.4, 0.0172, TAU * 76.26);
    let (radius, ratio) = ((-damping * omega * T).exp(), damping / (1.0_f64 - damping * damping).sqrt());
    let (sin, cos) = (omega * (1.0_f64 - damping * damping).sqrt() * T).sin_cos();
    let b1 = gain * (1.0 - radius * (cos + ratio * sin));
    let b2 = gain * radius * (radius + ratio * sin - cos);
    Sos::new(vec![Section { b: [0.0, b1, b2], a: [-2.0 * radius * cos, radius * radius] }], T).unwrap()
}

fn lines() -> Vec<usize> {
    (LINES[0]..=LINES[1]).step_by(2).collect()
}

fn multisine(random: &mut Random, lines: &[usize]) -> Vec<f64> {
    let phases: Vec<f64> = lines.iter().map(|_| TAU * random.uniform()).collect();
    let wave = |t: usize, h: usize, p: f64| (TAU * (h * t % PERIOD) as f64 / PERIOD as f64 + p).cos();
    (0..PERIOD).map(|t| lines.iter().zip(&phases).map(|(h, p)| wave(t, *h, *p)).sum()).collect()
}

fn with_noise(random: &mut Random, x: &[f64], deviation: f64) -> Vec<f64> {
    x.iter().map(|x| x + deviation * random.normal()).collect()
}

/// In steady state, and the truth.
fn steady(random: &mut Random, periods: usize) -> (Vec<f64>, Vec<f64>) {
    let u = multisine(random, &lines()).repeat(periods + 4);
    let y = system().filter(&u, &mut system().state_at_rest());
    (u[4 * PERIOD..].to_vec(), y[4 * PERIOD..].to_vec())
}

fn found(u: &[f64], y: &[f64]) -> RepeatedResponse {
    repeated_response(&[u], &[y], T, None).unwrap().unwrap()
}

fn used(r: &Repetition) -> (f64, usize, usize, usize) {
    (r.period_samples, r.first, r.periods, r.unsettled)
}

#[test]
fn exact_only_excited_lines_have_a_value_and_it_is_right() {
    let (u, y) = steady(&mut Random::new(1), 20);
    let all = found(&u, &y);
    assert_eq!(used(&all.repetition), (1000.0, 0, 20, 0));
    assert_eq!(all.repetition.excited, [lines()]);
    let response = &all.responses[0];
    for (f, g) in response.freq_hz.iter().zip(&response.response) {
        assert!((g - system().response(*f)).norm() < 1e-8, "{f}");
    }
}

#[test]
fn exact_a_resonance_between_lines() {
    let (u, y) = steady(&mut Random::new(1), 3);
    let response = &found(&u, &y).responses[0];
    let peak = response.freq_hz.iter().position(|f| (f - 77.0).abs() < 0.1).unwrap();
    let top = resonance(&response.freq_hz, &response.response, &response.variance, 4.0, peak).unwrap();
    let [freq_hz, height, width] = truth();
    assert!((top.freq_hz.value - freq_hz).abs() < 1e-3, "{top:?}");
    assert!((top.height.value / height - 1.0).abs() < 1e-4, "{top:?}");
    assert!((top.bandwidth_hz.unwrap().value / width - 1.0).abs() < 1e-3, "{top:?}");
}

/// Where the magnitude is largest, how large, and how wide at −3 dB.
fn truth() -> [f64; 3] {
    let magnitude = |f: f64| system().response(f).norm();
    let fine: Vec<f64> = (0..8000).map(|i| 72.0 + 1e-3 * f64::from(i)).collect();
    let top = fine.iter().copied().max_by(|a, b| magnitude(*a).total_cmp(&magnitude(*b))).unwrap();
    let above: Vec<&f64> = fine.iter().filter(|f| magnitude(**f) > magnitude(top) / 2.0_f64.sqrt()).collect();
    [top, magnitude(top), above[above.len() - 1] - above[0]]
}

/// From rest: the first periods are not settled.
#[test]
fn exact_periods_before_the_output_has_settled_are_left_out() {
    let mut random = Random::new(2);
    let u = multisine(&mut random, &lines()).repeat(12);
    let y = with_noise(&mut random, &system().filter(&u, &mut system().state_at_rest()), 0.01);
    let all = found(&u, &y);
    assert_eq!((all.repetition.unsettled, all.repetition.periods, all.repetition.first), (2, 10, 2 * PERIOD));
    let rest = repeated_response(&[&u], &[&y[..].iter().map(|v| v * 0.0).collect::<Vec<_>>()], T, None).unwrap();
    assert_eq!(rest.unwrap().repetition.unsettled, 0);
}

#[test]
fn exact_a_step_a_pause_and_another_level_before_the_periods_are_left_out() {
    let mut random = Random::new(3);
    let periodic = multisine(&mut random, &lines()).repeat(10);
    for lead in [[0.0; 2300], [25.0; 2300]] {
        let u = [&lead[..], &periodic, &[0.0; 700]].concat();
        let y = with_noise(&mut random, &system().filter(&u, &mut system().state_at_rest()), 0.01);
        let all = found(&u, &y);
        let Repetition { period_samples, first, periods, .. } = all.repetition;
        assert_eq!(period_samples, 1000.0);
        assert!((2290 + 1000..=2290 + 3100).contains(&first) && (7..=9).contains(&periods), "{first} {periods}");
        let response = &all.responses[0];
        let error = |(f, g): (&f64, &Complex64)| (g - system().response(*f)).norm();
        let worst = response.freq_hz.iter().zip(&response.response).map(error).fold(0.0, f64::max);
        assert!(worst < 0.02 && response.freq_hz.len() == lines().len(), "{worst}");
    }
}

#[test]
fn exact_a_drift_is_no_response() {
    let mut random = Random::new(4);
    let (u, y) = steady(&mut random, 10);
    let drifted: Vec<f64> = y.iter().enumerate().map(|(t, y)| y + 3e-3 * t as f64).collect();
    let (plain, with_drift) = (found(&u, &y), found(&u, &drifted));
    assert_eq!(with_drift.repetition.unsettled, 0);
    let pairs = plain.responses[0].response.iter().zip(&with_drift.responses[0].response);
    assert!(pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) < 1e-8);
}

#[test]
fn exact_a_period_of_a_fraction_of_a_sample_more() {
    let mut random = Random::new(5);
    let lines: Vec<usize> = (10..=120).step_by(2).collect();
    let period = 1000.37;
    let phases: Vec<f64> = lines.iter().map(|_| TAU * random.uniform()).collect();
    let wave = |t: f64, h: f64, p: f64| (TAU * h * t / period + p).cos();
    let value = |t: usize| lines.iter().zip(&phases).map(|(h, p)| wave(t as f64, *h as f64, *p)).sum::<f64>();
    let u: Vec<f64> = (0..24_000).map(value).collect();
    let y = system().filter(&u, &mut system().state_at_rest());
    let (u, y) = (&u[4000..], &y[4000..]);
    let all = found(u, y);
    let found = &all.repetition;
    assert!((found.period_samples - 0.5 * period).abs() < 1e-3 && found.periods > 30, "{found:?}");
    let response = &all.responses[0];
    assert!(response.freq_hz.len() >= lines.len() - 1, "{}", response.freq_hz.len());
    for (f, g) in response.freq_hz.iter().zip(&response.response) {
        assert!((g - system().response(*f)).norm() < 1e-3 * (1.0 + g.norm()), "{f} {g} {}", system().response(*f));
    }
}

#[test]
fn exact_inputs_that_do_not_repeat_or_repeat_otherwise() {
    let mut random = Random::new(6);
    let noise = with_noise(&mut random, &[0.0; 5000], 1.0);
    let (u, y) = steady(&mut random, 5);
    let ways = |u: &[f64], y: &[f64], period_s| repeated_response(&[u], &[y], T, period_s);
    assert_eq!(ways(&noise, &noise, None), Ok(None));
    assert_eq!(ways(&u[..PERIOD], &y[..PERIOD], None), Ok(None));
    assert_eq!(ways(&u[..1900], &y[..1900], None), Ok(None));
    assert_eq!(ways(&[1.0; 5000], &y, None), Ok(None));
    assert_eq!(ways(&u, &y, Some(0.7)), Err(SignalError::NotRepeated { period: 700 }));
    assert!(matches!(ways(&u, &y, Some(3.0)), Err(SignalError::Parameter { .. })));
    assert_eq!(ways(&u, &y, Some(2.0)).unwrap().unwrap().repetition.periods, 2);
    // A slow random walk is smooth over short lags.
    let mut level = 0.0;
    let walk: Vec<f64> = noise.iter().map(|v| (level += v, level).1).collect();
    assert_eq!(ways(&walk, &noise, None), Ok(None));
}

/// Each of two inputs on lines of its own; then one line shared.
#[test]
fn exact_two_inputs_are_separated_by_their_lines() {
    let mut random = Random::new(7);
    let (odd, even): (Vec<usize>, Vec<usize>) = ((1..100).step_by(2).collect(), (2..100).step_by(2).collect());
    let other = Sos::butterworth_lowpass(2, 40.0, T).unwrap();
    let both = [even.clone(), vec![51]].concat();
    for (second, shared_hz) in [(&even, vec![]), (&both, vec![51.0])] {
        let [a, b] = [&odd, second].map(|lines| multisine(&mut random, lines).repeat(8));
        let through = |filter: &Sos, u: &[f64]| filter.filter(u, &mut filter.state_at_rest());
        let y: Vec<f64> = through(&system(), &a).iter().zip(through(&other, &b)).map(|(a, b)| a + b).collect();
        let y = with_noise(&mut random, &y, 1e-3);
        let all = repeated_response(&[&a, &b], &[&y], T, None).unwrap().unwrap();
        assert_eq!(all.shared_hz, shared_hz);
        assert_eq!(all.responses[0].freq_hz.len(), odd.len() - shared_hz.len());
        for (response, filter) in all.responses.iter().zip([system(), other.clone()]) {
            for (f, g) in response.freq_hz.iter().zip(&response.response) {
                assert!((g - filter.response(*f)).norm() < 2e-3, "{f}");
            }
        }
    }
}

/// 95 % intervals of every line, of the resonance, its height and its width, with white noise on the output; from rest
/// in the second half of the draws, so that periods are left out.
#[test]
#[ignore = "Monte Carlo of 1000 draws"]
fn stat_intervals_at_the_lines_and_of_the_resonance_hold() {
    let truth = truth();
    let (draws, mut inside, mut total) = (1000, 0, 0);
    let (mut held, mut judged) = ([0; 3], [0; 3]);
    for seed in 0..draws {
        let mut random = Random::new(seed);
        let from_rest = seed % 2 == 1;
        let (u, y) = if from_rest {
            let u = multisine(&mut random, &lines()).repeat(8);
            let y = system().filter(&u, &mut system().state_at_rest());
            (u, y)
        } else {
            steady(&mut random, 8)
        };
        let y = with_noise(&mut random, &y, 1.0);
        let response = &found(&u, &y).responses[0];
        for (f, (low, high)) in response.freq_hz.iter().zip(response.magnitude_interval(0, 0, 0.95)) {
            let value = system().response(*f).norm();
            inside += usize::from(low <= value && value <= high);
            total += 1;
        }
        let magnitude = |k: &usize| response.response[*k].norm();
        let peak = (0..response.response.len()).max_by(|a, b| magnitude(a).total_cmp(&magnitude(b))).unwrap();
        let freedom = response.degrees_of_freedom[0];
        let top = resonance(&response.freq_hz, &response.response, &response.variance, freedom, peak);
        let Some(top) = top else { continue };
        for (i, number) in [Some(top.freq_hz), Some(top.height), top.bandwidth_hz].into_iter().enumerate() {
            let Some(number) = number else { continue };
            let (low, high) = number.interval(0.95);
            held[i] += usize::from(low <= truth[i] && truth[i] <= high);
            judged[i] += 1;
        }
    }
    let share = |part: usize, whole: usize| part as f64 / whole as f64;
    let coverage = share(inside, total);
    println!("lines {coverage}, top, height, width {held:?} of {judged:?}");
    assert!((0.925..=0.975).contains(&coverage), "{coverage}");
    for i in 0..3 {
        let coverage = share(held[i], judged[i]);
        assert!(judged[i] > 950 && (0.925..=0.975).contains(&coverage), "{i}: {coverage} of {}", judged[i]);
    }
}

/// Where the gain is less than its noise, and at few periods.
#[test]
#[ignore = "Monte Carlo of 1000 draws"]
fn stat_intervals_of_gains_within_the_noise_hold() {
    for (periods, deviation) in [(2, 3.0), (3, 10.0), (6, 30.0)] {
        let (mut inside, mut total) = (0, 0);
        for seed in 0..1000 {
            let mut random = Random::new(seed);
            let (u, y) = steady(&mut random, periods);
            let y = with_noise(&mut random, &y, deviation);
            let response = &found(&u, &y).responses[0];
            for (f, (low, high)) in response.freq_hz.iter().zip(response.magnitude_interval(0, 0, 0.95)) {
                let value = system().response(*f).norm();
                inside += usize::from(low <= value && value <= high);
                total += 1;
            }
        }
        let coverage = inside as f64 / total as f64;
        println!("{periods} periods, noise {deviation}: {coverage}");
        assert!((0.925..=0.975).contains(&coverage), "{periods}: {coverage}");
    }
}

/// Noise on both channels, and a period of no whole number of samples.
#[test]
#[ignore = "Monte Carlo of 1000 draws"]
fn stat_intervals_with_a_noisy_input_of_no_whole_period_hold() {
    let lines: Vec<usize> = (11..=119).step_by(4).collect();
    let u = multisine(&mut Random::new(1), &lines).repeat(7);
    let y = system().filter(&u, &mut system().state_at_rest());
    let times: Vec<f64> = (0..3500).map(|i| 3000.0 + 0.9996 * f64::from(i)).collect();
    let slower =
        |x: Vec<f64>| interpolate_at(&Signal::new(0.0, 1.0, x).unwrap(), &times, Interpolation::BandLimited).unwrap();
    let (u, y) = (slower(u), slower(y));
    let (mut inside, mut total) = (0, 0);
    for seed in 0..1000 {
        let mut random = Random::new(seed);
        let (u, y) = (with_noise(&mut random, &u, 0.2), with_noise(&mut random, &y, 0.5));
        let response = &found(&u, &y).responses[0];
        for (f, (low, high)) in response.freq_hz.iter().zip(response.magnitude_interval(0, 0, 0.95)) {
            let value = system().response(f / 0.9996).norm();
            inside += usize::from(low <= value && value <= high);
            total += 1;
        }
    }
    let coverage = inside as f64 / total as f64;
    println!("noisy input, other clock: {coverage}");
    assert!((0.925..=0.975).contains(&coverage), "{coverage}");
}

/// Stretches between lost samples are short, and some values of a short one look like others by chance.
#[test]
fn stat_random_inputs_do_not_repeat_in_short_stretches() {
    let mut random = Random::new(6);
    let mut repeating = 0;
    for length in [10, 14, 20, 30, 45, 60] {
        for _ in 0..60 {
            let u: Vec<f64> = (0..length).map(|_| random.normal()).collect();
            let binary: Vec<f64> = u.iter().map(|v| v.signum()).collect();
            for x in [u, binary] {
                repeating += usize::from(repeated_response(&[&x], &[&x], T, None).unwrap().is_some());
            }
        }
    }
    assert!(repeating <= 3, "{repeating} of 720");
}
