//! `dynoid fit …`: a model from recordings, with its uncertainty and its judgement.

use ident::prediction::InitialState;
use ident::validate::{Judgement, ResidualReport, ResidualTest, judge};
use ident::{
    AnyModel, Arx, ArxOrders, ContinuousTransferFunction, Criteria, Dataset, EstimateRecord, Fit, Focus, IdentError,
    Iv4, ModelDocument, Parametric, Polynomial, ProcessFit, StateSpacePem, Subspace, Weighting,
};
use serde::Serialize;
use signal::Sos;

use super::data::{Loaded, check_targets, draw, load, load_files};
use super::words::significant;
use super::{figures, greybox, look, model_file, words};
use crate::cli::identify::{
    ArxArguments, FitArguments, FitCommand, Initial, PolynomialArguments, ProcessArguments, StateSpaceArguments,
    SubspaceWeighting, TransferFunctionArguments,
};
use crate::error::{CliError, Outcome};
use crate::output::replace_file;
use crate::table::{Align, Style, Table};
use crate::terminal::Terminal;

/// Confidence of the intervals shown.
const INTERVAL: f64 = 0.95;
/// Confidence of the regions of the residual tests.
const REGION: f64 = 0.99;
/// Lags of the residual tests.
const LAGS: usize = 25;
/// Most states that `auto` may choose.
const MOST_STATES: usize = 10;

pub(crate) fn run(command: &FitCommand, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let common = command.common();
    check_fit(common)?;
    let whole = load(&common.data, terminal)?;
    let (estimation, unseen) = parts(whole, common, terminal)?;
    let wanted = method(command);
    let progress = terminal.progress(1);
    progress.say(&format!("estimating {wanted}"));
    let fit = estimate(command, &estimation.data)?;
    drop(progress);
    if let FitCommand::Greybox(arguments) = command {
        greybox::warnings(arguments, &fit.model).iter().for_each(|text| terminal.warning(text));
    }
    let document = document(&fit, fitted_method(wanted, &fit.model), &estimation);
    let verdict = Verdict::new(&fit, &estimation.data, unseen.as_ref().map(|u| &u.data))?;
    if let Some(path) = &common.out {
        let text = serde_json::to_string_pretty(&document).map_err(CliError::internal)?;
        replace_file(path, text.as_bytes())?;
    }
    if let Some(path) = &common.result.plot {
        let shown = unseen.as_ref().unwrap_or(&estimation);
        let figures = verdict.figures(&shown.data);
        let title = format!("{} → {}", document_name(&document), method_of(&document));
        replace_file(path, &draw(path, &title, &figures)?)?;
    }
    if common.result.json {
        terminal.json(&verdict.json(&document))?;
    } else if !terminal.is_quiet() {
        verdict.print(&document, common, terminal);
    }
    Ok(Outcome::Done)
}

/// Checks where results go before any work is done.
fn check_fit(arguments: &FitArguments) -> Result<(), CliError> {
    let targets = [&arguments.out, &arguments.result.plot];
    check_targets(&targets, &[&arguments.data.recordings, &arguments.validate])?;
    match &arguments.out {
        Some(path)
            if crate::input::ending(path).map(str::to_lowercase).as_deref() != Some("json") && !is_device(path) =>
        {
            Err(CliError::Usage { what: format!("{}: a model file ends in .json", path.display()) })
        }
        _ => Ok(()),
    }
}

