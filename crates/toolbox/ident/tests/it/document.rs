//! A model written down comes back as it was.

use faer::Mat;
use ident::{AnyModel, Arx, Dataset, EstimateRecord, IdentError, Label, LinearModel, ModelDocument, Parametric};
use lti::{ProcessModel, StateSpace};

use crate::noise::Noise;

fn written_and_read(document: &ModelDocument) -> ModelDocument {
    let text = serde_json::to_string(document).unwrap();
    serde_json::from_str::<ModelDocument>(&text).unwrap().checked().unwrap()
}

fn arx_document() -> ModelDocument {
    let mut noise = Noise::new(3);
    let u = noise.normals(300);
    let mut y = vec![0.0; 300];
    for t in 1..300 {
        y[t] = 0.7 * y[t - 1] + u[t - 1] + 0.1 * noise.normal();
    }
    let data = Dataset::siso(0.1, &u, &y).unwrap();
    let fit = Arx::new(1, 1, 1).fit(&data).unwrap();
    let record = EstimateRecord::new(&fit, "ARX(1, 1, 1)", Vec::new());
    let labels = |name: &str| vec![Label::new(name, "V")];
    let mut document = ModelDocument::new(fit.model, labels("u"), labels("y"), 0.1);
    document.estimate = Some(record);
    document
}

#[test]
fn exact_estimate_comes_back_bit_for_bit() {
    let document = arx_document();
    assert_eq!(written_and_read(&document), document);
    let fit = document.fit().unwrap();
    assert!(fit.standard_errors().iter().all(|e| *e > 0.0));
    assert_eq!(fit.parameters(), document.model.parameters());
}

#[test]
fn regress_infinite_numbers_of_doubts_come_back() {
    let mut document = arx_document();
    let doubts = vec![ident::Doubt::IllConditioned { condition: f64::INFINITY }, ident::Doubt::Unstable];
    document.estimate.as_mut().unwrap().doubts = doubts;
    assert_eq!(written_and_read(&document), document);
}

#[test]
fn regress_trends_of_other_channels_are_refused() {
    let document = arx_document();
    let level = || vec![ident::Line::level(1.0)];
    for (inputs, outputs) in [
        (vec![level(), vec![]], vec![level(), level()]),
        (vec![level()], vec![vec![ident::Line::level(1.0), ident::Line::level(2.0)]]),
    ] {
        let trend = ident::Trend::per_experiment(inputs, outputs).unwrap();
        let mut written = document.clone();
        written.trend = Some(trend);
        let refused = written.checked();
        assert!(matches!(refused, Err(IdentError::Length { .. })), "{refused:?}");
    }
}

#[test]
fn exact_every_kind_of_model_comes_back() {
    let system = StateSpace::discrete(
        Mat::from_fn(2, 2, |i, j| 0.3 + 0.1 * i as f64 - 0.2 * j as f64),
        Mat::full(2, 1, 1.0 / 3.0),
        Mat::full(1, 2, 0.7),
        Mat::zeros(1, 1),
        0.1,
    );
    let form = lti::Innovations::new(system.unwrap(), Mat::full(2, 1, 0.1), Mat::full(1, 1, 2.0)).unwrap();
    let lag = ProcessModel::new(2.0).unwrap().with_lags(vec![0.3]).unwrap().with_delay(0.05).unwrap();
    let rational = ident::RationalChannel::new(vec![1.0], vec![0.5, 2.0], 0.01).unwrap();
    let one = || Mat::full(1, 1, 1.0);
    let models: [AnyModel; 3] = [
        ident::StateSpaceModel::new(form, false, true).into(),
        ident::ProcessSystem::new(vec![lag], 1, one()).unwrap().into(),
        ident::TransferFunctionModel::new(vec![rational], 1, one()).unwrap().into(),
    ];
    for model in models {
        let labels = |name: &str| vec![Label::new(name, "")];
        let document = ModelDocument::new(model, labels("u"), labels("y"), 0.1);
        assert_eq!(written_and_read(&document), document);
        let form = document.model.innovations(0.1, document.intersample).unwrap();
        assert!(form.system().states() > 0);
    }
}

#[test]
fn regress_documents_that_are_none_are_refused() {
    let text = serde_json::to_string(&arx_document()).unwrap();
    let read = |text: String| serde_json::from_str::<ModelDocument>(&text).map(ModelDocument::checked);
    let later = read(text.replace("\"version\":1", "\"version\":2")).unwrap();
    assert!(matches!(later, Err(IdentError::DocumentVersion { found: 2, .. })));
    let other = read(text.replace("dynoid model", "another model")).unwrap();
    assert!(matches!(other, Err(IdentError::Document { .. })));
    let no_input = read(text.replace("\"inputs\":[{\"name\":\"u\",\"unit\":\"V\"}]", "\"inputs\":[]")).unwrap();
    assert!(matches!(no_input, Err(IdentError::Length { .. })));
    let backwards = text.replace("\"sample_time_s\":0.1", "\"sample_time_s\":-1.0");
    assert!(read(backwards).is_err(), "a model of a negative sample time");
    let mut bare = arx_document();
    bare.estimate = None;
    assert!(matches!(bare.fit(), Err(IdentError::NoEstimate)));
}

#[test]
fn exact_a_model_as_its_noise_sees_it() {
    let equation = lti::PolynomialEquation {
        a: vec![vec![-0.5]],
        b: vec![vec![1.0, 0.3]],
        nk: vec![2],
        c: vec![0.4],
        d: vec![-0.2, 0.1],
        f: vec![vec![-0.8]],
    };
    let model = lti::PolynomialModel::siso(0.1, 2, equation).unwrap();
    let expected = model.noise_transfer_function(0).unwrap();
    let forms = [AnyModel::from(model.clone()), {
        AnyModel::from(ident::StateSpaceModel::new(model.innovations().unwrap(), true, true))
    }];
    let labels = |name: &str| vec![Label::new(name, "V")];
    for form in forms {
        let seen = ModelDocument::new(form, labels("u"), labels("y"), 0.1).of_noise().unwrap().unwrap();
        assert_eq!((seen.inputs[0].name.as_str(), seen.inputs[0].unit.as_str()), ("e", "V"));
        let omega = [0.0, 1.0, 10.0, 30.0];
        let found = ident::uncertainty::Dynamics::frequency_response(&seen.model, 0, 0, &omega).unwrap();
        let wanted = expected.frequency_response(&omega).unwrap();
        for (a, b) in found.response.iter().zip(&wanted.response) {
            assert!((a - b).norm() < 1e-12, "{a} {b}");
        }
    }
    // The covariance goes with the parameters: that of a is the same, the one in front of the noise is certain.
    let document = arx_document();
    let seen = document.of_noise().unwrap().unwrap();
    let (own, of_noise) = (document.estimate.as_ref().unwrap(), seen.estimate.as_ref().unwrap());
    assert_eq!(of_noise.parameters, [own.parameters[0], 1.0]);
    assert_eq!(of_noise.covariance, [[own.covariance[0][0], 0.0], [0.0, 0.0]]);
    assert!(seen.fit().is_ok());
}
