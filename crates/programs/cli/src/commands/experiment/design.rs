//! `dynoid experiment design`: demands, a picture of them, and what the bench will do.

use std::path::PathBuf;

use design::excitation_design::ExcitedDemand;
use dynoid::experiments::{DemandForm, DesignFacts, DesignedExperiment, OptimalOptions, Planned};
use dynoid::{
    Error, FileFormat, Files, KnownBench, Mark, NotPredicted, OutputFolder, Staging, check_replaceable, pages,
};
use serde::Serialize;

use super::planned::{self, WithDoubts};
use crate::cli::experiment::{DesignArguments, Excite, Form};
use crate::commands::result::{Sorted, check_plot};
use crate::error::{self, CliError, Outcome};
use crate::path::shown;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &DesignArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let bench = planned::known(&arguments.on, terminal)?;
    let planned = match &arguments.experiment {
        Some(experiment) => planned::plan(experiment, &arguments.on.plan, terminal)?,
        None => optimal(arguments, &bench, terminal)?,
    };
    let seed = arguments.on.plan.seed();
    let targets = Targets::new(arguments, &planned.file_name(seed), &terminal.files())?;
    let doubts = planned::doubts(&planned.plan, &bench, terminal);
    let designed = DesignedExperiment::of(&bench, planned, seed, terminal.work());
    let mut staging = targets.stage(&designed, &terminal.files())?;
    let not_predicted = match designed.predicted() {
        Ok(predicted) => {
            predicted.warnings().iter().for_each(|warning| terminal.warning(warning));
            None
        }
        Err(reason) => Some(in_words(reason)),
    };
    not_predicted.iter().for_each(|reason| terminal.warning(&format!("nothing is predicted: {reason}")));
    let page = designed.page();
    let missing = pages::stage_page(&targets.plot, &page, &mut staging)?;
    missing.iter().for_each(|missing| terminal.warning(missing));
    staging.finish()?;
    let written = targets.all(not_predicted.is_none());
    let written: Vec<String> = written.into_iter().map(|path| shown(path).to_string()).collect();
    if arguments.on.result.json {
        let design = WithDoubts { facts: designed.facts(), doubts: &doubts };
        terminal.json(&Sorted(Facts { design, not_predicted, files: written }))?;
    } else if !terminal.is_quiet() {
        terminal.page(&page);
        written.iter().for_each(|path| terminal.line(&format!("written: {path}")));
    }
    Ok(Outcome::Done)
}

/// Why nothing is predicted, with the option that may help.
fn in_words(reason: &NotPredicted) -> String {
    match reason {
        NotPredicted::UnknownShaft => format!("{reason}{}; the demands were written", error::WITH_MODEL),
        _ => reason.to_string(),
    }
}

/// A designed experiment in numbers, with its files.
#[derive(Serialize)]
struct Facts<'a> {
    #[serde(flatten)]
    design: WithDoubts<'a, DesignFacts<'a>>,
    not_predicted: Option<String>,
    files: Vec<String>,
}

/// The plan of the excitation that the arguments ask for.
fn optimal(arguments: &DesignArguments, bench: &KnownBench, terminal: &Terminal) -> Result<Planned, CliError> {
    let asked = &arguments.optimal;
    let options = OptimalOptions {
        form: match asked.form {
            Form::Multisine => DemandForm::Multisine,
            Form::Binary => DemandForm::Binary,
        },
        excited: asked.excite.map(|excite| match excite {
            Excite::Torque => ExcitedDemand::Torque,
            Excite::Speed => ExcitedDemand::Speed,
        }),
        peak_shaft_torque_nm: asked.peak_shaft_torque,
        peak_torque_nm: asked.peak_torque,
        peak_speed_rpm: asked.peak_speed,
        goals: asked.optimal.clone(),
    };
    Ok(Planned::optimal(bench, &options, &arguments.on.plan.given()?, terminal.work())?)
}

/// The files that are written.
struct Targets {
    csv: PathBuf,
    mf4: PathBuf,
    plot: PathBuf,
    predicted: PathBuf,
}

impl Targets {
    fn new(arguments: &DesignArguments, stem: &str, files: &Files) -> Result<Self, CliError> {
        let folder = &arguments.out;
        OutputFolder::check(folder, files)?;
        let file = |ending: &str| folder.join(format!("{stem}{ending}"));
        let plot = arguments.on.result.plot.clone().unwrap_or_else(|| file(".html"));
        let targets = Targets { csv: file(".csv"), mf4: file(".mf4"), plot, predicted: file("_predicted.mf4") };
        check_plot(&arguments.on.result, files)?;
        targets
            .all(true)
            .into_iter()
            .try_for_each(|target| check_replaceable(target, Some(&Mark::of_run(files)), files))?;
        Ok(targets)
    }

    /// Writes all but the picture, to get their names together with it.
    fn stage(&self, designed: &DesignedExperiment, files: &Files) -> Result<Staging, CliError> {
        if let Some(folder) = self.csv.parent() {
            std::fs::create_dir_all(folder).map_err(|source| Error::write(folder, source))?;
        }
        let mut staging = Staging::of(files);
        FileFormat::Csv.stage(&designed.table()?, &self.csv, &mut staging)?;
        FileFormat::Mf4.stage(&designed.recording(), &self.mf4, &mut staging)?;
        if let Some(responses) = designed.responses() {
            FileFormat::Mf4.stage(&responses, &self.predicted, &mut staging)?;
        }
        Ok(staging)
    }

    fn all(&self, has_prediction: bool) -> Vec<&PathBuf> {
        let predicted = has_prediction.then_some(&self.predicted);
        [Some(&self.csv), Some(&self.mf4), Some(&self.plot), predicted].into_iter().flatten().collect()
    }
}
