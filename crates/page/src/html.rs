//! Figures in a page: the element the script draws into, and a page that holds nothing but figures.

use crate::figure::Figure;
use crate::markup;
use crate::markup::{Markup, script_json};

/// The plotting script, to be put once into a page, after its figures.
pub const SCRIPT: &str = concat!(
    include_str!("../assets/scale.js"),
    include_str!("../assets/data.js"),
    include_str!("../assets/draw.js"),
    include_str!("../assets/interact.js"),
    include_str!("../assets/mount.js"),
);

/// The style of figures; the colours (`--measured`, …) are the page's to set.
pub const STYLE: &str = include_str!("../assets/plot.css");

/// Colours and type of a page of figures.
const PAGE_STYLE: &str = include_str!("../assets/page.css");

/// The element the script draws a figure into; title and caption are HTML already.
pub fn figure(figure: &Figure, title: &Markup, caption: &Markup) -> Markup {
    markup!(
        "<figure class=\"plot\"><p class=\"plot-title\">{}</p><script type=\"application/json\">{}</script>\
         <figcaption>{}</figcaption></figure>\n",
        title,
        script_json(figure),
        caption
    )
}

/// A page of figures: one file that needs no network.
pub fn page(title: &str, figures: &[Figure]) -> String {
    let plain = |text: &str| markup!("{}", text);
    let body: Markup = figures.iter().map(|f| figure(f, &plain(&f.title), &plain(&f.caption))).collect();
    markup!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <style>\n{}{}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n\
         <noscript><p>The figures are drawn by a script in this file; allow scripts to see them.</p></noscript>\n\
         {}</main>\n<script>\n(function () {{\n\"use strict\";\n{}}})();\n</script>\n</body>\n</html>\n",
        title,
        Markup::raw(PAGE_STYLE),
        Markup::raw(STYLE),
        title,
        body,
        Markup::raw(SCRIPT),
    )
    .into_string()
}
