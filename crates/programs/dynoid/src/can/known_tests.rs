//! Tests that have a name: cycles, and shapes with their numbers.

use capability::shapes;
use cycle::Kind;
use rig::experiment::catalogue::{self, Parameter};
use serde::Serialize;

use super::test::Test;

/// A cycle by its name.
#[derive(Debug, Serialize)]
struct CycleFacts {
    name: &'static str,
    title: &'static str,
    /// True of a schedule of a vehicle, which needs one; all others need an engine map.
    needs_vehicle: bool,
}

/// A shape with its numbers.
#[derive(Debug, Serialize)]
struct ShapeFacts {
    name: &'static str,
    demands: &'static str,
    parameters: &'static [Parameter],
}

/// Tests that have a name.
#[derive(Debug, Serialize)]
pub struct KnownTests {
    cycles: Vec<CycleFacts>,
    shapes: Vec<ShapeFacts>,
}

impl KnownTests {
    /// All cycles and shapes.
    #[must_use]
    pub fn all() -> Self {
        let cycle = |cycle: &cycle::Builtin| CycleFacts {
            name: cycle.name,
            title: cycle.title,
            needs_vehicle: cycle.kind == Kind::Vehicle,
        };
        let shape = |shape: &shapes::Shape| ShapeFacts {
            name: shape.name,
            demands: shape.demands,
            parameters: shape.parameters,
        };
        KnownTests { cycles: cycle::all().iter().map(cycle).collect(), shapes: shapes::ALL.iter().map(shape).collect() }
    }
}

impl Test {
    /// Tells whether a test has this name, so that no file is meant.
    #[must_use]
    pub fn is_name(name: &str) -> bool {
        cycle::builtin(name).is_ok() || shapes::find(name).is_some() || catalogue::find(name).is_ok()
    }
}
