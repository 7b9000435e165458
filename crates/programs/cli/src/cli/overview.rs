//! The first help page: the commands, grouped by what the user wants to do.

use std::fmt::Write as _;

use clap::Command;

/// Headings and the commands below them.
const GROUPS: [(&str, &[&str]); 4] = [
    ("The whole bench", &["app", "init", "study", "report", "can", "experiment", "export", "diff", "demo"]),
    (
        "One part of the bench",
        &["lines", "torque-signals", "torque-control", "controller", "shaft", "engine", "friction"],
    ),
    ("Recordings, and your shell", &["inspect", "convert", "schema", "shell"]),
    ("Linear models of any channels", &["data", "fit", "model"]),
];

const EXAMPLES: &str = "  dynoid demo                 try everything without recordings of your own
  dynoid app recordings/      look at recordings and study them in the browser";

const EXIT_CODES: &str = "Exit codes: 1 bad verdict; faults: 2 command, 3 input, 4 output, 5 in dynoid";

/// The program with its commands listed under headings.
pub(super) fn grouped(command: Command) -> Command {
    let (heading, literal) = (*command.get_styles().get_header(), *command.get_styles().get_literal());
    let mut page = String::from("{about}\n\n{usage-heading} {usage}, or dynoid FOLDER: init, study, report\n");
    for (title, names) in GROUPS {
        let _ = write!(page, "\n{heading}{title}:{heading:#}\n");
        for name in names {
            // The app may be left out of the build.
            let Some(known) = command.find_subcommand(name) else { continue };
            let about = known.get_about().map(ToString::to_string);
            let _ = writeln!(page, "  {literal}{name:<14}{literal:#}  {}", about.unwrap_or_default());
        }
    }
    let _ = write!(page, "\n{heading}Examples:{heading:#}\n{EXAMPLES}\n");
    page.push_str("`dynoid help COMMAND` explains a command. Always: --quiet, --all, --color WHEN.\n");
    page.push_str(EXIT_CODES);
    command.help_template(page)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::{GROUPS, grouped};
    use crate::cli::Cli;

    #[test]
    fn exact_every_command_stands_in_one_group() {
        let command = Cli::command();
        let is_built = |name: &&str| cfg!(feature = "app") || *name != "app";
        let listed = GROUPS.iter().flat_map(|(_, names)| names.iter().copied());
        let mut listed: Vec<&str> = listed.filter(is_built).collect();
        let mut there: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        listed.sort_unstable();
        there.sort_unstable();
        assert_eq!(listed, there);
    }

    #[test]
    fn exact_the_first_page_fits_a_screen() {
        let page = grouped(Cli::command()).render_help().to_string();
        assert!(page.lines().count() <= 40, "{} lines", page.lines().count());
        let widest = page.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(80), "{widest:?} columns");
    }
}
