//! How fits and models look in print, and what the calls behind a summary return.

use faer::Mat;
use ident::prelude::*;
use ident::validate::compare_with;
use ident::{FormulaParts, GreyParameter, Iv4, LinearModel, ResponseFunction};
use insta::assert_snapshot;
use signal::Complex64;
use testkit::system;

fn siso() -> Dataset {
    system::data(&system::arx().unwrap(), 0.1, 1000, 1.0, 1).unwrap()
}

fn two_by_two() -> Dataset {
    system::data(&system::arx_two_by_two().unwrap(), 0.1, 1000, 0.3, 2).unwrap()
}

/// `2/(1 + 0.5 s) e^(−0.3 s)` under steps.
fn lag() -> Dataset {
    let mut random = signal::excitation::Random::new(3);
    let u: Vec<f64> = (0..600).map(|t| if (t / 60) % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let pole = (-0.1_f64 / 0.5).exp();
    let mut x = vec![0.0; 600];
    (4..600).for_each(|t| x[t] = pole * x[t - 1] + 2.0 * (1.0 - pole) * u[t - 4]);
    let y: Vec<f64> = x.iter().map(|x| x + 0.05 * random.normal()).collect();
    Dataset::siso(0.1, &u, &y).unwrap()
}

#[test]
fn snap_polynomial_fits() {
    let data = siso();
    assert_snapshot!("arx", Arx::new(2, 2, 1).fit(&data).unwrap());
    assert_snapshot!("iv4", Iv4::new(2, 2, 1).fit(&data).unwrap());
    assert_snapshot!("box_jenkins", BoxJenkins::new(2, 1, 1, 2, 1).fit(&data).unwrap());
    assert_snapshot!("held", OutputError::new(2, 2, 1).hold("f1", -1.5).fit(&data).unwrap());
    assert_snapshot!("two_by_two", Arx::with_orders(ArxOrders::uniform(2, 2, 1, 1, 1)).fit(&two_by_two()).unwrap());
    assert_snapshot!("long", Arx::new(12, 12, 1).fit(&data).unwrap());
}

#[test]
fn snap_state_space_and_continuous_fits() {
    assert_snapshot!("subspace", Subspace::new(2).fit(&siso()).unwrap());
    let continuous = ContinuousTransferFunction::new(0, 1).with_delay_between(&[(0.0, 1.0)]);
    assert_snapshot!("transfer_function", continuous.fit(&lag()).unwrap());
    assert_snapshot!("process", ProcessFit::named("P1D").unwrap().fit(&lag()).unwrap());
}

#[test]
fn snap_grey_box_and_frequency_fits() {
    let parameter = |name: &str, value: f64| GreyParameter::new(name, value);
    let formula = |text: &str| text.parse().unwrap();
    let structure = FormulaStructure::new(FormulaParts {
        parameters: vec![parameter("gain", 1.0), parameter("time_constant", 1.0)],
        a: vec![vec![formula("-1 / time_constant")]],
        b: vec![vec![formula("gain / time_constant")]],
        c: vec![vec![formula("1")]],
        input_delays_s: vec![formula("0.3")],
        ..Default::default()
    });
    assert_snapshot!("grey_box", GreyBox::new(structure.unwrap()).fit(&lag()).unwrap());
    let omega_rad_s: Vec<f64> = (1..60).map(|k| 0.1 * f64::from(k)).collect();
    let truth = TransferFunction::continuous(vec![5.0], vec![1.0, 0.4, 4.0]).unwrap();
    let mut random = signal::excitation::Random::new(5);
    let exact = truth.frequency_response(&omega_rad_s).unwrap().response;
    let response = exact.iter().map(|h| h + 0.01 * Complex64::new(random.normal(), random.normal())).collect();
    let data = FrequencyData { variance: vec![2e-4; 59], averages: None, shared_noise: None, omega_rad_s, response };
    let fit = FrequencyTransferFunction::continuous(0, 2).fit(&data).unwrap();
    assert_snapshot!("spectral", fit);
    assert!(fit.fit.bode().unwrap()[0].magnitude_db.iter().all(|m| m.is_finite()));
    let spring = ResponseFunction::new(&["gain", "damping"], &[4.0, 0.3], |theta: &[f64], w| {
        theta[0] / Complex64::new(4.0 - w * w, theta[1] * w)
    });
    assert_snapshot!("response_function", FrequencyGreyBox::default().fit(&spring, &data).unwrap());
}

#[test]
fn snap_systems_without_errors() {
    let pair =
        TransferFunction::continuous(vec![3.0, 1.0], vec![1.0, 0.4, 4.0, 0.0]).unwrap().with_delay(0.25).unwrap();
    assert_snapshot!("zeros_and_poles", pair.to_zero_pole_gain().unwrap());
    assert_snapshot!("continuous_ratio", pair);
    let discrete = TransferFunction::discrete(vec![0.1], vec![1.0, -0.9], 0.1).unwrap();
    assert_snapshot!("discrete_ratio", discrete.with_delay(0.2).unwrap());
    assert_snapshot!("state_space", system::arx_two_by_two().unwrap().innovations().unwrap());
}

#[test]
fn snap_comparison() {
    let data = siso();
    let (first, second) = (Arx::new(1, 1, 1).fit(&data).unwrap(), Subspace::new(2).fit(&data).unwrap());
    let other = system::arx_two_by_two().unwrap();
    let comparison = compare(&[&first, &second, &other], &data).named(&["ARX", "subspace", "wrong channels"]);
    assert_eq!(comparison.best(), Some("subspace"));
    assert_snapshot!("comparison", comparison);
}

/// The fit in the summary is that of the predictions, but for the first samples.
#[test]
fn exact_fit_of_the_summary_is_that_of_the_predictions() {
    for data in [siso(), two_by_two()] {
        let orders = ArxOrders::uniform(data.outputs(), data.inputs(), 2, 2, 1);
        let fit = Arx::with_orders(orders).fit(&data).unwrap();
        let judged = compare_with(&[&fit], &data, Some(1), &InitialState::Zero);
        let judged = judged.judgements[0].as_ref().unwrap();
        for (summary, direct) in fit.fit_percent().iter().zip(&judged.fit_percent[0]) {
            assert!((summary - direct).abs() < 0.2, "{summary} {direct}");
        }
        let squared: Vec<f64> = judged.rms_error[0].iter().map(|e| e * e).collect();
        for (summary, direct) in fit.mean_squared_errors().iter().zip(squared) {
            assert!((summary / direct - 1.0).abs() < 0.02, "{summary} {direct}");
        }
    }
}

#[test]
fn exact_charts_are_the_bands() {
    let fit = OutputError::new(2, 2, 1).fit(&siso()).unwrap();
    let bode = fit.bode().unwrap().remove(0);
    let omega: Vec<f64> = bode.freq_hz.iter().map(|f| f * std::f64::consts::TAU).collect();
    let band = fit.frequency_band(0, 0, &omega).unwrap();
    for (chart, band) in bode.magnitude_db.iter().zip(band.response.magnitude_db()) {
        assert!((chart - band).abs() < 1e-9);
    }
    let step = fit.step().unwrap().remove(0);
    assert_eq!((step.time_s[1], step.response.len()), (0.1, step.band.len()));
    let gain = fit.model.transfer_function(0, 0).unwrap().dc_gain();
    assert!((step.response.last().unwrap() / gain - 1.0).abs() < 0.05);
    assert!(step.band.iter().zip(&step.response).all(|((low, high), y)| low <= y && y <= high));
    assert_eq!(
        Arx::with_orders(ArxOrders::uniform(2, 2, 1, 1, 1)).fit(&two_by_two()).unwrap().bode().unwrap().len(),
        4
    );
}

#[test]
fn exact_datasets_of_slices() {
    let data = two_by_two();
    let record = &data.experiments()[0];
    let channels = |count: usize, of: &dyn Fn(usize) -> Vec<f64>| (0..count).map(of).collect::<Vec<_>>();
    let (u, y) = (channels(2, &|k| record.input(k).to_vec()), channels(2, &|k| record.output(k).to_vec()));
    assert_eq!(Dataset::from_channels(0.1, &[&u[0], &u[1]], &[&y[0], &y[1]]).unwrap(), data);
    let short = Dataset::from_channels(0.1, &[&u[0], &u[1][1..]], &[&y[0]]);
    assert!(matches!(short, Err(IdentError::Length { expected: 1000, found: 999, .. })));
    let series = Dataset::from_channels(0.1, &[], &[&y[0]]).unwrap();
    assert_eq!((series.inputs(), series.samples()), (0, 1000));
    #[cfg(feature = "ndarray")]
    {
        let table = |x: &Mat<f64>| ndarray::Array2::from_shape_fn((x.nrows(), x.ncols()), |(t, k)| x[(t, k)]);
        let (inputs, outputs) = (table(&record.inputs), table(&record.outputs));
        assert_eq!(Dataset::from_ndarray(0.1, inputs.view(), outputs.view()).unwrap(), data);
    }
    let _: &Mat<f64> = &record.inputs;
}

/// A fit stands wherever its model can, and says the same.
#[test]
fn exact_fit_as_a_model() {
    let data = siso();
    let fit = Arx::new(2, 2, 1).fit(&data).unwrap();
    let judged = |model: &dyn LinearModel| judge(model, &data, None, &InitialState::Zero).unwrap().fit_percent;
    assert_eq!(judged(&fit), judged(&fit.model));
}
