//! Criteria and the scan of ARX orders.

use faer::Mat;
use ident::{Arx, ArxOrders, Criteria, Criterion, Dataset, IdentError, OrderScan};

use crate::arx::respond;
use crate::noise::Noise;

fn data(samples: usize, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let (u, e) = (noise.normals(samples), noise.normals(samples));
    Dataset::siso(1.0, &u, &respond(&[-1.5, 0.7], &[1.0, 0.5], 2, &u, &e)).unwrap()
}

/// The rows from `from` on.
fn tail(data: &Dataset, from: usize) -> Dataset {
    let e = &data.experiments()[0];
    Dataset::siso(1.0, &e.input(0)[from..], &e.output(0)[from..]).unwrap()
}

#[test]
fn ref_criteria_of_a_published_model() {
    // Published with the loss rounded to five digits.
    let c = Criteria::of(1.65754, 6, 300, 1);
    let pairs = [(c.fpe, 1.7252, 5e-5), (c.aic, 1015.0, 0.05), (c.aicc, 1015.3, 0.05), (c.naic, 0.5453, 5e-5)];
    for (found, published, tolerance) in pairs.into_iter().chain([(c.bic, 1037.2, 0.05)]) {
        assert!((found - published).abs() <= tolerance, "{found} for {published}");
    }
}

#[test]
fn regress_criteria_without_samples_to_spare_are_infinite() {
    let c = Criteria::of(1.0, 10, 10, 1);
    assert!(c.fpe == f64::INFINITY && c.aicc == f64::INFINITY && c.aic.is_finite());
}

#[test]
fn exact_scan_agrees_with_single_fits_on_the_same_rows() {
    let data = data(500, 1);
    let table = OrderScan::new(0..=3, 1..=3, 0..=3).run_validated(&data, &tail(&data, 100)).unwrap();
    assert_eq!(table.structures().len(), 4 * 3 * 4);
    let deepest = 5; // nk + nb − 1 at its largest
    for s in table.structures() {
        let reach = s.na.max(s.nk + s.nb - 1);
        let fit = Arx::new(s.na, s.nb, s.nk).fit(&tail(&data, deepest - reach)).unwrap();
        assert_eq!((fit.samples, s.parameters), (table.samples(), s.na + s.nb));
        assert!((fit.loss / s.loss - 1.0).abs() < 1e-10);
    }
}

#[test]
fn exact_validation_loss_is_that_of_the_prediction_errors() {
    let (first, second) = (data(300, 2), data(200, 3));
    let table = OrderScan::new(2..=2, 2..=2, 2..=2).run_validated(&first, &second).unwrap();
    let theta = Arx::new(2, 2, 2).fit(&first).unwrap().parameters();
    let (u, y) = (second.experiments()[0].input(0), second.experiments()[0].output(0));
    let error = |t: usize| y[t] + theta[0] * y[t - 1] + theta[1] * y[t - 2] - theta[2] * u[t - 2] - theta[3] * u[t - 3];
    let errors: Vec<f64> = (3..200).map(error).collect();
    let squares: f64 = errors.iter().map(|e| e * e).sum();
    let s = &table.structures()[0];
    assert!((s.validation_loss.unwrap() / (squares / 197.0) - 1.0).abs() < 1e-10);
    let predicted: Vec<f64> = (3..200).map(|t| y[t] - errors[t - 3]).collect();
    let fit = ident::validate::fit_percent(&y[3..], &predicted).unwrap();
    assert!((s.validation_fit.unwrap() - fit).abs() < 1e-9);
}

#[test]
fn exact_several_outputs_agree_with_a_single_fit() {
    let mut noise = Noise::new(4);
    let u = Mat::from_fn(300, 2, |_, _| noise.normal());
    let y = Mat::from_fn(300, 2, |t, i| u[(t.saturating_sub(1), i)] + 0.3 * noise.normal());
    let data = Dataset::new(1.0, u, y).unwrap();
    let table = OrderScan::new(1..=1, 1..=1, 1..=1).run(&data).unwrap();
    let fit = Arx::with_orders(ArxOrders::uniform(2, 2, 1, 1, 1)).fit(&data).unwrap();
    assert!((table.structures()[0].loss / fit.loss - 1.0).abs() < 1e-10);
    assert_eq!(table.structures()[0].parameters, 8);
}

#[test]
fn stat_the_true_orders_are_found() {
    let table = OrderScan::new(0..=5, 1..=5, 0..=4).run_validated(&data(20_000, 5), &data(20_000, 6)).unwrap();
    for criterion in [Criterion::Bic, Criterion::Mdl] {
        let best = table.best(criterion);
        assert_eq!((best.na, best.nb, best.nk), (2, 2, 2));
    }
    let best = table.best(Criterion::Validation);
    assert!(best.na >= 2 && best.nk <= 2 && best.nk + best.nb >= 4);
    assert!((best.validation_loss.unwrap() - 1.0).abs() < 0.05);
    assert_eq!(table.arx(table.best(Criterion::Bic)), Arx::with_orders(ArxOrders::siso(2, 2, 2)));
}

#[test]
fn stat_a_time_series_is_scanned_once_an_order() {
    let e = Noise::new(7).normals(5000);
    let y = respond(&[-1.2, 0.6], &[], 0, &e, &e);
    let series = Dataset::new(1.0, Mat::new(), Mat::from_fn(y.len(), 1, |i, _| y[i])).unwrap();
    let table = OrderScan::new(1..=6, 0..=3, 0..=3).run(&series).unwrap();
    assert_eq!(table.structures().len(), 6);
    assert_eq!(table.best(Criterion::Bic).na, 2);
}

#[test]
fn regress_what_the_data_do_not_determine_is_left_out() {
    let u = Noise::new(8).normals(200);
    let y = respond(&[-0.5], &[1.0], 1, &u, &[0.0; 200]);
    let table = OrderScan::new(1..=3, 1..=3, 1..=1).run(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
    // A common factor of A and B is free where both have one to spare.
    assert!(table.structures().iter().all(|s| s.na == 1 || s.nb == 1));
    let flat = Dataset::siso(1.0, &[0.0; 50], &[0.0; 50]).unwrap();
    let scan = OrderScan::new(1..=2, 1..=2, 1..=1);
    assert!(matches!(scan.run(&flat), Err(IdentError::RankDeficient { .. })));
    assert!(matches!(scan.run(&data(4, 9)), Err(IdentError::TooFewSamples { .. })));
    let (from, to) = (2, 1);
    assert!(matches!(OrderScan::new(from..=to, 1..=1, 1..=1).run(&flat), Err(IdentError::Structure { .. })));
}
