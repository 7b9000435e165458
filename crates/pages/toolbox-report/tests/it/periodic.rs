//! Spectra of periodic inputs, and of inputs that excite a part of the frequencies only.

use std::f64::consts::TAU;

use ident::{AnyModel, ContinuousTransferFunction, Dataset};
use signal::Sos;
use signal::excitation::Random;
use signal::filter::Section;
use toolbox_report::spectrum::{Periods, SpectrumMethod, SpectrumOptions, facts, page, spectra};

use super::lines;

const T: f64 = 1e-3;

/// Where the magnitude of the system is largest: 76.26 Hz · √(1 − 2·0.0172²).
const PEAK_HZ: f64 = 76.2374;

/// Of a gain of 0.4 at rest, with a resonance of 76.26 Hz and a damping of 1.72 %.
fn system() -> Sos {
    let (damping, omega): (f64, f64) = (0.0172, TAU * 76.26 * T);
    let (radius, part) = ((-damping * omega).exp(), (1.0 - damping * damping).sqrt());
    let (sin, cos) = (omega * part).sin_cos();
    let b1 = 0.4 * (1.0 - radius * (cos + damping / part * sin));
    let b2 = 0.4 * radius * (radius + damping / part * sin - cos);
    Sos::new(vec![Section { b: [0.0, b1, b2], a: [-2.0 * radius * cos, radius * radius] }], T).unwrap()
}

fn answered(u: &[f64], random: &mut Random, skipped: usize) -> Dataset {
    let y = system().filter(u, &mut system().state_at_rest());
    let y: Vec<f64> = y.iter().map(|y| y + 0.05 * random.normal()).collect();
    Dataset::siso(T, &u[skipped..], &y[skipped..]).unwrap()
}

/// 20 periods of 1 s with lines every 2 Hz, up to 95 Hz.
fn multisine(skipped: usize) -> Dataset {
    let mut random = Random::new(1);
    let phases: Vec<f64> = (0..48).map(|_| TAU * random.uniform()).collect();
    let value = |t: usize| {
        let wave = |(k, phase): (usize, &f64)| (TAU * ((2 * k + 1) * t % 1000) as f64 / 1000.0 + phase).cos();
        phases.iter().enumerate().map(wave).sum::<f64>() / 7.0
    };
    let u: Vec<f64> = (0..20_000 + skipped).map(value).collect();
    answered(&u, &mut random, skipped)
}

fn options(method: Option<SpectrumMethod>, periods: Periods) -> SpectrumOptions {
    SpectrumOptions { method, periods, window: None }
}

/// Each method once claimed values between the lines and beyond them, and a resonance at 77 Hz.
#[test]
fn regress_a_multisine_gives_values_at_its_lines_and_the_resonance_between_them() {
    let data = multisine(4000);
    let methods = [None, Some(SpectrumMethod::Lpm), Some(SpectrumMethod::Lrm), Some(SpectrumMethod::Welch)];
    for method in methods {
        let found = spectra(&data, &options(method, Periods::Found)).unwrap();
        let numbers = &facts(&found)[0];
        let freq_hz = &numbers.frequency_hz;
        assert_eq!((freq_hz.len(), freq_hz[0], freq_hz[47]), (48, 1.0, 95.0));
        for (k, f) in freq_hz.iter().enumerate() {
            let truth = system().response(*f).norm();
            let gain = numbers.magnitude[k];
            assert!((gain - truth).abs() < 0.02, "{f} Hz: {gain}, {truth}");
        }
        assert_eq!(numbers.periodic.as_ref().map(|periodic| periodic.periods), Some(20));
        let (low, high) = numbers.peaks[0].frequency_interval_95_hz;
        assert!(numbers.peaks.len() == 1 && low < PEAK_HZ && PEAK_HZ < high && high - low < 0.2, "{low} {high}");
        let text = lines(&page(&found)).split_whitespace().collect::<Vec<_>>().join(" ");
        for words in ["repeats every 1 s", "mean of 20 periods", "48 lines", "no value at other frequencies"] {
            assert!(text.contains(words), "{words}: {text}");
        }
        assert_eq!(text.contains("--period none"), method.is_some(), "{text}");
    }
}

