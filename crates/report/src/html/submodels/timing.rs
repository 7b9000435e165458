//! Delays of the torque signals.

use bench::study::{Parameter, Part, SignalDelay, Study};

use crate::html::markup::{Markup, markup};
use crate::html::parts::{not_estimated, stretch, table, unbroken};
use crate::html::typeset::{prose, symbol};
use crate::wording::{number, role_name};

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
        ["", "Signal", "Behind T_d*", "Behind the bend of N_d", "Largest disagreement of the routes", "Measured in"];
    markup!(
        "<p class=\"lead\">{}</p>\n{}<p class=\"note\">{}</p>\n",
        prose(WHAT),
        table("timing", &heads, rows),
        prose(
            "Disagreement is the largest difference between the routes over its standard error; above about 3 the routes \
             contradict each other."
        )
    )
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

fn routes(routes: &[(String, f64)]) -> Markup {
    if routes.is_empty() {
        return markup!("<span class=\"none\">one route only</span>");
    }
    let listed: Vec<Markup> = routes
        .iter()
        .map(|(name, errors)| {
            let class = if *errors > 3.0 || errors.is_nan() { "n doubtful" } else { "n" };
            markup!("{} <span class=\"{}\">{} σ</span>", prose(name), class, number::significant(*errors, 2))
        })
        .collect();
    let mut all = Markup::default();
    for (at, item) in listed.iter().enumerate() {
        all.push(if at == 0 { item.clone() } else { markup!("<br>{}", item) });
    }
    all
}
