//! A bench model as linear models of the toolbox, and linear models as matrices.

use bench_model::document::BenchModelDocument;
use bench_model::model::{BenchModel, ModelParameter, PartCovariance};
use bench_model::simulate::{LoopMode, linear_form};
use faer::Mat;
use ident::uncertainty::Dynamics;
use ident::{
    AnyModel, EstimateRecord, Formula, FormulaParts, FormulaStructure, GreyBoxModel, GreyParameter, IdentError, Label,
    LinearModel, ModelDocument, Parametric, Source, StateSpaceModel, Termination,
};
use lti::{Innovations, StateSpace};

use crate::ExportError;
use crate::numbers::name_of;

/// Time between ticks where the model has no controller, s.
pub(crate) const TICK_S: f64 = 1e-3;
const SPEEDS: [(&str, &str); 2] = [("N_d", "rad/s"), ("N_e", "rad/s")];
const TORQUES: [(&str, &str); 2] = [("T_d", "Nm"), ("T_shaft", "Nm")];

/// The bench as linear models with named channels, each with the name of its control mode.
///
/// *TN torques* and *TN speeds*: T_d* and T_e to T_d and T_shaft, and to N_d and N_e, continuous, with the covariance
/// of the estimates. Without torque control the input is T_d. The speeds integrate the torques, T_d and T_shaft do not,
/// so each has a model of its own. *NT*: N_d* and T_e to all of them and T_d* in speed control, discrete, exact below
/// the torque limit, without covariance; it is there where the model has a speed controller. Speeds are in rad/s; those
/// of *TN* are without the encoders' gate.
///
/// # Errors
/// [`ExportError`] where the model has no linear form.
pub fn toolbox_models(document: &BenchModelDocument) -> Result<Vec<(&'static str, ModelDocument)>, ExportError> {
    let mut models =
        vec![("TN torques", torque_control(document, &TORQUES)?), ("TN speeds", torque_control(document, &SPEEDS)?)];
    if document.model.torque_control.is_some() && document.model.speed_controller.is_some() {
        models.push(("NT", speed_control(&document.model)?));
    }
    Ok(models)
}

fn labels(channels: &[(&str, &str)]) -> Vec<Label> {
    channels.iter().map(|(name, unit)| Label::new(*name, *unit)).collect()
}

/// The closed loop of speed control.
fn speed_control(model: &BenchModel) -> Result<ModelDocument, ExportError> {
    let form = linear_form(model, LoopMode::Speed, TICK_S)?;
    let outputs = form.system.outputs();
    let tick_s = form.system.sample_time_s().unwrap_or(TICK_S);
    let innovations = Innovations::output_error(form.system, Mat::zeros(outputs, outputs)).map_err(IdentError::from)?;
    let model = StateSpaceModel::new(innovations, false, false);
    let inputs = labels(&[("N_d*", "rad/s"), ("T_e", "Nm")]);
    let outputs = labels(&[&SPEEDS[..], &TORQUES[..], &[("T_d*", "Nm")]].concat());
    Ok(ModelDocument::new(model, inputs, outputs, tick_s))
}

/// The open bench as formulas of its parameters.
fn torque_control(document: &BenchModelDocument, responses: &[(&str, &str)]) -> Result<ModelDocument, ExportError> {
    let model = &document.model;
    let torque = if model.torque_control.is_some() { "T_d*" } else { "T_d" };
    let structure = FormulaStructure::new(parts(model, responses == SPEEDS)?)?;
    let grey = GreyBoxModel::new(structure).map_err(IdentError::from)?;
    let record = record(document, &grey);
    let tick_s = model.speed_controller.map_or(TICK_S, |pi| pi.sample_time_s);
    let inputs = labels(&[(torque, "Nm"), ("T_e", "Nm")]);
    let mut written = ModelDocument::new(grey, inputs, labels(responses), tick_s);
    written.estimate = Some(record);
    Ok(written)
}

/// With Δω = ω_e − ω_d and p = J_d ω_d + J_e ω_e: dΔω/dt = T_e/J_e + T_d/J_d − (1/J_d + 1/J_e) T_shaft, dΔθ/dt = Δω,
/// T_shaft = K Δθ + B Δω, dT_d/dt = a (T_d* − T_d); for the speeds dp/dt = T_e − T_d too. In these states the
/// integrator of the speeds is exactly one.
fn parts(model: &BenchModel, is_speeds: bool) -> Result<FormulaParts, IdentError> {
    let used = [
        ModelParameter::DynoInertia,
        ModelParameter::EngineInertia,
        ModelParameter::Stiffness,
        ModelParameter::Damping,
        ModelParameter::TorqueControlDelay,
        ModelParameter::TorqueControlBandwidth,
    ];
    let parameter = |which: ModelParameter| Some(GreyParameter::new(name_of(which).0, model.value(which)?));
    let has_lag = model.value(ModelParameter::TorqueControlBandwidth).is_some();
    let equations = Equations::of(has_lag, is_speeds);
    let delays: &[&str] = if model.torque_control.is_some() { &["tau_t", "0"] } else { &[] };
    Ok(FormulaParts {
        parameters: used.into_iter().filter_map(parameter).collect(),
        a: formulas(&equations.a)?,
        b: formulas(&equations.b)?,
        c: formulas(&equations.c)?,
        d: formulas(&equations.d)?,
        input_delays_s: delays.iter().map(|text| text.parse()).collect::<Result<_, _>>()?,
        ..FormulaParts::default()
    })
}

