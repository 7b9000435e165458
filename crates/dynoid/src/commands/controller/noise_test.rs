//! `dynoid controller noise-test`: what noise does to the estimate of a PI that is known.

use bench::experiment::Test;
use bench::speed_control::{Case, Estimator, PiStudy, StudyOptions, Summary, study, virtual_experiment};
use bench::{ControlMode, Experiment, Role};
use page::{Align, Table, Tone};
use report::controller::{ESTIMATORS, STUDY_DEFINITIONS, estimator, noise, published, study_figures};
use report::wording::number;

use crate::cli::GivenRecordings;
use crate::cli::controller::NoiseTestArguments;
use crate::commands::experiments;
use crate::commands::identify::data::check_plot;
use crate::commands::identify::judge::{picture, written};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(super) fn run(arguments: &NoiseTestArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let options = options(arguments)?;
    let experiment = match &arguments.bench {
        Some(bench) => recorded(bench, arguments, terminal)?,
        None => {
            check_plot(&arguments.result, &[])?;
            virtual_experiment(arguments.seed).map_err(CliError::internal)?
        }
    };
    let progress = terminal.long("estimating draw after draw");
    let found = study(&experiment, &options, &|done, all| progress.told(done, all));
    drop(progress);
    let found = found.map_err(|source| CliError::NoiseTest { source })?;
    picture(&arguments.result, "Study of a known PI", || study_figures(&found))?;
    if arguments.result.json {
        terminal.json(&found)?;
    } else if !terminal.is_quiet() {
        print(&found, terminal);
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

fn options(arguments: &NoiseTestArguments) -> Result<StudyOptions, CliError> {
    let [low, high] = arguments.band_pass[..] else {
        return Err(CliError::Usage { what: "--band-pass: give two corners, such as 100,200".to_owned() });
    };
    if low >= high {
        return Err(CliError::Usage { what: format!("--band-pass {low},{high}: the first corner is the lower one") });
    }
    Ok(StudyOptions {
        k_p: arguments.k_p,
        k_i: arguments.k_i,
        delay_s: arguments.delay,
        low_pass_hz: arguments.low_pass,
        low_pass_snr: arguments.low_pass_snr,
        band_pass_hz: (low, high),
        band_pass_snr: arguments.band_pass_snr,
        draws: arguments.draws as usize,
        seed: arguments.seed,
    })
}

/// The recording that is named, or the longest BS_T_NT, or else the longest in speed control.
fn recorded(
    bench: &std::path::Path,
    arguments: &NoiseTestArguments,
    terminal: &mut Terminal,
) -> Result<Experiment, CliError> {
    let given = GivenRecordings { bench: bench.to_owned(), recordings: arguments.recording.iter().cloned().collect() };
    let mut all: Vec<Experiment> = Vec::new();
    experiments::each((&given, &arguments.result), "reading", terminal, |_, experiment| {
        let has_speeds = [Role::DynoSpeed, Role::DynoSpeedDemand].iter().all(|r| experiment.signal(*r).is_some());
        if experiment.label.mode == ControlMode::Nt && has_speeds {
            all.push(experiment);
        }
    })?;
    let rank = |e: &Experiment| (e.is_test(&Test::Bs), e.signal(Role::DynoSpeed).map_or(0, signal::Signal::len));
    all.into_iter().max_by_key(rank).ok_or_else(|| CliError::NoSpeedControl { path: bench.to_owned() })
}

fn print(found: &PiStudy, terminal: &mut Terminal) {
    terminal.heading(&format!("A known PI on the speeds of {}", found.file), Tone::Strong);
    let columns = [
        ("noise", Align::Left),
        ("estimated", Align::Left),
        ("", Align::Left),
        ("truth", Align::Right),
        ("mean", Align::Right),
        ("bias", Align::Right),
        ("st. dev.", Align::Right),
        ("claimed", Align::Right),
        ("coverage", Align::Right),
        ("table 7.1", Align::Right),
        ("unit", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for case in &found.cases {
        for (index, summary) in case.summaries.iter().enumerate() {
            let is_first = index == 0 && case.estimator == Estimator::Forward;
            let heading = if is_first { noise(found, case.noise) } else { String::new() };
            row(found, (case, summary), heading, &mut table);
        }
    }
    terminal.table(&table);
    for case in found.cases.iter().filter(|case| case.failed > 0) {
        terminal.line(&format!("{}: {} draws gave no estimate", noise(found, case.noise), case.failed));
    }
    terminal.gap();
    terminal.paragraph(&format!("{} draws of each noise. {STUDY_DEFINITIONS}", found.options.draws));
    terminal.paragraph(ESTIMATORS);
}

fn row(found: &PiStudy, (case, summary): (&Case, &Summary), heading: String, table: &mut Table) {
    let digits = |value: f64| number::significant(value, 5);
    let spread = |value: f64| number::significant(value, 2);
    let is_one = summary.values.len() < 2;
    let of_many = |text: String| if is_one { "–".to_owned() } else { text };
    let once = published(found, case.noise, &summary.symbol).filter(|_| case.estimator == Estimator::Forward);
    table.row([
        heading.into(),
        estimator(case.estimator).into(),
        summary.symbol.clone().into(),
        digits(summary.truth).into(),
        digits(summary.mean).into(),
        spread(summary.bias).into(),
        of_many(spread(summary.standard_deviation)).into(),
        spread(summary.claimed).into(),
        of_many(number::proportion(&summary.coverage)).into(),
        once.map_or_else(|| "–".to_owned(), digits).into(),
        summary.unit.clone().into(),
    ]);
}
