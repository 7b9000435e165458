//! [`FormulaStructure`]: a structure whose matrices are formulas of the parameters.

mod written;

use std::sync::Arc;

use faer::Mat;
use lti::{LtiError, StateSpace};

use super::{Formula, GreyBoxModel, GreyNoise, GreyParameter, Structure};
use crate::{IdentError, Parametric, StructureFault};

/// Parts of a [`FormulaStructure`].
///
/// `ẋ = A x + B u(t − delay)`, or `x(t+1) = A x(t) + B u(t) + K e(t)` with a sample time; `y = C x + D u + e`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FormulaParts {
    /// The parameters.
    pub parameters: Vec<GreyParameter>,
    /// States × states.
    pub a: Vec<Vec<Formula>>,
    /// States × inputs.
    pub b: Vec<Vec<Formula>>,
    /// Outputs × states.
    pub c: Vec<Vec<Formula>>,
    /// Outputs × inputs; all zero where empty.
    pub d: Vec<Vec<Formula>>,
    /// The sampled predictor's gain, states × outputs; empty for an output-error model.
    pub k: Vec<Vec<Formula>>,
    /// The sample time; `None` for a continuous model.
    pub sample_time_s: Option<f64>,
    /// The delay of each input in seconds, for a continuous model; none where empty.
    pub input_delays_s: Vec<Formula>,
    /// Quantities that follow from the parameters, by name.
    pub derived: Vec<(String, Formula)>,
}

/// A structure whose matrices are formulas of the parameters, as it is written down in a file.
///
/// Serialised it has the tables `parameters` (by name: `value`, and `fixed`, `min`, `max`, `prior = { mean, sd }` where
/// given), `matrices` (`A`, `B`, `C`, and `D`, `K` where given; lists of rows of formulas or numbers) and `derived` (by
/// name: a formula), and `sample_time_s` and `input_delays_s`. Parameters keep the order in which they are written.
///
/// # Example
/// ```
/// let text = r#"{
///     "parameters": { "J": { "value": 0.1, "min": 1e-3 }, "b": { "value": 0.1 } },
///     "matrices": { "A": [["-b / J"]], "B": [["1 / J"]], "C": [[1]] },
///     "derived": { "time_constant": "J / b" }
/// }"#;
/// let structure: ident::FormulaStructure = serde_json::from_str(text)?;
/// let model = ident::GreyBoxModel::new(structure)?;
/// assert_eq!(model.derived(), [("time_constant".to_owned(), 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "written::Written"))]
pub struct FormulaStructure(Arc<Bound>);

/// The parts with every name looked up.
#[derive(Debug, Clone, PartialEq)]
struct Bound {
    parameters: Vec<GreyParameter>,
    a: Table,
    b: Table,
    c: Table,
    d: Table,
    k: Table,
    sample_time_s: Option<f64>,
    input_delays_s: Vec<Entry>,
    derived: Vec<(String, Entry)>,
}

type Table = Vec<Vec<Entry>>;

/// A formula, and which parameter each of its names is.
#[derive(Debug, Clone, PartialEq)]
struct Entry {
    formula: Formula,
    places: Vec<usize>,
}

impl Entry {
    fn new(formula: Formula, parameters: &[GreyParameter], place: impl Fn() -> String) -> Result<Self, IdentError> {
        let index = |name: &String| parameters.iter().position(|p| p.name == *name).ok_or_else(|| name.clone());
        let places = formula.names().iter().map(index).collect::<Result<_, _>>();
        let places = places.map_err(|name| fault(place(), StructureFault::UnknownName { name }))?;
        Ok(Entry { formula, places })
    }

    fn at(&self, parameters: &[f64]) -> f64 {
        self.formula.evaluate(|index| parameters.get(self.places[index]).copied().unwrap_or(f64::NAN))
    }
}

fn fault(place: impl Into<String>, fault: StructureFault) -> IdentError {
    IdentError::FormulaStructure { place: place.into(), fault }
}

