//! The estimators, as the command line asks for them.

use ident::{
    AnyModel, Arx, ArxOrders, ContinuousTransferFunction, Dataset, Fit, Focus, FormulaStructure, IdentError, Iv4,
    Polynomial, ProcessFit, StateSpacePem, Subspace, TransferFunctionMethod, Weighting,
};
use signal::Sos;
use work::Context;

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

fn failed(source: IdentError) -> CliError {
    CliError::identify("the estimate", source)
}

pub(super) fn estimate(
    command: &FitCommand,
    structure: Option<FormulaStructure>,
    data: &Dataset,
    context: &Context,
) -> Result<Fit<AnyModel>, CliError> {
    match (command, structure) {
        (FitCommand::Greybox(arguments), Some(structure)) => greybox::fit(arguments, structure, data),
        (FitCommand::Greybox(_), None) => Err(CliError::internal("a grey box without a structure")),
        (FitCommand::Arx(arguments), _) => arx(arguments, data).map_err(failed),
        (FitCommand::Tf(arguments), _) => transfer_function(arguments, data),
        (FitCommand::Process(arguments), _) => process(arguments, data),
        (FitCommand::Ss(arguments), _) => state_space(arguments, data, context),
        (FitCommand::Armax(a) | FitCommand::Oe(a) | FitCommand::Bj(a) | FitCommand::Poly(a), _) => {
            polynomial(a, Members::of(command), data)
        }
    }
}

fn arx(arguments: &ArxArguments, data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    let (outputs, inputs) = (data.outputs(), data.inputs());
    let each = |values: &[usize]| if let [one] = values { vec![*one; inputs] } else { values.to_vec() };
    let orders = ArxOrders {
        na: vec![vec![arguments.na; outputs]; outputs],
        nb: vec![each(&arguments.nb); outputs],
        nk: vec![each(&arguments.nk); outputs],
    };
    let fit = if arguments.iv { Iv4::with_orders(orders).fit(data) } else { Arx::with_orders(orders).fit(data) };
    Ok(fit?.map(AnyModel::from))
}

fn polynomial(arguments: &PolynomialArguments, members: Members, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
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
    options.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed)
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

fn transfer_function(arguments: &TransferFunctionArguments, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
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
    options.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed)
}

fn process(arguments: &ProcessArguments, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
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
    options.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed)
}

fn state_space(arguments: &StateSpaceArguments, data: &Dataset, context: &Context) -> Result<Fit<AnyModel>, CliError> {
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
    if arguments.subspace {
        return subspace.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed);
    }
    let start = subspace.start(data).map_err(failed)?;
    let _step = context.step(format!("searching from the subspace model of order {}", start.system().states()), 0);
    let mut search = StateSpacePem::from_model(start);
    if arguments.simulation {
        search = search.with_focus(Focus::Simulation);
    }
    search.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed)
}
