//! The simulation as one discrete linear system.

use faer::Mat;
use lti::StateSpace;
use rig::results::Part;

use super::error::SimulationError;
use super::inputs::InitialState;
use super::plant::{STATES, Substep, TORQUE, samples_back};
use crate::model::BenchModel;

/// Control that holds the dynamometer in a linear form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopMode {
    /// Speed control: inputs ω_d*, T_e.
    Speed,
    /// Torque control: inputs T_d*, T_e.
    Torque,
}

/// The bench as a discrete linear system: exactly what [`super::simulate`] does while T_d* is below its limit.
///
/// Outputs: ω_d and ω_e as the encoders read them, T_d, T_shaft, T_d*. The engine torque is straight between the
/// samples, so it enters the states before their time: the state at a sample is that of the bench less what the engine
/// torque of that sample has brought about since the sample before.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearForm {
    /// The system, on the tick of the controller.
    pub system: StateSpace,
    /// The states, in order.
    states: Vec<State>,
    /// Amount that the first engine torque takes off each state.
    of_engine_torque: Vec<f64>,
    sample_time_s: f64,
}

/// Meaning of a state of the linear form; the number counts samples back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// ω_d, ω_e, Δθ, T_d.
    Plant(usize),
    /// Angle that the dynamometer has turned since an earlier sample.
    DynoAngle(usize),
    /// The same of the engine.
    EngineAngle(usize),
    /// Earlier ω_d.
    DynoSpeed(usize),
    /// Earlier ω_e.
    EngineSpeed(usize),
    /// The integrator of the controller.
    Integral,
    /// Earlier output of PI.
    Delayed(usize),
    /// Earlier feed-forward, or T_d*.
    Immediate(usize),
    /// Earlier ω_d*.
    Demand(usize),
    /// Earlier reading of ω_d.
    Reading(usize),
}

/// A linear function of the states, of both inputs at this sample, and of both at the next.
type Form = Vec<f64>;

/// The linear form of a model in a mode; in torque control with this sample time, in speed control with that of the
/// controller.
///
/// Where the recordings have ω_d* later than the controller has it (a negative delay), the input is ω_d* as the
/// controller has it.
///
/// # Errors
/// The model lacks torque control, or in speed control the speed controller.
pub fn linear_form(model: &BenchModel, mode: LoopMode, sample_time_s: f64) -> Result<LinearForm, SimulationError> {
    let step_s = match mode {
        LoopMode::Torque => sample_time_s,
        LoopMode::Speed => {
            model.speed_controller.ok_or(SimulationError::MissingPart { part: Part::SpeedController })?.sample_time_s
        }
    };
    Builder::new(model, mode, step_s)?.build()
}

impl LinearForm {
    /// Name of each state; the number counts samples back.
    #[must_use]
    pub fn state_names(&self) -> Vec<String> {
        let plant = ["w_d", "w_e", "twist", "T_d"];
        let name = |state: &State| match *state {
            State::Plant(which) => plant[which].to_owned(),
            State::DynoAngle(back) => format!("turn_d_{back}"),
            State::EngineAngle(back) => format!("turn_e_{back}"),
            State::DynoSpeed(back) => format!("w_d_{back}"),
            State::EngineSpeed(back) => format!("w_e_{back}"),
            State::Integral => "integrator".to_owned(),
            State::Delayed(back) => format!("pi_{back}"),
            State::Immediate(back) => format!("direct_{back}"),
            State::Demand(back) => format!("w_d_demand_{back}"),
            State::Reading(back) => format!("w_d_read_{back}"),
        };
        self.states.iter().map(name).collect()
    }

    /// The state at the first sample, as a simulation from `start` has it, where the inputs at this sample are `first`
    /// (demand in rad/s or Nm, and T_e in Nm).
    #[must_use]
    pub fn initial(&self, start: &InitialState, first: [f64; 2], feed_forward_nm: f64) -> Vec<f64> {
        let plant = [start.dyno_speed_rad_s, start.engine_speed_rad_s, start.twist_rad, start.air_gap_torque_nm];
        let turned = |speed: f64, back: usize| speed * back as f64 * self.sample_time_s;
        let value = |state: &State| match *state {
            State::Plant(which) => plant[which],
            State::DynoAngle(back) => turned(start.dyno_speed_rad_s, back),
            State::EngineAngle(back) => turned(start.engine_speed_rad_s, back),
            State::DynoSpeed(_) | State::Reading(_) => start.dyno_speed_rad_s,
            State::EngineSpeed(_) => start.engine_speed_rad_s,
            State::Integral | State::Delayed(_) => start.integrator_nm,
            State::Immediate(_) => feed_forward_nm,
            State::Demand(_) => first[0],
        };
        self.states.iter().zip(&self.of_engine_torque).map(|(state, share)| value(state) - share * first[1]).collect()
    }
}