fn is_device(path: &std::path::Path) -> bool {
    std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

/// What the estimate rests on, and what it is judged by besides.
fn parts(
    whole: Loaded,
    arguments: &FitArguments,
    terminal: &mut Terminal,
) -> Result<(Loaded, Option<Loaded>), CliError> {
    if let Some(share) = arguments.split {
        let share = model_file::checked_share("--split", share)?;
        let split = whole.data.split(share).map_err(|source| CliError::identify("splitting the data", source))?;
        let (trend, sources) = (whole.trend.clone(), whole.sources.clone());
        let unseen = Loaded { data: split.validation, trend, sources };
        return Ok((Loaded { data: split.estimation, ..whole }, Some(unseen)));
    }
    if arguments.validate.is_empty() {
        return Ok((whole, None));
    }
    let mut data = arguments.data.clone();
    // The window belongs to the recordings of the estimate, the clock to both.
    (data.from_s, data.to_s, data.sample_time_s) = (None, None, Some(whole.data.sample_time_s()));
    let unseen = load_files(&arguments.validate, &data, terminal)?;
    Ok((whole, Some(unseen)))
}

fn estimate(command: &FitCommand, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
    let failed = |source| CliError::identify("the estimate", source);
    match command {
        FitCommand::Arx(arguments) => arx(arguments, data).map_err(failed),
        FitCommand::Armax(a) => polynomial(a, Members { a: Some(2), c: Some(2), d: None, f: None }, data),
        FitCommand::Oe(a) => polynomial(a, Members { a: None, c: None, d: None, f: Some(2) }, data),
        FitCommand::Bj(a) => polynomial(a, Members { a: None, c: Some(2), d: Some(2), f: Some(2) }, data),
        FitCommand::Poly(a) => polynomial(a, Members { a: Some(0), c: Some(0), d: Some(0), f: Some(0) }, data),
        FitCommand::Tf(arguments) => transfer_function(arguments, data),
        FitCommand::Process(arguments) => process(arguments, data),
        FitCommand::Ss(arguments) => state_space(arguments, data),
        FitCommand::Greybox(arguments) => greybox::fit(arguments, data),
    }
}

fn arx(arguments: &ArxArguments, data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    let (outputs, inputs) = (data.outputs(), data.inputs());
    let per_input = |values: &[usize], what| match values {
        [one] => Ok(vec![*one; inputs]),
        several if several.len() == inputs => Ok(several.to_vec()),
        several => Err(IdentError::Length { what, expected: inputs, found: several.len() }),
    };
    let orders = ArxOrders {
        na: vec![vec![arguments.na; outputs]; outputs],
        nb: vec![per_input(&arguments.nb, "orders nb")?; outputs],
        nk: vec![per_input(&arguments.nk, "delays nk")?; outputs],
    };
    let fit = if arguments.iv { Iv4::with_orders(orders).fit(data) } else { Arx::with_orders(orders).fit(data) };
    Ok(fit?.map(AnyModel::from))
}

/// Which polynomials a structure has, with their usual orders.
struct Members {
    a: Option<usize>,
    c: Option<usize>,
    d: Option<usize>,
    f: Option<usize>,
}

fn polynomial(arguments: &PolynomialArguments, members: Members, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
    let order = |name: &str, given: Option<usize>, usual: Option<usize>| match (given, usual) {
        (Some(_), None) => Err(CliError::Usage {
            what: format!("--{name}: this structure has no such polynomial; `fit poly` has all"),
        }),
        (given, usual) => Ok(given.or(usual).unwrap_or(0)),
    };
    let given_f = arguments.nf.first().copied();
    order("nf", given_f, members.f)?;
    let list = |values: &[usize], usual: usize| if values.is_empty() { vec![usual] } else { values.to_vec() };
    let mut options = Polynomial::new(
        order("na", arguments.na, members.a)?,
        list(&arguments.nb, 2),
        order("nc", arguments.nc, members.c)?,
        order("nd", arguments.nd, members.d)?,
        list(&arguments.nf, members.f.unwrap_or(0)),
        list(&arguments.nk, 1),
    );
    if matches!(arguments.initial, Initial::Zero) {
        options = options.from_rest();
    }
    if arguments.simulation {
        options = options.with_focus(Focus::Simulation);
    }
    if let Some(band) = band(arguments, data)? {
        options = options.with_prefilter(band);
    }
    options.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(|source| CliError::identify("the estimate", source))
}

fn band(arguments: &PolynomialArguments, data: &Dataset) -> Result<Option<Sos>, CliError> {
    match arguments.band[..] {
        [] => Ok(None),
        [low_hz, high_hz] => Sos::butterworth_bandpass(4, low_hz, high_hz, data.sample_time_s())
            .map(Some)
            .map_err(|source| CliError::Usage { what: format!("--band: {source}") }),
        _ => Err(CliError::Usage { what: "--band: give two frequencies in Hz, such as 0.5,20".into() }),
    }
}

fn transfer_function(arguments: &TransferFunctionArguments, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
    let mut options = ContinuousTransferFunction::per_input(arguments.zeros.clone(), arguments.poles.clone());
    if !arguments.delay.is_empty() {
        let ranges: Vec<Delay> = arguments.delay.iter().map(|text| delay(text)).collect::<Result<_, _>>()?;
        let fixed: Vec<f64> =
            ranges.iter().filter_map(|r| if r.low_s == r.high_s { Some(r.low_s) } else { None }).collect();
        options = match fixed.len() == ranges.len() {
            true => options.with_delay(&fixed),
            false => options.with_delay_between(&ranges.iter().map(|r| (r.low_s, r.high_s)).collect::<Vec<_>>()),
        };
    }
    options.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(|source| CliError::identify("the estimate", source))
}

fn process(arguments: &ProcessArguments, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
    let failed = |source| CliError::identify("the estimate", source);
    let mut options = ProcessFit::named(&arguments.structure).map_err(failed)?;
    if let Some(text) = &arguments.delay {
        let range = delay(text)?;
        options = options.with_delay_between(&[(range.low_s, range.high_s)]);
    }
    options.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed)
}

