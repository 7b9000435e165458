//! Estimates as text, as tables and as JSON.

use ident::uncertainty::Dynamics;
use ident::validate::Judgement;
use ident::{AnyModel, Doubt, IdentError, LinearModel, ModelDocument, Parametric};
use page::{Align, Table, Tone};
use serde::Serialize;

use super::verdict::{Judged, is_singular};
use super::{Finished, INTERVAL, greybox};
use crate::cli::identify::FitArguments;
use crate::commands::identify::judge::REGION;
use crate::commands::identify::show;
use crate::commands::identify::words::{self, significant};
use crate::terminal::Terminal;

/// How much a reason to doubt matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Weight {
    /// The model is of no use as it is.
    Grave,
    /// The model can be used with care.
    Doubt,
    /// It is as it has to be, and should be known.
    Note,
}

impl Weight {
    fn of(doubt: &Doubt) -> Self {
        match doubt {
            Doubt::Unstable | Doubt::NotConverged | Doubt::ExplainsLittle { .. } | Doubt::DependentOutputs { .. } => {
                Weight::Grave
            }
            Doubt::RowsLeftOut { .. } | Doubt::CovarianceIsLowerBound => Weight::Note,
            _ => Weight::Doubt,
        }
    }

    fn mark(self) -> (&'static str, Tone) {
        match self {
            Weight::Grave => ("doubt:", Tone::Bad),
            Weight::Doubt => ("doubt:", Tone::Caution),
            Weight::Note => ("note:", Tone::Faint),
        }
    }
}

pub(super) fn channels(document: &ModelDocument) -> String {
    let names = |labels: &[ident::Label]| labels.iter().map(|l| l.name.as_str()).collect::<Vec<_>>().join(", ");
    let inputs = if document.inputs.is_empty() { "e".to_owned() } else { names(&document.inputs) };
    format!("{inputs} → {}", names(&document.outputs))
}

pub(super) fn method(document: &ModelDocument) -> &str {
    document.estimate.as_ref().map_or("", |e| e.method.as_str())
}

impl Finished {
    pub(super) fn json(&self) -> impl Serialize {
        let intervals: Vec<[f64; 2]> = self.fit.intervals(INTERVAL).into_iter().map(|(a, b)| [a, b]).collect();
        let residuals = &self.verdict.residuals;
        serde_json::json!({
            "model": self.document,
            "adjustments": self.notes,
            "standard_errors": self.fit.standard_errors(),
            "intervals_95": intervals,
            "derived": greybox::derived_json(&self.fit, INTERVAL),
            "criteria": self.verdict.criteria,
            "judged": self.verdict.judged.iter().map(judged_json).collect::<Vec<_>>(),
            "residuals": residuals.as_ref().ok().map(|report| words::tests_json(report, REGION)),
            "residuals_error": self.verdict.no_residuals(),
            "doubts": self.doubts().into_iter().map(|(_, doubt)| doubt).collect::<Vec<_>>(),
        })
    }

    pub(super) fn print(&self, arguments: &FitArguments, terminal: &mut Terminal) {
        let document = &self.document;
        terminal.heading(&format!("{}: {}", method(document), channels(document)), Tone::Strong);
        terminal.line(&format!(
            "{} of {} s, {}",
            words::counted(self.fit.samples, "sample"),
            significant(document.sample_time_s),
            words::counted(self.experiments, "experiment"),
        ));
        let (grave, others): (Vec<_>, Vec<_>) =
            self.doubts().into_iter().partition(|(weight, _)| *weight == Weight::Grave);
        for (weight, doubt) in &grave {
            terminal.item(weight.mark(), doubt);
        }
        terminal.gap();
        self.print_model(terminal);
        terminal.gap();
        greybox::print_derived(&self.fit, INTERVAL, terminal);
        terminal.table(&self.fits());
        terminal.gap();
        self.print_tests(terminal);
        for (weight, doubt) in &others {
            terminal.item(weight.mark(), doubt);
        }
        for path in [&arguments.out, &arguments.result.plot].into_iter().flatten() {
            terminal.line(&format!("written: {}", path.display()));
        }
    }

    /// The poles and zeros of a state-space model, whose entries depend on the choice of the states; the parameters of others.
    fn print_model(&self, terminal: &mut Terminal) {
        if is_singular(&self.fit) {
            return;
        }
        match &self.fit.model {
            AnyModel::StateSpace(_) => {
                if let Err(reason) = show::print_roots(&self.document, INTERVAL, terminal) {
                    terminal.line(&format!("no poles and zeros: {reason}; the entries of the matrices are in --json"));
                }
            }
            _ => terminal.table(&self.parameters()),
        }
    }

