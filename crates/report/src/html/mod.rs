//! The report as one self-contained HTML file.
//!
//! The order is the one in which a test engineer asks: the verdict, what is known and how well, the block diagram, what was
//! recorded, each part, the whole model, replays, doubts, where it all came from, by which methods. Style and plotting script stand in `assets/` and are put into the file.

mod analyses;
mod diagnostics;
mod diagram;
mod known;
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
use bench::study::Analyses;

use page::markup;
use page::markup::Markup;

const STYLE: &str = include_str!("../../assets/report.css");

/// The report of a study: one HTML file that needs no network, works on a screen and prints on A4.
pub fn html(study: &Study) -> String {
    document(study, None)
}

/// The same report with all analyses of the recordings, each at its place.
pub fn full_html(study: &Study, analyses: &Analyses) -> String {
    document(study, Some(analyses))
}

fn document(study: &Study, analyses: Option<&Analyses>) -> String {
    let sections = sections(study, analyses);
    let contents: Markup =
        sections.iter().map(|(id, title, _)| markup!("<li><a href=\"#{}\">{}</a></li>", id, title)).collect();
    let body: Markup = sections.into_iter().map(|(id, title, content)| section(id, title, content)).collect();
    page(study, &contents, &body).into_string()
}

/// The sections in the order in which an engineer asks; those that only analyses fill are left out without them.
fn sections(study: &Study, analyses: Option<&Analyses>) -> Vec<(&'static str, &'static str, Markup)> {
    let with = |mut own: Markup, more: &dyn Fn(&Analyses) -> Markup| {
        analyses.iter().for_each(|found| own.push(more(found)));
        own
    };
    let only = |id, title, content: &dyn Fn(&Analyses) -> Markup| analyses.map(|found| (id, title, content(found)));
    let all = [
        Some(("verdict", "Verdict", verdict::section(study))),
        Some(("known", "What is known", known::section(study, analyses))),
        Some(("diagram", "Block diagram", diagram::section(study))),
        only("recorded", "What was recorded", &|found| analyses::courses(&found.courses)),
        only("lines", "Lines", &|found| analyses::lines(&found.lines, &found.over_speed)),
        Some(("timing", "Timing", with(submodels::timing(study), &|found| analyses::step(found.step.as_ref())))),
        only("torque-signals", "Torque signals", &|found| analyses::torque(&found.torque_signals)),
        Some((
            "speed-control",
            "Speed control",
            with(submodels::speed_controller(study), &|found| {
                analyses::controller(&found.speed_control, found.pi_study.as_ref())
            }),
        )),
        Some((
            "feed-forward",
            "Feed-forward",
            with(submodels::feed_forward(study), &|found| analyses::feed_forward(&found.speed_control)),
        )),
        Some((
            "torque-control",
            "Torque control",
            with(submodels::torque_control(study), &|found| analyses::inverter(&found.torque_control)),
        )),
        only("friction", "Friction", &|found| analyses::friction(&found.friction, &study.bench)),
        Some(("shaft", "Shaft", with(submodels::shaft(study), &|found| analyses::shaft(&found.shaft)))),
        only("engine-torque", "Engine torque", &|found| analyses::engine(&found.engine_torque)),
        Some(("whole", "Whole model", whole::section(study))),
        only("next", "What to record next", &|found| analyses::next(&found.next)),
        Some(("replays", "Replays", replays::section(study))),
        Some(("findings", "Findings", diagnostics::section(study))),
        Some(("provenance", "Recordings and bench", provenance::section(study))),
        Some(("methods", "Methods", methods::section())),
    ];
    all.into_iter().flatten().collect()
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
        Markup::raw(page::STYLE),
        contents,
        masthead(study),
        body,
        Markup::raw(page::SCRIPT),
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
