//! An estimate: the model with its uncertainty, how good it is, and what to doubt.

mod derived;
mod facts;
mod judged;
mod repeated;
mod table;

use ident::uncertainty::Dynamics;
use ident::validate::{Judgement, ResidualReport};
use ident::{AnyModel, Dataset, Doubt, Fit, IdentError, Label, LinearModel, ModelDocument, Parametric};
use page::decimal::{digits, percent, significant};
use page::{Align, Block, Blocks, Page, Table, Tone};

use crate::blocks::{finding, heading, line, name};
use crate::models::poles;
use crate::residuals::{self, REGION, TestFacts};
use crate::words;
use judged::{Judged, is_singular};
use repeated::Repeated;
use table::{INTERVAL, Known, estimate, estimates};

pub use facts::{DerivedFacts, EstimateFacts, JudgedFacts};
pub use judged::Verdict;
pub use repeated::RepeatedFacts;

/// Estimate with its model, its verdict and the number of its experiments.
pub struct Estimated {
    /// The model as a file holds it.
    pub document: ModelDocument,
    /// The estimate.
    pub fit: Fit<AnyModel>,
    /// How good it is.
    pub verdict: Verdict,
    /// Experiments that the estimate rests on.
    pub experiments: usize,
}

/// A residual of which the inputs explain more than this part is mostly an error of the model.
const MOSTLY: f64 = 0.5;

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
            Doubt::Unstable
            | Doubt::NotConverged
            | Doubt::HeldBeforeRefuted
            | Doubt::ExplainsLittle { .. }
            | Doubt::DependentOutputs { .. } => Weight::Grave,
            Doubt::FollowsInputs { share, .. } if *share > MOSTLY => Weight::Grave,
            Doubt::RowsLeftOut { .. } | Doubt::HeldBefore | Doubt::CovarianceIsLowerBound => Weight::Note,
            _ => Weight::Doubt,
        }
    }

    fn finding(self, text: &str) -> Block {
        let (tone, severity) = match self {
            Weight::Grave => (Tone::Bad, "doubt"),
            Weight::Doubt => (Tone::Caution, "doubt"),
            Weight::Note => (Tone::Faint, "note"),
        };
        finding(tone, severity, text)
    }
}

fn channels(document: &ModelDocument) -> String {
    let names = |labels: &[Label]| labels.iter().map(|l| l.name.as_str()).collect::<Vec<_>>().join(", ");
    let inputs = if document.inputs.is_empty() { "e".to_owned() } else { names(&document.inputs) };
    format!("{inputs} → {}", names(&document.outputs))
}

fn method(document: &ModelDocument) -> &str {
    document.estimate.as_ref().map_or("", |e| e.method.as_str())
}

impl Estimated {
    /// The estimate in words and tables, and what it makes of data.
    pub fn page(&self, shown: &Dataset) -> Page {
        let title = format!("{}, {}", channels(&self.document), method(&self.document));
        let mut all = self.text();
        let figures = self.verdict.figures(shown, self.has_noise_model());
        all.push(figures.into_iter().map(Block::figure).collect::<Blocks>());
        Page::new(title, all.into_vec())
    }

    /// The estimate in numbers, with what was done to the data on the way.
    pub fn facts(&self, adjustments: Vec<String>) -> EstimateFacts {
        let intervals: Vec<[f64; 2]> = self.fit.intervals(INTERVAL).into_iter().map(<[f64; 2]>::from).collect();
        EstimateFacts {
            model: self.document.clone(),
            adjustments,
            standard_errors: self.fit.standard_errors(),
            levels: self.fit.levels.clone(),
            derived: derived::facts(&self.fit),
            criteria: self.verdict.criteria,
            judged: self.verdict.judged.iter().map(JudgedFacts::of).collect(),
            residuals: self.verdict.residuals.as_ref().ok().map(TestFacts::of),
            residuals_error: self.verdict.no_residuals(),
            at_bound: (0..intervals.len()).map(|i| self.fit.is_at_bound(i)).collect(),
            doubts: self.doubts().into_iter().map(|(_, doubt)| doubt).collect(),
            intervals_95: intervals,
        }
    }

