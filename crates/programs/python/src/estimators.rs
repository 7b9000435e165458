//! The estimators, as `dynoid.fit` calls them: its functions have the keywords and their usual values.

use std::collections::BTreeMap;

use ident::{
    AnyModel, Arx, ArxOrders, ContinuousTransferFunction, Fit as Estimate, Focus, FormulaStructure, GreyBox,
    IdentError, InitialState, Iv4, Polynomial, ProcessFit, StateSpacePem, Subspace, TransferFunctionMethod, Weighting,
};
use pyo3::prelude::*;
use signal::Sos;

use crate::dataset::{Dataset, one_of};
use crate::errors::Fault;
use crate::fit::Fit;
use crate::interrupt;

/// Most states that are chosen where no order is given.
const MOST_STATES: usize = 10;

/// One number for all inputs, or one an input.
#[derive(FromPyObject)]
pub(crate) enum PerInput {
    All(usize),
    Each(Vec<usize>),
}

impl PerInput {
    fn list(&self) -> Vec<usize> {
        match self {
            PerInput::All(one) => vec![*one],
            PerInput::Each(values) => values.clone(),
        }
    }

    pub(crate) fn spread(&self, what: &str, inputs: usize) -> Result<Vec<usize>, Fault> {
        match self {
            PerInput::All(one) => Ok(vec![*one; inputs]),
            PerInput::Each(values) if values.len() == inputs => Ok(values.clone()),
            PerInput::Each(values) => Err(Fault::argument(format!(
                "{what}: {} values for {inputs} inputs; give one number for all, or one for each",
                values.len()
            ))),
        }
    }
}

/// Estimates, with the method in words.
fn estimated(
    data: &Bound<'_, Dataset>,
    method: String,
    fit: impl FnOnce(&ident::Dataset) -> Result<Estimate<AnyModel>, IdentError> + Send,
) -> Result<Fit, Fault> {
    let own = data.get();
    let fit = interrupt::quietly(data.py(), || fit(&own.data))??;
    Ok(Fit::new(fit, method, own))
}

/// A method and its orders, as people write them.
fn written(name: &str, orders: &[(&str, &[usize])]) -> String {
    let list = |values: &[usize]| values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let shown = orders.iter().filter(|(_, values)| values.iter().any(|value| *value > 0));
    shown.fold(name.to_owned(), |text, (order, values)| format!("{text} {order} {}", list(values)))
}

fn is_at_rest(initial: &str) -> Result<bool, Fault> {
    one_of("initial", initial, &[("estimated", false), ("zero", true)])
}

fn focus_of(focus: &str) -> Result<Focus, Fault> {
    one_of("focus", focus, &[("prediction", Focus::Prediction), ("simulation", Focus::Simulation)])
}

/// ARX by least squares, or by instrumental variables.
#[pyfunction]
pub(crate) fn arx(
    data: &Bound<'_, Dataset>,
    na: usize,
    nb: PerInput,
    nk: PerInput,
    instruments: bool,
) -> Result<Fit, Fault> {
    let (inputs, outputs) = (data.get().data.inputs(), data.get().data.outputs());
    let orders = ArxOrders {
        na: vec![vec![na; outputs]; outputs],
        nb: vec![nb.spread("nb", inputs)?; outputs],
        nk: vec![nk.spread("nk", inputs)?; outputs],
    };
    let name = if instruments { "ARX by instrumental variables" } else { "ARX" };
    let method = written(name, &[("na", &[na]), ("nb", &nb.list()), ("nk", &nk.list())]);
    estimated(data, method, move |data| {
        let fit = if instruments { Iv4::with_orders(orders).fit(data) } else { Arx::with_orders(orders).fit(data) };
        Ok(fit?.map(AnyModel::from))
    })
}

/// ARMAX, output error, Box–Jenkins and what lies between, by prediction error.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the orders of all polynomials")]
pub(crate) fn polynomial(
    data: &Bound<'_, Dataset>,
    name: &str,
    na: usize,
    nb: PerInput,
    nc: usize,
    nd: usize,
    nf: PerInput,
    nk: PerInput,
    focus: &str,
    initial: &str,
    band: Option<(f64, f64)>,
    hold: BTreeMap<String, f64>,
) -> Result<Fit, Fault> {
    let lists = (nb.list(), nf.list(), nk.list());
    let orders: [(&str, &[usize]); 6] =
        [("na", &[na]), ("nb", &lists.0), ("nc", &[nc]), ("nd", &[nd]), ("nf", &lists.1), ("nk", &lists.2)];
    let method = written(name, &orders);
    let mut options = Polynomial::new(na, nb.list(), nc, nd, nf.list(), nk.list()).with_focus(focus_of(focus)?);
    if is_at_rest(initial)? {
        options = options.from_rest();
    }
    if let Some((low_hz, high_hz)) = band {
        let sample_time_s = data.get().data.sample_time_s();
        let filter = Sos::butterworth_bandpass(4, low_hz, high_hz, sample_time_s).map_err(IdentError::from)?;
        options = options.with_prefilter(filter);
    }
    for (coefficient, value) in hold {
        options = options.hold(coefficient, value);
    }
    estimated(data, method, move |data| Ok(options.fit(data)?.map(AnyModel::from)))
}

