//! Conflicts between a structure, its options and its data.

/// Conflict between a structure, its options and its data.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StructureError {
    /// Data or a model with another number of inputs or outputs than a method takes.
    #[error("{method} takes {}, and there {} {found}{}", .of.counted(*.allowed), is_or_are(*.found), .of.remedy(*.found))]
    Channels {
        /// The method.
        method: &'static str,
        /// Which channels.
        of: ChannelKind,
        /// How many there may be.
        allowed: Count,
        /// How many there are.
        found: usize,
    },
    /// A channel that the data do not have.
    #[error(
        "there is no channel from input {input} to output {output}: the data have {inputs} inputs and {outputs} outputs"
    )]
    NoChannel {
        /// The output asked for, from zero.
        output: usize,
        /// The input asked for, from zero.
        input: usize,
        /// Outputs of the data.
        outputs: usize,
        /// Inputs of the data.
        inputs: usize,
    },
    /// Data without an experiment.
    #[error("the data have no experiment")]
    NoExperiment,
    /// Data sets of which one has held inputs, for example, and the other has not.
    #[error("the inputs of the data sets differ in their behaviour between samples")]
    IntersampleDiffers,
    /// An output that is not known at equal distances.
    #[error("the output is not known every so many samples")]
    UnevenOutput,
    /// A number that is too small, such as an order of zero.
    #[error("{what}: {found}, where at least {least} {} needed", is_or_are(*.least))]
    TooFew {
        /// Things of which there are too few.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// The smallest number allowed.
        least: usize,
    },
    /// A number that is too large.
    #[error("{what}: {found}, where at most {most} {} possible", is_or_are(*.most))]
    TooMany {
        /// Things of which there are too many.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// The largest number allowed.
        most: usize,
    },
    /// An input without a coefficient.
    #[error("nb is 0, so an input has no effect; raise it, or leave the input out")]
    NoNumerator,
    /// No parameter is left to estimate.
    #[error("there is no parameter to estimate; raise an order, or free a parameter")]
    NoParameters,
    /// A range without a value.
    #[error("the range of {what} is empty: {from} to {to}")]
    EmptyRange {
        /// Of what.
        what: &'static str,
        /// The first value.
        from: usize,
        /// The last value.
        to: usize,
    },
    /// Bounds that are none.
    #[error("the bounds {low_s} s to {high_s} s of {what} must be finite and {}, the lower one first",
            if *.positive { "positive" } else { "not negative" })]
    Bounds {
        /// Of what.
        what: &'static str,
        /// The lower bound.
        low_s: f64,
        /// The upper bound.
        high_s: f64,
        /// True if zero is refused.
        positive: bool,
    },
    /// Bounds of a parameter that it cannot lie within.
    #[error("the bounds {low} to {high} of {name}: {fault}")]
    ParameterBounds {
        /// The parameter.
        name: String,
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
        /// Fault of the bounds.
        fault: BoundsFault,
    },
    /// Lists that belong together differ in length.
    #[error("nb has {nb} entries, nf {nf} and nk {nk}; each input needs one entry in each list")]
    EntriesDiffer {
        /// Entries of nb.
        nb: usize,
        /// Entries of nf.
        nf: usize,
        /// Entries of nk.
        nk: usize,
    },
    /// Denominators of unequal orders where one order is needed.
    #[error("the denominators of all inputs need equal orders, and nf is {nf:?}")]
    UnequalOrders {
        /// The orders.
        nf: Vec<usize>,
    },
    /// Horizons that cannot hold the order.
    #[error(
        "horizons of {past} past and {future} future samples cannot hold {order} states: (future − 1) · {outputs} must reach \
         it, and past · {channels}; lengthen them"
    )]
    Horizons {
        /// Samples of the past horizon.
        past: usize,
        /// Samples of the future horizon.
        future: usize,
        /// States asked for.
        order: usize,
        /// Outputs.
        outputs: usize,
        /// Inputs and outputs.
        channels: usize,
    },
    /// A name that is none of a process model.
    #[error("\"{name}\" is no process model: the name is P0 to P3, then letters of D, Z, U, I, and U needs two poles")]
    ProcessName {
        /// The name given.
        name: String,
    },
    /// A parameter to be held or bounded that the model does not have.
    #[error("the model has no parameter \"{name}\"; its parameters are {}", .parameters.join(", "))]
    UnknownParameter {
        /// The name given.
        name: String,
        /// The names there are.
        parameters: Vec<String>,
    },
    /// Held coefficients that leave no stable predictor.
    #[error("the held coefficients make no stable predictor")]
    HeldUnstable,
    /// A prior that is no distribution.
    #[error(
        "the prior of parameter {index} has mean {mean} and standard deviation {deviation}: a finite mean and a positive deviation are needed"
    )]
    Prior {
        /// Parameter.
        index: usize,
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// A delay that cannot be searched for, as it shows only as a whole number of samples.
    #[error("with held inputs and as many zeros as poles the delay cannot be searched for; give it")]
    DelayNotSearchable,
    /// A delay at a whole number of samples, where the number of states changes.
    #[error("a delay is at a whole number of samples, where the number of states changes; start beside it")]
    WholeDelay,
    /// An option that a method does not take.
    #[error("refined instrumental variables {0}; use output error")]
    Refined(RefinedLimit),
    /// Simulation or a prefilter asked for without inputs.
    #[error("without inputs there are no dynamics to simulate or to filter")]
    NoDynamics,
    /// A prefilter without a coefficient other than zero.
    #[error("the prefilter is zero")]
    ZeroPrefilter,
    /// A band without a frequency of the spectrum.
    #[error(
        "no frequency of the spectrum lies between {low_hz} Hz and {high_hz} Hz; widen the band, or lengthen the segments"
    )]
    EmptyBand {
        /// The lower end.
        low_hz: f64,
        /// The upper end.
        high_hz: f64,
    },
    /// A frequency with nothing to estimate from.
    #[error("frequency {index} needs an input and a positive variance, and may not be negative")]
    Frequency {
        /// Index of the frequency.
        index: usize,
    },
    /// A covariance of input and output larger than their variances allow.
    #[error("the covariance at frequency {index} is larger than its variances allow")]
    CovarianceTooLarge {
        /// Index of the frequency.
        index: usize,
    },
    /// A variance that is negative or not finite.
    #[error("variance {value} of the noise is negative or not finite")]
    NoiseVariance {
        /// The value.
        value: f64,
    },
    /// A measurement that nothing can change, and that says otherwise.
    #[error("neither the noise nor the start leaves a measurement any uncertainty")]
    CertainMeasurement,
    /// Outputs whose errors determine each other.
    #[error("the errors of the outputs follow from each other")]
    DependentErrors,
    /// A covariance that is none.
    #[error("the covariance of the estimate is not symmetric and non-negative")]
    NotACovariance,
    /// An estimate that belongs to another model.
    #[error("the parameters of `estimate` are not those of `model`")]
    OtherParameters,
    /// Degrees of freedom that are not positive.
    #[error("the estimate has {found} degrees of freedom, and a positive number is needed")]
    DegreesOfFreedom {
        /// The number given.
        found: f64,
    },
    /// Models of which the larger does not have more free parameters.
    #[error("the larger of two nested models must have more free parameters: {larger} and {smaller}")]
    NotNested {
        /// Free parameters of the larger.
        larger: usize,
        /// Free parameters of the smaller.
        smaller: usize,
    },
    /// Something that has to be stable is not.
    #[error("{0}")]
    Unstable(UnstablePart),
    /// A rational function whose denominator lost its highest power.
    #[error("the denominator lost its highest power; try fewer poles")]
    LostDegree,
    /// No starting value was found.
    #[error(
        "no starting value was found, or no stable one near the data; try fewer poles, or give more data or frequencies"
    )]
    NoStart,
    /// None of the models compared could be fitted.
    #[error("no model could be fitted")]
    NoModel,
    /// A search that was given up before its end.
    #[error("the search was given up")]
    GivenUp,
}

