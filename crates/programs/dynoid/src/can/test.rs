//! Tests: cycles, shapes, experiments and files of demands.

use std::path::{Path, PathBuf};

use capability::{CycleDemand, Demand, shapes};
use cycle::{Driver, EngineMap, Gearbox, Kind, Reference, Vehicle, builtin};
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use serde::Deserialize;
use units::RPM_RAD_S;
use work::Context;

use super::{cycle_table, engine_map};
use crate::error::Error;
use crate::experiments::{Given, Planned, refused, settings};
use crate::files::Files;
use crate::paths;

/// The name that asks for the map in place of a test.
const MAP: &str = "map";

/// Files and numbers of a test, besides its name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TestOptions {
    /// Full-load curve of the engine: a table of speed and torque.
    pub engine_map: Option<PathBuf>,
    /// Warm idle speed, rpm; without it the lowest of the engine map, or of the cycle without one.
    pub idle_rpm: Option<f64>,
    /// Vehicle and gears, for a cycle of vehicle speed: a TOML file.
    pub vehicle: Option<PathBuf>,
    /// Numbers of a shape or an experiment.
    pub given: Vec<Given>,
    /// Seed of random demands.
    pub seed: u64,
}

/// A test with its name.
#[derive(Debug, Clone)]
pub struct Test {
    pub(super) title: String,
    pub(super) what: What,
    /// Warm idle speed that was stated, rpm.
    pub(super) idle_rpm: Option<f64>,
    usual_set: Option<&'static str>,
    remarks: Vec<String>,
}

/// Content of a test.
#[derive(Debug, Clone)]
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
    /// The test of a name: a cycle, a shape, an experiment, or a file of demands or of a cycle.
    ///
    /// # Errors
    /// A name that is not known, a file that cannot be read, and a cycle for which engine or vehicle are missing.
    pub fn find(name: &str, options: &TestOptions, files: &Files, context: &Context) -> Result<Self, Error> {
        let map = options.engine_map.as_deref();
        let map = map.map(|path| engine_map::read(path, options.idle_rpm, files)).transpose()?;
        if let Ok(cycle) = builtin(name) {
            return of_builtin(&cycle, map, options, files);
        }
        if let Some(shape) = shapes::find(name) {
            return of_shape(shape, options);
        }
        let path = Path::new(name);
        if path.is_file()
            && let Some((reference, gaps)) = cycle_table::read(path, map.as_ref(), files)?
        {
            let test = Test::of_cycle(name, reference, map, Some("1065.514"), options);
            return Ok(Test { remarks: gaps.into_iter().collect(), ..test });
        }
        if !path.exists() && paths::ending(path).is_none() && !name.contains('_') {
            return Err(unknown(name));
        }
        let planned = Planned::find(name, &options.given, files, context)?;
        let remarks = planned.remark(name).into_iter().collect();
        let test = Test::of_plan(&planned.plan.label.to_string(), planned.plan, options.seed);
        Ok(Test { remarks, idle_rpm: options.idle_rpm, ..test })
    }

    /// The test that runs a plan.
    pub fn of_plan(title: &str, plan: ExperimentPlan, seed: u64) -> Self {
        let demands = Box::new(Demands::of(&plan, seed, DEMAND_HOLD_S));
        let what = What::Plan { plan: Box::new(plan), demands };
        Test { title: title.to_owned(), what, idle_rpm: None, usual_set: None, remarks: Vec::new() }
    }

    /// The test that runs a cycle, with the idle speed that is stated; an engine map has it already.
    fn of_cycle(
        title: &str,
        mut reference: Reference,
        map: Option<EngineMap>,
        usual_set: Option<&'static str>,
        options: &TestOptions,
    ) -> Self {
        if let (None, Some(idle_rpm)) = (&map, options.idle_rpm) {
            reference.scales.idle_rad_s = idle_rpm * RPM_RAD_S;
        }
        let what = What::Cycle { reference, map };
        Test { title: title.to_owned(), what, idle_rpm: options.idle_rpm, usual_set, remarks: Vec::new() }
    }

    /// Its name.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// How long it lasts, s.
    pub fn duration_s(&self) -> f64 {
        self.demand().duration_s()
    }

    /// Doubts about the file that it is from, in words.
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// The set that judges it where none is named.
    pub(super) fn usual_set(&self) -> Option<&'static str> {
        self.usual_set
    }

    /// Tells whether it is a cycle.
    pub(super) fn is_cycle(&self) -> bool {
        matches!(self.what, What::Cycle { .. })
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
    options: &TestOptions,
    files: &Files,
) -> Result<Test, Error> {
    let name = || cycle.name.to_owned();
    let failed = |source: cycle::CycleError| Error::Cycle { cycle: name(), source };
    let reference = match (cycle.kind, &map, &options.vehicle) {
        (Kind::Vehicle, _, Some(path)) => vehicle(path, files)?.follow_cycle(cycle).map_err(failed)?,
        (Kind::Vehicle, _, None) => return Err(Error::NeedsVehicle { cycle: name() }),
        (_, Some(map), _) => cycle.reference(map).map_err(failed)?,
        (_, None, _) => return Err(Error::NeedsEngineMap { cycle: name() }),
    };
    Ok(Test::of_cycle(&cycle.name.to_uppercase(), reference, map, Some(cycle.requirement), options))
}

impl VehicleFile {
    fn follow_cycle(&self, cycle: &cycle::Builtin) -> Result<Reference, cycle::CycleError> {
        let driver = self.driver.unwrap_or_else(|| Driver::of(&self.vehicle));
        Ok(self.vehicle.follow(&cycle.vehicle_speed_m_s()?, &self.gears, &driver)?.reference)
    }
}

fn vehicle(path: &Path, files: &Files) -> Result<VehicleFile, Error> {
    let text = files.read_text(path, "a TOML file of a vehicle")?;
    toml::from_str(&text)
        .map_err(|error| Error::CycleTable { path: path.to_owned(), reason: error.to_string().trim().to_owned() })
}

fn of_shape(shape: &shapes::Shape, options: &TestOptions) -> Result<Test, Error> {
    let settings = settings(shape.name, shape.parameters, &options.given)?;
    let plan = shape.plan(&settings).map_err(|error| refused(shape.name, error))?;
    Ok(Test { idle_rpm: options.idle_rpm, ..Test::of_plan(shape.name, plan, options.seed) })
}

fn unknown(name: &str) -> Error {
    let cycles = cycle::all().iter().map(|cycle| cycle.name);
    let known: Vec<&'static str> = cycles.chain(shapes::ALL.iter().map(|shape| shape.name)).chain([MAP]).collect();
    let meant = recording::names::likely_meant(name, known.iter().copied());
    Error::UnknownTest { name: name.to_owned(), meant, known }
}
