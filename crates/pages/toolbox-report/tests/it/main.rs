//! Integration tests of `toolbox-report`: what a result holds is in its page and in its JSON.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod delay;
mod periodic;
mod written;

use ident::validate::judge;
use ident::{AnyModel, Arx, Dataset, EstimateRecord, Fit, InitialState, ModelDocument};
use page::{Page, Screen, terminal};
use signal::excitation::Random;
use toolbox_report::compare::{self, Met, MetFacts};
use toolbox_report::fit::{EstimateFacts, Estimated, Verdict};
use toolbox_report::models::{Detail, Model, bode, poles, step};
use toolbox_report::order::Orders;
use toolbox_report::response::Responded;
use toolbox_report::spectrum::{self, Periods, SpectrumMethod, SpectrumOptions, spectra};

fn data() -> Dataset {
    let mut random = Random::new(1);
    let u: Vec<f64> = (0..500).map(|_| random.normal()).collect();
    let mut y = vec![0.0; 500];
    (2..500).for_each(|t| y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 1] + 0.1 * random.normal());
    Dataset::siso(0.1, &u, &y).unwrap()
}

fn estimated(data: &Dataset) -> Estimated {
    estimated_as(Arx::new(2, 1, 1).fit(data).unwrap().map(AnyModel::from), data)
}

fn estimated_as(fit: Fit<AnyModel>, data: &Dataset) -> Estimated {
    let (inputs, outputs) = (data.input_labels().to_vec(), data.output_labels().to_vec());
    let mut document = ModelDocument::new(fit.model.clone(), inputs, outputs, data.sample_time_s());
    document.estimate = Some(EstimateRecord::new(&fit, "a method".to_owned(), Vec::new()));
    let verdict = Verdict::new(&fit, data, None);
    Estimated { document, fit, verdict, experiments: 1 }
}

fn model(data: &Dataset) -> Vec<Model> {
    vec![Model::new("arx".to_owned(), estimated(data).document).unwrap()]
}

fn lines(page: &Page) -> String {
    terminal(page, Screen { width: 100, colour: false, is_narrow: false })
}

fn assert_says(page: &Page, words: &[&str]) {
    let text = lines(page);
    words.iter().for_each(|word| assert!(text.contains(word), "{word}: {text}"));
    assert!(!page.figures().is_empty(), "{}", page.title);
}

#[test]
fn snap_an_estimate_has_parameters_fits_tests_and_figures() {
    let data = data();
    let found = estimated(&data);
    let words = ["95 % interval", "fit on", "loss", "passed: residuals of"];
    assert_says(&found.page(&data), &words);
    let facts = found.facts(vec!["filtered".to_owned()]);
    assert_eq!((facts.adjustments[0].as_str(), facts.judged.len()), ("filtered", 1));
    let text = serde_json::to_string(&facts).unwrap();
    assert_eq!(serde_json::from_str::<EstimateFacts>(&text).unwrap(), facts);
}

#[test]
fn snap_models_are_shown_by_their_curves_and_roots() {
    let data = data();
    let curves = bode(model(&data), 0.95).unwrap();
    assert_says(&curves.page(Detail::Summary), &["gain at rest", "95 % interval"]);
    assert!(lines(&curves.page(Detail::Points)).lines().count() > 300);
    assert_says(&step(model(&data), 0.95).unwrap().page(Detail::Summary), &["final value", "dead time"]);
    assert_says(&poles(model(&data), 0.95).unwrap().page(), &["poles", "natural frequency", "sample time 0.1 s"]);
}

#[test]
fn snap_models_on_recordings() {
    let data = data();
    let document = estimated(&data).document;
    let judged = judge(&document.model, &data, None, &InitialState::Estimated).unwrap();
    let shown = Responded { model: "arx", what: "simulated", outputs: &document.outputs, data: &data, judged: &judged };
    assert_says(&shown.page(), &["simulated, fit"]);
    assert_eq!(shown.facts()[0].values.len(), 500);
    let met = [Met { model: "arx".to_owned(), data: data.clone(), judged: Ok(judged.clone()) }];
    assert_says(&compare::page(&met), &["rms error", "arx"]);
    assert!(matches!(met[0].facts(), MetFacts::Judged { fit_percent, .. } if fit_percent[0][0] > 80.0));
}

#[test]
fn snap_data_before_a_model() {
    let data = data();
    let options = SpectrumOptions { method: Some(SpectrumMethod::Welch), periods: Periods::Found, window: None };
    let found = spectra(&data, &options).unwrap();
    assert_says(&spectrum::page(&found), &["coherence: median"]);
    let ranges = [1..=3, 1..=2, 1..=2];
    let [na, nb, nk] = ranges.clone();
    let table = ident::OrderScan::new(na, nb, nk).run(&data).unwrap();
    let orders = Orders { table, ranges, is_validated: false };
    assert_says(&orders.page(), &["best by", "12 structures"]);
    assert_eq!(orders.facts().best["BIC"].na, 2);
}
