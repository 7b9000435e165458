//! Rules for every estimator, whatever its model: [`conform`] runs the whole list.
//!
//! An estimator is given as a function from data to a fit, with a true system that its model can describe. Models are
//! compared by their impulse responses, so that the suite knows no parametrisation. Each rule returns what broke it.

use std::panic::{AssertUnwindSafe, catch_unwind};

use faer::{Mat, Side};
use ident::prediction::{InitialState, predict, residuals};
use ident::{Dataset, Experiment, Fit, IdentError, Intersample, LinearModel, Parametric};

use crate::system;

/// Length of the impulse responses that are compared.
const RESPONSE: usize = 40;

/// Samples whose weight in a loss counts as little.
const A_FEW_SAMPLES: f64 = 5.0;

/// An estimator with a system that its model can describe.
pub struct Case<'a, Estimate> {
    /// The estimator under test.
    pub fit: Estimate,
    /// The true system. Its inputs and outputs are those of the data that the estimator is given.
    pub truth: &'a dyn LinearModel,
    /// Sample time of the data, in seconds.
    pub sample_time_s: f64,
    /// Samples of a record that is long enough.
    pub samples: usize,
    /// A factor on the true noise for data that count as free of it: zero, or small where the noise model needs some.
    pub exact_noise: f64,
    /// How near the impulse response must come to the truth then, in parts of its largest value.
    pub exact_tolerance: f64,
    /// How near with the true noise.
    pub noisy_tolerance: f64,
    /// How near results must come that should be equal: a search stops before the last digit.
    pub same_tolerance: f64,
    /// True if the model is as free in one system of units as in another; not so where numbers in it are known.
    pub any_units: bool,
}

impl<'a, Estimate> Case<'a, Estimate> {
    /// A case with tolerances for an estimator that solves its problem at once.
    pub fn new(fit: Estimate, truth: &'a dyn LinearModel, sample_time_s: f64) -> Self {
        Case {
            fit,
            truth,
            sample_time_s,
            samples: 1000,
            exact_noise: 0.0,
            exact_tolerance: 1e-8,
            noisy_tolerance: 0.2,
            same_tolerance: 1e-6,
            any_units: true,
        }
    }

    /// The same case for an estimator that searches, whose noise model needs noise to be found by.
    #[must_use]
    pub fn iterative(self) -> Self {
        Case { exact_noise: 1e-7, exact_tolerance: 1e-5, same_tolerance: 1e-4, ..self }
    }

    /// The same case for a model that holds numbers in units: the truth in other units is none that it can describe.
    #[must_use]
    pub fn in_fixed_units(self) -> Self {
        Case { any_units: false, ..self }
    }
}

/// Result of a rule: nothing, or what broke it.
type Verdict = Result<(), String>;

