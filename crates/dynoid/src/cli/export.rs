//! Arguments of `dynoid export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid export study/model.json --to python
  dynoid export study/model.json --to mat --out matlab/
  dynoid export study/model.json --to modelica --out TestCell4.mo
  dynoid export study/model.json --to ssv --draws 100 --out draws/
  dynoid export study/model.json --to fmu3 --out TestCell4.fmu
  dynoid export arx.json --to fmu2

A bench model goes to every target, a model of `dynoid fit` to all but linear.
MODEL may also be an FMU that this command made.

Files written, NAME being the name of the bench or of --out:
  mat       NAME.mat with matrices, names, units and covariance, and NAME.m, a function
            that makes state-space systems of it and draws them; it also runs in Octave
  modelica  NAME.mo, a package of the mechanics, torque control and speed controller
  python    NAME.py, which simulates the bench as dynoid does; it needs numpy alone
  fmu2      NAME.fmu, FMI 2.0, Co-Simulation and Model Exchange, for Linux, Windows and macOS;
            with the report that is in the folder of the model
  fmu3      NAME.fmu, the same for FMI 3.0
  c         NAME.h with the numbers, the sources bench.c and matrix.c (linear.c of a linear model)
            with headers, example.c
  ssv       NAME.ssv, the parameters for SSP 2.0, and NAME_uncertainty.ssv
  linear    NAME_tn_torques.json, NAME_tn_speeds.json and NAME_nt.json, model files")]
pub(crate) struct ExportArguments {
    /// A bench model (model.json of a study), a model file of `dynoid fit`, or an FMU made of one
    #[arg(value_name = "MODEL")]
    pub(crate) model: PathBuf,
    /// What to export to
    #[arg(long, value_enum, value_name = "TARGET")]
    pub(crate) to: ExportTarget,
    /// The file to write, or a folder; created if it does not exist [default: the current folder]
    #[arg(long, short, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// With --to ssv: also write this many benches drawn from the covariance
    #[arg(long, value_name = "COUNT", default_value_t = 0)]
    pub(crate) draws: usize,
    /// Replace files that are there, whoever wrote them
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print the names of the files as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What a model is exported to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExportTarget {
    /// MATLAB and Octave
    Mat,
    /// Modelica
    Modelica,
    /// Python with numpy
    Python,
    /// Functional Mock-up Unit, FMI 2.0
    Fmu2,
    /// Functional Mock-up Unit, FMI 3.0
    Fmu3,
    /// C99
    C,
    /// SSP parameter sets
    Ssv,
    /// Linear models for `dynoid model`
    Linear,
}

impl ExportTarget {
    /// The ending of its main file.
    pub(crate) fn ending(self) -> &'static str {
        match self {
            ExportTarget::Mat => "mat",
            ExportTarget::Modelica => "mo",
            ExportTarget::Python => "py",
            ExportTarget::Fmu2 | ExportTarget::Fmu3 => "fmu",
            ExportTarget::C => "h",
            ExportTarget::Ssv => "ssv",
            ExportTarget::Linear => "json",
        }
    }
}
