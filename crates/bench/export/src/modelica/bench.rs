//! The bench in Modelica: the mechanics with torque control, the speed controller, and both together.

use std::fmt::Write as _;

use bench_model::document::{BenchModelDocument, Range};
use bench_model::model::{BenchModel, PiController};

use super::{html, number, text};
use crate::ExportedFile;
use crate::names::Names;
use crate::numbers::{self, Number, written_by};
use crate::start::{start_nm, start_rad_s};

const PACKAGE: &str = include_str!("bench.mo");
const CONTROL: &str = include_str!("control.mo");
const FLANGE: &str = include_str!("flange.mo");
const FLANGE_EQUATIONS: &str = include_str!("flange_equations.mo");
const ICON: &str = include_str!("icon.mo");
/// A time of the plant's delay that the demand has waited already.
const AHEAD_OF_PLANT: &str =
    "    parameter Real T_ahead(unit = \"s\") = 0.0 \"time that T_d_demand has waited of tau_t\";\n";
/// Part of a sample below which two instants count as one.
const INSTANT: f64 = 1e-9;
const PLANT: [&str; 7] = ["J_d", "J_e", "K", "B", "tau_t", "a", "T_gate"];
const CONTROLLER: [&str; 7] = ["K_p", "K_i", "tau_c", "k", "k_a", "T_s", "T_limit"];

/// The file `NAME.mo`, a package with the models `Plant` and, where the bench has a speed controller, `SpeedController`
/// and `SpeedControl`. `PlantFlange` and `SpeedControlFlange` have connectors of the Modelica Standard Library; the
/// others do not need it.
#[must_use]
pub fn bench(document: &BenchModelDocument, names: &Names) -> ExportedFile {
    let model = &document.model;
    let control = model.torque_control.and(model.speed_controller);
    let package = plant(PACKAGE, document)
        .replace("@CONTROL@", &control.map_or_else(String::new, |pi| controller(model, &pi)))
        .replace("@FLANGE@", &FLANGE.replace("@OF_PLANT@", ""))
        .replace("@FLANGE_EQUATIONS@", FLANGE_EQUATIONS)
        .replace("@ICON@", ICON)
        .replace("@W_START@", &number(start_rad_s(&document.validity)))
        .replace("@T_START@", &number(start_nm(&document.validity)))
        .replace("@CLASS@", &names.class)
        .replace("@TITLE@", &text(&format!("Bench model of {}", document.bench.name)))
        .replace("@DOCUMENTATION@", &documentation(document));
    ExportedFile::text(format!("{}.mo", names.class), format!("// {}\n{package}", written_by(document)))
}

/// The declarations of these parameters, as far as the model has them.
fn parameters(model: &BenchModel, which: &[&str]) -> String {
    let declared = |one: &Number| {
        let (unit, value) = (one.unit.modelica(), number(one.value?));
        Some(format!("    parameter Real {}(unit = \"{unit}\") = {value} \"{}\";\n", one.name, text(one.description)))
    };
    let all = numbers::all(model);
    all.iter().filter(|one| which.contains(&one.name)).filter_map(declared).collect()
}

fn plant(template: &str, document: &BenchModelDocument) -> String {
    let model = &document.model;
    let (demand, ahead) = match waits_beyond_delay(model) {
        Some(_) => ("delay(T_d_demand, tau_t - T_ahead)", AHEAD_OF_PLANT),
        None => ("delay(T_d_demand, tau_t)", ""),
    };
    let (has_control, bandwidth) =
        (model.torque_control.is_some(), model.torque_control.and_then(|control| control.bandwidth_rad_s));
    let (output, equation) = match (has_control, bandwidth) {
        (true, Some(_)) => (
            "    output Real T_d(unit = \"N.m\", start = T_start, fixed = true) \"torque of the dynamometer\";\n",
            format!("    der(T_d) = a * ({demand} - T_d);\n"),
        ),
        (true, None) => {
            ("    output Real T_d(unit = \"N.m\") \"torque of the dynamometer\";\n", format!("    T_d = {demand};\n"))
        }
        (false, _) => ("", String::new()),
    };
    let (torque, words) =
        if has_control { ("T_d_demand", "demanded torque") } else { ("T_d", "torque of the dynamometer") };
    let reading = if model.encoder_gate_s > 0.0 { "w_start + (turn - delay(turn, T_gate)) / T_gate" } else { "w_d" };
    template
        .replace("@WITH_TORQUE_CONTROL@", if has_control { " with the torque control (TN)" } else { "" })
        .replace("@PLANT_PARAMETERS@", &parameters(model, &PLANT))
        .replace("@AHEAD_OF_PLANT@", ahead)
        .replace("@TORQUE_OUTPUT@", output)
        .replace("@TORQUE_EQUATION@", &equation)
        .replace("@TORQUE_WORDS@", words)
        .replace("@TORQUE@", torque)
        .replace("@READING@", reading)
        .replace("@VALID@", &validity(document))
}

