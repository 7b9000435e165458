//! Speed control over a long time.
//!
//! Demand and engine torque are straight from one point of a coarse grid to the next. As long as the torque demand keeps away from
//! its limit, controller and bench are linear. Their samples from one point to the next are then one matrix, which is found by
//! stepping through them once. Near the limit, the bench is stepped sample by sample, with limit and anti-windup.

use rig::results::Part;

use super::plant::{STATES, Substep, samples_back};
use crate::model::{BenchModel, FeedForwardGains, PiController};
use crate::simulate::error::SimulationError;
use crate::simulate::inputs::InitialState;

/// Part of the torque limit from which on every sample is stepped.
const NEAR_LIMIT: f64 = 0.95;
/// Speed demand of the error, feed-forward of the speed and engine torque, each at both ends of a step; feed-forward of the
/// acceleration before the step and in it.
const INPUTS: usize = 8;
/// I, behind ω_d, ω_e, Δθ and T_d.
const INTEGRAL: usize = 4;
/// Rows of the matrix of a step that are summed together.
const ROWS: usize = 4;
/// First of the controller's last outputs, the latest first; the angles turned in the last samples follow them.
const OUTPUTS: usize = 5;

/// What a long run is driven by: values at the points of a coarse grid, straight in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CourseInputs<'a> {
    /// Samples of the controller from one point to the next.
    pub step_samples: usize,
    /// ω_d*, rad/s.
    pub speed_demand_rad_s: &'a [f64],
    /// T_e, Nm.
    pub engine_torque_nm: &'a [f64],
}

/// What the bench did, one value a point of the grid.
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
/// Speeds are those of the shaft's ends, and no readings of encoders. The gate of the encoder is rounded to samples in between which
/// its angle is straight.
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
    let linear = Lifted::of(&bench, step_samples);
    // Inputs, and behind them the states, as the columns of the matrix.
    let mut now = vec![0.0; INPUTS + bench.states().next_multiple_of(ROWS)];
    let states = INPUTS..INPUTS + bench.states();
    now[states.clone()].copy_from_slice(&bench.start(start));
    let mut next = now.clone();
    let mut course = Course::with_capacity(points, step_samples as f64 * bench.pi.sample_time_s);
    let near_nm = NEAR_LIMIT * bench.limit_nm;
    let mut input = bench.first_inputs(inputs);
    let mut wanted_nm = course.push(&bench, &now[states.clone()], &input);
    for k in 0..points - 1 {
        now[..INPUTS].copy_from_slice(&input);
        linear.apply(&now, &mut next);
        let at_end_nm = bench.wanted_nm(&next[states.clone()], input[1], input[3] + input[7]);
        if wanted_nm.abs().max(at_end_nm.abs()) > near_nm {
            course.stepped += 1;
            next.copy_from_slice(&now);
            let z = &mut next[states.clone()];
            (0..step_samples).for_each(|sample| bench.step(z, &input, (sample, step_samples), bench.limit_nm));
        }
        std::mem::swap(&mut now, &mut next);
        input = bench.next_inputs(inputs, k + 1, &input);
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
    /// Samples by which ω_d* is late in the error and in the feed-forward.
    lags: (f64, f64),
    /// The same in points of the grid.
    late: (Late, Late),
    /// How many outputs of the controller, and angles, are kept.
    kept: (usize, usize),
}

/// A time before a point of the grid, in points.
#[derive(Clone, Copy)]
struct Late {
    /// Points back to the one before that time.
    whole: usize,
    /// How far that time is from there to the next point.
    share: f64,
}

impl Late {
    fn of(points: f64) -> Self {
        let whole = points.ceil();
        Late { whole: whole as usize, share: whole - points }
    }

    /// The value of a series that is straight between its points; before the first one, that of the first.
    fn value(self, series: &[f64], point: usize) -> f64 {
        let Some(low) = point.checked_sub(self.whole) else { return series[0] };
        if self.share > 0.0 { series[low] + self.share * (series[low + 1] - series[low]) } else { series[low] }
    }
}

