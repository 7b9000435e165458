//! How good a model is on the data it was fitted to, and on others.

use ident::prediction::{InitialState, Response};
use ident::uncertainty::Dynamics;
use ident::validate::{Judgement, ResidualReport, ResidualTest, TestData, fit_percent, judge};
use ident::{AnyModel, Criteria, Dataset, Doubt, Fit, IdentError, StructureError};

use super::repeated::{Repeated, repeated};
use crate::figures::{Shown, comparison};
use crate::operating_point::without_level;
use crate::residuals::{self, REGION};

/// Lags of the residual tests.
const LAGS: usize = 25;
/// Below this fit, in percent, a model explains next to nothing.
const LITTLE: f64 = 5.0;

/// From this fit on, in percent, a model explains most of an output.
const MOSTLY: f64 = 50.0;

/// How good a model is.
pub struct Verdict {
    /// Cost of the estimate by several criteria.
    pub(super) criteria: Criteria,
    /// On the data of the estimate first, and then on others where there are any.
    pub(super) judged: Vec<Judged>,
    /// On the last of these.
    pub(super) residuals: Result<ResidualReport, IdentError>,
}

/// A judgement on one part of the data.
pub(super) struct Judged {
    pub(super) name: &'static str,
    /// Names of its experiments.
    pub(super) experiments: Vec<String>,
    pub(super) predicted: Result<Judgement, IdentError>,
    pub(super) simulated: Result<Judgement, IdentError>,
    /// By the mean over periods, where inputs repeat.
    pub(super) repeated: Vec<Repeated>,
    /// True if the model is not stable, so that its simulation says nothing of it.
    pub(super) diverges: bool,
    /// Outputs whose simulation is off by a constant or a drift.
    pub(super) shifted: Vec<String>,
    /// Outputs of which the model explains next to nothing, each with whether it is the simulation alone that does.
    pub(super) little: Vec<(usize, bool)>,
}

impl Judged {
    fn new(name: &'static str, fit: &Fit<AnyModel>, data: &Dataset) -> Self {
        let diverges = fit.model.system().and_then(|system| system.growing_mode()).is_ok_and(|mode| mode.is_some());
        let simulated = judge(&fit.model, data, None, &InitialState::Estimated);
        let mut judged = Judged {
            diverges,
            little: Vec::new(),
            shifted: match &simulated {
                Ok(judged) if !diverges => without_level(data, &judged.response),
                _ => Vec::new(),
            },
            name,
            experiments: data.experiments().iter().map(|e| e.name.clone()).collect(),
            predicted: judge(&fit.model, data, Some(1), &InitialState::Estimated),
            repeated: match &simulated {
                Ok(judged) if !diverges => repeated(data, &judged.response),
                _ => Vec::new(),
            },
            simulated,
        };
        judged.little =
            (0..data.outputs()).filter_map(|output| Some((output, judged.is_little(data, output)?))).collect();
        judged
    }

    /// Of an output of which next to nothing is explained: whether it is the simulation alone that does not.
    fn is_little(&self, data: &Dataset, output: usize) -> Option<bool> {
        // Noise that does not repeat with the inputs hides no model.
        let repeats = self.repeated.len() == data.experiments().len();
        if repeats && self.repeated.iter().all(|one| one.explains(output)) {
            return None;
        }
        let is_little = |judged: &Result<Judgement, IdentError>| {
            judged.as_ref().is_ok_and(|j| whole_fit(data, &j.response, output).is_some_and(|fit| fit < LITTLE))
        };
        // What is not even predicted is not simulated either; without inputs there is nothing to simulate.
        let predicted = is_little(&self.predicted);
        (predicted || (data.inputs() > 0 && !self.diverges && is_little(&self.simulated))).then_some(!predicted)
    }
}

impl Verdict {
    /// On the data of the estimate, and on others with what they are to it.
    pub fn new(fit: &Fit<AnyModel>, data: &Dataset, unseen: Option<(&Dataset, TestData)>) -> Self {
        let estimation = Judged::new("estimation", fit, data);
        let unseen_judged = unseen.map(|(unseen, _)| Judged::new("unseen", fit, unseen));
        let (tested, which) = unseen.unwrap_or((data, TestData::Own));
        let test = ResidualTest { lags: LAGS, level: REGION, ..ResidualTest::default() };
        Verdict {
            criteria: Criteria::of(fit.loss, fit.free_parameters, fit.samples, data.outputs()),
            residuals: match is_singular(fit) {
                true => Err(StructureError::DependentErrors.into()),
                false => test.run(fit, tested, which),
            },
            judged: std::iter::once(estimation).chain(unseen_judged).collect(),
        }
    }

