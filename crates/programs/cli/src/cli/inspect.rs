//! Arguments of `dynoid inspect`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid inspect BS_T_NT_1200.mf4
  dynoid inspect recordings/ | less
  dynoid inspect huge.mf4 --list
  dynoid inspect huge.mf4 --channels 'DynoSpeed,*Torque*'
  dynoid inspect run.mf4 --json | jq '.[].rasters[].channels[].name'")]
pub(crate) struct InspectArguments {
    /// Recordings, or folders of recordings
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// List channels and rasters only, without reading samples
    #[arg(long)]
    pub(crate) list: bool,
    /// Only channels of these names; `*` stands for any characters, `?` for one
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with = "list")]
    pub(crate) channels: Vec<String>,
    /// Print everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
