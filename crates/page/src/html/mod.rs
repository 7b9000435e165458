//! A page as one HTML file that needs no network, works on a screen and prints on A4. Figures are complete without
//! scripts; one script makes them interactive.

mod blocks;
mod figure;
mod text;

use crate::figure::MAX_POINTS;
use crate::markup;
use crate::markup::Markup;
use crate::model::{Block, Page};

use blocks::Renderer;
use text::prose;

const STYLE: &str = concat!(include_str!("../../assets/page.css"), include_str!("../../assets/plot.css"));

/// Points of all lines of a page.
const PAGE_POINTS: usize = 130_000;
/// Points of a line in a page of very many figures.
const FEWEST_POINTS: usize = 350;

/// What makes figures interactive; it stands once in a page, after them.
const SCRIPT: &str = concat!(
    include_str!("../../assets/scale.js"),
    include_str!("../../assets/view.js"),
    include_str!("../../assets/interact.js"),
    include_str!("../../assets/mount.js"),
);

/// The page as one HTML file. `generator` names the program and its version.
pub fn html(page: &Page, generator: &str) -> String {
    let body = Renderer::new(most_points(page)).blocks(&page.blocks);
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
         <title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body class=\"{}\">\n{}<main>\n{}{}</main>\n\
         <script>\n(function () {{\n\"use strict\";\n{}}})();\n</script>\n</body>\n</html>\n",
        generator,
        page.title,
        Markup::raw(STYLE),
        Markup::raw(paper(&page.running_head)),
        class,
        nav,
        masthead(page),
        body,
        Markup::raw(SCRIPT),
    )
    .into_string()
}

/// Points of a line, so that a page of many figures stays small: about ten bytes are written for each.
fn most_points(page: &Page) -> usize {
    let lengths: Vec<usize> = page.figures().iter().flat_map(|figure| figure.line_lengths()).collect();
    let total = |most: usize| lengths.iter().map(|length| (*length).min(most)).sum::<usize>();
    [MAX_POINTS, 3000, 2000, 1500, 1000, 700, 500]
        .into_iter()
        .find(|most| total(*most) <= PAGE_POINTS)
        .unwrap_or(FEWEST_POINTS)
}

/// What each printed page has at its edges.
fn paper(running_head: &str) -> String {
    let is_plain = |c: &char| !matches!(c, '"' | '\\' | '<' | '>');
    let head: String = crate::safe(running_head).chars().filter(is_plain).collect();
    format!(
        "@page {{ @top-left {{ content: \"{head}\"; font-size: 8pt; }} \
         @bottom-right {{ content: \"page \" counter(page) \" of \" counter(pages); font-size: 8pt; }} }}\n"
    )
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
