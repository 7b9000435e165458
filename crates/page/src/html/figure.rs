//! A figure in a page: title, legend and caption as text of the page, and the drawing between them.

use super::text::prose;
use crate::figure::{Figure, Layer};
use crate::markup;
use crate::markup::Markup;
use crate::prose::Prose;
use crate::svg;
use crate::thinned::thinned;

/// Width of a figure across the page, CSS pixels.
pub(super) const WIDE: f64 = 860.0;
/// Width of a figure beside another one.
pub(super) const NARROW: f64 = 440.0;

/// The figure with at most `most` points of a line; `number` is its own in the page.
pub(super) fn figure(figure: &Figure, width: f64, number: usize, most: usize) -> Markup {
    let figure = &thinned(figure, most);
    let text = |text: &str| prose(&if figure.symbols { text.into() } else { Prose::verbatim(text) });
    markup!(
        "<figure class=\"plot\"><p class=\"plot-title\">{}</p><div class=\"legend\">{}</div><div class=\"stage\">{}</div>\
         <figcaption>{}</figcaption></figure>\n",
        text(&figure.title),
        legend(figure, &text),
        Markup::raw(svg::embedded(figure, width, number)),
        text(&figure.caption)
    )
}

fn legend(figure: &Figure, text: &dyn Fn(&str) -> Markup) -> Markup {
    let entry = |(name, layer): (&str, &Layer)| {
        markup!("<span class=\"entry\" data-name=\"{}\">{} {}</span> ", name, Markup::raw(svg::key(layer)), text(name))
    };
    svg::legend_entries(figure).into_iter().map(entry).collect()
}
