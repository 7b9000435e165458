//! `dynoid convert` on a model file: the model in another form.

use std::f64::consts::TAU;
use std::path::PathBuf;

use faer::Mat;
use ident::uncertainty::Dynamics;
use ident::{
    AnyModel, Formula, FormulaParts, FormulaStructure, GreyBoxModel, IdentError, Intersample, LinearModel,
    ModelDocument, RationalChannel, StateSpaceModel, TransferFunctionModel,
};
use lti::{
    Complex64, Discretisation, Innovations, LtiError, PolynomialEquation, PolynomialModel, StateSpace, TransferFunction,
};

use super::data::{check_plot, check_targets};
use super::judge::{picture, written};
use super::words::{self, significant};
use super::{look, model_file};
use crate::cli::convert::{Representation, Sampling};
use crate::cli::identify::ResultArguments;
use crate::error::{CliError, Outcome};
use crate::output::replace_file;
use crate::table::{Align, Style, Table};
use crate::terminal::Terminal;

/// What is asked for.
pub(crate) struct ConvertArguments {
    /// The model file.
    pub(crate) model: PathBuf,
    /// The representation wanted.
    pub(crate) to: Representation,
    /// The clock it gets, s, if another.
    pub(crate) sample_time: Option<f64>,
    /// Makes a discrete model continuous.
    pub(crate) continuous: bool,
    /// The rule between continuous and discrete.
    pub(crate) method: Sampling,
    /// The model file to write.
    pub(crate) out: Option<PathBuf>,
    /// Where Tustin's rule is to be exact, Hz; at rest unless it is given.
    pub(crate) prewarp_hz: Option<f64>,
    /// The result as JSON or as a picture.
    pub(crate) result: ResultArguments,
}

fn failed(source: impl Into<IdentError>) -> CliError {
    let source = source.into();
    match &source {
        IdentError::Lti(LtiError::FractionalDelay { delay_s, sample_time_s }) => CliError::Usage {
            what: format!(
                "the delay of {} s is no whole number of samples of {sample_time_s} s, which this --method needs; --method zoh is exact for any delay (with --to ss foh is too), or choose a --sample-time that divides it",
                significant(*delay_s)
            ),
        },
        IdentError::Lti(LtiError::NoLogarithm { re, im }) => CliError::Usage {
            what: format!(
                "the model has a pole at {}, which no continuous model of the same order has under this --method: one at 0 is that of numerator coefficients beyond the order of the denominator, a negative one turns at half the sample rate; --method tustin gives an approximation, a fit of another order or of a continuous model (tf) avoids it",
                pair(Complex64::new(*re, *im))
            ),
        },
        _ => CliError::identify("the conversion", source),
    }
}

/// `dynoid convert` on a model file
pub(crate) fn convert(arguments: &ConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check(arguments)?;
    let source = from_noise(model_file::read(&arguments.model)?, arguments)?;
    let converted = match arguments.to {
        Representation::Ss => Converted::System(Box::new(system(&source, arguments)?)),
        Representation::Tf | Representation::Zpk => Converted::Ratios(ratios(&source, arguments).map_err(failed)?),
    };
    let document = match arguments.to {
        // No kind of model is written down by its zeros and poles.
        Representation::Zpk => None,
        _ if arguments.result.json || arguments.out.is_some() => Some(converted.document(&source)?),
        _ => None,
    };
    if arguments.result.plot.is_some() {
        let both = [("as it was", source.clone()), ("converted", converted.document(&source)?)];
        let figures = look::bode_figures(both.map(|(name, document)| (name.to_owned(), document)))?;
        picture(&arguments.result, &model_file::name(&arguments.model), || figures)?;
    }
    if let Some(document) = &document
        && let Some(lost) = lost(&source, document).map_err(failed)?
    {
        terminal.note(lost);
    }
    if let (Some(path), Some(document)) = (&arguments.out, &document) {
        let text = serde_json::to_string_pretty(document).map_err(CliError::internal)?;
        replace_file(path, text.as_bytes())?;
    }
    match document {
        Some(document) if arguments.result.json => terminal.json(&document)?,
        _ if arguments.result.json => terminal.json(&converted.zeros_and_poles(&source)?)?,
        _ if terminal.is_quiet() => {}
        _ => {
            converted.print(&source, arguments.to, terminal)?;
            [&arguments.out, &arguments.result.plot].into_iter().for_each(|path| written(path, terminal));
        }
    }
    Ok(Outcome::Done)
}