    /// Outputs of the estimation data of which the model explains next to nothing.
    pub fn doubts(&self) -> Vec<Doubt> {
        let own = self.judged.first().into_iter().flat_map(|own| &own.little);
        own.map(|(output, simulated)| Doubt::ExplainsLittle { output: *output, simulated: *simulated }).collect()
    }

    /// Outputs of the estimation data whose simulation is off by a constant or a drift.
    pub(super) fn shifted(&self) -> &[String] {
        self.judged.first().map_or(&[], |own| &own.shifted)
    }

    /// Outputs of unseen data of which the model explains next to nothing, each with whether it is the simulation alone
    /// that does.
    pub(super) fn little_of_unseen(&self) -> &[(usize, bool)] {
        self.judged.get(1).map_or(&[], |unseen| &unseen.little)
    }

    /// Returns true if the model explains next to nothing of an output, of the estimation data or of unseen ones.
    pub fn explains_little(&self) -> bool {
        self.judged.iter().any(|judged| !judged.little.is_empty())
    }

    /// Returns true if the prediction explains most of every output of the estimation data.
    pub(super) fn predicts(&self) -> bool {
        let predicted = self.judged.first().and_then(|own| own.predicted.as_ref().ok());
        predicted.is_some_and(|judged| judged.fit_percent.iter().flatten().all(|fit| *fit > MOSTLY))
    }

    /// Why there are no residual tests, if there are none.
    pub(super) fn no_residuals(&self) -> Option<String> {
        match self.residuals.as_ref().err()? {
            IdentError::TooFewSamples { samples, parameters } => {
                Some(format!("{samples} samples are too few for correlations up to {parameters} lags"))
            }
            other => Some(other.to_string()),
        }
    }

    /// Judgements that could not be made, and why.
    pub fn failures(&self) -> Vec<String> {
        let mut all = Vec::new();
        for judged in &self.judged {
            let both = [("simulated", &judged.simulated), ("predicted", &judged.predicted)];
            let both = both.into_iter().skip(usize::from(judged.diverges));
            for (how, reason) in both.filter_map(|(how, j)| Some((how, j.as_ref().err()?))) {
                all.push(format!("the model could not be {how} on the {} data: {reason}", judged.name));
            }
        }
        all
    }

    /// The response to the last of the data, simulated; none of a model that is not stable.
    pub fn simulated(&self) -> Option<&Response> {
        self.judged.last().filter(|judged| !judged.diverges)?.simulated.as_ref().ok().map(|judged| &judged.response)
    }

    /// The simulation, beside it the prediction where a noise model makes it another, and the residual tests.
    pub(super) fn figures(&self, data: &Dataset, has_noise_model: bool) -> Vec<page::Figure> {
        let mut all = Vec::new();
        if let Some(judged) = self.judged.last() {
            let predicted = has_noise_model.then_some(("predicted one step", &judged.predicted));
            let simulated = (!judged.diverges).then_some(("simulated", &judged.simulated));
            let pair = simulated.into_iter().chain(predicted);
            let there = pair.filter_map(|(name, judged)| Some((name, &judged.as_ref().ok()?.response)));
            let shown = there.map(|(name, response)| Shown { name, data, response });
            all.extend(comparison(&shown.collect::<Vec<_>>()));
        }
        if let Ok(report) = &self.residuals {
            all.extend(residuals::figures(report, data));
        }
        all
    }
}

/// Returns true if the outputs of an estimate depend on each other, so that their joint errors show nothing.
pub(super) fn is_singular(fit: &Fit<AnyModel>) -> bool {
    fit.doubts.iter().any(|doubt| matches!(doubt, Doubt::DependentOutputs { .. }))
}

/// The fit of an output over all experiments; none where nothing was measured.
fn whole_fit(data: &Dataset, response: &Response, output: usize) -> Option<f64> {
    let pairs = data.experiments().iter().zip(&response.outputs).flat_map(|(e, modelled)| {
        e.output(output).iter().zip(modelled.col_as_slice(output)).filter(|(y, _)| !y.is_nan())
    });
    let (measured, modelled): (Vec<f64>, Vec<f64>) = pairs.map(|(y, m)| (*y, *m)).unzip();
    fit_percent(&measured, &modelled).ok()
}
