//! The estimators, as the command line asks for them.

use dynoid::linear::{Method, Search};
use ident::{
    Arx, ArxOrders, ContinuousTransferFunction, Dataset, Focus, FormulaStructure, Iv4, Polynomial, ProcessFit,
    Subspace, TransferFunctionMethod, Weighting,
};
use signal::Sos;

use super::greybox;
use super::orders::{Delay, Members, bounded, delays, held, polynomial_orders, states};
use crate::cli::identify::{
    ArxArguments, FitCommand, Initial, PolynomialArguments, ProcessArguments, StateSpaceArguments, SubspaceWeighting,
    TransferFunctionArguments, TransferFunctionBy,
};
use crate::error::CliError;
use page::decimal::digits;

/// Most states that `auto` may choose.
const MOST_STATES: usize = 10;

/// The estimator that a command asks for, for these data.
pub(super) fn method(
    command: &FitCommand,
    structure: Option<FormulaStructure>,
    data: &Dataset,
) -> Result<Method, CliError> {
    Ok(match (command, structure) {
        (FitCommand::Greybox(arguments), Some(structure)) => {
            Method::GreyBox(Box::new(greybox::estimator(arguments, structure)))
        }
        (FitCommand::Greybox(_), None) => return Err(CliError::internal("a grey box without a structure")),
        (FitCommand::Arx(arguments), _) => arx(arguments, data),
        (FitCommand::Tf(arguments), _) => Method::TransferFunction(Box::new(transfer_function(arguments)?)),
        (FitCommand::Process(arguments), _) => Method::Process(Box::new(process(arguments)?)),
        (FitCommand::Ss(arguments), _) => state_space(arguments)?,
        (FitCommand::Armax(a) | FitCommand::Oe(a) | FitCommand::Bj(a) | FitCommand::Poly(a), _) => {
            Method::Polynomial(Box::new(polynomial(a, Members::of(command), data)?))
        }
    })
}

fn arx(arguments: &ArxArguments, data: &Dataset) -> Method {
    let (outputs, inputs) = (data.outputs(), data.inputs());
    let each = |values: &[usize]| if let [one] = values { vec![*one; inputs] } else { values.to_vec() };
    let orders = ArxOrders {
        na: vec![vec![arguments.na; outputs]; outputs],
        nb: vec![each(&arguments.nb); outputs],
        nk: vec![each(&arguments.nk); outputs],
    };
    match arguments.iv {
        true => Method::InstrumentalVariables(Iv4::with_orders(orders)),
        false => Method::Arx(Arx::with_orders(orders)),
    }
}

fn polynomial(arguments: &PolynomialArguments, members: Members, data: &Dataset) -> Result<Polynomial, CliError> {
    let o = polynomial_orders(arguments, members)?;
    let mut options = Polynomial::new(o.na, o.nb, o.nc, o.nd, o.nf, o.nk);
    if matches!(arguments.initial, Initial::Zero) {
        options = options.from_rest();
    }
    if arguments.simulation {
        options = options.with_focus(Focus::Simulation);
    }
    if let Some(band) = band(arguments, data)? {
        options = options.with_prefilter(band);
    }
    Ok(options)
}

fn band(arguments: &PolynomialArguments, data: &Dataset) -> Result<Option<Sos>, CliError> {
    match arguments.band[..] {
        [] => Ok(None),
        [low_hz, high_hz] if low_hz <= 0.0 || low_hz >= high_hz => Err(CliError::Usage {
            what: format!(
                "--band {low_hz},{high_hz}: give the lower edge first, above 0 Hz; to let all low frequencies pass too, make \
                 it small, such as {}",
                digits(0.1 / (data.samples() as f64 * data.sample_time_s()), 2)
            ),
        }),
        [low_hz, high_hz] => Sos::butterworth_bandpass(4, low_hz, high_hz, data.sample_time_s())
            .map(Some)
            .map_err(|source| CliError::Usage { what: format!("--band: {source}") }),
        _ => Err(CliError::Usage { what: "--band: give two frequencies in Hz, such as 0.5,20".into() }),
    }
}

fn transfer_function(arguments: &TransferFunctionArguments) -> Result<ContinuousTransferFunction, CliError> {
    let mut options = ContinuousTransferFunction::per_input(arguments.zeros.clone(), arguments.poles.clone())
        .with_integrators(arguments.integrators);
    options = match arguments.method {
        TransferFunctionBy::Oe => options,
        TransferFunctionBy::Srivc => options.by(TransferFunctionMethod::InstrumentalVariables),
    };
    let has_offset = arguments.offset.is_estimated(arguments.fit.data.detrend);
    options = if has_offset { options.with_offset() } else { options };
    options = if arguments.unstable { options.allow_unstable() } else { options };
    options = if arguments.initial == Initial::Zero { options.from_rest() } else { options };
    let ranges = delays(&arguments.delay)?;
    if !ranges.is_empty() {
        options = match ranges.iter().all(Delay::is_known) {
            true => options.with_delay(&ranges.iter().map(|r| r.low_s).collect::<Vec<_>>()),
            false => options.with_delay_between(&ranges.iter().map(|r| (r.low_s, r.high_s)).collect::<Vec<_>>()),
        };
    }
    Ok(options)
}

fn process(arguments: &ProcessArguments) -> Result<ProcessFit, CliError> {
    let failed = |source| CliError::identify("the estimate", source);
    let mut options = ProcessFit::named(&arguments.structure).map_err(failed)?;
    if let Some(text) = &arguments.delay {
        let range = Delay::read(text)?;
        options = options.with_delay_between(&[(range.low_s, range.high_s)]);
    }
    if arguments.offset.is_estimated(arguments.fit.data.detrend) {
        options = options.with_offset();
    }
    for text in &arguments.hold {
        let (name, value) = held(text)?;
        options = options.hold(name, value);
    }
    for text in &arguments.bound {
        let (name, (low, high)) = bounded(text)?;
        options = options.with_bounds(name, low, high);
    }
    Ok(options)
}

fn state_space(arguments: &StateSpaceArguments) -> Result<Method, CliError> {
    let subspace = states(arguments)?.map_or(Subspace::auto(MOST_STATES), Subspace::new);
    let mut subspace = subspace.with_weighting(match arguments.weighting {
        SubspaceWeighting::Auto => Weighting::Automatic,
        SubspaceWeighting::Cva => Weighting::Cva,
        SubspaceWeighting::N4sid => Weighting::N4sid,
        SubspaceWeighting::Moesp => Weighting::Moesp,
        SubspaceWeighting::Ssarx => Weighting::Ssarx,
    });
    if arguments.feedthrough {
        subspace = subspace.with_feedthrough();
    }
    if arguments.simulation {
        subspace = subspace.without_noise_model().with_stability();
    }
    let search = match (arguments.subspace, arguments.simulation) {
        (true, _) => Search::None,
        (false, true) => Search::Simulation,
        (false, false) => Search::Prediction,
    };
    Ok(Method::StateSpace { subspace, search })
}
