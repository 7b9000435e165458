//! The tutorials and the cookbook of the book: their files are written and their commands run, in the order of the pages.
//!
//! A block ```` ```toml file=NAME ```` is a file. In a block ```` ```console ```` each line that begins with `$` is a
//! command;
//! ```` ```console exit=1 ```` states another exit code than 0.

use std::path::Path;

use crate::support::dynoid;

const PAGES: [(&str, &str); 9] = [
    ("1-first-study", include_str!("../../../../../docs/src/tutorials/1-first-study.md")),
    ("2-one-part", include_str!("../../../../../docs/src/tutorials/2-one-part.md")),
    ("3-experiments", include_str!("../../../../../docs/src/tutorials/3-experiments.md")),
    ("4-linear-models", include_str!("../../../../../docs/src/tutorials/4-linear-models.md")),
    ("cookbook/study", include_str!("../../../../../docs/src/cookbook/study.md")),
    ("cookbook/verdict", include_str!("../../../../../docs/src/cookbook/verdict.md")),
    ("cookbook/fit", include_str!("../../../../../docs/src/cookbook/fit.md")),
    ("cookbook/export", include_str!("../../../../../docs/src/cookbook/export.md")),
    ("cookbook/convert", include_str!("../../../../../docs/src/cookbook/convert.md")),
];

/// A fenced block: the words behind the fence, and the lines.
struct Block<'a> {
    info: &'a str,
    lines: Vec<&'a str>,
}

#[test]
fn exact_the_tutorials_run_as_they_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let mut commands = 0;
    for (page, text) in PAGES {
        for block in blocks(text) {
            if let Some(name) = attribute(block.info, "file") {
                std::fs::write(folder.path().join(name), block.lines.join("\n")).unwrap();
            }
            if block.info.starts_with("console") {
                let code = attribute(block.info, "exit").map_or(0, |code| code.parse().unwrap());
                for line in block.lines.iter().filter_map(|line| line.strip_prefix("$ ")) {
                    run(folder.path(), page, line, code);
                    commands += 1;
                }
            }
        }
    }
    assert!(commands > 20, "{commands} commands were found");
}

#[track_caller]
fn run(folder: &Path, page: &str, line: &str, code: i32) {
    let words: Vec<&str> = line.split(' ').collect();
    match words.as_slice() {
        ["mkdir", name] => std::fs::create_dir(folder.join(name)).unwrap(),
        ["dynoid", arguments @ ..] => {
            let ran = dynoid(folder, arguments);
            assert_eq!(ran.code, Some(code), "{page}: {line}\n{}{}", ran.stdout, ran.stderr);
        }
        _ => panic!("{page}: neither mkdir nor dynoid: {line}"),
    }
}

fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(info), None) => open = Some(Block { info, lines: Vec::new() }),
            (Some(_), Some(block)) => blocks.push(block),
            (None, Some(mut block)) => {
                block.lines.push(line);
                open = Some(block);
            }
            (None, None) => {}
        }
    }
    blocks
}

fn attribute<'a>(info: &'a str, name: &str) -> Option<&'a str> {
    info.split(' ').find_map(|word| word.strip_prefix(name)?.strip_prefix('='))
}