/// Builds the system from linear forms.
struct Builder<'a> {
    model: &'a BenchModel,
    mode: LoopMode,
    step_s: f64,
    substeps: Vec<Substep>,
    states: Vec<State>,
    /// Samples by which ω_d* is late in the speed error and in the feed-forward.
    lags: (usize, usize),
    /// Samples for which the speed error waits for its demand; its output is as much younger than the reading in it.
    wait: usize,
}

impl<'a> Builder<'a> {
    fn new(model: &'a BenchModel, mode: LoopMode, step_s: f64) -> Result<Self, SimulationError> {
        let torque_control = model.torque_control.ok_or(SimulationError::MissingPart { part: Part::TorqueControl })?;
        let substeps = Substep::of_a_sample(model, Some(torque_control), step_s)?;
        let (in_error, in_feed_forward) = model.demand_lags();
        let lags = (in_error.max(0).unsigned_abs(), in_feed_forward);
        let wait = in_error.min(0).unsigned_abs();
        let states = states(model, mode, step_s, &substeps, lags, wait);
        Ok(Builder { model, mode, step_s, substeps, states, lags, wait })
    }

    fn build(self) -> Result<LinearForm, SimulationError> {
        let n = self.states.len();
        let demand = self.demand();
        let next = self.next(&demand);
        let outputs = self.outputs(&demand);
        let matrix =
            |rows: &[Form], from: usize, count: usize| Mat::from_fn(rows.len(), count, |i, j| rows[i][from + j]);
        // z̃ = z − G₁ w: what the inputs at the next sample do is taken off the state, and added where it is used.
        let (f, g0, g1) = (matrix(&next, 0, n), matrix(&next, n, 2), matrix(&next, n + 2, 2));
        let (h, l) = (matrix(&outputs, 0, n), matrix(&outputs, n, 2));
        let (b, d) = (&f * &g1 + &g0, &h * &g1 + &l);
        let system = StateSpace::discrete(f, b, h, d, self.step_s)?;
        let of_engine_torque = (0..n).map(|i| g1[(i, 1)]).collect();
        Ok(LinearForm { system, states: self.states, of_engine_torque, sample_time_s: self.step_s })
    }

    fn zero(&self) -> Form {
        vec![0.0; self.states.len() + 4]
    }

    /// A state as a form; zero where it is none.
    fn state(&self, state: State) -> Form {
        let mut form = self.zero();
        if let Some(place) = self.states.iter().position(|other| *other == state) {
            form[place] = 1.0;
        }
        form
    }

    /// An input at this sample or the next.
    fn input(&self, which: usize, is_next: bool) -> Form {
        let mut form = self.zero();
        let inputs = self.states.len();
        form[inputs + which + if is_next { 2 } else { 0 }] = 1.0;
        form
    }

    /// The reading of an encoder: the mean over its gate.
    fn reading(&self, speed: usize, angle: fn(usize) -> State, earlier: fn(usize) -> State) -> Form {
        let gate = self.model.encoder_gate_s / self.step_s;
        let now = self.state(State::Plant(speed));
        if gate <= 0.0 {
            return now;
        }
        let samples = gate.ceil() as usize;
        let part = gate.ceil() - gate;
        let turned = |back: usize| if back == 0 { self.zero() } else { self.state(angle(back)) };
        let (long, short) = (turned(samples), turned(samples - 1));
        let whole = 1.0 / (gate * self.step_s);
        if part == 0.0 {
            return combined(&[(whole, &long)]);
        }
        // The cubic between the two samples about the beginning of the gate.
        let (rest, square) = (1.0 - part, part * part);
        let share = square * (3.0 - 2.0 * part);
        let slope = part * rest * self.step_s;
        let before = self.state(earlier(samples));
        let after = if samples == 1 { now } else { self.state(earlier(samples - 1)) };
        combined(&[
            (whole * (1.0 - share), &long),
            (whole * share, &short),
            (-whole * slope * rest, &before),
            (whole * slope * part, &after),
        ])
    }

