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

A bench model goes to every target, a model of `dynoid fit` to all but linear and ssp.
MODEL may also be an FMU that this command made.

Files written, NAME being the name of the bench or of --out:
  mat       NAME.mat with matrices, names, units and covariance, and NAME.m, a function
            that makes state-space systems of it and draws them; it also runs in Octave
  modelica  NAME.mo, a package of the mechanics, torque control and speed controller,
            with signals or with the flange of the engine
  python    NAME.py, which simulates the bench as dynoid does; it needs numpy alone
  fmu2      NAME_fmi2.fmu, FMI 2.0, Co-Simulation and Model Exchange, for Linux, Windows and macOS;
            with the report that is in the folder of the model
  fmu3      NAME_fmi3.fmu, the same for FMI 3.0
  c         NAME.h with the numbers, the sources bench.c and matrix.c (linear.c of a linear model)
            with headers, NAME_example.c
  ssp       NAME.ssp, a system of SSP 1.0: the FMU (FMI 2.0) with its parameters, connected to the
            place of an engine
  ssv       NAME.ssv, the parameters for SSP 1.0, and NAME_uncertainty.ssv
  linear    NAME_tn_torques.json, NAME_tn_speeds.json and NAME_nt.json, model files

Models of other names fit into one folder. A file of an earlier export is replaced, and the command
says so. Without --overwrite it does not replace a file of another program, an FMU of another
version of FMI, or a source in C that differs.")]
pub(crate) struct ExportArguments {
    /// A bench model (model.json or study.json of a study), a model file of `dynoid fit`, or an FMU made of one
    #[arg(value_name = "MODEL")]
    pub(crate) model: PathBuf,
    /// What to export to
    #[arg(long, value_enum, value_name = "TARGET")]
    pub(crate) to: ExportTarget,
    /// The file to write, or a folder; created if it does not exist [default: the current folder]
    #[arg(long, short, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// With --to ssv: also write this many benches drawn from the covariance
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub(crate) draws: u32,
    /// Print the names of the files as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Targets to which a model is exported.
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
    /// SSP system with the bench and the place of an engine
    Ssp,
    /// SSP parameter sets
    Ssv,
    /// Linear models for `dynoid model`
    Linear,
}

impl ExportTarget {
    /// The target of the library, with so many draws of parameters.
    pub(crate) fn with_draws(self, draws: u32) -> dynoid::ExportTarget {
        use dynoid::ExportTarget as Of;
        match self {
            ExportTarget::Mat => Of::Mat,
            ExportTarget::Modelica => Of::Modelica,
            ExportTarget::Python => Of::Python,
            ExportTarget::Fmu2 => Of::Fmu2,
            ExportTarget::Fmu3 => Of::Fmu3,
            ExportTarget::C => Of::C,
            ExportTarget::Ssp => Of::Ssp,
            ExportTarget::Ssv => Of::Ssv { draws: draws as usize },
            ExportTarget::Linear => Of::Linear,
        }
    }
}
