//! Why an estimate cannot be made.

use crate::structure_error::StructureError;

/// Why an estimate cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentError {
    /// Two things that belong together differ in length.
    #[error("{what}: {found} values where {expected} are needed")]
    Length {
        /// Name of the quantity.
        what: &'static str,
        /// Values expected.
        expected: usize,
        /// Values found.
        found: usize,
    },
    /// Fewer data than parameters.
    #[error("{samples} sample{} cannot determine {parameters} parameter{}", plural(*.samples), plural(*.parameters))]
    TooFewSamples {
        /// Samples given.
        samples: usize,
        /// Parameters wanted.
        parameters: usize,
    },
    /// A value is NaN or infinite.
    #[error("{what} holds a value that is not finite at index {index}")]
    NotFinite {
        /// Where it was found.
        what: &'static str,
        /// Index of the first such value.
        index: usize,
    },
    /// The data do not determine every parameter.
    #[error("the data determine only {rank} of {parameters} parameters (condition number {condition:.1e})")]
    RankDeficient {
        /// Numerical rank.
        rank: usize,
        /// Parameters wanted.
        parameters: usize,
        /// Condition number of the scaled regressor.
        condition: f64,
    },
    /// A signal that has to vary is constant.
    #[error("{what} does not vary, so nothing can be learnt from it")]
    Constant {
        /// The signal.
        what: &'static str,
    },
    /// A starting value or bound is unusable.
    #[error("parameter {index}: start {start} is outside its bounds {lower} to {upper}")]
    StartOutsideBounds {
        /// Parameter.
        index: usize,
        /// Starting value.
        start: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// The decomposition of a matrix failed.
    #[error(transparent)]
    Decomposition(#[from] numerics::linalg::DecompositionError),
    /// The sample time is not a positive finite number.
    #[error("sample time {sample_time_s} s is not a positive finite number")]
    SampleTime {
        /// The value given.
        sample_time_s: f64,
    },
    /// Data without an output.
    #[error("the data have no output")]
    NoOutput,
    /// A structure, its options and its data that do not fit together.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// Samples are missing where the method needs every one.
    #[error("{what} has a missing sample at index {index}; fill it, or split the data there")]
    Missing {
        /// The signal.
        what: &'static str,
        /// Index of the first missing sample.
        index: usize,
    },
    /// An operation on a system failed.
    #[error(transparent)]
    Lti(#[from] lti::LtiError),
    /// An operation on a signal failed.
    #[error(transparent)]
    Signal(#[from] signal::SignalError),
    /// An input sample is missing, so nothing can be said of what follows it.
    #[error(
        "input {channel} of experiment {experiment} has a missing sample at index {index}; fill it, or split the data there"
    )]
    MissingInput {
        /// Index of the experiment.
        experiment: usize,
        /// The input's name.
        channel: String,
        /// Index of the first missing sample.
        index: usize,
    },
    /// A document of another version.
    #[error(
        "this is version {found} of the layout, and version {known} is understood: {}",
        if found > known { "a later dynoid wrote it; take that one, or write the model again with this one" } else { "write the model again" }
    )]
    DocumentVersion {
        /// The version it says it has.
        found: u32,
        /// The version that can be read.
        known: u32,
    },
    /// A document of another kind.
    #[error("this is a document of \"{found}\", where \"{expected}\" is understood")]
    Document {
        /// Kind of document that the file states.
        found: String,
        /// Kind of document that can be read.
        expected: String,
    },
    /// A model without an estimate, where its uncertainty is asked for.
    #[error("the model carries no estimate, so its uncertainty is not known")]
    NoEstimate,
    /// A formula that cannot be read.
    #[error("formula \"{formula}\", character {position}: expected {expected}")]
    Formula {
        /// The formula.
        formula: String,
        /// Where reading stopped, in characters from one.
        position: usize,
        /// Text that is allowed there.
        expected: &'static str,
    },
    /// A structure of formulas that does not hold together.
    #[error("{place}: {fault}")]
    FormulaStructure {
        /// The parameter or the entry.
        place: String,
        /// Fault of that part.
        fault: StructureFault,
    },
}

/// Fault of a part of a structure of formulas.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StructureFault {
    /// A name in a formula that no parameter has.
    #[error("there is no parameter \"{name}\"; list it among the parameters, or correct the name")]
    UnknownName {
        /// The name.
        name: String,
    },
    /// A matrix of another shape than the others ask for.
    #[error("{found} entries where {expected} are needed")]
    Shape {
        /// Rows and columns needed.
        expected: lti::Dimensions,
        /// Rows and columns found; the columns are those of the first row that differs.
        found: lti::Dimensions,
    },
    /// A parameter that nothing depends on.
    #[error("no matrix and no delay depends on it, so nothing can be learnt of it; use it or leave it out")]
    Unused,
    /// A name given twice.
    #[error("the name is given twice")]
    Repeated,
    /// A name that a formula cannot hold.
    #[error("a name has letters, digits and _, begins with no digit, and is none of pi, sqrt and exp")]
    Name,
    /// A value that is not finite, or not within its bounds.
    #[error("the value {value} is not a finite number from {lower} to {upper}")]
    Value {
        /// The value.
        value: f64,
        /// The smallest allowed.
        lower: f64,
        /// The largest allowed.
        upper: f64,
    },
    /// A prior that is no distribution.
    #[error("a prior needs a finite mean and a positive standard deviation")]
    Prior,
    /// Input delays in seconds of a discrete model.
    #[error("a discrete model takes no input delays in seconds; give them as states, or leave the sample time out")]
    DelayOfDiscrete,
}

/// The ending of the plural.
fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}
