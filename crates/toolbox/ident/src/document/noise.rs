//! A model as its noise sees it.

use faer::Mat;
use lti::{Innovations, LtiError, PolynomialEquation, PolynomialModel, StateSpace};

use super::{AnyModel, EstimateRecord, ModelDocument};
use crate::{IdentError, Label, Parametric, StateSpaceModel};

/// The first of the numbers that stand for parameters; smaller ones are constants of the structure.
const FIRST_TAG: usize = 2;

impl ModelDocument {
    /// The same model with its noise `e` for inputs, one an output, and the measured inputs left out: the way from `e`
    /// to `y`, `C/(A D)` or `I + C (qI − A)⁻¹ K`, with the part of the covariance that belongs to it. For a time series
    /// it is all there is. `None` where the noise is white, so that `y = e`.
    ///
    /// # Errors
    /// None for a document that was checked.
    ///
    /// # Source
    /// Ljung 1999, (4.33) and (4.91).
    pub fn of_noise(&self) -> Result<Option<ModelDocument>, IdentError> {
        let (model, kept): (AnyModel, _) = match &self.model {
            AnyModel::Polynomial(model) if model.equations().iter().any(has_noise) => {
                let (model, kept) = moved(model, polynomial)?;
                (model.into(), kept)
            }
            AnyModel::StateSpace(model) if model.innovations().k().norm_max() > 0.0 => {
                let (model, kept) = moved(model, state_space)?;
                (model.into(), kept)
            }
            _ => return Ok(None),
        };
        let single = self.outputs.len() == 1;
        let name = |y: &Label| if single { "e".to_owned() } else { format!("e({})", y.name) };
        let inputs = self.outputs.iter().map(|y| Label::new(name(y), y.unit.as_str())).collect();
        let estimate = self.estimate.as_ref().map(|record| of_parameters(record, &model, &kept));
        Ok(Some(ModelDocument { inputs, model, estimate, trend: None, ..self.clone() }))
    }
}

fn has_noise(e: &PolynomialEquation) -> bool {
    !(e.c.is_empty() && e.d.is_empty() && e.a.iter().all(Vec::is_empty))
}

/// The model in its new form, and for each of its parameters the one that it was, if it was one. Numbers in place of
/// the parameters show where each goes.
fn moved<M: Parametric>(
    model: &M,
    change: impl Fn(&M) -> Result<M, LtiError>,
) -> Result<(M, Vec<Option<usize>>), LtiError> {
    let tags: Vec<f64> = (0..model.parameters().len()).map(|n| (n + FIRST_TAG) as f64).collect();
    let tagged = change(&model.with_parameters(&tags)?)?.parameters();
    Ok((change(model)?, tagged.iter().map(|tag| (*tag as usize).checked_sub(FIRST_TAG)).collect()))
}

/// `A y = C/D e` with `e` for input.
fn polynomial(model: &PolynomialModel) -> Result<PolynomialModel, LtiError> {
    let outputs = model.outputs();
    let equation = |(i, e): (usize, &PolynomialEquation)| {
        let own = |values: Vec<f64>| (0..outputs).map(|j| if i == j { values.clone() } else { Vec::new() }).collect();
        PolynomialEquation {
            a: e.a.clone(),
            b: own(std::iter::once(1.0).chain(e.c.iter().copied()).collect()),
            nk: vec![0; outputs],
            f: own(e.d.clone()),
            ..Default::default()
        }
    };
    let equations = model.equations().iter().enumerate().map(equation).collect();
    PolynomialModel::new(model.sample_time_s(), equations, model.noise_covariance().to_owned())
}

/// `A`, `K`, `C`, `I`.
fn state_space(model: &StateSpaceModel) -> Result<StateSpaceModel, LtiError> {
    let form = model.innovations();
    let system: StateSpace = form.noise_system()?;
    let (states, outputs) = (system.states(), system.outputs());
    let form = Innovations::new(system, Mat::zeros(states, outputs), form.noise_covariance().to_owned())?;
    Ok(StateSpaceModel::new(form, false, false))
}

/// The record of an estimate with the parameters that are kept; what was none before is certain.
fn of_parameters(record: &EstimateRecord, model: &AnyModel, kept: &[Option<usize>]) -> EstimateRecord {
    let covariance = |i: Option<usize>, j: Option<usize>| match (i, j) {
        (Some(i), Some(j)) => record.covariance[i][j],
        _ => 0.0,
    };
    EstimateRecord {
        parameter_names: model.parameter_names(),
        parameters: model.parameters(),
        covariance: kept.iter().map(|i| kept.iter().map(|j| covariance(*i, *j)).collect()).collect(),
        ..record.clone()
    }
}
