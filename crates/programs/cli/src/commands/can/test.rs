//! From the command line to a test.

use std::path::Path;

use capability::{CycleDemand, Demand, shapes};
use cycle::{Driver, EngineMap, Gearbox, Kind, Reference, Vehicle, builtin};
use dynoid::{Files, paths};
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use serde::Deserialize;
use units::RPM_RAD_S;

use super::{cycle_table, engine_map};
use crate::cli::can::CanArguments;
use crate::commands::experiment::planned;
use crate::error::CliError;
use crate::terminal::Terminal;

/// A test with its name.
pub(super) struct Test {
    pub(super) title: String,
    pub(super) what: What,
    usual_set: Option<&'static str>,
}

/// Content of a test.
pub(super) enum What {
    Cycle { reference: Reference, map: Option<EngineMap> },
    Plan { plan: Box<ExperimentPlan>, demands: Box<Demands> },
}

/// A file of a vehicle.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleFile {
    vehicle: Vehicle,
    gears: Gearbox,
    driver: Option<Driver>,
}

impl Test {
    pub(super) fn of(arguments: &CanArguments, terminal: &mut Terminal) -> Result<Self, CliError> {
        let map = arguments
            .engine_map
            .as_deref()
            .map(|path| engine_map::read(path, arguments.idle, &terminal.files()))
            .transpose()?;
        if let Ok(cycle) = builtin(&arguments.test) {
            return of_builtin(&cycle, map, arguments, &terminal.files());
        }
        if let Some(shape) = shapes::find(&arguments.test) {
            return of_shape(shape, arguments);
        }
        let path = Path::new(&arguments.test);
        if path.is_file()
            && let Some(reference) = cycle_table::read(path, map.as_ref(), terminal)?
        {
            let what = What::Cycle { reference: with_idle(reference, map.as_ref(), arguments), map };
            return Ok(Test { title: arguments.test.clone(), what, usual_set: Some("1065.514") });
        }
        if !path.exists() && paths::ending(path).is_none() && !arguments.test.contains('_') {
            return Err(unknown(&arguments.test));
        }
        let plan = planned::plan(&arguments.test, &arguments.on.plan, terminal)?.plan;
        Ok(of_plan(plan.label.to_string(), plan, arguments))
    }

    /// The set that judges it where none is named.
    pub(super) fn usual_set(&self) -> Option<&'static str> {
        self.usual_set
    }

    /// For a prediction.
    pub(super) fn demand(&self) -> Demand<'_> {
        match &self.what {
            What::Cycle { reference, map } => Demand::Cycle(CycleDemand { reference, map: map.as_ref() }),
            What::Plan { plan, demands } => Demand::Plan(plan, demands),
        }
    }
}

fn of_builtin(
    cycle: &cycle::Builtin,
    map: Option<EngineMap>,
    arguments: &CanArguments,
    files: &Files,
) -> Result<Test, CliError> {
    let usage = |what: String| CliError::Usage { what };
    let failed = |error: cycle::CycleError| CliError::Usage { what: format!("{}: {error}", cycle.name) };
    let reference = match (cycle.kind, &map, &arguments.vehicle) {
        (Kind::Vehicle, _, Some(path)) => vehicle(path, files)?.follow_cycle(cycle).map_err(failed)?,
        (Kind::Vehicle, _, None) => {
            return Err(usage(format!(
                "{}: this is the speed of a vehicle; describe it with --vehicle FILE",
                cycle.name
            )));
        }
        (_, Some(map), _) => cycle.reference(map).map_err(failed)?,
        (_, None, _) => {
            let what = "this cycle is in % of an engine; give its full-load curve with --engine-map FILE";
            return Err(usage(format!("{}: {what}", cycle.name)));
        }
    };
    let what = What::Cycle { reference: with_idle(reference, map.as_ref(), arguments), map };
    Ok(Test { title: cycle.name.to_uppercase(), what, usual_set: Some(cycle.requirement) })
}

/// The reference with the idle speed that is stated; an engine map has it already.
fn with_idle(mut reference: Reference, map: Option<&EngineMap>, arguments: &CanArguments) -> Reference {
    if let (None, Some(idle_rpm)) = (map, arguments.idle) {
        reference.scales.idle_rad_s = idle_rpm * RPM_RAD_S;
    }
    reference
}

impl VehicleFile {
    fn follow_cycle(&self, cycle: &cycle::Builtin) -> Result<Reference, cycle::CycleError> {
        let driver = self.driver.unwrap_or_else(|| Driver::of(&self.vehicle));
        Ok(self.vehicle.follow(&cycle.vehicle_speed_m_s()?, &self.gears, &driver)?.reference)
    }
}

fn vehicle(path: &Path, files: &Files) -> Result<VehicleFile, CliError> {
    let text = files.read_text(path, "a TOML file of a vehicle")?;
    toml::from_str(&text)
        .map_err(|error| CliError::CycleTable { path: path.to_owned(), reason: error.to_string().trim().to_owned() })
}

fn of_shape(shape: &shapes::Shape, arguments: &CanArguments) -> Result<Test, CliError> {
    let usage = |error: rig::experiment::catalogue::CatalogueError| CliError::Usage {
        what: format!("{}: {error}", shape.name),
    };
    let given = planned::given(&arguments.on.plan)?;
    let given: Vec<(&str, &str)> = given.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    let settings = Settings::parse(shape.parameters, &given).map_err(usage)?;
    Ok(of_plan(shape.name.to_owned(), shape.plan(&settings).map_err(usage)?, arguments))
}

fn of_plan(title: String, plan: ExperimentPlan, arguments: &CanArguments) -> Test {
    let demands = Box::new(Demands::of(&plan, arguments.on.plan.seed(), DEMAND_HOLD_S));
    Test { title, what: What::Plan { plan: Box::new(plan), demands }, usual_set: None }
}

fn unknown(name: &str) -> CliError {
    let cycles = cycle::all().iter().map(|cycle| cycle.name);
    let names: Vec<&str> = cycles.chain(shapes::ALL.iter().map(|shape| shape.name)).chain(["map"]).collect();
    let closest = recording::names::likely_meant(name, names.iter().copied());
    let meant = closest.map_or_else(String::new, |meant| format!("; `{meant}` may be meant"));
    CliError::Usage {
        what: format!(
            "no test has the name `{name}`{meant}. Cycles and shapes: {}; experiments: `dynoid experiment list`; or a file",
            names.join(", ")
        ),
    }
}
