//! The conformance suite of estimators: it passes a right one, and catches wrong ones.

use faer::Mat;
use ident::{Dataset, Fit, IdentError};
use lti::{PolynomialEquation, PolynomialModel};
use testkit::estimator::{Case, conform, failures};
use testkit::system::{self, SAMPLE_TIME_S};

use crate::stand_in;

type Estimate = Result<Fit<PolynomialModel>, IdentError>;

fn broken_by(estimator: impl Fn(&Dataset) -> Estimate) -> Vec<String> {
    let truth = system::arx().unwrap();
    failures(&Case::new(estimator, &truth, SAMPLE_TIME_S))
}

#[test]
fn exact_plain_least_squares_conforms() {
    conform(&Case::new(|data: &Dataset| stand_in::arx(data, 2, 2), &system::arx().unwrap(), SAMPLE_TIME_S));
}

#[test]
fn exact_two_inputs_conform_and_collinear_ones_are_doubted() {
    let equation = PolynomialEquation {
        a: vec![vec![-1.5, 0.7]],
        b: vec![vec![1.0, 0.5], vec![-0.4, 0.8]],
        nk: vec![1, 1],
        f: vec![vec![], vec![]],
        ..Default::default()
    };
    let truth = PolynomialModel::new(SAMPLE_TIME_S, vec![equation], Mat::full(1, 1, 0.04)).unwrap();
    conform(&Case::new(|data: &Dataset| stand_in::arx(data, 2, 2), &truth, SAMPLE_TIME_S));
    let careless = |data: &Dataset| {
        let fit = stand_in::arx(data, 2, 2);
        let swapped = || system::data(&truth, SAMPLE_TIME_S, 500, 1.0, 1)?.channels(&[1, 0], &[0]);
        if matches!(fit, Err(IdentError::RankDeficient { .. })) { stand_in::arx(&swapped()?, 2, 2) } else { fit }
    };
    let broken = failures(&Case::new(careless, &truth, SAMPLE_TIME_S));
    assert!(broken.iter().any(|b| b.starts_with("doubts collinear")), "{broken:?}");
}

#[test]
fn exact_broken_estimators_are_caught() {
    let plain = |data: &Dataset| stand_in::arx(data, 2, 2);
    let change = |change: fn(&mut Fit<PolynomialModel>)| {
        broken_by(move |data| {
            let mut fit = plain(data)?;
            change(&mut fit);
            Ok(fit)
        })
    };
    let caught = |broken: &[String], rule: &str| broken.iter().any(|b| b.starts_with(rule));
    let biased = broken_by(|data| stand_in::arx(data, 2, 1));
    assert!(caught(&biased, "recovers the truth"), "{biased:?}");
    let wrong_loss = change(|fit| fit.loss *= 1.01);
    assert!(wrong_loss.len() == 1 && caught(&wrong_loss, "its loss"), "{wrong_loss:?}");
    let no_covariance = change(|fit| fit.covariance = -&fit.covariance);
    assert!(no_covariance.len() == 1 && caught(&no_covariance, "its covariance"), "{no_covariance:?}");
    let always = broken_by(|data| plain(data).or_else(|_| plain(&system::data(&system::arx()?, 0.1, 99, 1.0, 1)?)));
    for rule in ["refuses short data", "doubts inputs", "stands missing samples"] {
        assert!(caught(&always, rule), "{always:?}");
    }
    let panics = broken_by(|data| {
        assert!(data.samples() > 3);
        plain(data)
    });
    assert!(panics.len() == 1 && panics[0].ends_with("it panicked"), "{panics:?}");
    let from_units = broken_by(|data| {
        let mut fit = plain(data)?;
        let size = data.experiments()[0].output(0).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let theta: Vec<f64> = fit.parameters().iter().map(|v| v * (1.0 + 1e-9 * size)).collect();
        fit.model = fit.model.with_coefficients(&theta)?;
        Ok(fit)
    });
    assert!(caught(&from_units, "follows a change of units"), "{from_units:?}");
}
