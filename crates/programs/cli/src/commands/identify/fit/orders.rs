//! Orders and delays on the command line: what they are, and whether they can be.

use ident::{Dataset, ProcessFit};

use crate::cli::identify::{
    ArxArguments, FitCommand, PolynomialArguments, ProcessArguments, StateSpaceArguments, TransferFunctionArguments,
};
use crate::error::CliError;
use page::decimal::significant;

fn usage(what: impl Into<String>) -> CliError {
    CliError::Usage { what: what.into() }
}

/// Refuses orders that make no model of the channels named, before anything is read.
pub(super) fn check(command: &FitCommand) -> Result<(), CliError> {
    let inputs = command.common().data.inputs.len();
    match command {
        FitCommand::Arx(a) => check_arx(a, inputs),
        FitCommand::Armax(a) | FitCommand::Oe(a) | FitCommand::Bj(a) | FitCommand::Poly(a) => {
            check_polynomial(a, Members::of(command), inputs)
        }
        FitCommand::Tf(a) => check_transfer_function(a, inputs),
        FitCommand::Process(a) => check_process(a, inputs),
        FitCommand::Ss(a) => states(a).map(|_| ()),
        FitCommand::Greybox(_) => Ok(()),
    }
}

/// Refuses delays that are longer than the data.
pub(super) fn check_delays(command: &FitCommand, data: &Dataset) -> Result<(), CliError> {
    let samples = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0);
    let lasts_s = samples as f64 * data.sample_time_s();
    let nk = match command {
        FitCommand::Arx(a) => &a.nk,
        FitCommand::Armax(a) | FitCommand::Oe(a) | FitCommand::Bj(a) | FitCommand::Poly(a) => &a.nk,
        _ => &Vec::new(),
    };
    if let Some(nk) = nk.iter().find(|nk| **nk >= samples) {
        return Err(usage(format!(
            "--nk {nk}: the delay is in samples, and there are no more than {samples} on end; give a shorter one"
        )));
    }
    let texts = match command {
        FitCommand::Tf(a) => a.delay.as_slice(),
        FitCommand::Process(a) => a.delay.as_slice(),
        _ => &[],
    };
    for text in texts {
        if Delay::read(text)?.high_s >= lasts_s {
            let lasts = significant(lasts_s);
            return Err(usage(format!(
                "--delay {text}: the delay is in seconds, and the data last {lasts} s on end at most; give a shorter one"
            )));
        }
    }
    Ok(())
}

/// The options that make a model smaller.
pub(super) fn options(command: &FitCommand) -> &'static str {
    match command {
        FitCommand::Arx(_) => "--na, --nb or --nk",
        FitCommand::Armax(_) => "--na, --nb, --nc or --nk",
        FitCommand::Oe(_) => "--nb, --nf or --nk",
        FitCommand::Bj(_) => "--nb, --nf, --nc, --nd or --nk",
        FitCommand::Poly(_) => "--na, --nb, --nc, --nd, --nf or --nk",
        FitCommand::Tf(_) => "--zeros, --poles or the end of --delay",
        FitCommand::Process(_) => "the lags of --structure or the end of --delay",
        FitCommand::Ss(_) => "--order",
        FitCommand::Greybox(_) => "the number of free parameters",
    }
}

/// One number for all inputs, or one an input.
fn check_count<T>(option: &str, values: &[T], inputs: usize) -> Result<(), CliError> {
    match values.len() {
        0 | 1 => Ok(()),
        count if count == inputs => Ok(()),
        count => {
            let inputs = if inputs == 1 { "1 input".to_owned() } else { format!("{inputs} inputs") };
            Err(usage(format!("{option}: {count} values for {inputs}; give one, or one an input")))
        }
    }
}

fn check_inputs(inputs: usize) -> Result<(), CliError> {
    match inputs {
        0 => Err(usage("this model needs an input; name one with --input, or model a time series with armax")),
        _ => Ok(()),
    }
}

fn check_arx(arguments: &ArxArguments, inputs: usize) -> Result<(), CliError> {
    check_count("--nb", &arguments.nb, inputs)?;
    check_count("--nk", &arguments.nk, inputs)?;
    if arguments.na == 0 && (inputs == 0 || arguments.nb.iter().all(|nb| *nb == 0)) {
        return Err(usage("--na and --nb are zero, which leaves nothing to estimate; raise one"));
    }
    Ok(())
}

/// Which polynomials a structure has, with their usual orders.
#[derive(Clone, Copy)]
pub(super) struct Members {
    a: Option<usize>,
    c: Option<usize>,
    d: Option<usize>,
    f: Option<usize>,
}

impl Members {
    pub(super) fn of(command: &FitCommand) -> Self {
        match command {
            FitCommand::Armax(_) => Members { a: Some(2), c: Some(2), d: None, f: None },
            FitCommand::Oe(_) => Members { a: None, c: None, d: None, f: Some(2) },
            FitCommand::Bj(_) => Members { a: None, c: Some(2), d: Some(2), f: Some(2) },
            _ => Members { a: Some(0), c: Some(0), d: Some(0), f: Some(0) },
        }
    }
}

pub(super) struct PolynomialOrders {
    pub(super) na: usize,
    pub(super) nb: Vec<usize>,
    pub(super) nc: usize,
    pub(super) nd: usize,
    pub(super) nf: Vec<usize>,
    pub(super) nk: Vec<usize>,
}