/// What of a model its new form does not hold.
fn lost(source: &ModelDocument, converted: &ModelDocument) -> Result<Option<&'static str>, IdentError> {
    let models_noise = |document: &ModelDocument| -> Result<bool, IdentError> {
        let form = document.model.innovations(document.sample_time_s, document.intersample)?;
        Ok(form.k().norm_max() > 0.0)
    };
    let loses_noise = models_noise(source)? && !models_noise(converted)?;
    Ok(match (loses_noise, source.estimate.is_some()) {
        (true, true) => Some(
            "the noise model and the covariance of the estimate are left out: the noise model is kept by --to ss on the model's own clock alone, a covariance by no other form",
        ),
        (true, false) => Some("the noise model is left out: it is kept by --to ss on the model's own clock alone"),
        (false, true) => {
            Some("the covariance of the estimate is left out: it belongs to the parameters of the old form")
        }
        (false, false) => None,
    })
}

fn check(arguments: &ConvertArguments) -> Result<(), CliError> {
    check_plot(&arguments.result, &[std::slice::from_ref(&arguments.model)])?;
    if arguments.prewarp_hz.is_some() && arguments.method != Sampling::Tustin {
        return Err(CliError::Usage { what: "--prewarp belongs to --method tustin; give both".into() });
    }
    let Some(path) = &arguments.out else { return Ok(()) };
    if arguments.to == Representation::Zpk {
        let what = "--out writes a model file, which has no form of zeros and poles; give --to tf or --to ss".into();
        return Err(CliError::Usage { what });
    }
    model_file::check_ending(path)?;
    check_targets(&[&arguments.out], &[std::slice::from_ref(&arguments.model)])
}

/// A time series has no way but the one from its noise, which a state space on its own clock holds anyway.
fn from_noise(source: ModelDocument, arguments: &ConvertArguments) -> Result<ModelDocument, CliError> {
    let keeps_clock = arguments.sample_time.is_none() && !arguments.continuous;
    if !source.inputs.is_empty() || (arguments.to == Representation::Ss && keeps_clock) {
        return Ok(source);
    }
    let white = || CliError::Usage { what: "the model is white noise alone: there is nothing to convert".into() };
    source.of_noise().map_err(failed)?.ok_or_else(white)
}

/// A model in its new form.
enum Converted {
    System(Box<System>),
    /// Every way, output by output and in each from the first input on.
    Ratios(Vec<TransferFunction>),
}

/// A state space with what stands beside it.
struct System {
    system: StateSpace,
    /// Delay of each input, in seconds; empty where the states hold it.
    input_delays_s: Vec<f64>,
    /// The predictor's gain, where the noise model is still the source's.
    gain: Option<Mat<f64>>,
}

/// The names of the ways through a model, in the order of its ratios.
fn names(document: &ModelDocument) -> Vec<String> {
    let of = |output: &ident::Label| {
        let output = output.name.clone();
        document.inputs.iter().map(move |input| format!("{} → {output}", input.name))
    };
    document.outputs.iter().flat_map(of).collect()
}

impl Converted {
    /// The model as a file holds it. Its noise is that of the source, white on the outputs unless the form keeps the
    /// noise model; an estimate it has none.
    fn document(&self, source: &ModelDocument) -> Result<ModelDocument, CliError> {
        let model = match self {
            Converted::System(system) => system.model(source)?,
            Converted::Ratios(all) => ratio_model(all, source).map_err(failed)?,
        };
        let sample_time_s = self.sample_time_s().unwrap_or(source.sample_time_s);
        let mut document = ModelDocument::new(model, source.inputs.clone(), source.outputs.clone(), sample_time_s);
        (document.intersample, document.trend) = (source.intersample, source.trend.clone());
        Ok(document)
    }

    fn sample_time_s(&self) -> Option<f64> {
        match self {
            Converted::System(system) => system.system.sample_time_s(),
            Converted::Ratios(all) => all.first().and_then(TransferFunction::sample_time_s),
        }
    }

    fn zeros_and_poles(&self, source: &ModelDocument) -> Result<Vec<serde_json::Value>, CliError> {
        let Converted::Ratios(all) = self else { return Ok(Vec::new()) };
        let value = |(name, h): (String, &TransferFunction)| {
            Ok(serde_json::json!({"channel": name, "zpk": h.to_zero_pole_gain().map_err(failed)?}))
        };
        names(source).into_iter().zip(all).map(value).collect()
    }

    fn print(&self, source: &ModelDocument, to: Representation, terminal: &mut Terminal) -> Result<(), CliError> {
        match self {
            Converted::System(system) => system.print(source, terminal),
            Converted::Ratios(all) => {
                for (name, h) in names(source).iter().zip(all) {
                    print_ratio(name, h, to, terminal)?;
                }
            }
        }
        Ok(())
    }
}

