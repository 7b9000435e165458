//! Facts are read from JSON as they were written.

use std::fmt::Debug;

use ident::{AnyModel, Arx, Dataset, OrderScan};
use lti::Discretisation;
use proptest::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use signal::excitation::Random;
use toolbox_report::convert::{Conversion, Form, convert};
use toolbox_report::delay::{Delays, Known};
use toolbox_report::models::{Model, bode, poles, step};
use toolbox_report::order::Orders;
use toolbox_report::spectrum::{PeakWidth, Periods, SpectrumFacts, SpectrumMethod, SpectrumOptions, facts, spectra};

use super::estimated_as;

const SAMPLES: usize = 300;
const SAMPLE_TIME_S: f64 = 0.01;

/// Numbers that are not known are equal here, which no comparison of numbers is.
#[track_caller]
fn assert_reads_back<T: Serialize + DeserializeOwned + Debug>(facts: &T) {
    let text = serde_json::to_string(facts).unwrap();
    let read: T = serde_json::from_str(&text).unwrap();
    assert_eq!(format!("{read:?}"), format!("{facts:?}"));
}

/// A resonance with a pole of this radius behind a dead time, under noise of this size.
fn resonance(seed: u64, radius: f64, delay: usize, noise: f64) -> Dataset {
    let mut random = Random::new(seed);
    let u: Vec<f64> = (0..SAMPLES).map(|_| random.normal()).collect();
    let mut y = vec![0.0; SAMPLES];
    for t in delay.max(2)..SAMPLES {
        y[t] = 1.4 * radius * y[t - 1] - radius * radius * y[t - 2] + u[t - delay] + noise * random.normal();
    }
    Dataset::siso(SAMPLE_TIME_S, &u, &y).unwrap()
}

fn spectra_of(data: &Dataset, method: Option<SpectrumMethod>) -> Vec<SpectrumFacts> {
    facts(&spectra(data, &SpectrumOptions { method, periods: Periods::Found, window: None }).unwrap())
}

fn delays(data: &Dataset, spacing: Option<usize>) -> Delays {
    let known = Known { adjustments: &[], spacing, clock_is_given: false, between_is_given: true };
    Delays::of(data.clone(), &known, 5, &work::Context::new()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn prop_facts_of_models_are_read_as_they_were_written(seed in any::<u64>(), radius in 0.5..0.99, noise in 0.0..1.0) {
        let data = resonance(seed, radius, 1, noise);
        let estimated = estimated_as(Arx::new(2, 2, 1).fit(&data).unwrap().map(AnyModel::from), &data);
        let model = || vec![Model::new("arx".to_owned(), estimated.document.clone()).unwrap()];
        assert_reads_back(&bode(model(), 0.95).unwrap().facts());
        assert_reads_back(&step(model(), 0.95).unwrap().facts());
        assert_reads_back(&poles(model(), 0.95).unwrap().facts());
        assert_reads_back(&estimated.facts(Vec::new()));
        let rule = Discretisation::ZeroOrderHold;
        let asked = Conversion { form: Form::ZerosAndPoles, sample_time_s: None, continuous: false, rule };
        let zeros_and_poles = convert(estimated.document.clone(), &asked).unwrap().zeros_and_poles().unwrap();
        prop_assert_eq!(zeros_and_poles.len(), 1);
        assert_reads_back(&zeros_and_poles);
    }

    #[test]
    fn prop_facts_of_data_are_read_as_they_were_written(seed in any::<u64>(), radius in 0.5..0.99, noise in 0.0..1.0) {
        let data = resonance(seed, radius, 1, noise);
        use SpectrumMethod::{BlackmanTukey, Etfe, Lpm, Lrm, Welch};
        for method in [None, Some(Welch), Some(BlackmanTukey), Some(Lpm), Some(Lrm), Some(Etfe)] {
            assert_reads_back(&spectra_of(&data, method));
        }
        let ranges = [1..=2, 1..=2, 1..=3];
        let [na, nb, nk] = ranges.clone();
        let table = OrderScan::new(na, nb, nk).run(&data).unwrap();
        assert_reads_back(&Orders { table, ranges, is_validated: true }.facts());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2))]

    #[test]
    fn prop_facts_of_delays_are_read_as_they_were_written(seed in any::<u64>(), delay in 1_usize..4) {
        let data = resonance(seed, 0.5, delay, 0.1);
        let found = delays(&data, Some(1)).facts();
        prop_assert!(found.models.found().is_some_and(|models| !models.is_empty()));
        assert_reads_back(&found);
        let uneven = delays(&data, None).facts();
        prop_assert!(uneven.arx.is_none() && uneven.impulse_response.found().is_none());
        assert_reads_back(&uneven);
    }
}

/// Peaks of a response at lines and of a curve have different numbers beside the same ones.
#[test]
fn exact_both_kinds_of_peaks_are_read_as_they_were_written() {
    let once = resonance(3, 0.95, 1, 0.01);
    let kind = |found: &[SpectrumFacts]| found[0].peaks[0].width;
    let curve = spectra_of(&once, None);
    assert!(matches!(kind(&curve), PeakWidth::OfCurve { .. }));
    let (u, y) = (once.experiments()[0].input(0), once.experiments()[0].output(0));
    let lines = spectra_of(&Dataset::siso(SAMPLE_TIME_S, &u.repeat(8), &y.repeat(8)).unwrap(), None);
    assert!(matches!(kind(&lines), PeakWidth::AtLines { .. }) && lines[0].periodic.is_some());
    assert_reads_back(&curve);
    assert_reads_back(&lines);
}