#[test]
fn regress_periods_before_the_output_has_settled_are_named() {
    let text = lines(&page(&spectra(&multisine(0), &options(None, Periods::Found)).unwrap()));
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("2 periods before were left out"), "{text}");
}

#[test]
fn regress_a_method_that_leaks_between_lines_says_so() {
    let text =
        lines(&page(&spectra(&multisine(4000), &options(Some(SpectrumMethod::Welch), Periods::Ignored)).unwrap()));
    assert!(text.contains("leaks between its lines"), "{text}");
    assert!(spectra(&multisine(4000), &options(None, Periods::Given(0.7))).is_err());
}

/// Noise up to 100 Hz: nothing is known at 400 Hz, by whatever method.
#[test]
fn regress_there_is_no_value_where_an_input_has_no_power() {
    let mut random = Random::new(2);
    let white: Vec<f64> = (0..8000).map(|_| random.normal()).collect();
    let low = Sos::butterworth_lowpass(6, 60.0, T).unwrap();
    let data = answered(&low.filter(&white, &mut low.state_at_rest()), &mut random, 0);
    use SpectrumMethod::{BlackmanTukey, Etfe, Lpm, Lrm, Welch};
    for method in [Lpm, Lrm, Welch, BlackmanTukey, Etfe] {
        let found = spectra(&data, &options(Some(method), Periods::Found)).unwrap();
        let numbers = &facts(&found)[0];
        let freq_hz = &numbers.frequency_hz;
        let nearest = |wanted: f64| {
            let distance = |k: &usize| (freq_hz[*k] - wanted).abs();
            (0..freq_hz.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
        };
        assert!(numbers.magnitude[nearest(400.0)].is_nan(), "{method:?}");
        assert!(numbers.magnitude[nearest(40.0)].is_finite(), "{method:?}");
        assert!(lines(&page(&found)).contains("next to no power at"), "{method:?}");
        assert!(numbers.periodic.is_none());
    }
}

/// Noise far beside the lines once left a fit of 24 % for a perfect model, and nothing else to judge it by.
#[test]
fn snap_a_fit_on_inputs_that_repeat_is_also_that_of_the_mean_period() {
    let clean = multisine(0);
    let mut random = Random::new(7);
    let whole = &clean.experiments()[0];
    let y: Vec<f64> = whole.output(0).iter().map(|y| y + 1.5 * random.normal()).collect();
    let data = Dataset::siso(T, whole.input(0), &y).unwrap();
    let found =
        super::estimated_as(ContinuousTransferFunction::new(0, 2).fit(&data).unwrap().map(AnyModel::from), &data);
    let facts = found.facts(Vec::new());
    let judged = &facts.judged[0];
    let whole = judged.fit_percent_simulated.as_ref().unwrap()[0][0];
    let repeated = judged.repeated[0].fit_percent_simulated[0];
    assert!(whole < 50.0 && repeated > 70.0, "{whole} {repeated}");
    let text = lines(&found.page(&data)).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("the inputs repeat every 1 s; over the mean of"), "{text}");
}

/// Drift beside the lines once gave a wrong resonance with a narrow interval, and no doubt.
#[test]
fn regress_a_model_that_misses_what_repeats_is_doubted() {
    let clean = multisine(0);
    let (mut random, mut drift) = (Random::new(7), 0.0);
    let whole = &clean.experiments()[0];
    let drifting = whole.output(0).iter().map(|y| {
        drift = 0.999 * drift + 0.2 * random.normal();
        y + drift
    });
    let data = Dataset::siso(T, whole.input(0), &drifting.collect::<Vec<f64>>()).unwrap();
    let found =
        super::estimated_as(ContinuousTransferFunction::new(0, 2).fit(&data).unwrap().map(AnyModel::from), &data);
    let facts = found.facts(Vec::new());
    assert!(facts.doubts.iter().any(|doubt| doubt.contains("misses most of what repeats in")), "{:?}", facts.doubts);
    let repeated = &facts.judged[0].repeated[0];
    assert!(repeated.fit_percent_simulated[0] < repeated.fit_percent_attainable[0] - 30.0, "{repeated:?}");
}
