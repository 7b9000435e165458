//! The page of documentation of a linear model.

use super::super::csv;
use super::super::documentation::{HEAD, STYLE};
use super::description::{Description, Role, Variable};
use crate::xml::escaped;

/// `documentation/index.html`.
pub(super) fn page(description: &Description<'_>) -> String {
    let title = escaped(&description.name);
    let rows = |role| -> String { description.of_role(role).map(|(_, variable)| row(variable)).collect() };
    let (inputs, outputs, initial) = (rows(Role::Input), rows(Role::Output), rows(Role::Initial));
    let (sentence, tool) = (escaped(&description.sentence()), escaped(&description.tool));
    let draws = description.numbers.draws.len();
    let step = csv::number(description.numbers.sample_time_s);
    let levels = description.levels.as_ref().map_or_else(String::new, |words| format!("<p>{}</p>\n", escaped(words)));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n<p>{sentence}.</p>\n<p>Made by {tool}.</p>\n\
         <h2>Equations</h2>\n<p>x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k), every {step} s. The matrices are in \
         <code>resources/linear.txt</code>.</p>\n{levels}\
         <h2>Time</h2>\n<p>A step may have any length. The model takes its inputs at its samples. Between them the outputs are \
         those of the last sample. In Model Exchange every sample is a time event.</p>\n\
         <h2>Uncertainty</h2>\n<p>The FMU holds {draws} draws of the model from its covariance. Set <code>draw</code> to 0 for \
         the estimate, or to k for the k-th draw.</p>\n\
         <h2>Inputs</h2>\n{HEAD}{inputs}</table>\n<h2>Outputs</h2>\n{HEAD}{outputs}</table>\n\
         <h2>Parameters</h2>\n{HEAD}{initial}</table>\n</body>\n</html>\n"
    )
}

fn row(variable: &Variable) -> String {
    let start = if variable.role == Role::Output { "" } else { "0" };
    let (name, unit) = (escaped(&variable.name), escaped(&variable.unit));
    format!(
        "<tr><td><code>{name}</code></td><td>{start}</td><td>{unit}</td><td>{}</td></tr>\n",
        escaped(&variable.description)
    )
}