impl FormulaStructure {
    /// The structure of these parts.
    ///
    /// # Errors
    /// [`IdentError::FormulaStructure`] for names that no parameter has, parameters that nothing depends on, names
    /// given twice, values outside their bounds, priors that are none, and matrices of other shapes;
    /// [`IdentError::SampleTime`].
    pub fn new(parts: FormulaParts) -> Result<Self, IdentError> {
        check_parameters(&parts.parameters)?;
        check_shapes(&parts)?;
        check_time(&parts)?;
        let FormulaParts { parameters, a, b, c, d, k, sample_time_s, input_delays_s, derived } = parts;
        let table = |letter: char, rows: Vec<Vec<Formula>>| -> Result<Table, IdentError> {
            let entry = |i: usize, (j, formula): (usize, Formula)| {
                Entry::new(formula, &parameters, || format!("{letter}, row {}, column {}", i + 1, j + 1))
            };
            let row = |(i, row): (usize, Vec<Formula>)| row.into_iter().enumerate().map(|f| entry(i, f)).collect();
            rows.into_iter().enumerate().map(row).collect()
        };
        let delay = |(j, f)| Entry::new(f, &parameters, || format!("the delay of input {}", j + 1));
        let quantity = |(name, formula): (String, Formula)| {
            let entry = Entry::new(formula, &parameters, || format!("derived {name}"))?;
            Ok((name, entry))
        };
        let bound = Bound {
            a: table('A', a)?,
            b: table('B', b)?,
            c: table('C', c)?,
            d: table('D', d)?,
            k: table('K', k)?,
            input_delays_s: input_delays_s.into_iter().enumerate().map(delay).collect::<Result<_, _>>()?,
            derived: derived.into_iter().map(quantity).collect::<Result<_, IdentError>>()?,
            sample_time_s,
            parameters,
        };
        bound.check_use()?;
        Ok(FormulaStructure(Arc::new(bound)))
    }

    /// The parts again.
    #[must_use]
    pub fn parts(&self) -> FormulaParts {
        let table = |t: &Table| t.iter().map(|row| row.iter().map(|e| e.formula.clone()).collect()).collect();
        let bound = &*self.0;
        FormulaParts {
            parameters: bound.parameters.clone(),
            a: table(&bound.a),
            b: table(&bound.b),
            c: table(&bound.c),
            d: table(&bound.d),
            k: table(&bound.k),
            sample_time_s: bound.sample_time_s,
            input_delays_s: bound.input_delays_s.iter().map(|e| e.formula.clone()).collect(),
            derived: bound.derived.iter().map(|(name, e)| (name.clone(), e.formula.clone())).collect(),
        }
    }
}

impl Bound {
    fn matrix(&self, table: &Table, columns: usize, parameters: &[f64]) -> Mat<f64> {
        Mat::from_fn(table.len(), columns, |i, j| table[i][j].at(parameters))
    }

    fn inputs(&self) -> usize {
        self.b.first().map_or(0, Vec::len)
    }

    /// Refuses a free parameter without effect on the outputs, and a fixed one that appears nowhere.
    fn check_use(&self) -> Result<(), IdentError> {
        let mut used = vec![false; self.parameters.len()];
        let matrices = [&self.a, &self.b, &self.c, &self.d, &self.k];
        let entries = matrices.into_iter().flatten().flatten().chain(&self.input_delays_s);
        entries.flat_map(|e| &e.places).for_each(|place| used[*place] = true);
        let derived = self.derived.iter().flat_map(|(_, e)| &e.places);
        derived.filter(|place| self.parameters[**place].fixed).for_each(|place| used[*place] = true);
        match used.iter().position(|used| !used) {
            Some(unused) => Err(fault(about(&self.parameters[unused].name), StructureFault::Unused)),
            None => Ok(()),
        }
    }
}

fn about(name: &str) -> String {
    format!("parameter \"{name}\"")
}

