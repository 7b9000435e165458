//! A figure in a page: title, legend and caption as text of the page, and the drawing between them.

use super::samples::{Storage, UNPACKED};
use super::text::prose;
use crate::figure::{Figure, Layer};
use crate::markup;
use crate::markup::Markup;
use crate::prose::Prose;
use crate::svg;
use crate::thinned::{Place, groups, samples_drawn, thin};

/// Width of a figure across the page, CSS pixels.
pub(super) const WIDE: f64 = 860.0;
/// Width of a figure beside another one.
pub(super) const NARROW: f64 = 440.0;

/// Attribute that the style sheet has for all lines of a page.
const ROUND: &str = " stroke-linejoin=\"round\"";

/// How many points of a line a page has at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Points {
    /// In a drawing.
    pub(super) drawn: usize,
    /// For what a reader zooms to.
    pub(super) stored: Storage,
}

/// Title, tools, legend, drawing and caption; `number` is the figure's own in the page.
pub(super) fn figure(whole: &Figure, width: f64, number: usize, points: Points) -> Markup {
    let mut stored = whole.clone();
    thin(&mut stored, points.stored.most_of(whole));
    let mut drawn = stored.clone();
    thin(&mut drawn, points.drawn);
    let note = samples_drawn(&drawn, whole);
    let note = note.map_or_else(Markup::default, |note| markup!(" <span class=\"samples-drawn\">{}</span>", note));
    let packed: Vec<Place> = groups(&stored, UNPACKED).into_iter().flatten().collect();
    let drawing = svg::Drawing { whole, drawn: &drawn, packed: &packed, number };
    let text = |text: &str| prose(&if whole.symbols { text.into() } else { Prose::verbatim(text) });
    let samples = points.stored.packed(whole, &stored).map_or_else(Markup::default, |samples| {
        markup!(
            "<script type=\"text/plain\" class=\"samples\" data-groups=\"{}\">{}</script>",
            samples.header,
            samples.text
        )
    });
    markup!(
        "<figure class=\"plot\"><div class=\"plot-head\"><p class=\"plot-title\">{}</p></div><div class=\"legend\">{}</div>\
         <div class=\"stage\">{}</div><figcaption>{}{}</figcaption>{}</figure>\n",
        text(&whole.title),
        legend(&drawn, &text),
        Markup::raw(svg::embedded(drawing, width).replace(ROUND, "")),
        text(&whole.caption),
        note,
        samples
    )
}

fn legend(figure: &Figure, text: &dyn Fn(&str) -> Markup) -> Markup {
    let entry = |(name, layer): (&str, &Layer)| {
        markup!("<span class=\"entry\" data-name=\"{}\">{} {}</span> ", name, Markup::raw(svg::key(layer)), text(name))
    };
    svg::legend_entries(figure).into_iter().map(entry).collect()
}