/// Matrices by rows of formulas; states Δω, Δθ, then T_d with a lag, then p for the speeds.
struct Equations {
    a: Vec<Vec<&'static str>>,
    b: Vec<Vec<&'static str>>,
    c: Vec<Vec<&'static str>>,
    d: Vec<Vec<&'static str>>,
}

impl Equations {
    fn of(has_lag: bool, is_speeds: bool) -> Self {
        let mut own = Equations {
            a: vec![vec!["-B*(1/J_d + 1/J_e)", "-K*(1/J_d + 1/J_e)"], vec!["1", "0"]],
            b: vec![vec!["1/J_d", "1/J_e"], vec!["0", "0"]],
            c: vec![vec!["0", "0"], vec!["B", "K"]],
            d: vec![vec!["1", "0"], vec!["0", "0"]],
        };
        if is_speeds {
            own.c = vec![vec!["-J_e/(J_d + J_e)", "0"], vec!["J_d/(J_d + J_e)", "0"]];
            own.d = vec![vec!["0", "0"], vec!["0", "0"]];
        }
        let mut torque = ["-1", "1"];
        if has_lag {
            own.add_state(["1/J_d", "0"], "-a", ["a", "0"], if is_speeds { ["0", "0"] } else { ["1", "0"] });
            own.b[0][0] = "0";
            own.d[0][0] = "0";
            torque[0] = "0";
        }
        if is_speeds {
            own.add_state(["0", "0"], "0", torque, ["1/(J_d + J_e)"; 2]);
            if has_lag {
                own.a[3][2] = "-1";
            }
        }
        own
    }

    /// A further state: its share in Δω and Δθ, in itself, of the inputs, and in the outputs.
    fn add_state(
        &mut self,
        column: [&'static str; 2],
        own: &'static str,
        inputs: [&'static str; 2],
        out: [&'static str; 2],
    ) {
        let before = self.a.len();
        for (i, row) in self.a.iter_mut().enumerate() {
            row.push(column.get(i).copied().unwrap_or("0"));
        }
        let mut row = vec!["0"; before];
        row.push(own);
        self.a.push(row);
        self.b.push(inputs.to_vec());
        self.c.iter_mut().zip(out).for_each(|(row, entry)| row.push(entry));
    }
}

fn formulas(rows: &[Vec<&str>]) -> Result<Vec<Vec<Formula>>, IdentError> {
    rows.iter().map(|row| row.iter().map(|text| text.parse()).collect()).collect()
}

/// Record of the parameters' estimate, as a fit would have it. The degrees of freedom are the least of all parts.
fn record(document: &BenchModelDocument, grey: &GreyBoxModel<FormulaStructure>) -> EstimateRecord {
    let names = grey.parameter_names();
    let parts: Vec<PartCovariance> = document.uncertainty.clone().into();
    let place = |part: &PartCovariance, name: &str| part.parameters.iter().position(|p| name_of(*p).0 == name);
    let entry = |row: &str, column: &str| {
        let of = |part: &PartCovariance| Some(part.covariance[place(part, row)?][place(part, column)?]);
        parts.iter().find_map(of).unwrap_or(0.0)
    };
    let covariance = names.iter().map(|row| names.iter().map(|column| entry(row, column)).collect()).collect();
    let is_used = |part: &&PartCovariance| names.iter().any(|name| place(part, name).is_some());
    let degrees = parts.iter().filter(is_used).map(|part| part.degrees_of_freedom).fold(f64::INFINITY, f64::min);
    let source = |recording: &bench_model::document::UsedRecording| Source {
        file: recording.file.clone(),
        sha256: recording.sha256.clone(),
        from_s: 0.0,
        to_s: 0.0,
    };
    EstimateRecord {
        method: "bench model of a study".to_owned(),
        sources: document.provenance.recordings.iter().map(source).collect(),
        parameters: grey.parameters(),
        covariance,
        // A document cannot hold infinity.
        degrees_of_freedom: degrees.min(1e9),
        noise_covariance: vec![vec![0.0; TORQUES.len()]; TORQUES.len()],
        loss: 0.0,
        samples: 0,
        free_parameters: names.len(),
        parameter_names: names,
        initial_states: Vec::new(),
        termination: Termination::Direct,
        iterations: 0,
        condition: None,
        doubts: Vec::new(),
    }
}

/// A linear model as matrices.
pub(crate) struct Matrices {
    /// On the clock of its data, with the noise gain: exactly what the program simulates.
    pub(crate) discrete: Innovations,
    /// In continuous time, with the delay of each output and input, s, by rows of outputs; none for a discrete model.
    pub(crate) continuous: Option<(StateSpace, Vec<Vec<f64>>)>,
}

impl Matrices {
    /// The matrices of a model file.
    pub(crate) fn of(document: &ModelDocument) -> Result<Self, ExportError> {
        let model: &AnyModel = &document.model;
        let innovations = model.innovations(document.sample_time_s, document.intersample);
        let discrete = innovations.map_err(IdentError::from)?;
        let system = model.system().map_err(IdentError::from)?;
        let continuous = match system.sample_time_s() {
            Some(_) => None,
            None => {
                let row = |output| (0..model.inputs()).map(|input| model.delay_s(output, input)).collect();
                let delays: Result<Vec<Vec<f64>>, _> = (0..model.outputs()).map(row).collect();
                Some((system, delays.map_err(IdentError::from)?))
            }
        };
        Ok(Matrices { discrete, continuous })
    }
}
