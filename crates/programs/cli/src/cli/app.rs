//! Arguments of `dynoid app`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `dynoid app`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid app
  dynoid app cell4/ --port 8080
  dynoid app cell4/ --no-browser

The app answers on this computer alone, to the browser that opens the address which the command
prints. It reads and writes files below the folder. Ctrl-C ends it; studies that run go on, and are
there when it starts again.")]
pub(crate) struct AppArguments {
    /// The folder with recordings, bench files and studies
    #[arg(value_name = "FOLDER", default_value = ".")]
    pub(crate) folder: PathBuf,
    /// Port on this computer; 0 for any that is free
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub(crate) port: u16,
    /// Print the address, and open no browser
    #[arg(long)]
    pub(crate) no_browser: bool,
}
