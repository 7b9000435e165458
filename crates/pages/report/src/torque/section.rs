//! Delays of the torque signals.

use rig::Role;
use rig::results::{DelayRoute, Outcome, Parameter, SignalDelay};
use study::Study;

use page::{Block, Blocks, Cell, Prose, Table};

use crate::estimates::{not_estimated, parameters, stretch};
use crate::wording::{number, role, role_name};

const WHAT: &str = "How late each torque signal is behind the torque demand T_d*, and behind the torque itself. The course of N_d \
                    bends at the moment at which the torque acts.";

/// The timing table.
pub(crate) fn timing(study: &Study) -> Blocks {
    let timing = match &study.timing {
        Outcome::Estimated(timing) => timing,
        Outcome::NotEstimated { needs } => return not_estimated(WHAT, needs),
    };
    let rows = timing.delays.iter().map(row);
    let heads =
        ["", "Signal", "Behind T_d*", "Behind the bend of N_d", "The first delay by other methods", "Measured in"];
    let mut all = Blocks::from(vec![
        Block::lead(WHAT),
        Block::Table(Table::of_text(&heads).with_rows(rows)),
        Block::note(
            "Methods without a model see the mean delay over the demand’s spectrum. They agree with the first column to about a \
             tenth of a millisecond at best, the correlation peak to about one.",
        ),
    ]);
    timing.delays.iter().for_each(|delay| all.push(details(delay)));
    all
}

/// Reasons known why a signal is late: the system's moving average, the load cell's own dynamics.
fn details(delay: &SignalDelay) -> Blocks {
    let mut all = Blocks::default();
    if let Some(length) = delay.moving_average_length {
        all.push(Block::paragraph(format!(
            "{} is reproduced by a moving average over {length} samples of {}.",
            delay.role.symbol(),
            Role::DynoSpeed.symbol()
        )));
    }
    if let Some(dynamics) = &delay.dynamics {
        all.push(Block::heading(format!("Dynamics of the {}", role(delay.role))));
        all.push(parameters(dynamics, &[]));
    }
    all
}

fn row(delay: &SignalDelay) -> Vec<Cell> {
    vec![
        Prose::symbol(delay.role.symbol()).into(),
        role_name(delay.role).into(),
        delay_cell(delay.against_demand.as_ref()),
        delay_cell(delay.against_speed_bend.as_ref()),
        routes(&delay.routes).into(),
        stretch(&delay.stretch).into(),
    ]
}

fn delay_cell(parameter: Option<&Parameter>) -> Cell {
    match parameter {
        Some(parameter) => number::quantity(parameter).into(),
        None => "–".into(),
    }
}

fn routes(routes: &[DelayRoute]) -> String {
    if routes.is_empty() {
        return "one method only".to_owned();
    }
    let listed: Vec<String> = routes.iter().map(|r| format!("{} {}", r.name, number::duration(r.delay_s))).collect();
    listed.join("; ")
}
