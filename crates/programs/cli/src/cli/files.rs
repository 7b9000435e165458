//! The command that a command line names, and the files that it reads.

use std::ffi::OsStr;
use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command};

/// The options and arguments that name what a command writes. Every other value may name a file that is read.
const OUTPUTS: [&str; 4] = ["out", "plot", "truth", "folder"];

/// The words of the command, and the files that its arguments name but for those to be written.
pub(super) fn given(command: &Command, matches: &ArgMatches) -> (String, Vec<PathBuf>) {
    let mut inputs: Vec<PathBuf> = values(command, matches).map(PathBuf::from).filter(|path| path.is_file()).collect();
    let Some((name, inner)) = matches.subcommand() else { return (String::new(), inputs) };
    let Some(called) = command.find_subcommand(name) else { return (name.to_owned(), inputs) };
    let (words, more) = given(called, inner);
    inputs.extend(more);
    (format!("{name} {words}").trim_end().to_owned(), inputs)
}

/// The values of all arguments that are no output.
fn values<'a>(command: &'a Command, matches: &'a ArgMatches) -> impl Iterator<Item = &'a OsStr> {
    let is_input = |arg: &&Arg| arg.get_action().takes_values() && !OUTPUTS.contains(&arg.get_id().as_str());
    let given = |arg: &Arg| matches.try_get_raw(arg.get_id().as_str()).ok().flatten();
    command.get_arguments().filter(is_input).filter_map(given).flatten()
}

#[cfg(test)]
mod tests {
    use std::any::TypeId;

    use clap::CommandFactory;

    use super::*;
    use crate::cli::Cli;

    /// Inputs that commands read, by the names of their arguments.
    const INPUTS: [&str; 18] = [
        "bench",
        "engine_map",
        "files",
        "first",
        "model",
        "models",
        "on",
        "recorded",
        "recording",
        "recordings",
        "second",
        "structure",
        "study",
        "validate",
        "vehicle",
        "experiment",
        "test",
        "by",
    ];

    fn paths(command: &Command, found: &mut Vec<String>) {
        let is_path = |arg: &&Arg| arg.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        found.extend(command.get_arguments().filter(is_path).map(|arg| arg.get_id().to_string()));
        command.get_subcommands().for_each(|inner| paths(inner, found));
    }

    #[test]
    fn exact_every_path_on_a_command_line_is_known_to_be_read_or_written() {
        let mut found = Vec::new();
        paths(&Cli::command(), &mut found);
        let is_known = |name: &String| OUTPUTS.contains(&name.as_str()) != INPUTS.contains(&name.as_str());
        let unknown: Vec<&String> = found.iter().filter(|name| !is_known(name)).collect();
        assert!(found.len() > 30 && unknown.is_empty(), "read or written? {unknown:?}");
    }

    #[test]
    fn exact_words_and_inputs_of_a_command_line() {
        let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
        let command = Cli::command();
        let line = ["dynoid", "-q", "experiment", "design", manifest, "BS_T_NT", "--out", manifest];
        let matches = command.clone().try_get_matches_from(line).unwrap();
        assert_eq!(given(&command, &matches), ("experiment design".to_owned(), vec![PathBuf::from(manifest)]));
    }
}