pub(super) fn polynomial_orders(
    arguments: &PolynomialArguments,
    members: Members,
) -> Result<PolynomialOrders, CliError> {
    let order = |name: &str, given: Option<usize>, usual: Option<usize>| match (given, usual) {
        (Some(_), None) => Err(usage(format!("--{name}: this structure has no such polynomial; `fit poly` has all"))),
        (given, usual) => Ok(given.or(usual).unwrap_or(0)),
    };
    order("nf", arguments.nf.first().copied(), members.f)?;
    let list = |values: &[usize], usual: usize| if values.is_empty() { vec![usual] } else { values.to_vec() };
    Ok(PolynomialOrders {
        na: order("na", arguments.na, members.a)?,
        nb: list(&arguments.nb, 2),
        nc: order("nc", arguments.nc, members.c)?,
        nd: order("nd", arguments.nd, members.d)?,
        nf: list(&arguments.nf, members.f.unwrap_or(0)),
        nk: list(&arguments.nk, 1),
    })
}

fn check_polynomial(arguments: &PolynomialArguments, members: Members, inputs: usize) -> Result<(), CliError> {
    let orders = polynomial_orders(arguments, members)?;
    for (option, values) in [("--nb", &orders.nb), ("--nf", &orders.nf), ("--nk", &orders.nk)] {
        check_count(option, values, inputs)?;
    }
    if inputs > 0 && orders.nb.contains(&0) {
        return Err(usage("--nb 0 lets an input have no effect; raise it, or leave the input out"));
    }
    if inputs == 0 && orders.na + orders.nc + orders.nd == 0 {
        return check_inputs(inputs);
    }
    Ok(())
}

fn check_transfer_function(arguments: &TransferFunctionArguments, inputs: usize) -> Result<(), CliError> {
    check_inputs(inputs)?;
    check_count("--zeros", &arguments.zeros, inputs)?;
    check_count("--poles", &arguments.poles, inputs)?;
    check_count("--delay", &arguments.delay, inputs)?;
    delays(&arguments.delay)?;
    let of = |values: &[usize], k: usize| values.get(k).or(values.first()).copied().unwrap_or(0);
    match (0..inputs).find(|k| of(&arguments.zeros, *k) > of(&arguments.poles, *k)) {
        Some(k) => {
            let (zeros, poles) = (of(&arguments.zeros, k), of(&arguments.poles, k));
            Err(usage(format!("--zeros {zeros} is more than --poles {poles}; no physical system has that")))
        }
        None => Ok(()),
    }
}

fn check_process(arguments: &ProcessArguments, inputs: usize) -> Result<(), CliError> {
    check_inputs(inputs)?;
    arguments.delay.as_deref().map_or(Ok(()), |text| Delay::read(text).map(|_| ()))?;
    let wrong = |reason| usage(format!("--structure {}: {reason}", arguments.structure));
    arguments.hold.iter().try_for_each(|text| held(text).map(|_| ()))?;
    arguments.bound.iter().try_for_each(|text| bounded(text).map(|_| ()))?;
    ProcessFit::named(&arguments.structure).map(|_| ()).map_err(wrong)
}

/// A parameter that is held, and its value.
pub(super) fn held(text: &str) -> Result<(&str, f64), CliError> {
    let parts = text.split_once('=').map(|(name, value)| (name.trim(), value.trim().parse::<f64>()));
    match parts {
        Some((name, Ok(value))) if value.is_finite() && !name.is_empty() => Ok((name, value)),
        _ => Err(usage(format!("--hold {text}: give a parameter and a number, such as K=2"))),
    }
}

/// A parameter with bounds, and these.
pub(super) fn bounded(text: &str) -> Result<(&str, (f64, f64)), CliError> {
    let parts = text.split_once('=').and_then(|(name, range)| Some((name.trim(), range.split_once(':')?)));
    let number = |text: &str| text.trim().parse::<f64>().ok();
    match parts.and_then(|(name, (low, high))| Some((name, number(low)?, number(high)?))) {
        Some((name, low, high)) if low <= high && !name.is_empty() => Ok((name, (low, high))),
        _ => Err(usage(format!(
            "--bound {text}: give a parameter and a range, the lower number first, such as Tp1=0.1:2"
        ))),
    }
}

/// The number of states; none where it is to be found.
pub(super) fn states(arguments: &StateSpaceArguments) -> Result<Option<usize>, CliError> {
    match arguments.order.parse::<usize>() {
        Ok(order) if order > 0 => Ok(Some(order)),
        Err(_) if arguments.order == "auto" => Ok(None),
        _ => Err(usage(format!("--order {}: give a number of states from 1 on, or auto", arguments.order))),
    }
}

/// A delay, or a range of delays.
pub(super) struct Delay {
    pub(super) low_s: f64,
    pub(super) high_s: f64,
}

impl Delay {
    pub(super) fn read(text: &str) -> Result<Delay, CliError> {
        let (low, high) = text.split_once(':').unwrap_or((text, text));
        match (low.trim().parse::<f64>(), high.trim().parse::<f64>()) {
            (Ok(low_s), Ok(high_s)) if low_s >= 0.0 && low_s <= high_s && high_s.is_finite() => {
                Ok(Delay { low_s, high_s })
            }
            _ => Err(usage(format!(
                "--delay {text}: give seconds, such as 0.01, or a range such as 0:0.05, the shorter first, none negative"
            ))),
        }
    }

    pub(super) fn is_known(&self) -> bool {
        self.low_s == self.high_s
    }
}

pub(super) fn delays(texts: &[String]) -> Result<Vec<Delay>, CliError> {
    texts.iter().map(|text| Delay::read(text)).collect()
}