    fn print_tests(&self, terminal: &mut Terminal) {
        let c = &self.verdict.criteria;
        let numbers = [("loss", self.fit.loss), ("FPE", c.fpe), ("AIC", c.aic), ("BIC", c.bic)];
        // What is not finite is not defined, as with a loss of zero or as many parameters as samples.
        let number = |v: f64| if v.is_finite() { significant(v) } else { "–".to_owned() };
        let numbers: Vec<String> = numbers.iter().map(|(n, v)| format!("{n} {}", number(*v))).collect();
        if !is_singular(&self.fit) {
            terminal.line(&numbers.join(", "));
        }
        let labels = (self.document.inputs.as_slice(), self.document.outputs.as_slice());
        if let Ok(report) = &self.verdict.residuals {
            words::print_tests(report, labels, REGION, terminal);
        }
        if let Some(reason) = self.verdict.no_residuals() {
            terminal.line(&format!("no residual test: {reason}"));
        }
        terminal.line(&format!("{} ({} iterations)", words::termination(self.fit.termination), self.fit.iterations));
    }

    /// Every reason to doubt, in words, those first with which the model is of no use as it is.
    fn doubts(&self) -> Vec<(Weight, String)> {
        let names = self.fit.model.parameter_names();
        let is_coloured =
            |report: &ident::validate::ResidualReport| report.whiteness.iter().any(|w| !w.joint.passes(REGION));
        let coloured = self.verdict.residuals.as_ref().is_ok_and(is_coloured);
        let first = (coloured && self.has_noise_model()).then(|| {
            "the residuals are not white, and the intervals rest on white ones: true errors may be several times larger; give the noise a higher order, or take armax, bj or ss".to_owned()
        });
        let growing = self.fit.model.system().and_then(|system| system.growing_mode()).ok().flatten();
        let pole = |doubt: &Doubt| match (&growing, doubt) {
            (Some(mode), Doubt::Unstable) => format!(" ({})", words::growing_pole(mode)),
            _ => String::new(),
        };
        let word = |doubt| {
            (Weight::of(doubt), format!("{}{}", words::doubt(doubt, &names, &self.document.outputs), pole(doubt)))
        };
        let mut all: Vec<(Weight, String)> = self.fit.doubts.iter().map(word).collect();
        all.extend(first.map(|text| (Weight::Doubt, text)));
        all.sort_by_key(|(weight, _)| *weight);
        all
    }

    /// Whether the noise is modelled too; where not, the intervals allow for coloured residuals.
    pub(super) fn has_noise_model(&self) -> bool {
        let document = &self.document;
        let innovations = self.fit.model.innovations(document.sample_time_s, document.intersample);
        innovations.is_ok_and(|of| of.k().norm_max() > 0.0)
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
            let (error, interval) = match fixed.contains(&i) || errors[i] == 0.0 {
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

    fn fits(&self) -> Table {
        let columns = [
            ("fit on", Align::Left),
            ("output", Align::Left),
            ("simulated", Align::Right),
            ("predicted", Align::Right),
        ];
        let mut table = Table::new(&columns);
        for judged in &self.verdict.judged {
            for (experiment, recording) in judged.experiments.iter().enumerate() {
                let on = match judged.experiments.len() {
                    1 => judged.name.to_owned(),
                    _ => format!("{}, {recording}", judged.name),
                };
                for (output, label) in self.document.outputs.iter().enumerate() {
                    let fit = |j: &Result<Judgement, IdentError>| {
                        words::percent(j.as_ref().map_or(f64::NAN, |j| j.fit_percent[experiment][output]))
                    };
                    // Without inputs there is nothing to simulate from.
                    let simulated =
                        if self.document.inputs.is_empty() { "–".to_owned() } else { fit(&judged.simulated) };
                    table.row([
                        on.as_str().into(),
                        label.name.as_str().into(),
                        simulated.into(),
                        fit(&judged.predicted).into(),
                    ]);
                }
            }
        }
        table
    }
}

fn judged_json(judged: &Judged) -> serde_json::Value {
    let fit = |j: &Result<Judgement, IdentError>| j.as_ref().ok().map(|j| j.fit_percent.clone());
    let error = |j: &Result<Judgement, IdentError>| j.as_ref().err().map(ToString::to_string);
    serde_json::json!({
        "data": judged.name,
        "experiments": judged.experiments,
        "fit_percent_simulated": fit(&judged.simulated),
        "fit_percent_predicted": fit(&judged.predicted),
        "error_simulated": error(&judged.simulated),
        "error_predicted": error(&judged.predicted),
    })
}
