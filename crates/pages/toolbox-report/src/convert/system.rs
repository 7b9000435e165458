//! State spaces, and what belongs to them.

use faer::Mat;
use ident::uncertainty::Dynamics;
use ident::{
    AnyModel, Formula, FormulaParts, FormulaStructure, GreyBoxModel, IdentError, Intersample, LinearModel,
    ModelDocument, StateSpaceModel,
};
use lti::{Discretisation, Innovations, LtiError, PolynomialModel, StateSpace};
use page::decimal::significant;
use page::{Block, Blocks};

use super::clock::{Conversion, clock_words, noise_covariance, resampled};
use super::error::ConvertError;
use super::ratio::{discrete_model, ratios};
use crate::blocks::line;

/// A state space with what belongs to it.
pub(super) struct System {
    pub(super) system: StateSpace,
    /// Delay of each input, in seconds; empty where the states hold it.
    input_delays_s: Vec<f64>,
    /// The predictor's gain, where the noise model is still the source's.
    gain: Option<Mat<f64>>,
}

/// The state space that is asked for.
pub(super) fn system(source: &ModelDocument, asked: &Conversion) -> Result<System, ConvertError> {
    let own = source.model.system()?;
    let stays = asked.keeps_clock();
    if own.sample_time_s().is_some() && stays {
        let form = source.model.innovations(source.sample_time_s, source.intersample)?;
        let gain = Some(form.k().to_owned());
        return Ok(System { system: form.system().clone(), input_delays_s: Vec::new(), gain });
    }
    if let AnyModel::Polynomial(model) = &source.model {
        return polynomial_system(model, asked);
    }
    let (inputs, outputs) = (own.inputs(), own.outputs());
    let ways = (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input)));
    let delays_s = ways.map(|(o, i)| source.model.delay_s(o, i)).collect::<Result<Vec<f64>, _>>()?;
    let system = match asked.sample_time_s {
        _ if delays_s.iter().all(|d| *d == 0.0) => resampled(own, asked)?,
        Some(sample_time_s) => sampled_with_delays(source, asked, sample_time_s)?,
        None => return beside_delays(own, &delays_s),
    };
    Ok(System { system, input_delays_s: Vec::new(), gain: None })
}

/// A polynomial model continuous, or on another clock: with delays, which have no continuous counterpart as states,
/// beside it.
fn polynomial_system(model: &PolynomialModel, asked: &Conversion) -> Result<System, ConvertError> {
    let as_states = |system| System { system, input_delays_s: Vec::new(), gain: None };
    let whole = resampled(without_noise(model, usize::MAX)?, asked);
    // One sample of each delay is that of the hold.
    let samples = model.equations().iter().flat_map(|e| &e.nk).map(|nk| nk.saturating_sub(1));
    let delays_s: Vec<f64> = samples.map(|samples| samples as f64 * model.sample_time_s()).collect();
    // A clock of which the new one is a multiple keeps the delays as states.
    if delays_s.iter().all(|delay_s| *delay_s == 0.0) || (asked.sample_time_s.is_some() && whole.is_ok()) {
        return Ok(whole.map(as_states)?);
    }
    let continuous = without_noise(model, 1).and_then(|system| system.to_continuous(asked.rule));
    let beside = beside_delays(continuous?, &delays_s)?;
    let Some(sample_time_s) = asked.sample_time_s else { return Ok(beside) };
    let sampled = match asked.rule {
        Discretisation::ZeroOrderHold => {
            let delayed = beside.system.to_discrete_delayed(&beside.input_delays_s, sample_time_s);
            delayed.and_then(|delayed| delayed.to_state_space())
        }
        _ => {
            let delay_s = delays_s.iter().copied().fold(0.0, f64::max);
            Err(LtiError::FractionalDelay { delay_s, sample_time_s })
        }
    };
    Ok(sampled.map(as_states)?)
}

/// The way from the inputs, with delays of so many samples at most: states of the noise would have to have counterparts
/// too.
fn without_noise(model: &PolynomialModel, longest: usize) -> Result<StateSpace, LtiError> {
    let mut equations = model.equations().to_vec();
    for e in &mut equations {
        (e.c, e.d) = (Vec::new(), Vec::new());
        e.nk.iter_mut().for_each(|nk| *nk = longest.min(*nk));
    }
    let model = PolynomialModel::new(model.sample_time_s(), equations, model.noise_covariance().to_owned())?;
    Ok(model.innovations()?.system().clone())
}