    fn dyno_reading(&self) -> Form {
        self.reading(0, State::DynoAngle, State::DynoSpeed)
    }

    /// ω_d* so many samples ago.
    fn late_demand(&self, lag: usize) -> Form {
        if lag == 0 { self.input(0, false) } else { self.state(State::Demand(lag)) }
    }

    /// Demand of the controller at this sample: output of PI, feed-forward (or T_d*), and the speed error.
    fn demand(&self) -> Demand {
        let Some(pi) = self.model.speed_controller.filter(|_| self.mode == LoopMode::Speed) else {
            return Demand { delayed: self.zero(), immediate: self.input(0, false), error: self.zero() };
        };
        let reading = if self.wait == 0 { self.dyno_reading() } else { self.state(State::Reading(self.wait)) };
        let error = combined(&[(1.0, &reading), (-1.0, &self.late_demand(self.lags.0))]);
        let delayed = combined(&[(pi.proportional_nm_s_per_rad, &error), (1.0, &self.state(State::Integral))]);
        let immediate = self.model.feed_forward.map_or_else(
            || self.zero(),
            |feed| {
                let slope = feed.acceleration_nm_s2_per_rad / self.step_s;
                let (now, before) = (self.late_demand(self.lags.1), self.late_demand(self.lags.1 + 1));
                combined(&[(feed.speed_nm_s_per_rad + slope, &now), (-slope, &before)])
            },
        );
        Demand { delayed, immediate, error }
    }

    /// T_d* as it acts with these delays in samples; that of the controller's output counts from the reading in it.
    fn acting(&self, demand: &Demand, delayed_back: usize, immediate_back: usize) -> Form {
        let past = |now: &Form, back: usize, state: fn(usize) -> State| match back {
            0 => now.clone(),
            _ => self.state(state(back)),
        };
        let delayed = past(&demand.delayed, delayed_back.saturating_sub(self.wait), State::Delayed);
        let immediate = past(&demand.immediate, immediate_back, State::Immediate);
        combined(&[(1.0, &delayed), (1.0, &immediate)])
    }

    /// Every state at the next sample.
    fn next(&self, demand: &Demand) -> Vec<Form> {
        let plant = self.plant_after(demand);
        let row = |state: &State| match *state {
            State::Plant(which) => plant[which].clone(),
            State::DynoAngle(1) => plant[4].clone(),
            State::EngineAngle(1) => plant[5].clone(),
            State::DynoAngle(back) => combined(&[(1.0, &plant[4]), (1.0, &self.state(State::DynoAngle(back - 1)))]),
            State::EngineAngle(back) => combined(&[(1.0, &plant[5]), (1.0, &self.state(State::EngineAngle(back - 1)))]),
            State::DynoSpeed(1) => self.state(State::Plant(0)),
            State::EngineSpeed(1) => self.state(State::Plant(1)),
            State::DynoSpeed(back) => self.state(State::DynoSpeed(back - 1)),
            State::EngineSpeed(back) => self.state(State::EngineSpeed(back - 1)),
            State::Integral => {
                let gain = self.model.speed_controller.map_or(0.0, |pi| pi.integral_nm_per_rad * pi.sample_time_s);
                combined(&[(1.0, &self.state(State::Integral)), (gain, &demand.error)])
            }
            State::Delayed(1) => demand.delayed.clone(),
            State::Immediate(1) => demand.immediate.clone(),
            State::Demand(1) => self.input(0, false),
            State::Reading(1) => self.dyno_reading(),
            State::Delayed(back) => self.state(State::Delayed(back - 1)),
            State::Immediate(back) => self.state(State::Immediate(back - 1)),
            State::Demand(back) => self.state(State::Demand(back - 1)),
            State::Reading(back) => self.state(State::Reading(back - 1)),
        };
        self.states.iter().map(row).collect()
    }