/// Runs every rule.
///
/// # Panics
///
/// Where the estimator breaks one, with all that it breaks.
pub fn conform<M, Estimate>(case: &Case<'_, Estimate>)
where
    M: Parametric + LinearModel,
    Estimate: Fn(&Dataset) -> Result<Fit<M>, IdentError>,
{
    let broken = failures(case);
    assert!(broken.is_empty(), "the estimator breaks {} rules:\n{}", broken.len(), broken.join("\n"));
}

/// Runs every rule, and lists what broke them.
#[must_use]
pub fn failures<M, Estimate>(case: &Case<'_, Estimate>) -> Vec<String>
where
    M: Parametric + LinearModel,
    Estimate: Fn(&Dataset) -> Result<Fit<M>, IdentError>,
{
    let suite = Suite { case };
    let rules: [Rule<'_, '_, Estimate>; 12] = [
        ("recovers the truth without noise", Suite::recovers_the_truth),
        ("comes near the truth with noise", Suite::comes_near_the_truth),
        ("its loss is that of its residuals", Suite::loss_is_that_of_its_residuals),
        ("refuses short data", Suite::refuses_short_data),
        ("doubts inputs that do not excite", Suite::doubts_inputs_that_do_not_excite),
        ("doubts collinear inputs", Suite::doubts_collinear_inputs),
        ("stands missing samples or says so", Suite::stands_missing_samples),
        ("follows a change of units", Suite::follows_units),
        ("ignores where a record starts", Suite::ignores_the_start),
        ("hardly changes when a record is split", Suite::splits),
        ("its covariance is one", Suite::covariance_is_one),
        ("survives unreasonable data", Suite::survives),
    ];
    let mut broken = Vec::new();
    for (name, rule) in rules {
        match catch_unwind(AssertUnwindSafe(|| rule(&suite))) {
            Ok(Ok(())) => {}
            Ok(Err(why)) => broken.push(format!("{name}: {why}")),
            Err(_) => broken.push(format!("{name}: it panicked")),
        }
    }
    broken
}

/// Name of a rule, and the rule.
type Rule<'c, 'a, Estimate> = (&'static str, fn(&Suite<'c, 'a, Estimate>) -> Verdict);

struct Suite<'c, 'a, Estimate> {
    case: &'c Case<'a, Estimate>,
}

impl<M, Estimate> Suite<'_, '_, Estimate>
where
    M: Parametric + LinearModel,
    Estimate: Fn(&Dataset) -> Result<Fit<M>, IdentError>,
{
    fn recovers_the_truth(&self) -> Verdict {
        let fit = self.fit(&self.data(self.case.exact_noise, 1)?)?;
        near(&self.response(&fit.model)?, &self.truth()?, self.case.exact_tolerance)
    }

    fn comes_near_the_truth(&self) -> Verdict {
        let fit = self.fit(&self.data(1.0, 2)?)?;
        near(&self.response(&fit.model)?, &self.truth()?, self.case.noisy_tolerance)
    }

    /// Residuals from the fit's own initial states give its loss, and are what one-step prediction leaves. An estimator
    /// that counts fewer samples than there are may have left out the first ones, whose past it does not know; if it
    /// gives initial states all the same, these suit the first ones too, which may cost what a few samples weigh.
    fn loss_is_that_of_its_residuals(&self) -> Verdict {
        let data = self.data(1.0, 3)?;
        let fit = self.fit(&data)?;
        let initial = match fit.initial_states.is_empty() {
            true => InitialState::Estimated,
            false => InitialState::Given(fit.initial_states.clone()),
        };
        let errors = residuals(&fit.model, &data, &initial).map_err(text)?.outputs.remove(0);
        let counted = errors.subrows(errors.nrows().saturating_sub(fit.samples), fit.samples.min(errors.nrows()));
        let mean = faer::Scale(1.0 / fit.samples as f64) * (counted.transpose() * counted);
        let torn = fit.samples < errors.nrows() && !fit.initial_states.is_empty();
        let tolerance = if torn { A_FEW_SAMPLES / fit.samples as f64 } else { self.case.same_tolerance };
        let loss = mean.determinant();
        ensure((loss - fit.loss).abs() <= tolerance * loss, || format!("loss {}, residuals {loss}", fit.loss))?;
        let predicted = predict(&fit.model, &data, 1, &initial).map_err(text)?.outputs.remove(0);
        let rest = &data.experiments()[0].outputs - predicted - errors;
        ensure(rest.norm_max() == 0.0, || format!("prediction and residuals differ by {}", rest.norm_max()))
    }

    fn refuses_short_data(&self) -> Verdict {
        for samples in 0..4 {
            let data = system_data(self.case, samples, 1.0, 4)?;
            ensure((self.case.fit)(&data).is_err(), || format!("{samples} samples gave a model"))?;
        }
        Ok(())
    }

    /// Zero inputs show nothing; constant ones excite from rest at most, so that a model near the truth is no fault.
    fn doubts_inputs_that_do_not_excite(&self) -> Verdict {
        if self.case.truth.inputs() == 0 {
            return Ok(());
        }
        for level in [0.0, 1.0] {
            let inputs = Mat::full(self.case.samples, self.case.truth.inputs(), level);
            let result = (self.case.fit)(&self.data_for(inputs, 5)?);
            let Some(fit) = result.ok().filter(|fit| fit.doubts.is_empty()) else {
                continue;
            };
            let right =
                level != 0.0 && near(&self.response(&fit.model)?, &self.truth()?, self.case.noisy_tolerance).is_ok();
            ensure(right, || format!("inputs that stay at {level} left no doubt"))?;
        }
        Ok(())
    }

    /// A model near the truth is no fault: a structure may know how its inputs differ.
    fn doubts_collinear_inputs(&self) -> Verdict {
        let inputs = self.case.truth.inputs();
        if inputs < 2 {
            return Ok(());
        }
        let one = system::white(self.case.samples, 1, 6);
        let same = Mat::from_fn(self.case.samples, inputs, |t, k| (k as f64 + 1.0) * one[(t, 0)]);
        let Some(fit) = (self.case.fit)(&self.data_for(same, 6)?).ok().filter(|fit| fit.doubts.is_empty()) else {
            return Ok(());
        };
        near(&self.response(&fit.model)?, &self.truth()?, self.case.noisy_tolerance)
            .map_err(|why| format!("inputs that are multiples of each other left no doubt, and the {why}"))
    }

    fn stands_missing_samples(&self) -> Verdict {
        let data = self.data(1.0, 7)?;
        let blank = self.punched(&data, |_| false, |_| true)?;
        ensure((self.case.fit)(&blank).is_err(), || "outputs that are all missing gave a model".into())?;
        let blank = self.punched(&data, |_| true, |_| false)?;
        let refused = self.case.truth.inputs() == 0 || (self.case.fit)(&blank).is_err();
        ensure(refused, || "inputs that are all missing gave a model".into())?;
        for few in [self.punched(&data, |_| false, |t| t % 97 == 50)?, self.punched(&data, |t| t == 333, |_| false)?] {
            if let Ok(fit) = (self.case.fit)(&few) {
                near(&self.response(&fit.model)?, &self.truth()?, self.case.noisy_tolerance)
                    .map_err(|why| format!("with a few samples missing: {why}"))?;
            }
        }
        Ok(())
    }

    /// Outputs a million times, inputs a millionth: gains from inputs grow by 10¹², nothing else.
    fn follows_units(&self) -> Verdict {
        if !self.case.any_units {
            return Ok(());
        }
        let data = self.data(1.0, 8)?;
        let record = &data.experiments()[0];
        let scaled = Experiment {
            inputs: faer::Scale(1e-6) * &record.inputs,
            outputs: faer::Scale(1e6) * &record.outputs,
            ..record.clone()
        };
        let scaled = self.dataset(scaled)?;
        let gain = if self.case.truth.inputs() == 0 { 1.0 } else { 1e12 };
        let expected = faer::Scale(gain) * self.response(&self.fit(&data)?.model)?;
        near(&self.response(&self.fit(&scaled)?.model)?, &expected, self.case.same_tolerance)
    }

    fn ignores_the_start(&self) -> Verdict {
        let data = self.data(1.0, 9)?;
        let at = |start_s: f64| {
            let again = Experiment { start_s, ..data.experiments()[0].clone() };
            Ok::<_, String>(self.fit(&data.clone().with_experiment(again).map_err(text)?)?.parameters())
        };
        let (one, other) = (at(0.0)?, at(1234.5)?);
        ensure(one == other, || format!("{one:?} became {other:?}"))
    }

    fn splits(&self) -> Verdict {
        let data = self.data(1.0, 10)?;
        let record = &data.experiments()[0];
        let half = record.len() / 2;
        let part = |from: usize, rows: usize| Experiment {
            inputs: record.inputs.get(from..from + rows, ..).to_owned(),
            outputs: record.outputs.get(from..from + rows, ..).to_owned(),
            ..record.clone()
        };
        let two = self.dataset(part(0, half))?.with_experiment(part(half, record.len() - half)).map_err(text)?;
        let whole = self.response(&self.fit(&data)?.model)?;
        near(&self.response(&self.fit(&two)?.model)?, &whole, 0.25 * self.case.noisy_tolerance)
    }

    fn covariance_is_one(&self) -> Verdict {
        let fit = self.fit(&self.data(1.0, 11)?)?;
        let (p, n) = (&fit.covariance, fit.parameters().len());
        ensure(p.shape() == (n, n), || format!("{:?} for {n} parameters", p.shape()))?;
        ensure(p.norm_max().is_finite(), || "it is not finite".into())?;
        let deviations = fit.standard_errors();
        let unit = |i: usize| if deviations[i] > 0.0 { deviations[i].recip() } else { 0.0 };
        let scaled = Mat::from_fn(n, n, |i, j| unit(i) * p[(i, j)] * unit(j));
        let asymmetry = (&scaled - scaled.transpose()).norm_max();
        ensure(asymmetry < 1e-8, || format!("asymmetric by {asymmetry:e} of a correlation"))?;
        let values = scaled.self_adjoint_eigenvalues(Side::Lower).map_err(|_| "no eigenvalues".to_string())?;
        let smallest = values.first().copied().unwrap_or(0.0);
        ensure(smallest > -1e-8 && deviations.iter().any(|d| *d > 0.0), || format!("eigenvalue {smallest:e}"))
    }

    /// No panic, and no model with parameters that are not finite.
    fn survives(&self) -> Verdict {
        let (inputs, outputs) = (self.case.truth.inputs(), self.case.truth.outputs());
        let white = |columns, seed| system::white(200, columns, seed);
        let scale = |size: f64, m: Mat<f64>| faer::Scale(size) * m;
        let tables = [
            (scale(1e300, white(inputs, 12)), scale(1e300, white(outputs, 13))),
            (scale(1e-300, white(inputs, 12)), scale(1e-300, white(outputs, 13))),
            (scale(1e160, white(inputs, 12)), scale(1e-160, white(outputs, 13))),
            (white(inputs, 12), Mat::zeros(200, outputs)),
            (Mat::zeros(200, inputs), Mat::zeros(200, outputs)),
            (white(inputs, 12), Mat::full(200, outputs, 5.0)),
            (white(inputs + 1, 12), white(outputs, 13)),
            (white(inputs, 12), white(outputs + 1, 13)),
        ];
        for (number, (u, y)) in tables.into_iter().enumerate() {
            let data = Dataset::new(self.case.sample_time_s, u, y).map_err(text)?;
            if let Ok(fit) = (self.case.fit)(&data) {
                let finite = fit.parameters().iter().all(|v| v.is_finite());
                ensure(finite, || format!("table {number} gave parameters that are not finite"))?;
            }
        }
        let empty = Experiment {
            name: "empty".into(),
            start_s: 0.0,
            inputs: Mat::zeros(0, inputs),
            outputs: Mat::zeros(0, outputs),
        };
        if let Ok(fit) = (self.case.fit)(&self.data(1.0, 14)?.with_experiment(empty).map_err(text)?) {
            near(&self.response(&fit.model)?, &self.truth()?, self.case.noisy_tolerance)?;
        }
        Ok(())
    }

    fn fit(&self, data: &Dataset) -> Result<Fit<M>, String> {
        (self.case.fit)(data).map_err(text)
    }

    fn data(&self, noise: f64, seed: u64) -> Result<Dataset, String> {
        system_data(self.case, self.case.samples, noise, seed)
    }

    fn data_for(&self, inputs: Mat<f64>, seed: u64) -> Result<Dataset, String> {
        let case = self.case;
        let outputs = system::outputs(case.truth, case.sample_time_s, &inputs, 1.0, seed).map_err(text)?;
        Dataset::new(case.sample_time_s, inputs, outputs).map_err(text)
    }

    /// The data with the inputs and outputs missing at the samples chosen.
    fn punched(
        &self,
        data: &Dataset,
        input: impl Fn(usize) -> bool,
        output: impl Fn(usize) -> bool,
    ) -> Result<Dataset, String> {
        let record = &data.experiments()[0];
        let punch = |m: &Mat<f64>, at: &dyn Fn(usize) -> bool| {
            Mat::from_fn(m.nrows(), m.ncols(), |t, k| if at(t) { f64::NAN } else { m[(t, k)] })
        };
        let (inputs, outputs) = (punch(&record.inputs, &input), punch(&record.outputs, &output));
        self.dataset(Experiment { inputs, outputs, ..record.clone() })
    }

    fn dataset(&self, record: Experiment) -> Result<Dataset, String> {
        Dataset::new(self.case.sample_time_s, record.inputs, record.outputs).map_err(text)
    }

    fn truth(&self) -> Result<Mat<f64>, String> {
        impulse_responses(self.case.truth, self.case.sample_time_s)
    }

    fn response(&self, model: &M) -> Result<Mat<f64>, String> {
        impulse_responses(model, self.case.sample_time_s)
    }
}

fn system_data<Estimate>(case: &Case<'_, Estimate>, samples: usize, noise: f64, seed: u64) -> Result<Dataset, String> {
    system::data(case.truth, case.sample_time_s, samples, noise, seed).map_err(text)
}

/// The responses to a pulse on each input, samples × (inputs · outputs); without inputs, those to the noise.
fn impulse_responses<M: LinearModel + ?Sized>(model: &M, sample_time_s: f64) -> Result<Mat<f64>, String> {
    let text = |e: lti::LtiError| e.to_string();
    let form = model.innovations(sample_time_s, Intersample::ZeroOrderHold).map_err(text)?;
    let system = if model.inputs() == 0 { form.noise_system().map_err(text)? } else { form.system().clone() };
    let (inputs, outputs) = (system.inputs(), system.outputs());
    let mut all = Mat::zeros(RESPONSE, inputs * outputs);
    for k in 0..inputs {
        let pulse = Mat::from_fn(RESPONSE, inputs, |t, j| f64::from(u8::from(t == 0 && j == k)));
        let y = system.simulate(pulse.as_ref(), &vec![0.0; system.states()]).map_err(text)?;
        for i in 0..outputs {
            (0..RESPONSE).for_each(|t| all[(t, k * outputs + i)] = y[(t, i)]);
        }
    }
    Ok(all)
}

fn near(found: &Mat<f64>, expected: &Mat<f64>, tolerance: f64) -> Verdict {
    if found.shape() != expected.shape() {
        return Err(format!("the model has other channels: {:?} and {:?}", found.shape(), expected.shape()));
    }
    let distance = (found - expected).norm_max() / expected.norm_max();
    ensure(distance <= tolerance, || format!("impulse response off by {distance:.1e} of its largest value"))
}

fn ensure(holds: bool, why: impl FnOnce() -> String) -> Verdict {
    if holds { Ok(()) } else { Err(why()) }
}

fn text(error: IdentError) -> String {
    error.to_string()
}
