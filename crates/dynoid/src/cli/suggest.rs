//! "Did you mean" for commands that are not there.

use std::ffi::OsString;

use clap::Command;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

/// Other words for a command, and its name here.
const OTHER_WORDS: [(&str, &str); 11] = [
    ("run", "study"),
    ("report", "study"),
    ("look", "lines"),
    ("campbell", "lines"),
    ("orders", "lines"),
    ("inverter", "torque-control"),
    ("drive", "torque-control"),
    ("torque", "torque-signals"),
    ("pi", "controller"),
    ("resid", "model residuals"),
    ("identify", "fit"),
];

/// The error with the commands that may have been meant.
pub(super) fn improved(mut error: Error, program: &Command) -> Error {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return error };
            let meant = meant(word, program);
            if !meant.is_empty() {
                error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(meant));
            }
        }
        ErrorKind::UnknownArgument => {
            let tip = if arguments.starts_with(&["study".into(), "run".into()]) {
                "`study` takes the bench file at once: dynoid study BENCH.toml".to_owned()
            } else if let Some(ContextValue::String(size)) = error.get(ContextKind::InvalidArg)
                && arguments.windows(2).any(|pair| pair[0] == "--pdf" && pair[1] == size.as_str())
            {
                format!("the size of the paper follows an equals sign: --pdf={size}")
            } else {
                return error;
            };
            error.remove(ContextKind::SuggestedArg);
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        _ => {}
    }
    error
}

/// Commands of this name in any group, those that another word is used for, and those of similar spelling.
fn meant(word: &str, program: &Command) -> Vec<String> {
    let word = word.to_lowercase();
    let mut names = Vec::new();
    for command in program.get_subcommands() {
        names.push(command.get_name().to_owned());
        names.extend(command.get_subcommands().map(|inner| format!("{} {}", command.get_name(), inner.get_name())));
    }
    let is_named = |name: &&String| name.rsplit(' ').next() == Some(word.as_str());
    let same: Vec<String> = names.iter().filter(is_named).cloned().collect();
    if !same.is_empty() {
        return same;
    }
    if let Some((_, name)) = OTHER_WORDS.iter().find(|(other, _)| *other == word) {
        return vec![(*name).to_owned()];
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::{OTHER_WORDS, meant};
    use crate::cli::Cli;

    #[test]
    fn exact_commands_inside_groups_are_found() {
        let program = Cli::command();
        assert_eq!(meant("bode", &program), ["model bode"]);
        assert_eq!(meant("simulate", &program), ["experiment simulate", "model simulate"]);
        assert_eq!(meant("look", &program), ["lines"]);
        assert!(meant("bodee", &program).is_empty());
    }

    #[test]
    fn exact_other_words_lead_to_commands_that_are_there() {
        let program = Cli::command();
        for (word, name) in OTHER_WORDS {
            let is_there = name.split(' ').try_fold(&program, |command, name| command.find_subcommand(name)).is_some();
            assert!(is_there && program.find_subcommand(word).is_none(), "{word}");
        }
    }
}