/// A delay, or a range of delays.
struct Delay {
    low_s: f64,
    high_s: f64,
}

fn delay(text: &str) -> Result<Delay, CliError> {
    let (low, high) = text.split_once(':').unwrap_or((text, text));
    match (low.trim().parse(), high.trim().parse()) {
        (Ok(low_s), Ok(high_s)) => Ok(Delay { low_s, high_s }),
        _ => Err(CliError::Usage {
            what: format!("--delay {text}: give seconds, such as 0.01, or a range such as 0:0.05"),
        }),
    }
}

fn state_space(arguments: &StateSpaceArguments, data: &Dataset) -> Result<Fit<AnyModel>, CliError> {
    let failed = |source| CliError::identify("the estimate", source);
    let mut subspace = match arguments.order.parse::<usize>() {
        Ok(order) => Subspace::new(order),
        Err(_) if arguments.order == "auto" => Subspace::auto(MOST_STATES),
        Err(_) => {
            let what = format!("--order {}: give a number of states, or auto", arguments.order);
            return Err(CliError::Usage { what });
        }
    };
    subspace = subspace.with_weighting(match arguments.weighting {
        SubspaceWeighting::Cva => Weighting::Cva,
        SubspaceWeighting::N4sid => Weighting::N4sid,
        SubspaceWeighting::Moesp => Weighting::Moesp,
    });
    if arguments.feedthrough {
        subspace = subspace.with_feedthrough();
    }
    if arguments.simulation {
        subspace = subspace.without_noise_model();
    }
    let start = subspace.fit(data).map_err(failed)?;
    if arguments.subspace {
        return Ok(start.map(AnyModel::from));
    }
    let mut search = StateSpacePem::from_model(start.model);
    if arguments.simulation {
        search = search.with_focus(Focus::Simulation);
    }
    search.fit(data).map(|fit| fit.map(AnyModel::from)).map_err(failed)
}

/// The method and its orders, as a person would write it.
fn method(command: &FitCommand) -> String {
    let list = |values: &[usize]| values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let polynomial = |name: &str, a: &PolynomialArguments| {
        let mut text = name.to_owned();
        let single = [("na", a.na), ("nc", a.nc), ("nd", a.nd)];
        single.iter().filter_map(|(n, v)| v.map(|v| format!(" {n} {v}"))).for_each(|part| text.push_str(&part));
        let several = [("nb", &a.nb), ("nf", &a.nf), ("nk", &a.nk)];
        several.iter().filter(|(_, v)| !v.is_empty()).for_each(|(n, v)| text.push_str(&format!(" {n} {}", list(v))));
        text
    };
    match command {
        FitCommand::Arx(a) => {
            let name = if a.iv { "ARX by instrumental variables" } else { "ARX" };
            format!("{name} na {} nb {} nk {}", a.na, list(&a.nb), list(&a.nk))
        }
        FitCommand::Armax(a) => polynomial("ARMAX", a),
        FitCommand::Oe(a) => polynomial("output error", a),
        FitCommand::Bj(a) => polynomial("Box–Jenkins", a),
        FitCommand::Poly(a) => polynomial("polynomial", a),
        FitCommand::Tf(a) => format!("transfer function, zeros {} poles {}", list(&a.zeros), list(&a.poles)),
        FitCommand::Process(a) => format!("process model {}", a.structure),
        FitCommand::Ss(a) => {
            let how = if a.subspace { "subspace" } else { "prediction error" };
            format!("state space by {how}, order {}", a.order)
        }
        FitCommand::Greybox(a) => greybox::method(a),
    }
}