/// Condition, in Modelica, that speed and torque are in range.
fn validity(document: &BenchModelDocument) -> String {
    let within = |name: &str, range: Option<Range>| {
        range.map(|(low, high)| format!("{name} >= {} and {name} <= {}", number(low), number(high)))
    };
    let validity = &document.validity;
    let conditions = [within("w_d", validity.dyno_speed_rad_s), within("T_d", validity.air_gap_torque_nm)];
    let conditions: Vec<String> = conditions.into_iter().flatten().collect();
    if conditions.is_empty() { "true".to_owned() } else { conditions.join(" and ") }
}

/// How a recorded demand becomes the one that the controller takes.
fn demand_lead(model: &BenchModel) -> String {
    numbers::demand_lead(model).map_or_else(String::new, |words| format!("; {words}"))
}

/// Samples that the speed error waits for its demand where they are more than τ_c. PI has its output after the demanded
/// torque should have it, so that the whole torque is demanded later, and the plant's delay is as much shorter.
fn waits_beyond_delay(model: &BenchModel) -> Option<usize> {
    let pi = model.torque_control.and(model.speed_controller)?;
    let wait = model.demand_lags().0.min(0).unsigned_abs();
    (wait as f64 - pi.delay_s / pi.sample_time_s > INSTANT).then_some(wait)
}

