//! Arguments of `dynoid shell`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use clap_complete::Shell;

pub(crate) const EXAMPLES: &str = "\
Examples:
  dynoid shell completions bash > ~/.local/share/bash-completion/completions/dynoid
  dynoid shell manual ~/.local/share/man/man1";

#[derive(Debug, Subcommand)]
pub(crate) enum ShellCommand {
    /// Print what lets a shell complete commands and options
    Completions(CompletionsArguments),
    /// Write manual pages for `man`
    Manual(ManualArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid shell completions bash > ~/.local/share/bash-completion/completions/dynoid
  dynoid shell completions zsh > ~/.zfunc/_dynoid
  dynoid shell completions fish > ~/.config/fish/completions/dynoid.fish
  dynoid shell completions powershell >> $PROFILE

Start a new shell afterwards. zsh needs `fpath+=~/.zfunc` before `compinit` in ~/.zshrc.")]
pub(crate) struct CompletionsArguments {
    /// The shell to write for
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid shell manual ~/.local/share/man/man1
  man dynoid-study")]
pub(crate) struct ManualArguments {
    /// The folder for the pages, one for each command
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
}
