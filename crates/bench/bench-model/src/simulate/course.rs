//! Speed control over a long time.
//!
//! Demand and engine torque are straight from one point of a coarse grid to the next. As long as the torque demand
//! keeps away from its limit, controller and bench are linear. Their samples from one point to the next are then one
//! matrix, which is found by stepping through them once. Near the limit, the bench is stepped sample by sample, with
//! limit and anti-windup.

use rig::results::Part;

use super::plant::{STATES, Substep, samples_back};
use crate::friction::DynoFriction;
use crate::model::{BenchModel, FeedForwardGains, PiController};
use crate::simulate::error::SimulationError;
use crate::simulate::inputs::InitialState;

/// Part of the torque limit from which on every sample is stepped.
const NEAR_LIMIT: f64 = 0.95;
/// Speed demand of the error and of the feed-forward, each at the points before, at and after the late or early time at
/// which a step begins; engine torque and friction at both ends of a step.
const INPUTS: usize = 10;
/// First input of the speed error, of the feed-forward, of the engine and of friction.
const OF_ERROR: usize = 0;
const OF_FEED_FORWARD: usize = 3;
const OF_ENGINE: usize = 6;
const OF_FRICTION: usize = 8;
/// I, behind ω_d, ω_e, Δθ and T_d.
const INTEGRAL: usize = 4;
/// Rows of the matrix of a step that are summed together.
const ROWS: usize = 4;
/// First of the controller's last outputs, the latest first; the last feed-forwards follow them, then the angles turned
/// in the last samples and the speeds before them.
const OUTPUTS: usize = 5;

/// Inputs of a long run: values at the points of a coarse grid, straight in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CourseInputs<'a> {
    /// Samples of the controller from one point to the next.
    pub step_samples: usize,
    /// ω_d*, rad/s.
    pub speed_demand_rad_s: &'a [f64],
    /// T_e, Nm.
    pub engine_torque_nm: &'a [f64],
    /// Friction of the dynamometer, at the speed that is demanded.
    pub friction: DynoFriction,
}

/// Response of the bench, one value a point of the grid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Course {
    /// Time from point to point, s.
    pub step_s: f64,
    /// ω_d, rad/s.
    pub dyno_speed_rad_s: Vec<f64>,
    /// ω_e, rad/s.
    pub engine_speed_rad_s: Vec<f64>,
    /// T_shaft, Nm.
    pub shaft_torque_nm: Vec<f64>,
    /// T_d*, Nm, limited.
    pub torque_demand_nm: Vec<f64>,
    /// Steps that were made sample by sample, since T_d* was near its limit.
    pub stepped: usize,
}

/// Simulates speed control over a long time, see [`CourseInputs`].
///
/// Speeds are those of the shaft's ends, and no readings of encoders. All else is what [`super::simulate`] gives at
/// every sample of the straight inputs.
///
/// # Errors
/// A part that speed control needs is missing, inputs of unequal length or fewer than two points.
pub fn simulate_course(
    model: &BenchModel,
    inputs: &CourseInputs<'_>,
    start: &InitialState,
) -> Result<Course, SimulationError> {
    let points = inputs.speed_demand_rad_s.len();
    if points < 2 || inputs.engine_torque_nm.len() != points {
        let found = inputs.engine_torque_nm.len();
        return Err(SimulationError::Length { what: "engine torque", expected: points.max(2), found });
    }
    let step_samples = inputs.step_samples.max(1);
    let bench = Bench::new(model, step_samples)?;
    let linear = Lifted::of(&bench);
    // Inputs, and behind them the states, as the columns of the matrix.
    let mut now = vec![0.0; INPUTS + bench.states().next_multiple_of(ROWS)];
    let states = INPUTS..INPUTS + bench.states();
    let mut input = bench.inputs(inputs, 0);
    now[states.clone()].copy_from_slice(&bench.start(start, &input));
    let mut next = now.clone();
    let mut course = Course::with_capacity(points, step_samples as f64 * bench.pi.sample_time_s);
    let near_nm = NEAR_LIMIT * bench.limit_nm;
    let mut wanted_nm = course.push(&bench, &now[states.clone()], &input);
    for k in work::checked(0..points - 1) {
        now[..INPUTS].copy_from_slice(&input);
        linear.apply(&now, &mut next);
        let at_end_nm = bench.wanted_nm(&next[states.clone()], &input, step_samples);
        if wanted_nm.abs().max(at_end_nm.abs()) > near_nm {
            course.stepped += 1;
            next.copy_from_slice(&now);
            let z = &mut next[states.clone()];
            (0..step_samples).for_each(|sample| bench.step(z, &input, sample, bench.limit_nm));
        }
        std::mem::swap(&mut now, &mut next);
        input = bench.inputs(inputs, k + 1);
        wanted_nm = course.push(&bench, &now[states.clone()], &input);
    }
    Ok(course)
}

