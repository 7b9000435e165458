//! `dynoid demo`: a bench whose every parameter is known, its recordings, and a study of them beside the truth.

mod comparison;

use std::path::Path;

use demo::comparison::Row;
use dynoid::{Demonstration, EFFECTS, StudyOptions, WrittenStudy};
use page::{Block, Page, Prose};

use crate::cli::bench::DemoArguments;
use crate::commands::study;
use crate::error::{CliError, Outcome};
use crate::path::shown;
use crate::summary;
use crate::terminal::Terminal;

const RECORDINGS: &str = "recordings";

pub(crate) fn run(arguments: &DemoArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = &arguments.out;
    let demonstration = Demonstration::check(out, arguments.seed, &terminal.files())?;
    let bench = demonstration.write(terminal.work())?;
    let written = study::study(&bench, out, Some(arguments.seed), StudyOptions::default(), terminal)?;
    let rows = demonstration.rows(&written.study);
    if arguments.json {
        terminal.json(&comparison::Document::new(arguments.seed, &written, &bench, &rows))?;
    } else if !terminal.is_quiet() {
        terminal.page(&page(&written, &bench, &rows));
    }
    Ok(summary::outcome(&written.study))
}

/// Page of the demo on a screen.
fn page(written: &WrittenStudy, bench: &Path, rows: &[Row]) -> Page {
    let beside = |name: &str| shown(&written.report.with_file_name(name));
    let next = vec![
        format!("open {} in a browser", shown(&written.report)),
        format!("open {}: firing, aliases and late sensors in the recordings", beside(EFFECTS)),
        format!("dynoid inspect {}", beside(RECORDINGS)),
        format!("change {} and: dynoid study {0}", shown(bench)),
        "your own recordings: dynoid init FOLDER".to_owned(),
    ];
    let mut blocks = vec![
        Block::paragraph("A bench was simulated, recorded and studied. The estimates and the true values:"),
        Block::Table(comparison::table(rows)),
        Block::paragraph(comparison::remark(rows)),
    ];
    blocks.extend(summary::judgement(written));
    blocks.push(Block::heading("Next"));
    blocks.push(Block::List { items: next.into_iter().map(Prose::verbatim).collect() });
    Page::new("Demonstration", blocks)
}