impl Bench {
    fn new(model: &BenchModel, step_samples: usize) -> Result<Self, SimulationError> {
        let pi = model.speed_controller.ok_or(SimulationError::MissingPart { part: Part::SpeedController })?;
        let torque_control = model.torque_control.ok_or(SimulationError::MissingPart { part: Part::TorqueControl })?;
        let substeps = Substep::of_a_sample(model, Some(torque_control), pi.sample_time_s)?;
        let gate_samples = (model.encoder_gate_s / pi.sample_time_s).max(0.0);
        let oldest = substeps.iter().map(|part| part.delayed_back).max().unwrap_or(0);
        let reported = samples_back(pi.delay_s / pi.sample_time_s, 0.0);
        let (in_error, in_feed_forward) = model.recorded_demand_lags();
        Ok(Bench {
            substeps,
            pi,
            feed_forward: model.feed_forward,
            limit_nm: model.torque_limit_nm.unwrap_or(f64::INFINITY),
            stiffness_nm_per_rad: model.mechanics.stiffness_nm_per_rad,
            damping_nm_s_per_rad: model.mechanics.damping_nm_s_per_rad,
            gate_samples,
            lags: (in_error as f64, in_feed_forward as f64),
            late: (
                Late::of(in_error as f64 / step_samples as f64),
                Late::of(in_feed_forward as f64 / step_samples as f64),
            ),
            kept: (oldest.max(reported) + 1, gate_samples.ceil() as usize),
        })
    }

    fn states(&self) -> usize {
        OUTPUTS + self.kept.0 + self.kept.1
    }

    fn start(&self, start: &InitialState) -> Vec<f64> {
        let mut z = vec![0.0; self.states()];
        let first = [
            start.dyno_speed_rad_s,
            start.engine_speed_rad_s,
            start.twist_rad,
            start.air_gap_torque_nm,
            start.integrator_nm,
        ];
        z[..OUTPUTS].copy_from_slice(&first);
        z[OUTPUTS..OUTPUTS + self.kept.0].fill(start.integrator_nm);
        let turned = start.dyno_speed_rad_s * self.pi.sample_time_s;
        z[OUTPUTS + self.kept.0..].iter_mut().zip(1..).for_each(|(angle, back)| *angle = turned * f64::from(back));
        z
    }

    /// The inputs of the first step.
    fn first_inputs(&self, inputs: &CourseInputs<'_>) -> [f64; INPUTS] {
        let (demand, fed) = self.at_point(inputs, 0);
        self.next_inputs(inputs, 0, &[0.0, demand, 0.0, fed, 0.0, inputs.engine_torque_nm[0], 0.0, 0.0])
    }

    /// The inputs of the step from point `k` on, which begins as the last one ended; at the last point both ends are that point.
    fn next_inputs(&self, inputs: &CourseInputs<'_>, k: usize, last: &[f64; INPUTS]) -> [f64; INPUTS] {
        let end = (k + 1).min(inputs.speed_demand_rad_s.len() - 1);
        let (demand, fed) = self.at_point(inputs, end);
        let accelerated = self.feed_forward.map_or(0.0, |gains| {
            let change = inputs.speed_demand_rad_s[end] - inputs.speed_demand_rad_s[k];
            let step = inputs.step_samples.max(1) as f64;
            gains.acceleration_nm_s2_per_rad * (change / (step * self.pi.sample_time_s))
        });
        [last[1], demand, last[3], fed, last[5], inputs.engine_torque_nm[end], last[7], accelerated]
    }

    /// The speed demand of the error, and the feed-forward of the speed, at a point.
    fn at_point(&self, inputs: &CourseInputs<'_>, point: usize) -> (f64, f64) {
        let demand = inputs.speed_demand_rad_s;
        let fed = self.feed_forward.map_or(0.0, |gains| gains.speed_nm_s_per_rad * self.late.1.value(demand, point));
        (self.late.0.value(demand, point), fed)
    }