/// The speed controller, with its demand as late as the recordings show. Where the speed error waits for its demand,
/// the reading and the feed-forward of then go with it, and its output acts as much sooner after it.
fn controller(model: &BenchModel, pi: &PiController) -> String {
    let (in_error, feed_lag) = model.demand_lags();
    let (lag, wait) = (in_error.max(0).unsigned_abs(), in_error.min(0).unsigned_abs());
    let feed = model.feed_forward.is_some();
    let (feed_now, feed_start) = match feed {
        true => (format!("k * past_{feed_lag} + k_a * (past_{feed_lag} - past_{}) / T_s", feed_lag + 1), "k * w_start"),
        false => ("0.0".to_owned(), "0.0"),
    };
    let speed = "(unit = \"rad/s\", start = w_start, fixed = true)";
    let torque = format!("(unit = \"N.m\", start = {feed_start}, fixed = true)");
    let (reading, fed) = match wait {
        0 => ("w_d".to_owned(), "feed_forward".to_owned()),
        _ => (format!("read_{wait}"), format!("fed_{wait}")),
    };
    let oldest = lag.max(if feed { feed_lag + 1 } else { 0 });
    let waiting = (wait > 0).then_some(wait);
    let kept = [("past", Some(oldest), speed), ("read", waiting, speed), ("fed", waiting, &torque)];
    let kept = || kept.iter().filter_map(|(name, oldest, start)| Some((name, (*oldest)?, start)));
    let past: String = kept()
        .flat_map(|(name, oldest, start)| {
            (0..=oldest).map(move |back| format!("    discrete Real {name}_{back}{start};\n"))
        })
        .collect();
    let shift = |name: &str, oldest: usize| -> String {
        (1..=oldest).map(|back| format!("      {name}_{back} = pre({name}_{});\n", back - 1)).collect()
    };
    let readings = if wait > 0 { format!("      read_0 = w_d;\n{}", shift("read", wait)) } else { String::new() };
    let feeds = if wait > 0 { format!("      fed_0 = feed_forward;\n{}", shift("fed", wait)) } else { String::new() };
    let step = "pre(integrator) + K_i * T_s * error";
    let left_s = pi.delay_s - wait as f64 * pi.sample_time_s;
    let beyond = waits_beyond_delay(model);
    let demanded = match (left_s > 0.0, wait) {
        (false, _) if beyond.is_some() && feed => "pi_part + delay(feed_forward, T_ahead)".to_owned(),
        (false, _) => "pi_part + feed_forward".to_owned(),
        (true, 0) => "delay(pi_part, tau_c) + feed_forward".to_owned(),
        (true, wait) => format!("delay(pi_part, tau_c - {wait} * T_s) + feed_forward"),
    };
    let (integrator, limited) = match model.torque_limit_nm {
        Some(_) => (
            format!(
                "if abs(pi_part + {fed}) > T_limit and K_i * error * (pi_part + {fed}) > 0.0 then pre(integrator) else {step}"
            ),
            format!("max(-T_limit, min(T_limit, {demanded}))"),
        ),
        None => (step.to_owned(), demanded),
    };
    let ahead = |wait| {
        format!(
            "    parameter Real T_ahead(unit = \"s\") = {wait} * T_s - tau_c \"time that T_d_demand has waited of tau_t\";\n"
        )
    };
    CONTROL
        .replace("@FLANGE@", FLANGE)
        .replace("@OF_PLANT@", if beyond.is_some() { ", T_ahead = controller.T_ahead" } else { "" })
        .replace("@AHEAD_OF_CONTROLLER@", &beyond.map_or_else(String::new, ahead))
        .replace("@LATE@", if beyond.is_some() { ", T_ahead after it is due" } else { "" })
        .replace("@CONTROLLER_PARAMETERS@", &parameters(model, &CONTROLLER))
        .replace("@DEMAND_LEAD@", &demand_lead(model))
        .replace("@PAST_EQUATIONS@", &format!("{}{readings}", shift("past", oldest)))
        .replace("@PAST@", &past)
        .replace("@READING_IN_ERROR@", &reading)
        .replace("@LAG@", &lag.to_string())
        .replace("@FEED@", &feed_now)
        .replace("@FED_EQUATIONS@", &feeds)
        .replace("@FEED_START@", feed_start)
        .replace("@INTEGRATOR@", &integrator)
        .replace("@LIMITED@", &limited)
}

/// Equations, parameters with standard errors, range and origin.
fn documentation(document: &BenchModelDocument) -> String {
    let mut page = format!(
        "<p>The bench {}: two masses and a shaft. All numbers are in SI. T_d is positive when it brakes the dynamometer.</p>\n\
         <table border=\\\"1\\\">\n<tr><th></th><th></th><th>value</th><th>standard error</th><th>unit</th></tr>\n",
        html(&document.bench.name)
    );
    for one in numbers::all(&document.model) {
        let Some(value) = one.value else { continue };
        let error = one.parameter.and_then(|parameter| document.uncertainty.standard_error(parameter));
        let error = error.map_or_else(|| "exact".to_owned(), |(error, _)| format!("{error:.3e}"));
        let (unit, name, description) = (one.unit.plain(), one.name, html(one.description));
        let _ = writeln!(
            page,
            "<tr><td>{name}</td><td>{description}</td><td>{value:.6}</td><td>{error}</td><td>{unit}</td></tr>"
        );
    }
    page.push_str("</table>\n");
    if let Some(words) = numbers::demand_lead_sentence(&document.model) {
        let _ = writeln!(page, "<p>{words}</p>");
    }
    let range = |name: &str, unit: &str, range: Option<Range>| {
        range.map(|(low, high)| format!("{name} {low:.4} … {high:.4} {unit}"))
    };
    let validity = &document.validity;
    let ranges: Vec<String> = [
        range("w_d", "rad/s", validity.dyno_speed_rad_s),
        range("T_d", "Nm", validity.air_gap_torque_nm),
        range("frequency", "Hz", validity.frequency_hz),
    ]
    .into_iter()
    .flatten()
    .collect();
    if !ranges.is_empty() {
        let _ = writeln!(page, "<p>Range of the recordings: {}.</p>", ranges.join(", "));
    }
    let _ = write!(page, "<p>{}</p>", html(&written_by(document)));
    page
}
