//! Arguments of `dynoid schema`.

use clap::Args;
use clap::builder::PossibleValuesParser;
use dynoid::schemas::SCHEMAS;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid schema                    list the names
  dynoid schema study > study.schema.json
  dynoid schema can-output         of what `dynoid can --json` prints")]
pub(crate) struct SchemaArguments {
    /// Name of a schema; without one, all names are listed
    #[arg(value_name = "NAME", hide_possible_values = true)]
    #[arg(value_parser = PossibleValuesParser::new(SCHEMAS.iter().map(|schema| schema.name)))]
    pub(crate) name: Option<String>,
}
