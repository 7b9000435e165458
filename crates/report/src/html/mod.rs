//! The report as one self-contained HTML file.
//!
//! The order is the one in which a test engineer asks: the verdict, the block diagram, each part, the whole model,
//! replays, doubts, where it all came from. Style and plotting script stand in `assets/` and are put into the file.

mod diagnostics;
mod diagram;
mod methods;
mod parts;
mod plots;
mod provenance;
mod replays;
mod submodels;
mod typeset;
mod verdict;
mod whole;

use bench::Study;

use plot::markup;
use plot::markup::Markup;

const STYLE: &str = include_str!("../../assets/report.css");

/// The report of a study: one HTML file that needs no network, works on a screen and prints on A4.
pub fn html(study: &Study) -> String {
    let sections = [
        ("verdict", "Verdict", verdict::section(study)),
        ("diagram", "Block diagram", diagram::section(study)),
        ("timing", "Timing", submodels::timing(study)),
        ("speed-control", "Speed control", submodels::speed_controller(study)),
        ("feed-forward", "Feed-forward", submodels::feed_forward(study)),
        ("torque-control", "Torque control", submodels::torque_control(study)),
        ("shaft", "Shaft", submodels::shaft(study)),
        ("whole", "Whole model", whole::section(study)),
        ("replays", "Replays", replays::section(study)),
        ("findings", "Findings", diagnostics::section(study)),
        ("provenance", "Recordings and bench", provenance::section(study)),
        ("methods", "Methods", methods::section()),
    ];
    let contents: Markup =
        sections.iter().map(|(id, title, _)| markup!("<li><a href=\"#{}\">{}</a></li>", id, title)).collect();
    let body: Markup = sections.into_iter().map(|(id, title, content)| section(id, title, content)).collect();
    page(study, &contents, &body).into_string()
}

fn section(id: &str, title: &str, content: Markup) -> Markup {
    if id == "verdict" {
        return markup!("<section id=\"verdict\">{}</section>\n", content);
    }
    markup!("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title, content)
}

fn page(study: &Study, contents: &Markup, body: &Markup) -> Markup {
    markup!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"dynoid {}\">\n\
         <title>{} – bench model</title>\n<style>\n{}{}</style>\n</head>\n<body>\n\
         <nav aria-label=\"Contents\"><p class=\"brand\">dynoid</p><ol>{}</ol></nav>\n<main>\n{}\
         <noscript><p class=\"note\">The figures are drawn by a script in this file; allow scripts to see them.</p></noscript>\n\
         {}</main>\n<script>\n(function () {{\n\"use strict\";\n{}}})();\n</script>\n</body>\n</html>\n",
        study.provenance.version,
        study.bench.name,
        Markup::raw(STYLE),
        Markup::raw(plot::STYLE),
        contents,
        masthead(study),
        body,
        Markup::raw(plot::SCRIPT),
    )
}

fn masthead(study: &Study) -> Markup {
    let simulated = match study.provenance.seed {
        Some(seed) => markup!(" · <strong>simulated recordings</strong>, seed {}", seed.to_string()),
        None => Markup::default(),
    };
    let recordings = match study.recordings.len() {
        1 => "1 recording".to_owned(),
        n => format!("{n} recordings"),
    };
    markup!(
        "<header class=\"masthead\"><p class=\"kicker\">Bench model</p><h1>{}</h1>\
         <p class=\"sub\">{} · {} · dynoid {}{}</p></header>\n",
        study.bench.name,
        crate::wording::variant(study.bench.variant),
        recordings,
        study.provenance.version,
        simulated,
    )
}