fn clock_words(sample_time_s: Option<f64>) -> String {
    sample_time_s.map_or("continuous".to_owned(), |t| format!("every {t} s"))
}

fn print_ratio(name: &str, h: &TransferFunction, to: Representation, terminal: &mut Terminal) -> Result<(), CliError> {
    let delay = if h.delay_s() > 0.0 { format!(", delay {} s", significant(h.delay_s())) } else { String::new() };
    let form = match (to, h.sample_time_s()) {
        (Representation::Zpk, Some(_)) => "in z",
        (Representation::Zpk, None) => "in s, rad/s",
        (_, Some(_)) => "in falling powers of z",
        (_, None) => "in falling powers of s",
    };
    terminal.heading(&format!("{name}, {}{delay}, {form}", clock_words(h.sample_time_s())), Style::Bold);
    if to == Representation::Zpk {
        let zpk = h.to_zero_pole_gain().map_err(failed)?;
        let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
        table.row(["gain".into(), significant(zpk.gain()).into()]);
        for (name, roots) in [("zeros", zpk.zeros()), ("poles", zpk.poles())] {
            let all: Vec<String> = roots.iter().filter(|root| root.im >= 0.0).map(|root| pair(*root)).collect();
            table.row([name.into(), if all.is_empty() { "none".to_owned() } else { all.join(", ") }.into()]);
        }
        terminal.table(&table);
        return Ok(());
    }
    // The leading coefficient of the denominator is one.
    let list = |p: &[f64]| words::coefficients(&p.iter().map(|v| v / h.den()[0]).collect::<Vec<_>>());
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    table.row(["numerator".into(), list(h.num()).into()]);
    table.row(["denominator".into(), list(h.den()).into()]);
    terminal.table(&table);
    Ok(())
}

/// A root, with its conjugate where it has one.
fn pair(root: Complex64) -> String {
    match root.im.abs() {
        0.0 => significant(root.re),
        im => format!("{} ± {}i", significant(root.re), significant(im)),
    }
}

/// The covariance of the source's innovations.
fn noise_covariance(source: &ModelDocument) -> Result<Mat<f64>, LtiError> {
    Ok(source.model.innovations(source.sample_time_s, source.intersample)?.noise_covariance().to_owned())
}

/// The state space that is asked for.
fn system(source: &ModelDocument, arguments: &ConvertArguments) -> Result<System, CliError> {
    let own = source.model.system().map_err(failed)?;
    let stays = arguments.sample_time.is_none() && !arguments.continuous;
    if own.sample_time_s().is_some() && stays {
        let form = source.model.innovations(source.sample_time_s, source.intersample).map_err(failed)?;
        let gain = Some(form.k().to_owned());
        return Ok(System { system: form.system().clone(), input_delays_s: Vec::new(), gain });
    }
    if let AnyModel::Polynomial(model) = &source.model {
        return polynomial_system(model, arguments);
    }
    let (inputs, outputs) = (own.inputs(), own.outputs());
    let ways = (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input)));
    let delays_s = ways.map(|(o, i)| source.model.delay_s(o, i)).collect::<Result<Vec<f64>, _>>().map_err(failed)?;
    let system = match arguments.sample_time {
        _ if delays_s.iter().all(|d| *d == 0.0) => resampled(own, arguments).map_err(failed)?,
        Some(sample_time_s) => sampled_with_delays(source, arguments, sample_time_s).map_err(failed)?,
        None => return beside_delays(own, &delays_s),
    };
    Ok(System { system, input_delays_s: Vec::new(), gain: None })
}

/// A polynomial model continuous, or on another clock: with delays, which have no continuous counterpart as states, beside
/// it.
fn polynomial_system(model: &PolynomialModel, arguments: &ConvertArguments) -> Result<System, CliError> {
    let as_states = |system| System { system, input_delays_s: Vec::new(), gain: None };
    let whole = resampled(without_noise(model, usize::MAX).map_err(failed)?, arguments);
    // One sample of each delay is that of the hold.
    let samples = model.equations().iter().flat_map(|e| &e.nk).map(|nk| nk.saturating_sub(1));
    let delays_s: Vec<f64> = samples.map(|samples| samples as f64 * model.sample_time_s()).collect();
    // A clock of which the new one is a multiple keeps the delays as states.
    if delays_s.iter().all(|delay_s| *delay_s == 0.0) || (arguments.sample_time.is_some() && whole.is_ok()) {
        return whole.map(as_states).map_err(failed);
    }
    let continuous = without_noise(model, 1).and_then(|system| system.to_continuous(rule(arguments)));
    let beside = beside_delays(continuous.map_err(failed)?, &delays_s)?;
    let Some(sample_time_s) = arguments.sample_time else { return Ok(beside) };
    let sampled = match rule(arguments) {
        Discretisation::ZeroOrderHold => {
            let delayed = beside.system.to_discrete_delayed(&beside.input_delays_s, sample_time_s);
            delayed.and_then(|delayed| delayed.to_state_space())
        }
        _ => {
            let delay_s = delays_s.iter().copied().fold(0.0, f64::max);
            Err(LtiError::FractionalDelay { delay_s, sample_time_s })
        }
    };
    sampled.map(as_states).map_err(failed)
}

