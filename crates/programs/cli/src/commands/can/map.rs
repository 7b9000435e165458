//! The capability map.

use capability::LimitOf;
use capability::beyond::of_model;
use capability::gradient::gradients;
use capability::map::{MapInputs, SineOf, map};
use capability::wanted::{self, Wanted, WantedAnswer};
use report::can::MapPage;
use serde_json::json;
use units::RPM_RAD_S;

use super::predicted::{spread, words_and_numbers};
use crate::cli::can::CanArguments;
use crate::commands::experiment::check::pulses_from;
use crate::commands::experiment::planned;
use crate::commands::experiment::stated::Bench;
use crate::commands::result::show;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Frequencies of the table, Hz.
const FREQUENCIES_HZ: [f64; 19] =
    [0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 25.0, 30.0, 40.0, 60.0, 100.0];
/// Frequencies of the figure in each of the three decades from 0.1 Hz on.
const IN_A_DECADE: u32 = 30;
/// Speeds, rpm, up to the limit.
const SPEEDS_RPM: [f64; 8] = [800.0, 1200.0, 1500.0, 2000.0, 3000.0, 4000.0, 5000.0, 6000.0];

pub(super) fn run(arguments: &CanArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let bench = Bench::read(&arguments.on.bench, arguments.on.plan.study.as_deref(), terminal)?;
    let not_checkable = |reason: String| CliError::NotCheckable { path: arguments.on.bench.clone(), reason };
    let model = bench.model_with_shaft().map_err(|reason| not_checkable(reason.to_owned()))?;
    let limits = bench.file.limits;
    let (torque_nm, wishes) = (torque_nm(arguments)?, wishes(arguments)?);
    let is_possible = |speed: &f64| limits.speed_rad_s.is_none_or(|limit| *speed < limit);
    let speeds: Vec<f64> = match arguments.on.plan.speed {
        Some(rpm) if rpm > 0.0 => vec![rpm * RPM_RAD_S],
        Some(rpm) => {
            let what = format!("--speed {rpm}: a map needs a speed above 0 rpm, since an engine turns forwards");
            return Err(CliError::Usage { what });
        }
        None => SPEEDS_RPM.into_iter().map(|rpm| rpm * RPM_RAD_S).filter(is_possible).collect(),
    };
    let inputs = MapInputs {
        model: &model,
        engine: &bench.stated.parameters.engine,
        pulses: &bench.stated.pulses,
        limits,
        spread: spread(&bench),
        friction: bench.friction(),
        torque_nm,
        samples: arguments.samples as usize,
        seed: arguments.on.plan.seed(),
    };
    let unstated: Vec<LimitOf> = LimitOf::of_map(&limits).filter(|of| of.limit(&limits).is_none()).collect();
    if !unstated.is_empty() {
        let names = unstated.iter().map(|of| of.key()).collect::<Vec<_>>().join(", ");
        terminal.warning(&format!(
            "the map does not count limits that the bench file does not state: {names}; write them in [limits]"
        ));
    }
    let failed = |error: capability::CapabilityError| not_checkable(error.to_string());
    let maps = [SineOf::Speed, SineOf::Torque]
        .into_iter()
        .map(|of| map(&inputs, of, &frequencies_hz(), &speeds))
        .collect::<Result<Vec<_>, _>>()
        .map_err(failed)?;
    let gradients = gradients(&inputs, &speeds, &torques_nm(torque_nm, limits.torque_nm)).map_err(failed)?;
    let answers = wishes
        .into_iter()
        .map(|wish| wanted::answer(&inputs, wish, &speeds))
        .collect::<Result<Vec<_>, _>>()
        .map_err(failed)?;
    let title = format!("{}, mean torque {torque_nm} Nm", bench.file.name);
    let beyond = of_model(&bench.validity, &speeds, &[torque_nm]);
    let shown = MapPage {
        title: &title,
        maps: &maps,
        in_table_hz: &FREQUENCIES_HZ,
        gradients: &gradients,
        wanted: &answers,
        beyond: &beyond,
        friction: inputs.friction,
        pulses: &bench.stated.pulses,
    };
    let json = || {
        let beyond: Vec<_> = beyond.iter().map(words_and_numbers).collect();
        json!({"bench": bench.file.name, "torque_nm": torque_nm, "unchecked": unstated, "beyond": beyond, "friction": inputs.friction,
            "engine_pulses": pulses_from(&bench.stated.pulses), "wanted": answers, "maps": maps, "gradients": gradients})
    };
    show(&arguments.on.result, || bench.on_page(report::can::map(&shown)), json, terminal)?;
    // A yes that leaves a limit out, or goes beyond the model, is none, as for a test.
    let is_complete = answers.is_empty() || beyond.is_empty() && (unstated.is_empty() || arguments.allow_unchecked);
    Ok(if is_complete && answers.iter().all(WantedAnswer::is_yes) { Outcome::Done } else { Outcome::NotSafe })
}

/// Frequencies of table and figure, growing, Hz.
fn frequencies_hz() -> Vec<f64> {
    let of_figure = (0..=3 * IN_A_DECADE).map(|k| 0.1 * 10_f64.powf(f64::from(k) / f64::from(IN_A_DECADE)));
    let mut all: Vec<f64> = of_figure.chain(FREQUENCIES_HZ).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * *a);
    all
}

/// Wishes of `--want`.
fn wishes(arguments: &CanArguments) -> Result<Vec<Wanted>, CliError> {
    let usage = |error: capability::CapabilityError| CliError::Usage { what: format!("--want: {error}") };
    arguments.want.iter().map(|text| text.parse().map_err(usage)).collect()
}

/// Torques of the engine for gradients: the mean torque, none, and parts of the dynamometer's limit.
fn torques_nm(mean_nm: f64, limit_nm: Option<f64>) -> Vec<f64> {
    let parts = limit_nm.map_or(Vec::new(), |limit| vec![0.25 * limit, 0.5 * limit]);
    let mut torques: Vec<f64> = [0.0, mean_nm].into_iter().chain(parts).collect();
    torques.sort_by(f64::total_cmp);
    torques.dedup();
    torques
}

/// The mean torque, by `--set torque=…`.
fn torque_nm(arguments: &CanArguments) -> Result<f64, CliError> {
    let given = planned::given(&arguments.on.plan)?;
    let mut torque_nm = 50.0;
    for (name, value) in given.iter().filter(|(name, _)| name != "speed") {
        let number = value.trim_end_matches("Nm").trim().parse().ok().filter(|value: &f64| value.is_finite());
        match (name.as_str(), number) {
            ("torque", Some(number)) => torque_nm = number,
            _ => {
                let what = format!("--set {name}={value}: a map takes --set torque=NM and --speed RPM");
                return Err(CliError::Usage { what });
            }
        }
    }
    Ok(torque_nm)
}
