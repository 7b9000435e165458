//! "Did you mean" for commands that are not there.

use std::ffi::OsString;

use clap::Command;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

/// Other words for a command, and its name here.
const OTHER_WORDS: [(&str, &str); 12] = [
    ("experiment run", "experiment simulate"),
    ("experiment record", "experiment simulate"),
    ("run", "study"),
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

/// Programs and formats, and the target of an export for them.
const OTHER_TARGETS: [(&str, &str); 9] = [
    (
        "simulink",
        "for Simulink give --to fmu2 or --to fmu3, an FMU for its block `FMU`, or --to mat for state-space systems",
    ),
    ("matlab", "for MATLAB give --to mat"),
    ("octave", "for Octave give --to mat"),
    ("fmu", "give --to fmu3, or --to fmu2 for programs that take FMI 2.0 only"),
    ("fmi", "give --to fmu3, or --to fmu2 for programs that take FMI 2.0 only"),
    ("dymola", "for Dymola give --to modelica, or --to fmu2"),
    ("openmodelica", "for OpenModelica give --to modelica"),
    ("amesim", "for Amesim give --to fmu2"),
    ("json", "give --to linear, which writes model files"),
];

/// The error with the commands that may have been meant.
pub(super) fn improved(mut error: Error, program: &Command) -> Error {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return error };
            let before =
                arguments.iter().position(|one| *one == word.as_str()).and_then(|at| arguments.get(at.checked_sub(1)?));
            let group = before.map(|group| group.to_string_lossy().into_owned()).unwrap_or_default();
            let meant = meant(&group, word, program);
            if !meant.is_empty() {
                error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(meant));
            }
        }
        ErrorKind::InvalidValue => {
            let text = |kind| match error.get(kind) {
                Some(ContextValue::String(text)) => text.to_lowercase(),
                _ => String::new(),
            };
            let (option, value) = (text(ContextKind::InvalidArg), text(ContextKind::InvalidValue));
            let target = OTHER_TARGETS.iter().find(|(other, _)| option == "--to <target>" && *other == value);
            if let Some((_, tip)) = target {
                error.remove(ContextKind::SuggestedValue);
                error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![(*tip).into()]));
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

/// Commands that another word of this group is used for, those of this name in any group, and those that another word
/// is used for.
fn meant(group: &str, word: &str, program: &Command) -> Vec<String> {
    let word = word.to_lowercase();
    let other = |word: &str| OTHER_WORDS.iter().find(|(other, _)| *other == word).map(|(_, name)| (*name).to_owned());
    if let Some(name) = other(&format!("{group} {word}")) {
        return vec![name];
    }
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
    other(&word).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use clap::ValueEnum;

    use super::{OTHER_TARGETS, OTHER_WORDS, meant};
    use crate::cli::Cli;
    use crate::cli::export::ExportTarget;

    #[test]
    fn exact_commands_inside_groups_are_found() {
        let program = Cli::command();
        assert_eq!(meant("", "bode", &program), ["model bode"]);
        assert_eq!(meant("", "simulate", &program), ["experiment simulate", "model simulate"]);
        assert_eq!(meant("", "look", &program), ["lines"]);
        assert_eq!(meant("", "run", &program), ["study"]);
        assert_eq!(meant("experiment", "run", &program), ["experiment simulate"]);
        assert!(meant("", "bodee", &program).is_empty());
    }

    #[test]
    fn exact_other_words_lead_to_commands_that_are_there() {
        let program = Cli::command();
        for (word, name) in OTHER_WORDS {
            let is_there = name.split(' ').try_fold(&program, |command, name| command.find_subcommand(name)).is_some();
            assert!(is_there && program.find_subcommand(word).is_none(), "{word}");
        }
    }

    #[test]
    fn exact_tips_name_targets_that_are_there() {
        for (word, tip) in OTHER_TARGETS {
            assert!(ExportTarget::from_str(word, true).is_err(), "{word} is a target");
            let targets = tip.split("--to ").skip(1).map(|rest| rest.split([' ', ',']).next().unwrap_or_default());
            assert!(targets.clone().count() > 0, "{tip}");
            targets.for_each(|target| assert!(ExportTarget::from_str(target, false).is_ok(), "{target}"));
        }
    }
}
