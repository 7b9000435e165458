//! A study of a bench.

use std::path::PathBuf;

use ::study::Study;
use dynoid::{Bench, Error, Files, Session};
use pyo3::prelude::*;
use report::brief::key_numbers;
use report::estimated::not_estimated;
use report::verdict::{Rule, verdict};
use report::wording;
use serde_json::{Value, json};
use work::Context;

use crate::errors::Fault;
use crate::interrupt;
use crate::results::to_python;

/// What a study gives: a summary and the whole study as data, the bench model as the text of its file, and the report.
type Studied<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>, Option<String>, String);

/// Studies a bench with the recordings that its file lists.
#[pyfunction]
#[pyo3(signature = (bench, progress=None, threads=None))]
pub(crate) fn study(
    py: Python<'_>,
    bench: PathBuf,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Studied<'_>, Fault> {
    let made = interrupt::run(py, progress, threads, |context| Made::of(&bench, context))??;
    let whole = py.import("json")?.call_method1("loads", (made.whole,))?;
    Ok((to_python(py, &made.summary)?, whole, made.model, made.report))
}

struct Made {
    summary: Value,
    whole: String,
    model: Option<String>,
    report: String,
}

impl Made {
    fn of(bench: &std::path::Path, context: &Context) -> Result<Self, Error> {
        let files = Files::new("python", false);
        let bench = Bench::load(bench, &files)?;
        let step = context.step("study", 3);
        let session = Session::open(bench, &files, &step)?;
        let study = session.study(&step)?;
        let _writing = step.step("writing the report", 0);
        let model = session.model(&study).map(|model| model.to_json().map_err(Error::internal)).transpose()?;
        let page = report::study(&study, &session.bench().origin());
        Ok(Made {
            summary: summary(&study),
            whole: report::json(&study, None),
            model,
            report: page::html(&page, &files.generator()),
        })
    }
}

fn summary(study: &Study) -> Value {
    let verdict = verdict(study);
    let rule = |rule: &Rule| json!({ "asks": rule.asks, "found": rule.found, "outcome": rule.level.outcome() });
    let estimates = key_numbers(study).into_iter().map(|(part, parameter)| {
        let mut estimate = json!(parameter);
        estimate["part"] = part.into();
        estimate
    });
    let needs = not_estimated(study).into_iter();
    json!({
        "bench": study.bench.name,
        "level": verdict.level.key(),
        "headline": verdict.level.headline(),
        "rules": verdict.rules.iter().map(rule).collect::<Vec<_>>(),
        "estimates": estimates.collect::<Vec<_>>(),
        "not_estimated": needs.map(|(part, needs)| json!({ "part": part, "needs": wording::needs(needs) })).collect::<Vec<_>>(),
        "findings": study.diagnostics.iter().map(wording::remark).collect::<Vec<_>>(),
    })
}
