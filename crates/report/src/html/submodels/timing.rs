//! Delays of the torque signals.

use bench::Role;
use bench::study::{DelayRoute, Parameter, Part, SignalDelay, Study};

use crate::html::parts::{not_estimated, parameters, stretch, table, unbroken};
use crate::html::typeset::{prose, symbol};
use crate::wording::{number, role, role_name};
use page::markup;
use page::markup::Markup;

const WHAT: &str = "How late each torque signal is, against the torque demand T_d* and against the moment the \
                    dynamometer speed N_d begins to bend.";

/// The timing table.
pub(crate) fn timing(study: &Study) -> Markup {
    let timing = match &study.timing {
        Part::Estimated(timing) => timing,
        Part::NotEstimated { needs } => return not_estimated(WHAT, needs),
    };
    let rows = timing.delays.iter().map(row);
    let heads =
        ["", "Signal", "Behind T_d*", "Behind the bend of N_d", "The same delay by other routes", "Measured in"];
    let details: Markup = timing.delays.iter().map(details).collect();
    markup!(
        "<p class=\"lead\">{}</p>\n{}<p class=\"note\">{}</p>\n{}",
        prose(WHAT),
        table("timing", &heads, rows),
        prose(
            "Routes without a model see the mean delay over the demand’s spectrum; they agree with the first column to \
             about a tenth of a millisecond at best, the correlation peak to about one."
        ),
        details
    )
}

/// What is known of why a signal is late: the system's moving average, the load cell's own dynamics.
fn details(delay: &SignalDelay) -> Markup {
    let mut all = Markup::default();
    if let Some(length) = delay.moving_average_length {
        all.push(markup!(
            "<p>{} is reproduced by a moving average over {} samples of {}.</p>\n",
            symbol(delay.role.symbol()),
            length,
            symbol(Role::DynoSpeed.symbol())
        ));
    }
    if let Some(dynamics) = &delay.dynamics {
        all.push(markup!("<h3>Dynamics of the {}</h3>\n{}", prose(&role(delay.role)), parameters(dynamics, &[])));
    }
    all
}

fn row(delay: &SignalDelay) -> Vec<Markup> {
    vec![
        symbol(delay.role.symbol()),
        markup!("{}", role_name(delay.role)),
        delay_cell(delay.against_demand.as_ref()),
        delay_cell(delay.against_speed_bend.as_ref()),
        routes(&delay.routes),
        stretch(&delay.stretch),
    ]
}

fn delay_cell(parameter: Option<&Parameter>) -> Markup {
    match parameter {
        Some(parameter) => unbroken(&number::parameter(parameter)),
        None => markup!("<span class=\"none\">–</span>"),
    }
}

fn routes(routes: &[DelayRoute]) -> Markup {
    if routes.is_empty() {
        return markup!("<span class=\"none\">one route only</span>");
    }
    let listed: Vec<Markup> = routes
        .iter()
        .map(|r| markup!("{} <span class=\"n\">{}</span>", prose(&r.name), number::duration(r.delay_s)))
        .collect();
    let mut all = Markup::default();
    for (at, item) in listed.iter().enumerate() {
        all.push(if at == 0 { item.clone() } else { markup!("<br>{}", item) });
    }
    all
}