/// Controller, torque control and mechanics, stepped sample by sample.
struct Bench {
    substeps: Vec<Substep>,
    pi: PiController,
    feed_forward: Option<FeedForwardGains>,
    limit_nm: f64,
    stiffness_nm_per_rad: f64,
    damping_nm_s_per_rad: f64,
    gate_samples: f64,
    /// Samples of a step.
    step_samples: usize,
    /// By how much ω_d* is late in the error and in the feed-forward.
    late: [Late; 2],
    kept: Kept,
}

/// How many earlier values are kept.
struct Kept {
    /// Outputs of the controller.
    outputs: usize,
    /// Feed-forwards.
    feed_forwards: usize,
    /// Angles turned since an earlier sample.
    angles: usize,
    /// Earlier speeds.
    speeds: usize,
}

impl Kept {
    fn all(&self) -> usize {
        self.outputs + self.feed_forwards + self.angles + self.speeds
    }
}

/// A whole number of samples, late or early, on the coarse grid.
#[derive(Clone, Copy)]
struct Late {
    /// Points back, or forward if negative.
    points: isize,
    /// Samples back from there, fewer than a step has.
    samples: f64,
}

impl Late {
    fn of(samples: isize, step_samples: usize) -> Self {
        let step = step_samples as isize;
        Late { points: samples.div_euclid(step), samples: samples.rem_euclid(step) as f64 }
    }

    /// The values of a series before, at and after a point of the grid so much earlier; beyond its ends a series stays.
    fn values(self, series: &[f64], point: usize) -> [f64; 3] {
        let last = series.len() as isize - 1;
        [-1, 0, 1].map(|beside| series[(point as isize - self.points + beside).clamp(0, last) as usize])
    }

    /// The value so many samples after the point, from the three values about it: straight before it, and after it.
    fn at(self, [before, middle, after]: [f64; 3], sample: f64, step_samples: f64) -> f64 {
        let place = sample - self.samples;
        let slope = if place < 0.0 { middle - before } else { after - middle };
        middle + slope * place / step_samples
    }
}

impl Bench {
    fn new(model: &BenchModel, step_samples: usize) -> Result<Self, SimulationError> {
        let pi = model.speed_controller.ok_or(SimulationError::MissingPart { part: Part::SpeedController })?;
        let torque_control = model.torque_control.ok_or(SimulationError::MissingPart { part: Part::TorqueControl })?;
        let substeps = Substep::of_a_sample(model, Some(torque_control), pi.sample_time_s)?;
        let gate_samples = (model.encoder_gate_s / pi.sample_time_s).max(0.0);
        let oldest = |back: fn(&Substep) -> usize| substeps.iter().map(back).max().unwrap_or(0);
        let reported = samples_back(pi.delay_s / pi.sample_time_s, 0.0);
        let angles = gate_samples.ceil() as usize;
        let kept = Kept {
            outputs: oldest(|part| part.delayed_back).max(reported) + 1,
            feed_forwards: model.feed_forward.map_or(0, |_| oldest(|part| part.immediate_back) + 1),
            angles,
            speeds: if gate_samples.fract() > 0.0 { angles } else { 0 },
        };
        let (in_error, in_feed_forward) = model.recorded_demand_lags();
        Ok(Bench {
            substeps,
            pi,
            feed_forward: model.feed_forward,
            limit_nm: model.torque_limit_nm.unwrap_or(f64::INFINITY),
            stiffness_nm_per_rad: model.mechanics.stiffness_nm_per_rad,
            damping_nm_s_per_rad: model.mechanics.damping_nm_s_per_rad,
            gate_samples,
            step_samples,
            late: [in_error, in_feed_forward].map(|samples| Late::of(samples, step_samples)),
            kept,
        })
    }

    fn states(&self) -> usize {
        OUTPUTS + self.kept.all()
    }

    fn start(&self, start: &InitialState, input: &[f64; INPUTS]) -> Vec<f64> {
        let mut z = vec![0.0; self.states()];
        let first = [
            start.dyno_speed_rad_s,
            start.engine_speed_rad_s,
            start.twist_rad,
            start.air_gap_torque_nm,
            start.integrator_nm,
        ];
        z[..OUTPUTS].copy_from_slice(&first);
        let Past { outputs, feed_forwards, angles, speeds } = self.past(&mut z);
        outputs.fill(start.integrator_nm);
        feed_forwards.fill(self.fed_nm(input, 0));
        let turned = start.dyno_speed_rad_s * self.pi.sample_time_s;
        angles.iter_mut().zip(1..).for_each(|(angle, back)| *angle = turned * f64::from(back));
        speeds.fill(start.dyno_speed_rad_s);
        z
    }

