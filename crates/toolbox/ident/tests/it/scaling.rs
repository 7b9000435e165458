//! Quantities derived from an estimate do not depend on the units of the channels.

use ident::uncertainty::{Features, UncertainRoot};
use ident::{
    AnyModel, Arx, ContinuousTransferFunction, Dataset, Fit, IdentError, OutputError, StateSpacePem, Subspace,
};

use crate::noise::Noise;
use crate::residual_levels::Estimator;

const FACTORS: [f64; 5] = [1e-15, 1e-6, 1.0, 1e7, 1e15];

/// `y = (q⁻¹ + 0.5 q⁻² )/(1 − 1.5 q⁻¹ + 0.7 q⁻²) u` with errors of a tenth on the output.
fn record() -> (Vec<f64>, Vec<f64>) {
    let mut noise = Noise::new(12);
    let (u, e) = (noise.coloured(1500, 1.0, 0.6), noise.normals(1500));
    let mut x = vec![0.0; 1500];
    for t in 2..1500 {
        x[t] = 1.5 * x[t - 1] - 0.7 * x[t - 2] + u[t - 1] + 0.5 * u[t - 2];
    }
    (u, x.iter().zip(&e).map(|(x, e)| x + 0.1 * e).collect())
}

fn estimate(estimator: Estimator, input: f64, output: f64) -> Fit<AnyModel> {
    let (u, y) = record();
    let scaled = |values: &[f64], by: f64| values.iter().map(|v| v * by).collect::<Vec<_>>();
    estimator(&Dataset::siso(0.1, &scaled(&u, input), &scaled(&y, output)).unwrap()).unwrap()
}

fn sorted(mut roots: Vec<UncertainRoot>) -> Vec<UncertainRoot> {
    roots.sort_by(|a, b| (a.value.re, a.value.im).partial_cmp(&(b.value.re, b.value.im)).unwrap());
    roots
}

/// Roots stay where they are to a hundredth of their deviation, and deviations to a hundredth of themselves.
fn compare_roots(what: &str, found: Vec<UncertainRoot>, wanted: Vec<UncertainRoot>) -> Result<(), String> {
    if found.len() != wanted.len() {
        return Err(format!("{what}: {} for {}", found.len(), wanted.len()));
    }
    for (found, wanted) in sorted(found).iter().zip(&sorted(wanted)) {
        let deviation = (wanted.covariance[0][0] + wanted.covariance[1][1]).sqrt();
        let other = (found.covariance[0][0] + found.covariance[1][1]).sqrt();
        let near = (found.value - wanted.value).norm() < 0.01 * deviation && (other / deviation - 1.0).abs() < 0.01;
        if !near || found.near_multiple != wanted.near_multiple {
            return Err(format!("{what}: {found:?} for {wanted:?}"));
        }
    }
    Ok(())
}

fn compare(found: &Fit<AnyModel>, wanted: &Fit<AnyModel>, gain: f64) -> Result<(), String> {
    compare_roots("poles", found.poles(0, 0).unwrap(), wanted.poles(0, 0).unwrap())?;
    compare_roots("zeros", found.zeros(0, 0).unwrap(), wanted.zeros(0, 0).unwrap())?;
    let interval = |fit| Features::of_fit(fit, 0, 0).dc_gain().unwrap().unwrap().interval(0.95).unwrap();
    let ((low, high), (other_low, other_high)) = (interval(found), interval(wanted));
    let width = 0.01 * (other_high - other_low);
    if (low / gain - other_low).abs() > width || (high / gain - other_high).abs() > width {
        return Err(format!("gain: {low} {high} for {other_low} {other_high} times {gain}"));
    }
    Ok(())
}

fn scales(name: &str, estimator: Estimator) {
    let wanted = estimate(estimator, 1.0, 1.0);
    let mut failures = Vec::new();
    for (input, output) in FACTORS.iter().flat_map(|u| FACTORS.iter().map(move |y| (*u, *y))) {
        let found = estimate(estimator, input, output);
        if let Err(reason) = compare(&found, &wanted, output / input) {
            failures.push(format!("{name}, u · {input:e}, y · {output:e}: {reason}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn arx(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    Arx::new(2, 2, 1).fit(data).map(|fit| fit.map(Into::into))
}

fn oe(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    OutputError::new(2, 2, 1).fit(data).map(|fit| fit.map(Into::into))
}

fn state_space(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    StateSpacePem::new(2).fit(data).map(|fit| fit.map(Into::into))
}

fn subspace(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    Subspace::new(2).fit(data).map(|fit| fit.map(Into::into))
}

fn transfer_function(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    ContinuousTransferFunction::new(1, 2).fit(data).map(|fit| fit.map(Into::into))
}

#[test]
fn prop_regions_of_equation_errors_do_not_depend_on_units() {
    scales("arx", arx);
}

#[test]
fn prop_regions_of_output_errors_do_not_depend_on_units() {
    scales("oe", oe);
}

#[test]
fn prop_regions_of_subspace_models_do_not_depend_on_units() {
    scales("subspace", subspace);
}

#[test]
fn prop_regions_of_state_space_models_do_not_depend_on_units() {
    scales("ss", state_space);
}

#[test]
fn prop_regions_of_transfer_functions_do_not_depend_on_units() {
    scales("tf", transfer_function);
}