/// The method with the orders that the model came to have, the usual ones included.
fn fitted_method(wanted: String, model: &AnyModel) -> String {
    let list = |values: Vec<usize>| values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    match model {
        AnyModel::Polynomial(model) => {
            let Some(e) = model.equations().first() else { return wanted };
            let name = wanted.split(" n").next().unwrap_or(&wanted);
            let lengths = |lists: &[Vec<f64>]| list(lists.iter().map(Vec::len).collect());
            let orders = [
                ("na", lengths(&e.a)),
                ("nb", lengths(&e.b)),
                ("nc", e.c.len().to_string()),
                ("nd", e.d.len().to_string()),
                ("nf", lengths(&e.f)),
                ("nk", list(e.nk.clone())),
            ];
            let is_there = |text: &str| text.split(' ').any(|n| n != "0" && !n.is_empty());
            let orders = orders.iter().filter(|(name, text)| *name == "nk" || is_there(text));
            orders.fold(name.to_owned(), |text, (name, order)| format!("{text} {name} {order}"))
        }
        AnyModel::StateSpace(model) => {
            let name = wanted.split(", order").next().unwrap_or(&wanted);
            format!("{name}, order {}", model.system().states())
        }
        _ => wanted,
    }
}

fn document(fit: &Fit<AnyModel>, method: String, data: &Loaded) -> ModelDocument {
    let (inputs, outputs) = (data.data.input_labels().to_vec(), data.data.output_labels().to_vec());
    let mut document = ModelDocument::new(fit.model.clone(), inputs, outputs, data.data.sample_time_s());
    document.intersample = data.data.intersample();
    document.trend = data.trend.clone();
    document.estimate = Some(EstimateRecord::new(fit, method, data.sources.clone()));
    document
}

fn document_name(document: &ModelDocument) -> String {
    let names = |labels: &[ident::Label]| labels.iter().map(|l| l.name.as_str()).collect::<Vec<_>>().join(", ");
    format!("{} → {}", names(&document.inputs), names(&document.outputs))
}

fn method_of(document: &ModelDocument) -> &str {
    document.estimate.as_ref().map_or("", |e| e.method.as_str())
}

/// How good the model is.
struct Verdict<'a> {
    fit: &'a Fit<AnyModel>,
    criteria: Criteria,
    judged: Vec<Judged>,
    residuals: Result<ResidualReport, IdentError>,
}

/// A judgement on one part of the data.
struct Judged {
    name: &'static str,
    predicted: Judgement,
    simulated: Judgement,
}

impl<'a> Verdict<'a> {
    fn new(fit: &'a Fit<AnyModel>, data: &Dataset, unseen: Option<&Dataset>) -> Result<Self, CliError> {
        let failed = |source| CliError::identify("the judgement", source);
        let judged = |name, data: &Dataset| {
            Ok(Judged {
                name,
                predicted: judge(&fit.model, data, Some(1), &InitialState::Estimated)?,
                simulated: judge(&fit.model, data, None, &InitialState::Estimated)?,
            })
        };
        let mut all = vec![judged("estimation", data).map_err(failed)?];
        if let Some(unseen) = unseen {
            all.push(judged("unseen", unseen).map_err(failed)?);
        }
        let test = ResidualTest { lags: LAGS, level: REGION, ..ResidualTest::default() };
        Ok(Verdict {
            fit,
            criteria: Criteria::of(fit.loss, fit.free_parameters, fit.samples, data.outputs()),
            judged: all,
            residuals: test.run(&fit.model, unseen.unwrap_or(data)),
        })
    }

    /// The last judgement: on unseen data where there are any.
    fn last(&self) -> Option<&Judged> {
        self.judged.last()
    }

    fn figures(&self, data: &Dataset) -> Vec<plot::Figure> {
        let mut all = Vec::new();
        if let Some(judged) = self.last() {
            let (simulated, predicted) = (&judged.simulated.response, &judged.predicted.response);
            let pair = [("simulated", simulated), ("predicted one step", predicted)];
            all.extend(figures::comparison(&pair.map(|(name, response)| figures::Shown { name, data, response })));
        }
        if let Ok(report) = &self.residuals {
            all.extend(figures::residuals(report, data, REGION));
        }
        all
    }