    /// The earlier values among the states.
    fn past<'a>(&self, z: &'a mut [f64]) -> Past<'a> {
        let (outputs, rest) = z[OUTPUTS..].split_at_mut(self.kept.outputs);
        let (feed_forwards, rest) = rest.split_at_mut(self.kept.feed_forwards);
        let (angles, rest) = rest.split_at_mut(self.kept.angles);
        Past { outputs, feed_forwards, angles, speeds: &mut rest[..self.kept.speeds] }
    }

    /// The inputs of the step from point `k` on.
    fn inputs(&self, inputs: &CourseInputs<'_>, k: usize) -> [f64; INPUTS] {
        let [e0, e1, e2] = self.late[0].values(inputs.speed_demand_rad_s, k);
        let [f0, f1, f2] = self.late[1].values(inputs.speed_demand_rad_s, k);
        let (engine, end) = (inputs.engine_torque_nm, (k + 1).min(inputs.engine_torque_nm.len() - 1));
        let friction = |point: usize| inputs.friction.torque_nm(inputs.speed_demand_rad_s[point]);
        [e0, e1, e2, f0, f1, f2, engine[k], engine[end], friction(k), friction(end)]
    }

    /// ω_d* as the error has it, so many samples after the step has begun.
    fn demand_rad_s(&self, input: &[f64; INPUTS], sample: usize) -> f64 {
        let values = [input[OF_ERROR], input[OF_ERROR + 1], input[OF_ERROR + 2]];
        self.late[0].at(values, sample as f64, self.step_samples as f64)
    }

    /// The feed-forward so many samples after the step has begun: k ω_d* + k_a (ω_d* − ω_d* a sample ago)/T.
    fn fed_nm(&self, input: &[f64; INPUTS], sample: usize) -> f64 {
        let Some(gains) = self.feed_forward else { return 0.0 };
        let values = [input[OF_FEED_FORWARD], input[OF_FEED_FORWARD + 1], input[OF_FEED_FORWARD + 2]];
        let demand = |sample: f64| self.late[1].at(values, sample, self.step_samples as f64);
        let (now, before) = (demand(sample as f64), demand(sample as f64 - 1.0));
        gains.speed_nm_s_per_rad * now + gains.acceleration_nm_s2_per_rad * (now - before) / self.pi.sample_time_s
    }

    /// The speed that the controller reads: the angle of the gate is the cubic between two samples with the speeds
    /// there.
    fn reading(&self, z: &[f64]) -> f64 {
        if self.gate_samples <= 0.0 {
            return z[0];
        }
        let angles = &z[OUTPUTS + self.kept.outputs + self.kept.feed_forwards..];
        let speeds = &angles[self.kept.angles..];
        let whole_s = self.gate_samples * self.pi.sample_time_s;
        let back = self.kept.angles;
        let long = angles[back - 1];
        let part = back as f64 - self.gate_samples;
        if part == 0.0 {
            return long / whole_s;
        }
        let (short, after) = if back == 1 { (0.0, z[0]) } else { (angles[back - 2], speeds[back - 2]) };
        let (rest, share) = (1.0 - part, part * part * (3.0 - 2.0 * part));
        let bend = part * rest * self.pi.sample_time_s * (speeds[back - 1] * rest - after * part);
        (long + share * (short - long) - bend) / whole_s
    }

    /// T_d* so many samples after the step has begun, without limit: the controller's output of then, or an older one,
    /// and the feed-forward.
    fn wanted_nm(&self, z: &[f64], input: &[f64; INPUTS], sample: usize) -> f64 {
        let output = match samples_back(self.pi.delay_s / self.pi.sample_time_s, 0.0) {
            0 => {
                let error = self.reading(z) - self.demand_rad_s(input, sample);
                self.pi.proportional_nm_s_per_rad * error + z[INTEGRAL]
            }
            back => z[OUTPUTS + back - 1],
        };
        output + self.fed_nm(input, sample)
    }

    fn shaft_torque_nm(&self, z: &[f64]) -> f64 {
        self.stiffness_nm_per_rad * z[2] + self.damping_nm_s_per_rad * (z[1] - z[0])
    }

    /// One sample of a step.
    fn step(&self, z: &mut [f64], input: &[f64; INPUTS], sample: usize, limit_nm: f64) {
        let error = self.reading(z) - self.demand_rad_s(input, sample);
        let output = self.pi.proportional_nm_s_per_rad * error + z[INTEGRAL];
        let change = self.pi.integral_nm_per_rad * self.pi.sample_time_s * error;
        let fed = self.fed_nm(input, sample);
        let demand = output + fed;
        if !(demand.abs() > limit_nm && change * demand > 0.0) {
            z[INTEGRAL] += change;
        }
        let Past { outputs, feed_forwards, .. } = self.past(z);
        push(outputs, output);
        push(feed_forwards, fed);
        let straight = |first: usize, within: f64| {
            input[first] + (input[first + 1] - input[first]) * (sample as f64 + within) / self.step_samples as f64
        };
        let mut x: [f64; STATES] = [z[0], z[1], z[2], z[3], 0.0, 0.0];
        for part in &self.substeps {
            let braking = self.braking_nm(z, part).clamp(-limit_nm, limit_nm);
            let acting = |within: f64| [braking, straight(OF_ENGINE, within), straight(OF_FRICTION, within)];
            x = part.apply(&x, acting(part.from), acting(part.to));
        }
        let speed = z[0];
        z[..INTEGRAL].copy_from_slice(&x[..INTEGRAL]);
        let Past { angles, speeds, .. } = self.past(z);
        push(angles, 0.0);
        angles.iter_mut().for_each(|angle| *angle += x[4]);
        push(speeds, speed);
    }

    /// T_d* as it acts in a part of the sample that has just begun, without limit.
    fn braking_nm(&self, z: &[f64], part: &Substep) -> f64 {
        let (outputs, rest) = z[OUTPUTS..].split_at(self.kept.outputs);
        let fed = rest[..self.kept.feed_forwards].get(part.immediate_back);
        outputs[part.delayed_back] + fed.copied().unwrap_or(0.0)
    }
}

