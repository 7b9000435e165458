//! A page as one HTML file that needs no network, works on a screen and prints on A4. Figures are complete without
//! scripts; one script makes them interactive.

mod blocks;
mod figure;
mod text;

use crate::markup;
use crate::markup::Markup;
use crate::model::{Block, Page};

use blocks::Renderer;
use text::prose;

const STYLE: &str = concat!(include_str!("../../assets/page.css"), include_str!("../../assets/plot.css"));

/// What makes figures interactive; it stands once in a page, after them.
const SCRIPT: &str = concat!(
    include_str!("../../assets/scale.js"),
    include_str!("../../assets/view.js"),
    include_str!("../../assets/interact.js"),
    include_str!("../../assets/mount.js"),
);

/// The page as one HTML file. `generator` names the program and its version.
pub fn html(page: &Page, generator: &str) -> String {
    let body = Renderer::default().blocks(&page.blocks);
    let contents = contents(&page.blocks);
    let (class, nav) = match contents.is_empty() {
        true => ("plain", Markup::default()),
        false => (
            "parted",
            markup!(
                "<nav aria-label=\"Contents\"><p class=\"brand\">{}</p><ol>{}</ol></nav>\n",
                brand(generator),
                contents
            ),
        ),
    };
    markup!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"generator\" content=\"{}\">\n\
         <title>{}</title>\n<style>\n{}</style>\n</head>\n<body class=\"{}\">\n{}<main>\n{}{}</main>\n\
         <script>\n(function () {{\n\"use strict\";\n{}}})();\n</script>\n</body>\n</html>\n",
        generator,
        page.title,
        Markup::raw(STYLE),
        class,
        nav,
        masthead(page),
        body,
        Markup::raw(SCRIPT),
    )
    .into_string()
}

fn brand(generator: &str) -> &str {
    generator.split(' ').next().unwrap_or(generator)
}

fn masthead(page: &Page) -> Markup {
    let subtitle = match page.subtitle.is_empty() {
        true => Markup::default(),
        false => markup!("<p class=\"sub\">{}</p>", prose(&page.subtitle)),
    };
    markup!("<header class=\"masthead\"><h1>{}</h1>{}</header>\n", page.title, subtitle)
}

/// One entry a section.
fn contents(blocks: &[Block]) -> Markup {
    let entry = |block: &Block| match block {
        Block::Section { id, title, .. } => Some(markup!("<li><a href=\"#{}\">{}</a></li>", id, title)),
        _ => None,
    };
    blocks.iter().filter_map(entry).collect()
}