/// Continuous transfer functions.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of the method")]
pub(crate) fn transfer_function(
    data: &Bound<'_, Dataset>,
    poles: PerInput,
    zeros: PerInput,
    delay: Vec<(f64, f64)>,
    integrators: usize,
    offset: bool,
    unstable: bool,
    initial: &str,
    method: &str,
) -> Result<Fit, Fault> {
    let words = written("transfer function", &[("zeros", &zeros.list()), ("poles", &poles.list())]);
    let by = [
        ("output-error", TransferFunctionMethod::default()),
        ("instruments", TransferFunctionMethod::InstrumentalVariables),
    ];
    let by = one_of("method", method, &by)?;
    let mut options =
        ContinuousTransferFunction::per_input(zeros.list(), poles.list()).with_integrators(integrators).by(by);
    options = if offset { options.with_offset() } else { options };
    options = if unstable { options.allow_unstable() } else { options };
    options = if is_at_rest(initial)? { options.from_rest() } else { options };
    if !delay.is_empty() {
        options = match delay.iter().all(|(low_s, high_s)| low_s == high_s) {
            true => options.with_delay(&delay.iter().map(|(low_s, _)| *low_s).collect::<Vec<_>>()),
            false => options.with_delay_between(&delay),
        };
    }
    estimated(data, words, move |data| Ok(options.fit(data)?.map(AnyModel::from)))
}

/// Process models: gain, lags and delay.
#[pyfunction]
pub(crate) fn process(
    data: &Bound<'_, Dataset>,
    structure: &str,
    delay: Vec<(f64, f64)>,
    offset: bool,
    hold: BTreeMap<String, f64>,
    bounds: BTreeMap<String, (f64, f64)>,
) -> Result<Fit, Fault> {
    let mut options = ProcessFit::named(structure)?;
    options = if offset { options.with_offset() } else { options };
    options = if delay.is_empty() { options } else { options.with_delay_between(&delay) };
    for (name, value) in hold {
        options = options.hold(name, value);
    }
    for (name, (low, high)) in bounds {
        options = options.with_bounds(name, low, high);
    }
    let method = format!("process model {structure}");
    estimated(data, method, move |data| Ok(options.fit(data)?.map(AnyModel::from)))
}

/// State space by subspaces.
#[pyfunction]
pub(crate) fn subspace(
    data: &Bound<'_, Dataset>,
    order: Option<usize>,
    weighting: &str,
    feedthrough: bool,
    simulation: bool,
) -> Result<Fit, Fault> {
    let options = subspace_of(order, weighting, feedthrough, simulation)?;
    estimated(data, of_order("subspaces", order), move |data| Ok(options.fit(data)?.map(AnyModel::from)))
}

/// State space by prediction error, from a start by subspaces.
#[pyfunction]
pub(crate) fn state_space(
    data: &Bound<'_, Dataset>,
    order: Option<usize>,
    weighting: &str,
    feedthrough: bool,
    simulation: bool,
) -> Result<Fit, Fault> {
    let options = StateSpacePem::from_subspace(subspace_of(order, weighting, feedthrough, simulation)?);
    estimated(data, of_order("state space", order), move |data| Ok(options.fit(data)?.map(AnyModel::from)))
}

fn of_order(name: &str, order: Option<usize>) -> String {
    order.map_or_else(|| format!("{name}, order found"), |order| format!("{name}, order {order}"))
}

fn subspace_of(order: Option<usize>, weighting: &str, feedthrough: bool, simulation: bool) -> Result<Subspace, Fault> {
    let weightings = [
        ("auto", Weighting::Automatic),
        ("cva", Weighting::Cva),
        ("n4sid", Weighting::N4sid),
        ("moesp", Weighting::Moesp),
        ("ssarx", Weighting::Ssarx),
    ];
    let mut options = order.map_or(Subspace::auto(MOST_STATES), Subspace::new);
    options = options.with_weighting(one_of("weighting", weighting, &weightings)?);
    options = if feedthrough { options.with_feedthrough() } else { options };
    Ok(if simulation { options.without_noise_model().with_stability() } else { options })
}

/// A grey box, of the JSON of a structure of formulas.
#[pyfunction]
pub(crate) fn grey_box(data: &Bound<'_, Dataset>, structure: &str, initial: &str, starts: usize) -> Result<Fit, Fault> {
    let structure: FormulaStructure =
        serde_json::from_str(structure).map_err(|error| Fault::argument(format!("structure: {error}")))?;
    let initial = if is_at_rest(initial)? { InitialState::Zero } else { InitialState::Estimated };
    let options = GreyBox::new(structure).with_initial_state(initial).with_further_starts(starts);
    estimated(data, "grey box".to_owned(), move |data| Ok(options.fit(data)?.map(AnyModel::from)))
}