fn check_parameters(parameters: &[GreyParameter]) -> Result<(), IdentError> {
    for (index, p) in parameters.iter().enumerate() {
        let (value, lower, upper) = (p.value, p.bounds.lower, p.bounds.upper);
        let wrong = if !Formula::is_name(&p.name) {
            StructureFault::Name
        } else if parameters[..index].iter().any(|other| other.name == p.name) {
            StructureFault::Repeated
        } else if !(value.is_finite() && lower <= value && value <= upper) {
            StructureFault::Value { value, lower, upper }
        } else if p.prior.is_some_and(|(mean, sd)| !(mean.is_finite() && sd.is_finite() && sd > 0.0)) {
            StructureFault::Prior
        } else {
            continue;
        };
        return Err(fault(about(&p.name), wrong));
    }
    Ok(())
}

fn check_shapes(parts: &FormulaParts) -> Result<(), IdentError> {
    let (states, outputs) = (parts.a.len().max(1), parts.c.len().max(1));
    let inputs = parts.b.first().map_or(0, Vec::len);
    let tables = [
        ("A", &parts.a, (states, states), false),
        ("B", &parts.b, (states, inputs), false),
        ("C", &parts.c, (outputs, states), false),
        ("D", &parts.d, (outputs, inputs), true),
        ("K", &parts.k, (states, outputs), true),
    ];
    for (name, rows, expected, optional) in tables {
        if optional && rows.is_empty() {
            continue;
        }
        let columns = rows.iter().map(Vec::len).find(|columns| *columns != expected.1);
        if rows.len() != expected.0 || columns.is_some() {
            let found = (rows.len(), columns.unwrap_or(expected.1));
            return Err(fault(name, StructureFault::Shape { expected: expected.into(), found: found.into() }));
        }
    }
    let delays = parts.input_delays_s.len();
    if delays != 0 && delays != inputs {
        return Err(fault(
            "input_delays_s",
            StructureFault::Shape { expected: (1, inputs).into(), found: (1, delays).into() },
        ));
    }
    Ok(())
}

fn check_time(parts: &FormulaParts) -> Result<(), IdentError> {
    let Some(sample_time_s) = parts.sample_time_s else { return Ok(()) };
    if !(sample_time_s.is_finite() && sample_time_s > 0.0) {
        return Err(IdentError::SampleTime { sample_time_s });
    }
    if parts.input_delays_s.is_empty() {
        return Ok(());
    }
    Err(fault("input_delays_s", StructureFault::DelayOfDiscrete))
}

impl Structure for FormulaStructure {
    fn parameters(&self) -> Vec<GreyParameter> {
        self.0.parameters.clone()
    }

    fn system(&self, parameters: &[f64]) -> Result<StateSpace, LtiError> {
        let bound = &*self.0;
        let (states, inputs, outputs) = (bound.a.len(), bound.inputs(), bound.c.len());
        let d = match bound.d.is_empty() {
            true => Mat::zeros(outputs, inputs),
            false => bound.matrix(&bound.d, inputs, parameters),
        };
        StateSpace::new(
            bound.matrix(&bound.a, states, parameters),
            bound.matrix(&bound.b, inputs, parameters),
            bound.matrix(&bound.c, states, parameters),
            d,
            bound.sample_time_s,
        )
    }

    fn noise(&self, parameters: &[f64]) -> GreyNoise {
        match self.0.k.is_empty() {
            true => GreyNoise::OutputError,
            false => GreyNoise::Gain(self.0.matrix(&self.0.k, self.0.c.len(), parameters)),
        }
    }

    fn input_delays_s(&self, parameters: &[f64]) -> Vec<f64> {
        self.0.input_delays_s.iter().map(|e| e.at(parameters)).collect()
    }
}

impl GreyBoxModel<FormulaStructure> {
    /// The derived quantities at the parameters, by name; for their standard errors see [`crate::Fit::derive`].
    #[must_use]
    pub fn derived(&self) -> Vec<(String, f64)> {
        let parameters = self.parameters();
        self.structure().0.derived.iter().map(|(name, e)| (name.clone(), e.at(&parameters))).collect()
    }
}