    fn json<'b>(&'b self, document: &'b ModelDocument) -> impl Serialize + 'b {
        let fits = |j: &Judged| {
            serde_json::json!({
                "data": j.name,
                "fit_percent_simulated": j.simulated.fit_percent,
                "fit_percent_predicted": j.predicted.fit_percent,
            })
        };
        let intervals: Vec<[f64; 2]> = self.fit.intervals(INTERVAL).into_iter().map(|(a, b)| [a, b]).collect();
        serde_json::json!({
            "model": document,
            "standard_errors": self.fit.standard_errors(),
            "intervals_95": intervals,
            "derived": greybox::derived_json(self.fit, INTERVAL),
            "criteria": self.criteria,
            "judged": self.judged.iter().map(fits).collect::<Vec<_>>(),
            "residuals": self.residuals.as_ref().ok().map(|report| words::tests_json(report, REGION)),
        })
    }

    fn print(&self, document: &ModelDocument, arguments: &FitArguments, terminal: &mut Terminal) {
        terminal.heading(&format!("{}: {}", method_of(document), document_name(document)), Style::Bold);
        terminal.line(&format!(
            "{} samples of {} s, {} experiment{}",
            self.fit.samples,
            significant(document.sample_time_s),
            arguments.data.recordings.len(),
            if arguments.data.recordings.len() == 1 { "" } else { "s" }
        ));
        terminal.gap();
        // The entries of a state-space model depend on the choice of the states; its poles and zeros do not.
        let shown = matches!(self.fit.model, AnyModel::StateSpace(_))
            && look::print_roots(document, INTERVAL, terminal).is_ok();
        if !shown {
            terminal.table(&self.parameters());
        }
        terminal.gap();
        greybox::print_derived(self.fit, INTERVAL, terminal);
        terminal.table(&self.fits(document));
        terminal.gap();
        let c = &self.criteria;
        let numbers = [("loss", self.fit.loss), ("FPE", c.fpe), ("AIC", c.aic), ("BIC", c.bic)];
        let numbers: Vec<String> = numbers.iter().map(|(n, v)| format!("{n} {}", significant(*v))).collect();
        terminal.line(&numbers.join(", "));
        match &self.residuals {
            Ok(report) => words::print_tests(report, (&document.inputs, &document.outputs), REGION, terminal),
            Err(reason) => terminal.line(&format!("no residual test: {reason}")),
        }
        terminal.line(&format!("{} ({} iterations)", words::termination(self.fit.termination), self.fit.iterations));
        let names = self.fit.model.parameter_names();
        let coloured = self.residuals.as_ref().is_ok_and(|r| r.whiteness.iter().any(|w| !w.joint.passes(REGION)));
        if coloured {
            let text = "the residuals are not white, and the intervals rest on white ones: true errors may be several times larger; add a noise model (armax, bj, ss), or take the intervals for too narrow";
            terminal.item(("doubt:", Style::Caution), text);
        }
        for doubt in &self.fit.doubts {
            terminal.item(("doubt:", Style::Caution), &words::doubt(doubt, &names));
        }
        for path in [&arguments.out, &arguments.result.plot].into_iter().flatten() {
            terminal.line(&format!("written: {}", path.display()));
        }
    }

    fn parameters(&self) -> Table {
        let columns = [
            ("parameter", Align::Left),
            ("value", Align::Right),
            ("± (standard error)", Align::Right),
            ("95 % interval", Align::Left),
        ];
        let mut table = Table::new(&columns);
        let values = self.fit.parameters();
        let (errors, intervals) = (self.fit.standard_errors(), self.fit.intervals(INTERVAL));
        let fixed = greybox::fixed(&self.fit.model);
        for (i, name) in self.fit.model.parameter_names().iter().enumerate() {
            let (error, interval) = match fixed.contains(&i) {
                true => ("fixed".to_owned(), String::new()),
                false => (
                    significant(errors[i]),
                    format!("{} … {}", significant(intervals[i].0), significant(intervals[i].1)),
                ),
            };
            table.row([name.into(), significant(values[i]).into(), error.into(), interval.into()]);
        }
        table
    }

    fn fits(&self, document: &ModelDocument) -> Table {
        let columns = [
            ("fit on", Align::Left),
            ("output", Align::Left),
            ("simulated", Align::Right),
            ("predicted", Align::Right),
        ];
        let mut table = Table::new(&columns);
        for judged in &self.judged {
            for (simulated, predicted) in judged.simulated.fit_percent.iter().zip(&judged.predicted.fit_percent) {
                for (output, label) in document.outputs.iter().enumerate() {
                    table.row([
                        judged.name.into(),
                        label.name.as_str().into(),
                        words::percent(simulated[output]).into(),
                        words::percent(predicted[output]).into(),
                    ]);
                }
            }
        }
        table
    }
}