/// Fault of the bounds of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BoundsFault {
    /// They are in the wrong order, or no numbers.
    #[error("give the lower one first")]
    Order,
    /// A time constant that may be zero or less, or without end.
    #[error("a time constant is a positive number of seconds")]
    TimeConstant,
    /// A negative damping.
    #[error("a damping ratio is a number that is not negative")]
    Damping,
    /// A negative delay.
    #[error("a delay is a number of seconds that is not negative")]
    Delay,
    /// It is held at a value outside.
    #[error("it is held at a value outside them")]
    HeldOutside,
}

/// Inputs or outputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelKind {
    /// Inputs.
    Inputs,
    /// Outputs.
    Outputs,
}

impl ChannelKind {
    fn counted(self, allowed: Count) -> String {
        let noun = if self == ChannelKind::Inputs { "input" } else { "output" };
        let ending = |count: usize| if count == 1 { "" } else { "s" };
        match allowed {
            Count::Exactly(count) => format!("{count} {noun}{}", ending(count)),
            Count::AtLeast(least) => format!("at least {least} {noun}{}", ending(least)),
        }
    }

    fn remedy(self, found: usize) -> &'static str {
        match (self, found) {
            (ChannelKind::Inputs, 0) => "; give an input, or model a time series as noise",
            (_, 0 | 1) => "",
            _ => "; choose from them",
        }
    }
}

/// A number that is fixed, or has a lower bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Count {
    /// This number.
    Exactly(usize),
    /// This number or more.
    AtLeast(usize),
}

/// Limit of refined instrumental variables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RefinedLimit {
    /// Several inputs.
    #[error("take one input")]
    Inputs,
    /// A delay that is searched for.
    #[error("take a known delay")]
    SearchedDelay,
    /// A start at rest, or unstable poles.
    #[error("estimate the initial state, and stable poles")]
    RestOrUnstable,
}

/// Part that has to be stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum UnstablePart {
    /// The model.
    #[error("the model is not stable")]
    Model,
    /// The predictor.
    #[error("the predictor is not stable; estimate a noise model, or ask for a stable model")]
    Predictor,
    /// The predictor of the model that a search starts from.
    #[error("the predictor of the starting model is not stable")]
    StartingPredictor,
    /// The prefilter.
    #[error("the prefilter has a pole on or outside the unit circle")]
    Prefilter,
}

impl StructureError {
    /// A wrong number of inputs.
    pub fn inputs(method: &'static str, allowed: Count, found: usize) -> Self {
        StructureError::Channels { method, of: ChannelKind::Inputs, allowed, found }
    }

    /// A wrong number of outputs.
    pub fn outputs(method: &'static str, allowed: Count, found: usize) -> Self {
        StructureError::Channels { method, of: ChannelKind::Outputs, allowed, found }
    }
}

fn is_or_are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}
