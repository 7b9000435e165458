//! `dynoid can`: whether a bench can run a test, and whether a run of one is valid.

use std::path::Path;

use dynoid::can::{Capability, CapabilityOptions, JudgedRun, Predicted, Requirements, Test, TestOptions};

use crate::cli::can::CanArguments;
use crate::commands::experiment::planned::known;
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// The name that asks for the map in place of a test.
const MAP: &str = "map";

pub(crate) fn run(arguments: &CanArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.on.result, &terminal.files())?;
    if arguments.test.eq_ignore_ascii_case(MAP) {
        return map(arguments, terminal);
    }
    if !arguments.want.is_empty() {
        let what = "--want compares sines and gradients with the map; give `map` as the test".to_owned();
        return Err(CliError::Usage { what });
    }
    let test = Test::find(&arguments.test, &options(arguments)?, &terminal.files(), terminal.work())?;
    test.remarks().iter().for_each(|remark| terminal.warning(remark));
    let wanted = Requirements::of(&test, &arguments.by, &arguments.require)?;
    match &arguments.recorded {
        Some(file) => recorded(arguments, &test, &wanted, file, terminal),
        None => predicted(arguments, &test, &wanted, terminal),
    }
}

fn options(arguments: &CanArguments) -> Result<TestOptions, CliError> {
    Ok(TestOptions {
        engine_map: arguments.engine_map.clone(),
        idle_rpm: arguments.idle,
        vehicle: arguments.vehicle.clone(),
        given: arguments.on.plan.given()?,
        seed: arguments.on.plan.seed(),
    })
}

fn predicted(
    arguments: &CanArguments,
    test: &Test,
    wanted: &Requirements,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let bench = known(&arguments.on, terminal)?;
    let answer = Predicted::of(&bench, test, wanted, arguments.on.draws(arguments.samples), terminal.work())?;
    show(&arguments.on.result, || bench.on_page(answer.page()), || Sorted(answer.facts()), terminal)?;
    let is_complete = answer.unchecked().is_empty() || arguments.allow_unchecked;
    Ok(if answer.is_yes() && is_complete { Outcome::Done } else { Outcome::NotSafe })
}

fn recorded(
    arguments: &CanArguments,
    test: &Test,
    wanted: &Requirements,
    file: &Path,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let (bench, start_s) = (&arguments.on.bench, arguments.start);
    let run = JudgedRun::read(bench, file, test, wanted, start_s, &terminal.files(), terminal.work())?;
    show(&arguments.on.result, || run.page(), || Sorted(run.facts()), terminal)?;
    Ok(if run.passes() { Outcome::Done } else { Outcome::NotSafe })
}

fn map(arguments: &CanArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let bench = known(&arguments.on, terminal)?;
    Capability::check(&bench)?;
    let map = Capability::of(&bench, map_options(arguments)?)?;
    if !map.unchecked().is_empty() {
        let names = map.unchecked().iter().map(|of| of.key()).collect::<Vec<_>>().join(", ");
        terminal.warning(&format!(
            "the map does not count limits that the bench file does not state: {names}; write them in [limits]"
        ));
    }
    show(&arguments.on.result, || bench.on_page(map.page()), || Sorted(map.facts()), terminal)?;
    Ok(if map.is_yes(arguments.allow_unchecked) { Outcome::Done } else { Outcome::NotSafe })
}

/// The choices of a map, with its mean torque by `--set torque=…`.
fn map_options(arguments: &CanArguments) -> Result<CapabilityOptions, CliError> {
    let mut options = CapabilityOptions::of(arguments.on.draws(arguments.samples));
    options.speed_rpm = arguments.on.plan.speed;
    for given in arguments.on.plan.given()?.iter().filter(|given| given.name != "speed") {
        let number = given.value.trim_end_matches("Nm").trim().parse().ok().filter(|value: &f64| value.is_finite());
        match (given.name.as_str(), number) {
            ("torque", Some(number)) => options.torque_nm = number,
            (name, _) => {
                let what = format!("--set {name}={}: a map takes --set torque=NM and --speed RPM", given.value);
                return Err(CliError::Usage { what });
            }
        }
    }
    let usage = |error: capability::CapabilityError| CliError::Usage { what: format!("--want: {error}") };
    options.wanted = arguments.want.iter().map(|text| text.parse().map_err(usage)).collect::<Result<_, _>>()?;
    Ok(options)
}
