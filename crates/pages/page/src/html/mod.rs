//! A page as one HTML file that needs no network, works on a screen and prints on A4. Figures are complete without
//! scripts; one script makes them interactive.

mod blocks;
mod figure;
mod samples;
mod text;

use crate::logo::Logo;
use crate::markup;
use crate::markup::Markup;
use crate::model::{Block, Page};
use crate::thinned::most_points;

use blocks::Renderer;
use figure::Points;
use samples::Storage;
use text::prose;

const STYLE: &str = concat!(
    include_str!("../../assets/page.css"),
    include_str!("../../assets/drawing.css"),
    include_str!("../../assets/plot.css")
);

/// Characters of all samples in a page, and of all of the page where that leaves fewer samples.
const SAMPLES_ROOM: usize = 1_300_000;
const PAGE_ROOM: usize = 2_850_000;

/// Script that makes figures interactive; it is once in a page, after them.
const SCRIPT: &str = concat!(
    include_str!("../../assets/scale.js"),
    include_str!("../../assets/view.js"),
    include_str!("../../assets/samples.js"),
    include_str!("../../assets/zoom.js"),
    include_str!("../../assets/interact.js"),
    include_str!("../../assets/save.js"),
    include_str!("../../assets/tools.js"),
    include_str!("../../assets/mount.js"),
);

/// The page as one HTML file. `generator` names the program and its version.
pub fn html(page: &Page, generator: &str) -> String {
    let body = body(page);
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

/// Content below the title, with as many samples as have room.
fn body(page: &Page) -> Markup {
    let figures = page.figures();
    let drawn = most_points(&figures);
    let within = |room: usize| {
        let stored = Storage::within(room, &figures, drawn);
        Renderer::new(Points { drawn, stored }).blocks(&page.blocks)
    };
    let body = within(SAMPLES_ROOM);
    match body.as_str().len().saturating_sub(PAGE_ROOM) {
        0 => body,
        excess => within(SAMPLES_ROOM.saturating_sub(excess)),
    }
}

/// Texts at the edges of each printed page.
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
    let picture = |logo: &Logo| markup!("<img class=\"logo\" src=\"{}\" alt=\"Logo\">", logo.data_uri());
    let logo: Markup = page.logo.iter().map(picture).collect();
    markup!("<header class=\"masthead\">{}<h1>{}</h1>{}</header>\n", logo, page.title, subtitle)
}

/// One entry a section.
fn contents(blocks: &[Block]) -> Markup {
    let entry = |(id, title)| markup!("<li><a href=\"#{}\">{}</a></li>", id, title);
    blocks.iter().filter_map(Block::as_section).map(entry).collect()
}
