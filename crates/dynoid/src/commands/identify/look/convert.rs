//! `dynoid convert`: a model in another form.

use ident::uncertainty::Dynamics;
use ident::{LinearModel, ModelDocument};
use lti::{Complex64, Discretisation, LtiError, PolynomialModel, StateSpace, TransferFunction};

use super::super::model_file;
use super::super::words::significant;
use super::longest_delay_s;
use crate::cli::identify::{ConvertArguments, Representation, Sampling};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid convert` on a model file
pub(crate) fn convert(arguments: &ConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let document = model_file::read(&arguments.model)?;
    let failed = |source: LtiError| CliError::identify("the conversion", source.into());
    if arguments.to == Representation::Ss {
        check_delay(&document, arguments)?;
        let system = resampled(document.model.system().map_err(failed)?, arguments).map_err(failed)?;
        if arguments.json {
            terminal.json(&system)?;
        } else {
            print_state_space(&system, terminal);
        }
        return Ok(Outcome::Done);
    }
    let mut all = Vec::new();
    for output in 0..document.model.outputs() {
        for input in 0..document.model.inputs() {
            let h =
                channel_ratio(&document, output, input).and_then(|h| resampled_ratio(h, arguments)).map_err(failed)?;
            let name = format!("{} → {}", document.inputs[input].name, document.outputs[output].name);
            all.push((name, h));
        }
    }
    if arguments.json {
        let value = |(name, h): &(String, TransferFunction)| {
            Ok(match arguments.to {
                Representation::Zpk => {
                    serde_json::json!({"channel": name, "zpk": h.to_zero_pole_gain().map_err(failed)?})
                }
                _ => serde_json::json!({"channel": name, "tf": h}),
            })
        };
        let values = all.iter().map(value).collect::<Result<Vec<_>, CliError>>()?;
        terminal.json(&values)?;
        return Ok(Outcome::Done);
    }
    for (name, h) in &all {
        let clock = h.sample_time_s().map_or("continuous".to_owned(), |t| format!("every {t} s"));
        terminal.line(&format!("{name}, {clock}, delay {} s", significant(h.delay_s())));
        match arguments.to {
            Representation::Zpk => {
                let zpk = h.to_zero_pole_gain().map_err(failed)?;
                let list = |roots: &[Complex64]| roots.iter().map(|r| format!("{r:.6}")).collect::<Vec<_>>().join(", ");
                terminal.line(&format!("  gain  {}", significant(zpk.gain())));
                terminal.line(&format!("  zeros {}", list(zpk.zeros())));
                terminal.line(&format!("  poles {}", list(zpk.poles())));
            }
            _ => {
                let list = |p: &[f64]| p.iter().map(|v| significant(*v)).collect::<Vec<_>>().join(", ");
                terminal.line(&format!("  numerator   {}", list(h.num())));
                terminal.line(&format!("  denominator {}", list(h.den())));
            }
        }
    }
    Ok(Outcome::Done)
}

/// State space holds no delay of a continuous model; left out silently it would be another model.
fn check_delay(document: &ModelDocument, arguments: &ConvertArguments) -> Result<(), CliError> {
    let delay_s = longest_delay_s(document).map_err(|source| CliError::identify("the conversion", source))?;
    if delay_s == 0.0 {
        return Ok(());
    }
    let clock = if arguments.sample_time.is_some() { "sampled " } else { "" };
    Err(CliError::Usage {
        what: format!(
            "the model has a delay of {} s, which a {clock}state space of its poles cannot hold; use --to tf or --to zpk, which keep it",
            significant(delay_s)
        ),
    })
}

/// The way from an input to an output as a ratio with its delay.
pub(super) fn channel_ratio(
    document: &ModelDocument,
    output: usize,
    input: usize,
) -> Result<TransferFunction, LtiError> {
    match &document.model {
        ident::AnyModel::TransferFunction(m) => m.transfer_function(output, input),
        ident::AnyModel::Process(m) => m.transfer_function(output, input),
        ident::AnyModel::Polynomial(m) => polynomial_ratio(m, output, input),
        ident::AnyModel::StateSpace(m) => m.system().channel(output, input)?.to_transfer_function(),
        ident::AnyModel::GreyBox(m) => {
            m.system()?.channel(output, input)?.to_transfer_function()?.with_delay(m.input_delay_s(input))
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

fn rule(arguments: &ConvertArguments) -> Discretisation {
    match arguments.method {
        Sampling::Zoh => Discretisation::ZeroOrderHold,
        Sampling::Foh => Discretisation::FirstOrderHold,
        Sampling::Tustin => Discretisation::Tustin { prewarp_rad_s: None },
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

fn print_state_space(system: &StateSpace, terminal: &mut Terminal) {
    let clock = system.sample_time_s().map_or("continuous".to_owned(), |t| format!("every {t} s"));
    terminal.line(&clock);
    for (name, m) in [("A", system.a()), ("B", system.b()), ("C", system.c()), ("D", system.d())] {
        for i in 0..m.nrows() {
            let row: Vec<String> = (0..m.ncols()).map(|j| format!("{:>14}", significant(m[(i, j)]))).collect();
            terminal.line(&format!("{} {}", if i == 0 { name } else { " " }, row.join("")));
        }
    }
}