/// The earlier values among the states, the latest first.
struct Past<'a> {
    outputs: &'a mut [f64],
    feed_forwards: &'a mut [f64],
    /// Angles that have been turned since then, rad.
    angles: &'a mut [f64],
    speeds: &'a mut [f64],
}

/// Puts a value before the others, of which the last one is forgotten.
fn push(values: &mut [f64], value: f64) {
    if let Some(last) = values.last_mut() {
        *last = value;
        values.rotate_right(1);
    }
}

/// The samples of a step as one matrix, in blocks of rows, each column by column: inputs, then states.
struct Lifted {
    columns: usize,
    blocks: Vec<[f64; ROWS]>,
}

impl Lifted {
    fn of(bench: &Bench) -> Self {
        let states = bench.states();
        let columns = INPUTS + states;
        let mut blocks = vec![[0.0; ROWS]; states.div_ceil(ROWS) * columns];
        for column in 0..columns {
            let mut z = vec![0.0; states];
            let mut input = [0.0; INPUTS];
            match column.checked_sub(INPUTS) {
                None => input[column] = 1.0,
                Some(of) => z[of] = 1.0,
            }
            (0..bench.step_samples).for_each(|sample| bench.step(&mut z, &input, sample, f64::INFINITY));
            z.iter().enumerate().for_each(|(row, value)| blocks[row / ROWS * columns + column][row % ROWS] = *value);
        }
        Lifted { columns, blocks }
    }

    /// The states behind the inputs of `next`. The sums of a block's rows stay in registers.
    fn apply(&self, now: &[f64], next: &mut [f64]) {
        let now = &now[..self.columns];
        for (next, block) in next[INPUTS..].chunks_exact_mut(ROWS).zip(self.blocks.chunks_exact(self.columns)) {
            let mut sums = [0.0; ROWS];
            for (value, column) in now.iter().zip(block) {
                sums.iter_mut().zip(column).for_each(|(sum, part)| *sum += part * value);
            }
            next.copy_from_slice(&sums);
        }
    }
}

impl Course {
    fn with_capacity(points: usize, step_s: f64) -> Self {
        let series = || Vec::with_capacity(points);
        Course {
            step_s,
            dyno_speed_rad_s: series(),
            engine_speed_rad_s: series(),
            shaft_torque_nm: series(),
            torque_demand_nm: series(),
            stepped: 0,
        }
    }

    /// Takes a point; returns T_d* there without its limit, Nm.
    fn push(&mut self, bench: &Bench, z: &[f64], input: &[f64; INPUTS]) -> f64 {
        self.dyno_speed_rad_s.push(z[0]);
        self.engine_speed_rad_s.push(z[1]);
        self.shaft_torque_nm.push(bench.shaft_torque_nm(z));
        let wanted = bench.wanted_nm(z, input, 0);
        self.torque_demand_nm.push(wanted.clamp(-bench.limit_nm, bench.limit_nm));
        wanted
    }
}