    fn text(&self) -> Blocks {
        let document = &self.document;
        let mut all = Blocks::default();
        all.push(heading(format!("{}: {}", method(document), channels(document))));
        all.push(line(format!(
            "{} of {} s, {}",
            words::counted(self.fit.samples, "sample"),
            significant(document.sample_time_s),
            words::counted(self.experiments, "experiment"),
        )));
        all.push(self.levels());
        let (grave, others): (Vec<_>, Vec<_>) =
            self.doubts().into_iter().partition(|(weight, _)| *weight == Weight::Grave);
        let findings = |doubts: Vec<(Weight, String)>| -> Blocks {
            doubts.into_iter().map(|(weight, doubt)| weight.finding(&doubt)).collect()
        };
        all.push(findings(grave));
        all.push(self.model());
        all.push(derived::blocks(&self.fit).into_iter().collect::<Blocks>());
        all.push(self.fits());
        all.push(self.repeated());
        all.push(self.tests());
        all.push(findings(others));
        all
    }

    /// The levels that were estimated with the model, beside what was subtracted before.
    fn levels(&self) -> Blocks {
        let [levels] = self.fit.levels.as_slice() else { return Blocks::default() };
        let of = |(label, level): (&Label, &f64)| {
            let unit = if label.unit.is_empty() { String::new() } else { format!(" {}", label.unit) };
            line(format!(
                "level of {}, estimated with the model: {}{unit} above what was subtracted",
                label.name,
                digits(*level, 4)
            ))
        };
        self.document.outputs.iter().zip(levels).map(of).collect()
    }

    /// The poles and zeros of a state-space model, whose entries depend on the choice of the states; the parameters of
    /// others.
    fn model(&self) -> Blocks {
        if is_singular(&self.fit) {
            return Blocks::default();
        }
        match &self.fit.model {
            AnyModel::StateSpace(_) => match poles::roots_of_model(&self.document, INTERVAL) {
                Ok(roots) => roots,
                Err(reason) => {
                    line(format!("no poles and zeros: {reason}; the entries of the matrices are in --json")).into()
                }
            },
            _ => self.parameters().into(),
        }
    }

    fn tests(&self) -> Blocks {
        let c = &self.verdict.criteria;
        let numbers = [("loss", self.fit.loss), ("FPE", c.fpe), ("AIC", c.aic), ("BIC", c.bic)];
        // What is not finite is not defined, as with a loss of zero or as many parameters as samples.
        let number = |v: f64| if v.is_finite() { significant(v) } else { "–".to_owned() };
        let numbers: Vec<String> = numbers.iter().map(|(n, v)| format!("{n} {}", number(*v))).collect();
        let mut all = Blocks::default();
        if !is_singular(&self.fit) {
            all.push(line(numbers.join(", ")));
        }
        if let Ok(report) = &self.verdict.residuals {
            all.push(residuals::findings(report, &self.document.inputs, &self.document.outputs));
        }
        if let Some(reason) = self.verdict.no_residuals() {
            all.push(line(format!("no residual test: {reason}")));
        }
        let (ended, iterations) = (words::termination(self.fit.termination), self.fit.iterations);
        all.push(line(format!("{ended} ({iterations} iterations)")));
        all
    }

