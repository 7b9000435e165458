//! A short account of the method, the same in every report.

use page::{Block, Blocks};

/// One line a block; its first character says of which kind.
const METHODS: &str = include_str!("../../assets/methods.txt");

/// The methods appendix.
pub(crate) fn section() -> Blocks {
    let mut all = Blocks::default();
    let mut sources = Vec::new();
    for line in METHODS.lines().filter(|line| !line.is_empty()) {
        match line.split_once(' ') {
            Some(("#", text)) => all.push(Block::heading(text)),
            Some(("=", formula)) => all.push(Block::equation(formula)),
            Some(("~", text)) => all.push(Block::note(text)),
            Some(("-", source)) => sources.push(source.into()),
            _ => all.push(Block::paragraph(line)),
        }
    }
    all.push(Block::List { items: sources });
    all
}