    /// ω_d, ω_e, Δθ, T_d and the angles turned, one sample later.
    fn plant_after(&self, demand: &Demand) -> Vec<Form> {
        let mut now: Vec<Form> = (0..4).map(|which| self.state(State::Plant(which))).collect();
        now.extend([self.zero(), self.zero()]);
        for substep in &self.substeps {
            let braking = self.acting(demand, substep.delayed_back, substep.immediate_back);
            let engine = |x: f64| combined(&[(1.0 - x, &self.input(1, false)), (x, &self.input(1, true))]);
            let (first, last) = (engine(substep.from), engine(substep.to));
            let row = |i: usize| {
                let mut terms: Vec<(f64, &Form)> = (0..STATES).map(|j| (substep.transition[i][j], &now[j])).collect();
                terms.push((substep.first[i][0] + substep.last[i][0], &braking));
                terms.extend([(substep.first[i][1], &first), (substep.last[i][1], &last)]);
                combined(&terms)
            };
            now = (0..STATES).map(row).collect();
        }
        now
    }

    fn outputs(&self, demand: &Demand) -> Vec<Form> {
        let mechanics = &self.model.mechanics;
        let (dyno, engine) = (self.state(State::Plant(0)), self.state(State::Plant(1)));
        let shaft = combined(&[
            (mechanics.stiffness_nm_per_rad, &self.state(State::Plant(2))),
            (mechanics.damping_nm_s_per_rad, &engine),
            (-mechanics.damping_nm_s_per_rad, &dyno),
        ]);
        let has_lag = self.model.torque_control.is_some_and(|control| control.bandwidth_rad_s.is_some());
        let torque = match self.substeps.first() {
            Some(first) if !has_lag => self.acting(demand, first.delayed_back, first.immediate_back),
            _ => self.state(State::Plant(TORQUE)),
        };
        let own_delay = self.model.speed_controller.map_or(0.0, |pi| pi.delay_s / pi.sample_time_s);
        let back = if self.mode == LoopMode::Speed { samples_back(own_delay, 0.0) } else { 0 };
        vec![
            self.dyno_reading(),
            self.reading(1, State::EngineAngle, State::EngineSpeed),
            torque,
            shaft,
            self.acting(demand, back, 0),
        ]
    }
}

struct Demand {
    delayed: Form,
    immediate: Form,
    error: Form,
}

fn combined(terms: &[(f64, &Form)]) -> Form {
    let length = terms.first().map_or(0, |(_, form)| form.len());
    (0..length).map(|i| terms.iter().map(|(factor, form)| factor * form[i]).sum()).collect()
}

/// The states that this model needs.
fn states(
    model: &BenchModel,
    mode: LoopMode,
    step_s: f64,
    substeps: &[Substep],
    lags: (usize, usize),
    wait: usize,
) -> Vec<State> {
    let gate = model.encoder_gate_s / step_s;
    let samples = gate.max(0.0).ceil() as usize;
    let speeds = if gate.fract() == 0.0 { 0 } else { samples };
    let most = |back: fn(&Substep) -> usize| substeps.iter().map(back).max().unwrap_or(0);
    let own_delay = model.speed_controller.map_or(0.0, |pi| pi.delay_s / pi.sample_time_s);
    let (delayed, demands, readings) = match mode {
        LoopMode::Torque => (0, 0, 0),
        LoopMode::Speed => {
            let feed = model.feed_forward.map_or(0, |_| lags.1 + 1);
            let oldest = most(|s| s.delayed_back).max(samples_back(own_delay, 0.0));
            (oldest.saturating_sub(wait), lags.0.max(feed), wait)
        }
    };
    let mut states: Vec<State> = (0..4).map(State::Plant).collect();
    states.extend((1..=samples).map(State::DynoAngle));
    states.extend((1..=samples).map(State::EngineAngle));
    states.extend((1..=speeds).map(State::DynoSpeed));
    states.extend((1..=speeds).map(State::EngineSpeed));
    states.extend((mode == LoopMode::Speed).then_some(State::Integral));
    states.extend((1..=delayed).map(State::Delayed));
    states.extend((1..=most(|s| s.immediate_back)).map(State::Immediate));
    states.extend((1..=demands).map(State::Demand));
    states.extend((1..=readings).map(State::Reading));
    states
}
