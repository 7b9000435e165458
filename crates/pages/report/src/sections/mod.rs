//! The report of a study as a page.
//!
//! The order is the one in which a test engineer asks: the verdict, what is known and how well, the block diagram, what
//! was recorded, each part, the whole model, replays, doubts, where it all came from, by which methods.

pub(crate) mod diagnostics;
mod diagram;
mod foundation;
mod identity;
mod known;
mod methods;
mod provenance;
mod recorded;
pub(crate) mod replays;
pub(crate) mod verdict;
mod whole;

use rig::results::Part;
use study::{Analyses, Origin, Study};

use page::{Block, Blocks, Figure, Page};

use crate::{controller, engine, friction, lines, next, shaft, torque, torque_control, wording};

/// The report of a study.
pub fn study(study: &Study, origin: &Origin) -> Page {
    page(study, origin, None)
}

/// The same report with all analyses of the recordings, each at its place.
pub fn full_study(study: &Study, origin: &Origin, analyses: &Analyses) -> Page {
    page(study, origin, Some(analyses))
}

/// The answer of the report on a page of its own.
pub fn summary_page(study: &Study, origin: &Origin) -> Page {
    Page {
        subtitle: identity::subtitle(study, origin),
        running_head: identity::running_head(study, origin),
        ..Page::new(identity::title(study), on_one_page(study).into_vec())
    }
}

/// The answer, the rules that it follows, and what is not known.
fn on_one_page(study: &Study) -> Blocks {
    let mut all = verdict::answer(study);
    all.push(verdict::rules(study));
    all.push(known::not_known(study));
    all.push(foundation::signatures(study));
    all
}

fn page(study: &Study, origin: &Origin, analyses: Option<&Analyses>) -> Page {
    let section = |(id, title, content): (&str, &str, Blocks)| Block::section(id, title, content.into_vec());
    let blocks = sections(study, origin, analyses).into_iter().map(section).collect();
    let page = Page {
        subtitle: identity::subtitle(study, origin),
        running_head: identity::running_head(study, origin),
        ..Page::new(identity::title(study), blocks)
    };
    if study.lacks_series() { page.with_remarks_for_empty_figures(&left_out) } else { page }
}

/// In place of a figure whose curves are in a table that was not read.
fn left_out(figure: &Figure) -> String {
    format!("The figure “{}” is left out: its curves are in the table of series beside study.json.", figure.title)
}

/// The sections in the order in which an engineer asks; those that only analyses fill are left out without them.
fn sections(study: &Study, origin: &Origin, analyses: Option<&Analyses>) -> Vec<(&'static str, &'static str, Blocks)> {
    let with = |mut own: Blocks, more: &dyn Fn(&Analyses) -> Blocks| {
        analyses.iter().for_each(|found| own.push(folded(more(found))));
        own
    };
    // Of a part with an error no analysis is shown: its numbers would be those that the error concerns.
    let unless = |part: Part, own: Blocks, more: &dyn Fn(&Analyses) -> Blocks| match study.is_struck(part) {
        true => own,
        false => with(own, more),
    };
    let only =
        |id, title, content: &dyn Fn(&Analyses) -> Blocks| analyses.map(|found| (id, title, folded(content(found))));
    let only_unless = |part: Part, id, title, content: &dyn Fn(&Analyses) -> Blocks| match study.is_struck(part) {
        true => analyses.map(|_| (id, title, struck(part))),
        false => only(id, title, content),
    };
    let all = [
        Some(("verdict", "Verdict", verdict::section(study))),
        Some(("known", "What is known", known::section(study, analyses))),
        Some(("diagram", "Block diagram", diagram::section(study))),
        only("recorded", "What was recorded", &|found| recorded::courses(&found.courses)),
        only("lines", "Lines", &|found| lines::analysis(&found.lines, &found.over_speed)),
        Some(("timing", "Timing", with(torque::timing(study), &|found| recorded::step(found.step.as_ref())))),
        only_unless(Part::TorqueControl, "torque-signals", "Torque signals", &|found| {
            torque::analysis(&found.torque_signals)
        }),
        Some((
            "speed-control",
            "Speed control",
            unless(Part::SpeedController, controller::section(study), &|found| {
                controller::analysis(&found.speed_control, found.pi_study.as_ref())
            }),
        )),
        Some((
            "feed-forward",
            "Feed-forward",
            unless(Part::FeedForward, controller::feed_forward_section(study), &|found| {
                controller::feed_forward_analysis(&found.speed_control)
            }),
        )),
        Some((
            "torque-control",
            "Torque control",
            unless(Part::TorqueControl, torque_control::section(study), &|found| {
                torque_control::analysis_in_report(&found.torque_control)
            }),
        )),
        only("friction", "Friction", &|found| friction::analysis(&found.friction, &study.bench)),
        Some(("shaft", "Shaft", unless(Part::Shaft, shaft::section(study), &|found| shaft::analysis(&found.shaft)))),
        only_unless(Part::Whole, "engine-torque", "Engine torque", &|found| engine::analysis(&found.engine_torque)),
        Some(("whole", "Whole model", whole::section(study, origin))),
        only_unless(Part::Whole, "next", "What to record next", &|found| next::analysis(&found.next)),
        Some(("replays", "Replays", replays::section(study))),
        Some(("findings", "Findings", diagnostics::section(study))),
        Some(("provenance", "Recordings and bench", provenance::section(study, origin))),
        Some(("methods", "Methods", methods_folded())),
    ];
    all.into_iter().flatten().collect()
}

/// In place of an analysis whose numbers an error concerns.
fn struck(part: Part) -> Blocks {
    let part = wording::part(part);
    Block::paragraph(format!("Not shown, since an error concerns the {part}. See the findings.")).into()
}

fn methods_folded() -> Blocks {
    Block::Fold { summary: "Every method, with its source".into(), blocks: methods::section().into_vec() }.into()
}

/// Text of a section before its figures and tables; what follows is detail.
fn is_detail(block: &Block) -> bool {
    !matches!(block, Block::Paragraph { .. } | Block::List { .. } | Block::Finding(_))
}

/// The first words of an analysis, and its figures and tables on request.
fn folded(blocks: Blocks) -> Blocks {
    let mut first = blocks.into_vec();
    let detail = first.iter().position(is_detail).unwrap_or(first.len());
    let rest = first.split_off(detail);
    let count = Page::new("", rest.clone()).figures().len();
    if rest.is_empty() {
        return first.into();
    }
    let summary = match count {
        0 => "Tables of the analysis".to_owned(),
        1 => "The analysis, with 1 figure".to_owned(),
        _ => format!("The analysis, with {count} figures"),
    };
    first.push(Block::Fold { summary: summary.into(), blocks: rest });
    first.into()
}
