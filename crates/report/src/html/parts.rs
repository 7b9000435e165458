//! Pieces several sections share: parameter tables, what is missing, where data came from.

use bench::study::{Estimate, Need, Parameter, Stretch, Validation};

use super::typeset::{prose, symbol};
use crate::wording::{self, number};
use page::markup;
use page::markup::Markup;

/// A number that must not break across lines.
pub(crate) fn unbroken(text: &str) -> Markup {
    markup!("<span class=\"n\">{}</span>", text)
}

/// A table with a caption; cells are rows of finished markup.
pub(crate) fn table(class: &str, heads: &[&str], rows: impl IntoIterator<Item = Vec<Markup>>) -> Markup {
    let heads: Markup = heads.iter().map(|head| markup!("<th scope=\"col\">{}</th>", prose(head))).collect();
    let rows: Markup = rows
        .into_iter()
        .map(|cells| {
            let cells: Markup = cells.iter().map(|cell| markup!("<td>{}</td>", cell)).collect();
            markup!("<tr>{}</tr>\n", cells)
        })
        .collect();
    markup!(
        "<div class=\"wide\"><table class=\"{}\"><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
        class,
        heads,
        rows
    )
}

/// The parameters of an estimate and numbers derived from them with their 95 % intervals, and below what they rest on.
pub(crate) fn parameters(estimate: &Estimate, derived: &[&Parameter]) -> Markup {
    let mut all = parameter_rows(&estimate.parameters.iter().chain(derived.iter().copied()).collect::<Vec<_>>());
    all.push(basis(estimate));
    all
}

/// A table of single parameters.
pub(crate) fn parameter_rows(parameters: &[&Parameter]) -> Markup {
    let rows = parameters.iter().map(|parameter| {
        vec![
            symbol(&parameter.symbol),
            prose(&parameter.name),
            unbroken(&number::parameter(parameter)),
            unbroken(&number::interval(parameter)),
        ]
    });
    table("parameters", &["", "Parameter", "Estimate", "95 % interval"], rows)
}

fn basis(estimate: &Estimate) -> Markup {
    let solution = match estimate.iterations {
        0 => "direct solution".to_owned(),
        1 => "1 iteration".to_owned(),
        n => format!("{n} iterations"),
    };
    let freedom = estimate.parameters.first().map(|p| p.degrees_of_freedom).filter(|f| f.is_finite());
    let freedom = freedom.map(|f| format!("{f:.0} degrees of freedom, ")).unwrap_or_default();
    markup!(
        "<p class=\"basis\">Estimated from {}. {}{}, condition number {}.</p>\n",
        stretches(&estimate.stretches),
        freedom,
        solution,
        unbroken(&number::significant_with_unit(estimate.condition, 3, "")),
    )
}

/// Stretches of recordings, in words.
pub(crate) fn stretches(stretches: &[Stretch]) -> Markup {
    let listed: Vec<Markup> = stretches.iter().map(stretch).collect();
    match listed.as_slice() {
        [] => markup!("data that were not stated"),
        [only] => only.clone(),
        [first, rest @ ..] => {
            let mut all = first.clone();
            rest.iter().for_each(|next| all.push(markup!("; {}", next)));
            all
        }
    }
}

/// One stretch, e.g. `bs.mf4, 10.0–60.0 s`.
pub(crate) fn stretch(stretch: &Stretch) -> Markup {
    markup!(
        "<span class=\"file\">{}</span>, {}",
        stretch.file,
        unbroken(&format!("{}–{} s", seconds(stretch.start_s), seconds(stretch.end_s)))
    )
}

fn seconds(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "?".to_owned() }
}

/// What stands in place of a part that was not estimated.
pub(crate) fn not_estimated(what: &str, needs: &[Need]) -> Markup {
    let needs: Markup = match needs {
        [] => markup!("<li>{}</li>", wording::needs(needs)),
        _ => needs.iter().map(|need| markup!("<li>{}</li>", prose(&wording::need(need)))).collect(),
    };
    markup!(
        "<div class=\"missing\"><p><strong>Not estimated.</strong> {}</p><p>It needs:</p><ul>{}</ul></div>\n",
        prose(what),
        needs
    )
}

/// The fit on a held-out stretch, as a sentence.
pub(crate) fn fit_line(validation: &Validation) -> Markup {
    markup!(
        "<p class=\"fit\">Fit on data the estimate has not seen ({}): <strong>{}</strong>, rms error {}.</p>\n",
        stretch(&validation.stretch),
        unbroken(&number::fit(validation.fit_percent)),
        unbroken(&number::significant_with_unit(validation.rms_error, 3, &validation.unit)),
    )
}

/// A plain sentence at the head of a part, and its equation.
pub(crate) fn lead(sentence: &str, equation: &str) -> Markup {
    markup!("<p class=\"lead\">{}</p>\n<p class=\"equation\">{}</p>\n", prose(sentence), Markup::raw(equation))
}
