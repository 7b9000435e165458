//! The program `dynoid`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(dynoid_cli::main(std::env::args_os().collect()))
}
