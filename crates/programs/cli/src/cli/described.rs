//! The commands as data, from which the app makes a form of each.

use std::any::TypeId;
use std::path::PathBuf;

use clap::builder::ValueParser;
use clap::{Arg, ArgAction, Command};
use serde::Serialize;

/// A command that does something.
#[derive(Debug, Serialize)]
pub(crate) struct Described {
    /// Its words, such as `fit` and `arx`.
    words: Vec<String>,
    about: String,
    /// Examples and remarks.
    after: String,
    arguments: Vec<Argument>,
}

/// An argument of a command.
#[derive(Debug, Serialize)]
struct Argument {
    name: String,
    /// The option, such as `--poles`; none of what stands at its place.
    option: Option<String>,
    help: String,
    /// Heading in the help, if it has one of its own.
    heading: Option<String>,
    /// Name of its value, such as `FILE`; none where it is on or off.
    value: Option<String>,
    kind: Kind,
    is_required: bool,
    is_repeated: bool,
    default: Option<String>,
    /// The values that it may have, where these are few.
    choices: Vec<String>,
}

/// Kind of a value.
#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Flag,
    Path,
    /// A whole number, from zero on.
    Count,
    Number,
    Text,
}

/// Options of every command, which a form does not show.
const OF_ALL: [&str; 7] = ["quiet", "all", "overwrite", "color", "progress", "help", "json"];

/// Commands for programs and shells, and the app itself: a page starts none of them.
const NOT_OF_PAGES: [&str; 4] = ["app", "schema", "shell", "help"];

/// All commands that a page may start, in the order of the help.
pub(crate) fn described(command: &Command) -> Vec<Described> {
    let mut found = Vec::new();
    for command in command.get_subcommands().filter(|command| !NOT_OF_PAGES.contains(&command.get_name())) {
        gather(command, &[], &mut found);
    }
    found
}

fn gather(command: &Command, above: &[String], found: &mut Vec<Described>) {
    let words = [above, &[command.get_name().to_owned()]].concat();
    let below: Vec<&Command> = command.get_subcommands().filter(|command| command.get_name() != "help").collect();
    if !below.is_empty() {
        below.iter().for_each(|command| gather(command, &words, found));
        return;
    }
    let own = command.get_arguments().filter(|arg| !arg.is_hide_set() && !OF_ALL.contains(&arg.get_id().as_str()));
    found.push(Described {
        words,
        about: command.get_about().map(ToString::to_string).unwrap_or_default(),
        after: command.get_after_help().map(ToString::to_string).unwrap_or_default(),
        arguments: own.map(Argument::of).collect(),
    });
}

impl Argument {
    fn of(arg: &Arg) -> Self {
        let takes_values = arg.get_action().takes_values();
        let parser = arg.get_value_parser();
        Argument {
            name: arg.get_id().to_string(),
            option: arg.get_long().map(|long| format!("--{long}")),
            help: arg.get_help().map(ToString::to_string).unwrap_or_default(),
            heading: arg.get_help_heading().map(str::to_owned),
            value: arg
                .get_value_names()
                .and_then(|names| names.first())
                .map(ToString::to_string)
                .filter(|_| takes_values),
            kind: if takes_values { Kind::of(parser) } else { Kind::Flag },
            is_required: arg.is_required_set(),
            is_repeated: matches!(arg.get_action(), ArgAction::Append)
                || arg.get_num_args().is_some_and(|range| range.max_values() > 1),
            default: arg.get_default_values().first().map(|value| value.to_string_lossy().into_owned()),
            choices: parser.possible_values().into_iter().flatten().map(|value| value.get_name().to_owned()).collect(),
        }
    }
}

impl Kind {
    fn of(parser: &ValueParser) -> Self {
        let is = |kind: TypeId| parser.type_id() == kind;
        let counts = [TypeId::of::<usize>(), TypeId::of::<u64>(), TypeId::of::<u32>()];
        match () {
            () if is(TypeId::of::<PathBuf>()) => Kind::Path,
            () if counts.into_iter().any(is) => Kind::Count,
            () if is(TypeId::of::<f64>()) => Kind::Number,
            () => Kind::Text,
        }
    }
}
