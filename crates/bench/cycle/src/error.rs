//! Faults of cycles, maps and requirements.

/// Why a cycle cannot be made, or a run of it cannot be judged.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// No cycle of this name.
    #[error("no cycle has the name `{name}`; the cycles are {}", .known.join(", "))]
    UnknownCycle {
        /// The name.
        name: String,
        /// Names that exist.
        known: Vec<&'static str>,
    },
    /// No requirement set of this name.
    #[error("no requirement set has the name `{name}`; the sets are {}", .known.join(", "))]
    UnknownRequirement {
        /// The name.
        name: String,
        /// Names that exist.
        known: Vec<String>,
    },
    /// Embedded data that cannot be read.
    #[error("the data of `{name}` are damaged near `{near}`")]
    Data {
        /// The cycle or set.
        name: &'static str,
        /// The text that is not understood.
        near: String,
    },
    /// An engine map with too few points, or values that are impossible.
    #[error("engine map, row {row}: {problem}")]
    Map {
        /// The row, from 1 on.
        row: usize,
        /// The problem, with the remedy.
        problem: &'static str,
    },
    /// A cycle of a vehicle needs a vehicle.
    #[error("`{name}` is the speed of a vehicle; it needs the data of a vehicle and its gears")]
    NeedsVehicle {
        /// The cycle.
        name: &'static str,
    },
    /// A cycle that is no cycle of a vehicle.
    #[error("`{name}` is a cycle of an engine; a vehicle has no part in it")]
    NoVehicle {
        /// The cycle.
        name: &'static str,
    },
    /// Data of a vehicle that cannot be.
    #[error("vehicle: {name} is {value}; it must be {possible}")]
    Vehicle {
        /// Which value.
        name: &'static str,
        /// The value.
        value: f64,
        /// Values that are possible.
        possible: &'static str,
    },
    /// A feedback that ends, or begins, within the cycle.
    #[error(
        "the feedback covers {first_s:.1} … {last_s:.1} s of the test, which lasts from {start_s:.1} to {end_s:.1} s"
    )]
    NotCovered {
        /// First second that the feedback covers.
        first_s: f64,
        /// Last one.
        last_s: f64,
        /// First second of the cycle.
        start_s: f64,
        /// Last one.
        end_s: f64,
    },
    /// Series that should be as long as each other.
    #[error("{what}: {found} samples where {expected} are needed")]
    Length {
        /// Which series.
        what: &'static str,
        /// Samples needed.
        expected: usize,
        /// Samples found.
        found: usize,
    },
    /// A value that is no number.
    #[error("{what}, sample {sample}: the value is no number")]
    NotFinite {
        /// Which series.
        what: &'static str,
        /// The sample, from 0 on.
        sample: usize,
    },
    /// A requirement of one's own that says nothing about this test.
    #[error("`{text}` cannot be judged by this test: {problem}")]
    NotInTest {
        /// The requirement.
        text: String,
        /// Property that the test lacks.
        problem: String,
    },
    /// A requirement of one's own that is not understood.
    #[error(
        "`{text}` is no requirement: {problem}; write it like `speed within 10 rpm for 95 %` or `torque rise below 50 ms`"
    )]
    Own {
        /// The text.
        text: String,
        /// The problem.
        problem: String,
    },
}