    /// Every reason to doubt, in words, those first with which the model is of no use as it is.
    fn doubts(&self) -> Vec<(Weight, String)> {
        let names = self.fit.model.parameter_names();
        let is_coloured = |report: &ResidualReport| report.whiteness.iter().any(|w| !w.joint.passes(REGION));
        let coloured = self.verdict.residuals.as_ref().is_ok_and(is_coloured);
        let first = (coloured && self.has_noise_model()).then(|| {
            "the residuals are not white, and the intervals rest on white ones: true errors may be several times larger; give the noise a higher order, or take armax, bj or ss".to_owned()
        });
        let growing = self.fit.model.system().and_then(|system| system.growing_mode()).ok().flatten();
        let pole = |doubt: &Doubt| match (&growing, doubt) {
            (Some(mode), Doubt::Unstable) => format!(" ({})", words::growing_pole(mode)),
            _ => String::new(),
        };
        let word = |doubt: &Doubt| {
            let weight = match doubt {
                // What only a controller keeps stable is predicted well all the same.
                Doubt::Unstable if self.verdict.predicts() => Weight::Doubt,
                _ => Weight::of(doubt),
            };
            (weight, format!("{}{}", words::doubt(doubt, &names, &self.document.outputs), pole(doubt)))
        };
        // What ended at the unit circle is named by its root.
        let is_at_edge = self.fit.doubts.iter().any(|doubt| matches!(doubt, Doubt::RootAtEdge { .. }));
        let is_said = |doubt: &&Doubt| is_at_edge && matches!(doubt, Doubt::AtBound { .. });
        let mut all: Vec<(Weight, String)> = self.fit.doubts.iter().filter(|doubt| !is_said(doubt)).map(word).collect();
        all.extend(first.map(|text| (Weight::Doubt, text)));
        let repeated = self.verdict.judged.first().into_iter().flat_map(|own| &own.repeated);
        let missed = repeated.flat_map(|one| one.doubts(&self.document.outputs));
        all.extend(missed.map(|text| (Weight::Grave, text)));
        let of_unseen =
            self.verdict.little_of_unseen().iter().map(|(output, simulated)| {
                words::explains_little(*output, *simulated, &self.document.outputs, "unseen")
            });
        all.extend(of_unseen.map(|text| (Weight::Grave, text)));
        all.extend(self.off_its_level().map(|text| (Weight::Doubt, text)));
        all.sort_by_key(|(weight, _)| *weight);
        all
    }

    /// That the simulation of the model's own data misses a level, which other methods estimate.
    fn off_its_level(&self) -> Option<String> {
        let shifted = self.verdict.shifted();
        if shifted.is_empty() || !self.fit.levels.is_empty() || self.document.inputs.is_empty() {
            return None;
        }
        let names = shifted.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        Some(format!(
            "most of what the simulation misses of {names} is an offset or a drift: the mean is not the level at which the system \
             rests, as where a record begins far from rest; tf and process estimate that level, so compare them, or record a rest first"
        ))
    }

    /// Returns true if the noise is modelled too; where not, the intervals allow for coloured residuals.
    fn has_noise_model(&self) -> bool {
        let document = &self.document;
        let innovations = self.fit.model.innovations(document.sample_time_s, document.intersample);
        innovations.is_ok_and(|of| of.k().norm_max() > 0.0)
    }

    fn parameters(&self) -> Table {
        let mut table = estimates("parameter");
        let values = self.fit.parameters();
        let (errors, intervals) = (self.fit.standard_errors(), self.fit.intervals(INTERVAL));
        let fixed = derived::fixed(&self.fit.model);
        for (i, name) in self.fit.model.parameter_names().iter().enumerate() {
            let known = match errors[i] {
                _ if self.fit.is_at_bound(i) => Known::AtBound,
                error if fixed.contains(&i) || error == 0.0 => Known::Fixed,
                error => Known::Within(error, intervals[i]),
            };
            table.row(estimate(name, values[i], &known));
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
                        percent(j.as_ref().map_or(f64::NAN, |j| j.fit_percent[experiment][output]))
                    };
                    // Without inputs there is nothing to simulate from, and what runs away measures nothing.
                    let has_simulation = !self.document.inputs.is_empty() && !judged.diverges;
                    let simulated = if has_simulation { fit(&judged.simulated) } else { "–".to_owned() };
                    table.row([name(&on), name(&label.name), simulated.into(), fit(&judged.predicted).into()]);
                }
            }
        }
        table
    }

    fn repeated(&self) -> Blocks {
        let of = |judged: &Judged| {
            let several = judged.experiments.len() > 1;
            let text =
                |r: &Repeated| line(format!("{} data: {}", judged.name, r.sentence(&self.document.outputs, several)));
            judged.repeated.iter().map(text).collect::<Vec<_>>()
        };
        self.verdict.judged.iter().flat_map(of).collect()
    }
}