/// A model with delays, sampled: its delays are states.
fn sampled_with_delays(source: &ModelDocument, asked: &Conversion, sample_time_s: f64) -> Result<StateSpace, LtiError> {
    let held = |intersample| Ok(source.model.innovations(sample_time_s, intersample)?.system().clone());
    match asked.rule {
        Discretisation::ZeroOrderHold => held(Intersample::ZeroOrderHold),
        Discretisation::FirstOrderHold => held(Intersample::FirstOrderHold),
        _ => {
            let all = ratios(source, asked)?;
            Ok(discrete_model(&all, source, sample_time_s)?.innovations()?.system().clone())
        }
    }
}

/// A continuous system whose inputs are delayed.
fn beside_delays(system: StateSpace, delays_s: &[f64]) -> Result<System, ConvertError> {
    let inputs = system.inputs();
    let first = &delays_s[..inputs];
    if delays_s.chunks(inputs).any(|row| row != first) {
        return Err(ConvertError::DelaysDiffer);
    }
    Ok(System { input_delays_s: first.to_vec(), system, gain: None })
}

impl System {
    pub(super) fn model(&self, source: &ModelDocument) -> Result<AnyModel, ConvertError> {
        let noise = noise_covariance(source)?;
        if self.system.sample_time_s().is_none() {
            return Ok(self.continuous_model(noise)?);
        }
        let (states, outputs) = (self.system.states(), self.system.outputs());
        let gain = self.gain.clone().unwrap_or_else(|| Mat::zeros(states, outputs));
        let (feedthrough, coloured) = (self.system.d().norm_max() > 0.0, gain.norm_max() > 0.0);
        let form = Innovations::new(self.system.clone(), gain, noise)?;
        Ok(StateSpaceModel::new(form, feedthrough, coloured).into())
    }

    /// A structure whose entries are all numbers.
    fn continuous_model(&self, noise: Mat<f64>) -> Result<AnyModel, IdentError> {
        let formula = |value: f64| value.to_string().parse::<Formula>();
        let table = |m: faer::MatRef<'_, f64>| {
            let row = |i: usize| (0..m.ncols()).map(|j| formula(m[(i, j)])).collect();
            (0..m.nrows()).map(row).collect::<Result<Vec<Vec<Formula>>, IdentError>>()
        };
        let parts = FormulaParts {
            a: table(self.system.a())?,
            b: table(self.system.b())?,
            c: table(self.system.c())?,
            d: table(self.system.d())?,
            input_delays_s: self.input_delays_s.iter().map(|d| formula(*d)).collect::<Result<_, _>>()?,
            ..FormulaParts::default()
        };
        Ok(GreyBoxModel::new(FormulaStructure::new(parts)?)?.with_noise_covariance(noise)?.into())
    }

    pub(super) fn blocks(&self, source: &ModelDocument) -> Blocks {
        let system = &self.system;
        let delays = source.inputs.iter().zip(&self.input_delays_s);
        let delays =
            delays.map(|(label, delay_s)| line(format!("delay of {} {} s", label.name, significant(*delay_s))));
        let clock = std::iter::once(line(clock_words(system.sample_time_s())));
        clock.chain(delays).chain(std::iter::once(Block::Preformatted { text: self.matrices() })).collect()
    }

    /// The matrices, a row in a line.
    fn matrices(&self) -> String {
        let system = &self.system;
        let gain = self.gain.as_ref().filter(|k| k.norm_max() > 0.0).map(|k| ("K", k.as_ref()));
        let own = [("A", system.a()), ("B", system.b()), ("C", system.c()), ("D", system.d())];
        let mut lines = Vec::new();
        for (name, m) in own.into_iter().chain(gain).filter(|(_, m)| m.ncols() > 0) {
            for i in 0..m.nrows() {
                let row: String = (0..m.ncols()).map(|j| format!("{:>14}", significant(m[(i, j)]))).collect();
                lines.push(format!("{} {row}", if i == 0 { name } else { " " }));
            }
        }
        lines.join("\n")
    }
}
