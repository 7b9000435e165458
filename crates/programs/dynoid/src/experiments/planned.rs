//! Plans of experiments: by name, and from files of demands.

use std::fmt;
use std::path::Path;

use design::excitation_design::OperatingPoint;
use recording::Selection;
use rig::experiment::catalogue::{self, CatalogueError, Parameter, Settings};
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, free_form};
use rig::{BenchFile, ControlMode};
use units::RPM_RAD_S;
use work::Context;

use super::optimal::{OPTIMAL, OptimalExcitation, OptimalOptions};
use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::known::KnownBench;
use crate::paths;

/// A number that is given to an experiment: its name, and its value as people write it, such as `35` or `35 Nm`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Given {
    /// Name of the parameter.
    pub name: String,
    /// Value, with or without its unit.
    pub value: String,
}

/// A plan of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// The plan.
    pub plan: ExperimentPlan,
    /// The speed that its files are named by, rpm; none where the demands are one's own.
    pub speed_rpm: Option<f64>,
    /// Channels of a file of demands that are no demands.
    pub ignored: Vec<String>,
    /// The excitation where it was designed for chosen parameters.
    pub optimal: Option<OptimalExcitation>,
}

impl Planned {
    /// A plan that a program has made.
    pub fn of(plan: ExperimentPlan) -> Self {
        Planned { plan, speed_rpm: None, ignored: Vec::new(), optimal: None }
    }

    /// The plan of an experiment by name, or of a file of demands.
    ///
    /// # Errors
    /// An experiment that is not known, a number that it does not take, and a file that makes no experiment.
    pub fn find(experiment: &str, given: &[Given], files: &Files, context: &Context) -> Result<Self, Error> {
        let path = Path::new(experiment);
        match catalogue::find(experiment) {
            Ok(template) => {
                let settings = settings(experiment, &template.parameters(), given)?;
                let plan = template.plan(&settings).map_err(|error| refused(experiment, error))?;
                Ok(Planned { speed_rpm: Some(settings.get("speed")), ..Planned::of(plan) })
            }
            Err(unknown) if !path.exists() && paths::ending(path).is_none() => Err(refused(experiment, unknown)),
            Err(_) => from_file(path, given, files, context),
        }
    }

    /// The plan of the excitation that gives chosen parameters the least variance on a bench.
    ///
    /// # Errors
    /// A bench or limits for which nothing can be designed, and a number that the plan does not take.
    pub fn optimal(
        bench: &KnownBench,
        options: &OptimalOptions,
        given: &[Given],
        context: &Context,
    ) -> Result<Self, Error> {
        let settings = settings(OPTIMAL, catalogue::OPTIMAL, given)?;
        let (speed_rpm, duration_s) = (settings.get("speed"), settings.get("duration"));
        let at = OperatingPoint { speed_rad_s: speed_rpm * RPM_RAD_S, torque_nm: settings.get("torque") };
        let optimal = OptimalExcitation::of(bench, options, at, duration_s, context);
        let optimal = optimal.map_err(|reason| Error::NotDesigned { reason })?;
        let mut plan = optimal.plan(options.form, at, duration_s);
        plan.settling_s = settings.get("settling");
        Ok(Planned { speed_rpm: Some(speed_rpm), optimal: Some(optimal), ..Planned::of(plan) })
    }

    /// Name of its files without their endings: label, speed, and the parameters that it is designed for.
    pub fn file_name(&self, seed: u64) -> String {
        let first_rpm = || Demands::of(&self.plan, seed, DEMAND_HOLD_S).speed_rad_s[0] / RPM_RAD_S;
        let suffix = self.optimal.as_ref().map(OptimalExcitation::suffix).unwrap_or_default();
        format!("{}_{:.0}{suffix}", self.plan.label, self.speed_rpm.unwrap_or_else(first_rpm))
    }

    /// Channels of a file of demands that were left out, in words.
    pub fn remark(&self, experiment: &str) -> Option<String> {
        let name = paths::with_slashes(Path::new(experiment));
        (!self.ignored.is_empty()).then(|| format!("{name}: no demands, and left out: {}", self.ignored.join(", ")))
    }
}

/// The numbers that are given to an experiment with these parameters; the usual ones for the others.
///
/// # Errors
/// A number that the experiment does not take.
pub fn settings(experiment: &str, parameters: &[Parameter], given: &[Given]) -> Result<Settings, Error> {
    let given: Vec<(&str, &str)> = given.iter().map(|one| (one.name.as_str(), one.value.as_str())).collect();
    Settings::parse(parameters, &given).map_err(|error| refused(experiment, error))
}

fn from_file(path: &Path, given: &[Given], files: &Files, context: &Context) -> Result<Planned, Error> {
    let name = paths::with_slashes(path);
    let settings = settings(&name, free_form::PARAMETERS, given)?;
    let file = InputFile { path: path.to_owned(), name: name.clone() };
    let step = context.step(format!("reading {name}"), 0);
    let read = files.read_recording(&file, &Selection::All, None, &step)?;
    drop(step);
    let free = free_form::plan(&name, &read.recording, &settings)
        .map_err(|source| Error::Demands { path: path.to_owned(), source })?;
    Ok(Planned { ignored: free.ignored, ..Planned::of(free.plan) })
}

pub(crate) fn refused(experiment: &str, source: CatalogueError) -> Error {
    Error::Catalogue { experiment: experiment.to_owned(), source }
}

/// A doubt about a plan on a bench, before it is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlanDoubt {
    /// The torque of the engine is switched more often than a cylinder fires.
    SwitchesWithinFiring {
        /// Time between switches, s.
        level_s: f64,
        /// Time between firings, s.
        firing_s: f64,
    },
    /// The engine is motored in torque control, so nothing holds its speed.
    RunsAway,
}

impl PlanDoubt {
    /// Doubts about this plan on this bench.
    pub fn of(plan: &ExperimentPlan, bench: &BenchFile) -> Vec<Self> {
        let switches = plan.switches_within_a_firing(bench.engine());
        let switches = switches.map(|(level_s, firing_s)| PlanDoubt::SwitchesWithinFiring { level_s, firing_s });
        let runs_away = plan.label.mode == ControlMode::Tn && plan.is_motored;
        switches.into_iter().chain(runs_away.then_some(PlanDoubt::RunsAway)).collect()
    }

    /// The number that would remove the doubt.
    pub fn remedy(&self) -> Option<Given> {
        match self {
            PlanDoubt::SwitchesWithinFiring { firing_s, .. } => {
                let value = format!("{:.2}", (1.2 * firing_s * 100.0).ceil() / 100.0);
                Some(Given { name: "clock".to_owned(), value })
            }
            PlanDoubt::RunsAway => None,
        }
    }
}

impl fmt::Display for PlanDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlanDoubt::SwitchesWithinFiring { level_s, firing_s } => write!(
                f,
                "the engine's torque is switched every {:.0} ms, but a cylinder fires every {:.0} ms only: raise clock",
                1e3 * level_s,
                1e3 * firing_s
            ),
            PlanDoubt::RunsAway => {
                f.write_str("the engine is motored and does not hold its speed in TN: the speed will run away")
            }
        }
    }
}
