//! `dynoid friction`: friction and inertia of the dynamometer.

use bench::Experiment;
use bench::friction::{Friction, FrictionOptions, Inertia, estimate};
use bench::units::RPM_RAD_S;
use page::{Align, Table, Tone};
use report::friction::{StatedInertia, doubts, figures, remarks, terms, torque_used};
use report::wording::number;
use serde_json::json;

use super::experiments::{self, print_parameters};
use super::identify::judge::{picture, written};
use crate::cli::friction::FrictionArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &FrictionArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut used: Vec<Experiment> = Vec::new();
    let mut options = FrictionOptions { inertia_kg_m2: f64::NAN, slowest_rad_s: None, torque_limit_nm: None };
    let mut stated = StatedInertia { kg_m2: f64::NAN, uncertainty_percent: None };
    let all_named = !arguments.given.recordings.is_empty();
    let refused =
        experiments::each((&arguments.given, &arguments.result), "reading", terminal, |bench, experiment| {
            let slowest_rad_s = arguments.slowest.map(|rpm| rpm * RPM_RAD_S);
            options = FrictionOptions { slowest_rad_s, ..FrictionOptions::of(bench) };
            stated = StatedInertia {
                kg_m2: bench.dynamometer_inertia_kg_m2,
                uncertainty_percent: bench.dynamometer_inertia_uncertainty_percent,
            };
            // Of a whole campaign those without shaft are meant; a recording that is named is meant whatever it is.
            if all_named || experiment.label.is_without_shaft() {
                used.push(experiment);
            }
        })?;
    let found = estimate(&used.iter().collect::<Vec<_>>(), options).map_err(|source| CliError::Friction { source })?;
    picture(&arguments.result, "Friction of the dynamometer", || figures(&found))?;
    let doubts = doubts(&found, stated);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    if arguments.result.json {
        terminal.json(&json!({
            "inertia": found.inertia, "friction": found.friction, "per_inertia": found.per_inertia,
            "candidates": found.candidates, "curve": found.curve,
            "used": found.run_outs.iter().map(|r| json!({"stretch": r.stretch, "torque": r.torque, "left_out": r.left_out})).collect::<Vec<_>>(),
            "doubts": doubts, "refused": refused,
        }))?;
    } else if !terminal.is_quiet() {
        print(&found, terminal);
        written(&arguments.result.plot, terminal);
    }
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

fn print(found: &Friction, terminal: &mut Terminal) {
    let inertia = match &found.inertia {
        Inertia::Estimated { inertia, delay } => vec![inertia.as_ref(), delay.as_ref()],
        Inertia::Stated { .. } => Vec::new(),
    };
    let friction = found.friction.parameters.iter().chain(&found.per_inertia.parameters);
    terminal.heading("Friction of the dynamometer, without shaft", Tone::Strong);
    print_parameters(inertia.into_iter().chain(friction), terminal);
    terminal.gap();
    candidates(found, terminal);
    for point in [found.curve.first(), found.curve.get(found.curve.len() / 2), found.curve.last()].into_iter().flatten()
    {
        let torque = number::plus_minus(point.torque_nm, point.half_width_nm, "Nm");
        terminal.line(&format!("T_fric at {}: {torque} (95 %)", number::rpm(point.speed_rad_s)));
    }
    for run_out in &found.run_outs {
        let stretch = &run_out.stretch;
        let lost = match run_out.left_out {
            0 => String::new(),
            count => format!(", {count} samples that drop out left out"),
        };
        let ends = [stretch.start_s, stretch.end_s].map(|s| number::significant(s, 4));
        let torque = torque_used(run_out.torque);
        terminal.line(&format!("used: {}, {} to {} s, {torque}{lost}", stretch.file, ends[0], ends[1]));
    }
    remarks(found).iter().for_each(|remark| terminal.note(remark));
}

fn candidates(found: &Friction, terminal: &mut Terminal) {
    let columns = [("terms", Align::Left), ("BIC above the best", Align::Right), ("", Align::Left)];
    let mut table = Table::new(&columns);
    for candidate in &found.candidates {
        let above = number::significant(candidate.bic_above_best, 3);
        let chosen = if candidate.chosen { "chosen" } else { "" };
        table.row([terms(&candidate.terms).into(), above.into(), chosen.into()]);
    }
    terminal.table(&table);
    terminal.gap();
}