    /// The speed that the controller reads.
    fn reading(&self, z: &[f64]) -> f64 {
        if self.gate_samples <= 0.0 {
            return z[0];
        }
        let angles = &z[OUTPUTS + self.kept.0..];
        let (whole, share) = (self.gate_samples.floor() as usize, self.gate_samples.fract());
        let back = |samples: usize| if samples == 0 { 0.0 } else { angles[samples - 1] };
        let turned = back(whole) + if share > 0.0 { share * (back(whole + 1) - back(whole)) } else { 0.0 };
        turned / (self.gate_samples * self.pi.sample_time_s)
    }

    /// T_d* at a point, without limit: the controller's output of then, or an older one, and the feed-forward.
    fn wanted_nm(&self, z: &[f64], demand_rad_s: f64, feed_forward_nm: f64) -> f64 {
        let output = match samples_back(self.pi.delay_s / self.pi.sample_time_s, 0.0) {
            0 => self.pi.proportional_nm_s_per_rad * (self.reading(z) - demand_rad_s) + z[INTEGRAL],
            back => z[OUTPUTS + back - 1],
        };
        output + feed_forward_nm
    }

    fn shaft_torque_nm(&self, z: &[f64]) -> f64 {
        self.stiffness_nm_per_rad * z[2] + self.damping_nm_s_per_rad * (z[1] - z[0])
    }

    /// One sample of `of` in a step.
    fn step(&self, z: &mut [f64], input: &[f64; INPUTS], (sample, of): (usize, usize), limit_nm: f64) {
        let at = |end: usize, place: f64| input[end] + (input[end + 1] - input[end]) * place / of as f64;
        let place = sample as f64;
        let error = self.reading(z) - at(0, place);
        let output = self.pi.proportional_nm_s_per_rad * error + z[INTEGRAL];
        let change = self.pi.integral_nm_per_rad * self.pi.sample_time_s * error;
        let fed = |place: f64| at(2, place) + input[if place <= self.lags.1 { 6 } else { 7 }];
        let demand = output + fed(place);
        if !(demand.abs() > limit_nm && change * demand > 0.0) {
            z[INTEGRAL] += change;
        }
        let outputs = &mut z[OUTPUTS..OUTPUTS + self.kept.0];
        outputs.rotate_right(1);
        outputs[0] = output;
        let mut x: [f64; STATES] = [z[0], z[1], z[2], z[3], 0.0, 0.0];
        for part in &self.substeps {
            let fed = fed(place - part.immediate_back as f64);
            let braking = (z[OUTPUTS + part.delayed_back] + fed).clamp(-limit_nm, limit_nm);
            let driving = |within: f64| at(4, place + within);
            x = part.apply(&x, [braking, driving(part.from), 0.0], [braking, driving(part.to), 0.0]);
        }
        z[..INTEGRAL].copy_from_slice(&x[..INTEGRAL]);
        let angles = &mut z[OUTPUTS + self.kept.0..];
        if !angles.is_empty() {
            angles.rotate_right(1);
            angles[0] = 0.0;
            angles.iter_mut().for_each(|angle| *angle += x[4]);
        }
    }
}

/// The samples of a step as one matrix, in blocks of rows, each column by column: inputs, then states.
struct Lifted {
    columns: usize,
    blocks: Vec<[f64; ROWS]>,
}

impl Lifted {
    fn of(bench: &Bench, samples: usize) -> Self {
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
            (0..samples).for_each(|sample| bench.step(&mut z, &input, (sample, samples), f64::INFINITY));
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
        let wanted = bench.wanted_nm(z, input[0], input[2] + input[6]);
        self.torque_demand_nm.push(wanted.clamp(-bench.limit_nm, bench.limit_nm));
        wanted
    }
}
