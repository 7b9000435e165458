//! `dynoid controller noise-test`: what noise does to the estimate of a PI that is known.

use demo::campaign::held_speed;
use part_controller::noise_test::{NoiseTestOptions, noise_test};
use rig::experiment::Test;
use rig::{ControlMode, Experiment, Role};

use crate::cli::GivenRecordings;
use crate::cli::controller::NoiseTestArguments;
use crate::commands::experiments;
use crate::commands::result::{check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(super) fn run(arguments: &NoiseTestArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let options = options(arguments)?;
    let experiment = match &arguments.bench {
        Some(bench) => recorded(bench, arguments, terminal)?,
        None => {
            check_plot(&arguments.result, &terminal.files())?;
            held_speed(arguments.seed).map_err(CliError::internal)?
        }
    };
    let found = noise_test(&experiment, &options, terminal.work());
    let found = found.map_err(|source| CliError::NoiseTest { source })?;
    show(&arguments.result, || report::pages::controller_noise(&found), || &found, terminal)?;
    Ok(Outcome::Done)
}

fn options(arguments: &NoiseTestArguments) -> Result<NoiseTestOptions, CliError> {
    let [low, high] = arguments.band_pass[..] else {
        return Err(CliError::Usage { what: "--band-pass: give two corners, such as 100,200".to_owned() });
    };
    if low >= high {
        return Err(CliError::Usage { what: format!("--band-pass {low},{high}: the first corner is the lower one") });
    }
    Ok(NoiseTestOptions {
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
    let recordings = experiments::find(&given, &arguments.result, terminal)?;
    experiments::each(&recordings, "reading", terminal, |experiment| {
        let has_speeds = [Role::DynoSpeed, Role::DynoSpeedDemand].iter().all(|r| experiment.signal(*r).is_some());
        if experiment.label.mode == ControlMode::Nt && has_speeds {
            all.push(experiment);
        }
    })?;
    let rank = |e: &Experiment| (e.is_test(&Test::Bs), e.signal(Role::DynoSpeed).map_or(0, signal::Signal::len));
    all.into_iter().max_by_key(rank).ok_or_else(|| CliError::NoSpeedControl { path: bench.to_owned() })
}
