//! Clocks that run apart.

use std::f64::consts::TAU;

use signal::drift::relative_drift;
use signal::excitation::Random;
use signal::{Complex64, Signal, SignalError};

/// Lines of a signal: frequency in Hz, amplitude and phase.
struct Lines(Vec<(f64, Complex64)>);

impl Lines {
    fn new(random: &mut Random, count: usize, highest_hz: f64) -> Self {
        let line = |_| (0.3 + highest_hz * random.uniform(), Complex64::new(random.normal(), random.normal()));
        Lines((0..count).map(line).collect())
    }

    /// After a resonance at 12 Hz with a damping of a tenth.
    fn filtered(&self) -> Self {
        let gain = |f: f64| (Complex64::new(1.0 - (f / 12.0).powi(2), 0.2 * f / 12.0)).inv();
        Lines(self.0.iter().map(|(f, a)| (*f, a * gain(*f))).collect())
    }

    /// Sampled on a clock whose stamps run fast by `rate`, from a start, with noise.
    fn sampled(&self, random: &mut Random, clock: (f64, f64), duration_s: f64, rate: f64, noise: f64) -> Signal {
        let value = |i: usize| {
            let true_s = (clock.0 + i as f64 * clock.1) * (1.0 - rate);
            self.0.iter().map(|(f, a)| (a * Complex64::cis(TAU * f * true_s)).re).sum::<f64>()
        };
        let samples = (0..(duration_s / clock.1) as usize).map(|i| value(i) + noise * random.normal()).collect();
        Signal::new(clock.0, clock.1, samples).unwrap()
    }
}

#[test]
fn stat_drift_is_found_with_its_standard_error() {
    let (mut covered, mut sum, runs) = (0, 0.0, 60);
    for seed in 0..runs {
        let mut random = Random::new(100 + seed);
        let lines = Lines::new(&mut random, 80, 30.0);
        let rate = 4e-4 * (random.uniform() - 0.5);
        let x = lines.sampled(&mut random, (0.0, 0.004), 24.0, 0.0, 1.0);
        let y = lines.filtered().sampled(&mut random, (0.37, 0.01), 24.0, rate, 1.0);
        let found = relative_drift(&x, &y).unwrap();
        let z = (found.rate - rate) / found.standard_error;
        covered += usize::from(z.abs() < 2.13);
        sum += z;
        assert!(found.standard_error < 2e-4, "{found:?}");
    }
    // 95 % by Student's t with fifteen degrees of freedom: 51 or more of 60 with a probability of 99.7 %.
    assert!(covered >= 51, "{covered} of {runs}");
    assert!(sum.abs() < 4.0 * (runs as f64).sqrt(), "{sum}");
}

/// Nearly five hours at a thousand samples a second, of which not all are transformed.
#[test]
#[ignore = "slow"]
fn stat_drift_over_hours_is_found_with_its_standard_error() {
    let mut random = Random::new(1);
    let steps: Vec<f64> = (0..175_002).map(|_| random.normal()).collect();
    let mut sampled = |sample_time_s: f64, rate: f64| {
        let value = |i: usize| {
            let place = i as f64 * sample_time_s * (1.0 - rate) / 0.1;
            let (before, part) = (place.floor(), place.fract());
            steps[before as usize] * (1.0 - part) + steps[before as usize + 1] * part
        };
        let samples = (0..(17_500.0 / sample_time_s) as usize).map(|i| value(i) + random.normal()).collect();
        Signal::new(0.0, sample_time_s, samples).unwrap()
    };
    let (x, y) = (sampled(0.001, 0.0), sampled(0.01, 3e-7));
    let found = relative_drift(&x, &y).unwrap();
    assert!((found.rate - 3e-7).abs() < 4.0 * found.standard_error && found.standard_error < 1e-7, "{found:?}");
}

/// A line that another one folds onto, some hundredths of a hertz beside it, turns steadily against the first signal,
/// as behind a clock that runs apart. All other lines say that none does.
#[test]
fn exact_what_one_line_shows_is_no_clock() {
    let mut random = Random::new(7);
    let common = Lines::new(&mut random, 60, 30.0);
    let strong = |hz: f64| Lines(vec![(hz, Complex64::new(30.0, 0.0))]);
    let sum = |a: Signal, b: Signal| {
        let samples = a.samples.iter().zip(&b.samples).map(|(a, b)| a + b).collect();
        Signal::new(a.start_s, a.sample_time_s, samples).unwrap()
    };
    let clock = (0.0, 0.004);
    let mut with = |hz: f64| {
        let weak = common.sampled(&mut random, clock, 24.0, 0.0, 8.0);
        sum(weak, strong(hz).sampled(&mut random, clock, 24.0, 0.0, 0.0))
    };
    let found = relative_drift(&with(33.0), &with(33.02)).unwrap();
    assert!(found.rate.abs() < 5.0 * found.standard_error, "{found:?}");
}

#[test]
fn stat_signals_with_nothing_in_common_say_nothing() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let noise = |random: &mut Random, sample_time_s: f64| {
            let samples = (0..(20.0 / sample_time_s) as usize).map(|_| random.normal()).collect();
            Signal::new(0.0, sample_time_s, samples).unwrap()
        };
        let (x, y) = (noise(&mut random, 0.002), noise(&mut random, 0.005));
        assert_eq!(relative_drift(&x, &y).unwrap().standard_error, 2e-3);
    }
}

#[test]
fn exact_one_line_alone_tells_no_rate() {
    let mut random = Random::new(1);
    let line = Lines(vec![(40.0, Complex64::ONE)]);
    let x = line.sampled(&mut random, (0.0, 0.002), 200.0, 0.0, 0.01);
    let y = line.sampled(&mut random, (0.0, 0.002), 200.0, 1e-4, 0.01);
    assert_eq!(relative_drift(&x, &y).unwrap().standard_error, 2e-3);
}

#[test]
fn regress_what_cannot_be_compared_is_refused() {
    let signal = |start_s: f64, samples: Vec<f64>| Signal::new(start_s, 0.01, samples).unwrap();
    let wave = |count: usize| (0..count).map(|i| (i as f64).sin()).collect::<Vec<_>>();
    let x = signal(0.0, wave(3000));
    assert!(matches!(relative_drift(&x, &signal(25.0, wave(3000))), Err(SignalError::TooShort { .. })));
    assert!(matches!(relative_drift(&x, &signal(100.0, wave(3000))), Err(SignalError::TooShort { .. })));
    assert_eq!(relative_drift(&x, &signal(0.0, vec![1.0; 3000])), Err(SignalError::Constant));
    let mut broken = wave(3000);
    broken[7] = f64::NAN;
    assert_eq!(relative_drift(&x, &signal(0.0, broken)), Err(SignalError::NonFinite { index: 7 }));
}