/// The way from the inputs, with delays of so many samples at most: states of the noise would have to have counterparts too.
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
fn sampled_with_delays(
    source: &ModelDocument,
    arguments: &ConvertArguments,
    sample_time_s: f64,
) -> Result<StateSpace, LtiError> {
    let held = |intersample| Ok(source.model.innovations(sample_time_s, intersample)?.system().clone());
    match rule(arguments) {
        Discretisation::ZeroOrderHold => held(Intersample::ZeroOrderHold),
        Discretisation::FirstOrderHold => held(Intersample::FirstOrderHold),
        _ => {
            let all = ratios(source, arguments)?;
            Ok(discrete_model(&all, source, sample_time_s)?.innovations()?.system().clone())
        }
    }
}

/// A continuous system whose inputs are delayed.
fn beside_delays(system: StateSpace, delays_s: &[f64]) -> Result<System, CliError> {
    let inputs = system.inputs();
    let first = &delays_s[..inputs];
    if delays_s.chunks(inputs).any(|row| row != first) {
        let what = "the delays from one input differ from output to output, which a state space with delayed inputs cannot hold; give --to tf, or --sample-time".into();
        return Err(CliError::Usage { what });
    }
    Ok(System { input_delays_s: first.to_vec(), system, gain: None })
}

impl System {
    fn model(&self, source: &ModelDocument) -> Result<AnyModel, CliError> {
        let noise = noise_covariance(source).map_err(failed)?;
        if self.system.sample_time_s().is_none() {
            return self.continuous_model(noise).map_err(failed);
        }
        let (states, outputs) = (self.system.states(), self.system.outputs());
        let gain = self.gain.clone().unwrap_or_else(|| Mat::zeros(states, outputs));
        let (feedthrough, coloured) = (self.system.d().norm_max() > 0.0, gain.norm_max() > 0.0);
        let form = Innovations::new(self.system.clone(), gain, noise).map_err(failed)?;
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

    fn print(&self, source: &ModelDocument, terminal: &mut Terminal) {
        let system = &self.system;
        terminal.line(&clock_words(system.sample_time_s()));
        for (label, delay_s) in source.inputs.iter().zip(&self.input_delays_s) {
            terminal.line(&format!("delay of {} {} s", label.name, significant(*delay_s)));
        }
        let gain = self.gain.as_ref().filter(|k| k.norm_max() > 0.0).map(|k| ("K", k.as_ref()));
        let own = [("A", system.a()), ("B", system.b()), ("C", system.c()), ("D", system.d())];
        for (name, m) in own.into_iter().chain(gain).filter(|(_, m)| m.ncols() > 0) {
            for i in 0..m.nrows() {
                let row: Vec<String> = (0..m.ncols()).map(|j| format!("{:>14}", significant(m[(i, j)]))).collect();
                terminal.line(&format!("{} {}", if i == 0 { name } else { " " }, row.join("")));
            }
        }
    }
}

/// Every way from an input to an output on the clock that is asked for.
fn ratios(source: &ModelDocument, arguments: &ConvertArguments) -> Result<Vec<TransferFunction>, LtiError> {
    let inputs = source.inputs.len();
    let way = |n: usize| resampled_ratio(ratio(&source.model, n / inputs, n % inputs)?, arguments);
    (0..source.outputs.len() * inputs).map(way).collect()
}

/// The way from an input to an output as a ratio with its delay.
fn ratio(model: &AnyModel, output: usize, input: usize) -> Result<TransferFunction, LtiError> {
    match (model, model.polynomials(output, input)?) {
        (AnyModel::Polynomial(m), _) => polynomial_ratio(m, output, input),
        (_, Some(ratio)) => {
            TransferFunction::continuous(ratio.numerator, ratio.denominator)?.with_delay(model.delay_s(output, input)?)
        }
        (_, None) => {
            let h = model.system()?.channel(output, input)?.to_transfer_function()?;
            h.with_delay(model.delay_s(output, input)?)
        }
    }
}

/// The ratio of a polynomial model. All but one sample of the delay stand beside it, so that it has no poles at zero that
/// are but a delay; the one left is that of the hold.
fn polynomial_ratio(model: &PolynomialModel, output: usize, input: usize) -> Result<TransferFunction, LtiError> {
    let mut equations = model.equations().to_vec();
    let samples = equations.get(output).and_then(|e| e.nk.get(input)).map_or(0, |nk| nk.saturating_sub(1));
    for nk in equations.iter_mut().filter_map(|e| e.nk.get_mut(input)) {
        *nk = nk.saturating_sub(samples);
    }
    let sooner = PolynomialModel::new(model.sample_time_s(), equations, model.noise_covariance().to_owned())?;
    match sooner.transfer_function(output, input) {
        Err(LtiError::OutputsCoupled { .. }) => {
            model.innovations()?.system().channel(output, input)?.to_transfer_function()
        }
        other => other?.with_delay(samples as f64 * model.sample_time_s()),
    }
}

/// Ratios as a model.
fn ratio_model(all: &[TransferFunction], source: &ModelDocument) -> Result<AnyModel, LtiError> {
    if let Some(sample_time_s) = all.first().and_then(TransferFunction::sample_time_s) {
        return Ok(discrete_model(all, source, sample_time_s)?.into());
    }
    let channel = |h: &TransferFunction| {
        let lead = h.den()[0];
        let scaled = |p: &[f64]| p.iter().map(|v| v / lead).collect::<Vec<f64>>();
        RationalChannel::new(scaled(h.num()), scaled(&h.den()[1..]), h.delay_s())
    };
    let channels = all.iter().map(channel).collect::<Result<_, _>>()?;
    Ok(TransferFunctionModel::new(channels, source.inputs.len(), noise_covariance(source)?)?.into())
}

/// Discrete ratios as an output-error model: `B/F` with the delay in samples, the difference of the degrees and the delay
/// beside the ratio.
fn discrete_model(
    all: &[TransferFunction],
    source: &ModelDocument,
    sample_time_s: f64,
) -> Result<PolynomialModel, LtiError> {
    let (inputs, outputs) = (source.inputs.len(), source.outputs.len());
    let mut equations = vec![PolynomialEquation { a: vec![Vec::new(); outputs], ..Default::default() }; outputs];
    for (n, h) in all.iter().enumerate() {
        let (num, den) = (h.num(), h.den());
        if num.len() > den.len() {
            return Err(LtiError::Improper { numerator: num.len() - 1, denominator: den.len() - 1 });
        }
        let equation = &mut equations[n / inputs];
        equation.b.push(num.iter().map(|v| v / den[0]).collect());
        equation.f.push(den[1..].iter().map(|v| v / den[0]).collect());
        equation.nk.push(den.len() - num.len() + (h.delay_s() / sample_time_s).round() as usize);
    }
    PolynomialModel::new(sample_time_s, equations, noise_covariance(source)?)
}

fn rule(arguments: &ConvertArguments) -> Discretisation {
    match arguments.method {
        Sampling::Zoh => Discretisation::ZeroOrderHold,
        Sampling::Foh => Discretisation::FirstOrderHold,
        Sampling::Tustin => Discretisation::Tustin { prewarp_rad_s: arguments.prewarp_hz.map(|hz| TAU * hz) },
        Sampling::Impulse => Discretisation::ImpulseInvariant,
        Sampling::Matched => Discretisation::Matched,
    }
}

fn resampled(system: StateSpace, arguments: &ConvertArguments) -> Result<StateSpace, LtiError> {
    let method = rule(arguments);
    match (arguments.sample_time, system.sample_time_s()) {
        (Some(t), None) => system.to_discrete(method, t),
        (Some(t), Some(_)) => system.resampled(method, t),
        (None, Some(_)) if arguments.continuous => system.to_continuous(method),
        (None, _) => Ok(system),
    }
}

fn resampled_ratio(h: TransferFunction, arguments: &ConvertArguments) -> Result<TransferFunction, LtiError> {
    let method = rule(arguments);
    match (arguments.sample_time, h.sample_time_s()) {
        (Some(t), None) => h.to_discrete(method, t),
        (Some(t), Some(_)) => h.resampled(method, t),
        (None, Some(_)) if arguments.continuous => h.to_continuous(method),
        (None, _) => Ok(h),
    }
}
