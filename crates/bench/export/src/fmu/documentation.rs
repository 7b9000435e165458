//! The page of documentation in an FMU.

use super::csv;
use super::description::Description;
use super::variables::{Kind, Role, Variable};
use crate::xml::escaped;

/// `documentation/index.html`.
pub(super) fn page(description: &Description<'_>) -> String {
    let title = escaped(&description.document.bench.name);
    let rows = |wanted: fn(&Variable) -> bool| -> String {
        description.variables.iter().filter(|variable| wanted(variable)).map(row).collect()
    };
    let inputs = rows(|variable| variable.role == Role::Input);
    let outputs = rows(Variable::is_output);
    let parameters = rows(Variable::is_parameter);
    let states = rows(|variable| variable.role == Role::State);
    let draws = description.numbers.draws.len();
    let lead = crate::numbers::demand_lead_sentence(&description.document.model);
    let lead = lead.map_or_else(String::new, |words| format!("<p>{}</p>\n", escaped(&words)));
    let (tool, date) = (escaped(&description.tool()), escaped(&description.document.provenance.date));
    let made = format!("<p>Made by {tool} from a model of {date}.</p>\n");
    let validity = escaped(&description.validity());
    let head =
        format!("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n");
    let sentence = escaped(&description.sentence());
    let first = format!("<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p>{sentence}.</p>\n{made}");
    format!(
        "{head}{first}\
         <h2>Equations</h2>\n{EQUATIONS}\
         <h2>Range of validity</h2>\n<p>{validity}.</p>\n<p>The output <code>valid</code> is false when N<sub>d</sub> or \
         T<sub>d</sub> was outside this range in the last step. The first time there is one log message. The runtime cannot judge \
         the frequency.</p>\n\
         <h2>Uncertainty</h2>\n<p>The FMU holds {draws} draws of the parameters from their covariance. Set <code>draw</code> to 0 for \
         the estimate, or to k for the k-th draw. A parameter that is set to another value than the estimate keeps that \
         value.</p>\n\
         <h2>Time</h2>\n{TIME}{lead}\
         <h2>Inputs</h2>\n{HEAD}{inputs}</table>\n<h2>Outputs</h2>\n{HEAD}{outputs}</table>\n\
         <h2>Parameters</h2>\n{HEAD}{parameters}</table>\n<h2>States</h2>\n{HEAD}{states}</table>\n</body>\n</html>\n"
    )
}

pub(super) const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:52rem;margin:2rem auto;padding:0 1rem;color:#1c2733}\
    h1,h2{line-height:1.2}table{border-collapse:collapse;width:100%}td,th{text-align:left;padding:.25rem .75rem .25rem 0;\
    border-bottom:1px solid #d5dbe1;vertical-align:top}td:nth-child(2){text-align:right;font-variant-numeric:tabular-nums}\
    code{font-family:ui-monospace,monospace}";

pub(super) const HEAD: &str = "<table>\n<tr><th>Name</th><th>Start</th><th>Unit</th><th>Meaning</th></tr>\n";

const EQUATIONS: &str = "<p>J<sub>d</sub> dω<sub>d</sub>/dt = T<sub>shaft</sub> − T<sub>d</sub>, \
    J<sub>e</sub> dω<sub>e</sub>/dt = T<sub>e</sub> − T<sub>shaft</sub>, \
    T<sub>shaft</sub> = K Δθ + B (ω<sub>e</sub> − ω<sub>d</sub>). T<sub>d</sub> is positive when it brakes.</p>\n\
    <p>Speed control: T<sub>d</sub>* is the output of a PI controller on the encoder’s speed, plus the feed-forward \
    k N<sub>d</sub>* + k<sub>a</sub> dN<sub>d</sub>*/dt. The controller runs every T<sub>s</sub>. T<sub>d</sub>* is limited, and the \
    integrator rests at the limit. Torque control: T<sub>d</sub> follows T<sub>d</sub>* after tau<sub>t</sub> through a/(s + a).</p>\n\
    <p>Control of the shaft torque is no part of the model.</p>\n";

const TIME: &str = "<p>Co-Simulation is exact for any step, also between the samples of the controller. Inputs act from the start of a \
    step. In Model Exchange every sample of the controller is a time event. Outputs of the controller and the encoders are those of \
    the last sample.</p>\n";

fn row(variable: &Variable) -> String {
    let (start, unit) = match variable.kind {
        Kind::Real(unit, start, _) => (start.map_or_else(String::new, csv::number), unit.name),
        Kind::ControlMode(start) => (start.to_string(), ""),
        Kind::Integer(_) => ("0".to_owned(), ""),
        Kind::Boolean => (String::new(), ""),
    };
    let (name, meaning) = (escaped(&variable.name), escaped(&variable.description));
    format!("<tr><td><code>{name}</code></td><td>{start}</td><td>{unit}</td><td>{meaning}</td></tr>\n")
}
