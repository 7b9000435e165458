//! From the torque demand to the air-gap torque, in two fidelities: a delay and a lag, or an induction machine under
//! field-oriented control.

mod field_oriented;
mod knowledge;
mod lag;
mod machine;
mod ripple;
mod timed;

use std::collections::VecDeque;

use lti::Complex64;
use rig::bench_parameters::DriveParameters;

use field_oriented::FieldOrientedControl;
pub(super) use knowledge::Knowledge;
use lag::Lag;
use machine::{Electrical, Machine};
use ripple::Ripple;
pub(crate) use timed::TimedDemand;

/// Samples of the drive's control in a millisecond.
pub(super) const SAMPLES_PER_UPDATE: usize = 4;

/// The drive: demands on their way to it, and what it makes of them.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    parameters: DriveParameters,
    /// Demands on their way, the oldest first, at the times when they take effect.
    on_the_way: VecDeque<TimedDemand>,
    fidelity: Fidelity,
    ripple: Ripple,
}

#[derive(Debug, Clone)]
enum Fidelity {
    Lag(Lag),
    Machine(Box<MachineDrive>),
}

/// An induction machine with its control.
#[derive(Debug, Clone)]
struct MachineDrive {
    machine: Machine,
    control: FieldOrientedControl,
    state: Electrical,
    voltage_v: Complex64,
    held_nm: f64,
    last_speed_rad_s: f64,
    steps_per_sample: usize,
    step_in_sample: usize,
}

impl Drive {
    /// The drive at rest at a torque and a speed, stepped so many times a millisecond.
    pub(super) fn new(
        parameters: &DriveParameters,
        torque_nm: f64,
        speed_rad_s: f64,
        update_s: f64,
        steps_per_update: usize,
    ) -> Self {
        let step_s = update_s / steps_per_update as f64;
        let fidelity = match &parameters.machine {
            None => Fidelity::Lag(Lag::new(parameters.bandwidth_rad_s, torque_nm, step_s)),
            Some(induction) => {
                let machine = Machine::new(induction);
                let sample_s = update_s / SAMPLES_PER_UPDATE as f64;
                let (control, state, voltage_v) =
                    FieldOrientedControl::at_rest(induction, machine, sample_s, torque_nm, speed_rad_s);
                let steps_per_sample = steps_per_update / SAMPLES_PER_UPDATE;
                Fidelity::Machine(Box::new(MachineDrive {
                    machine,
                    control,
                    state,
                    voltage_v,
                    held_nm: torque_nm,
                    last_speed_rad_s: speed_rad_s,
                    steps_per_sample,
                    step_in_sample: 0,
                }))
            }
        };
        let ripple = Ripple::new(parameters.ripple_hz, step_s);
        Self { parameters: parameters.clone(), on_the_way: VecDeque::with_capacity(64), fidelity, ripple }
    }

    /// The demand changes; times must not decrease from call to call.
    pub(super) fn demand(&mut self, demand: TimedDemand) {
        let limit = self.parameters.torque_limit_nm;
        self.on_the_way.push_back(TimedDemand {
            time_s: demand.time_s + self.parameters.delay_s,
            torque_nm: demand.torque_nm.clamp(-limit, limit),
        });
    }

    /// Torque without ripple at `end_s`, Nm, where the last call ended at `start_s` and the rotor turned at
    /// `speed_rad_s`.
    pub(super) fn advance(&mut self, start_s: f64, end_s: f64, speed_rad_s: f64) -> f64 {
        match &mut self.fidelity {
            Fidelity::Lag(lag) => lag.advance(&mut self.on_the_way, start_s, end_s),
            Fidelity::Machine(drive) => drive.advance(&mut self.on_the_way, start_s, end_s, speed_rad_s),
        }
    }

    /// Air-gap torque with ripple, Nm, a step after the last call: T (1 + r_m sin 2πft) + r_a sin 2πft.
    pub(super) fn with_ripple_nm(&mut self, torque_nm: f64, time_s: f64) -> f64 {
        let (ripple, sine) = (&self.parameters, self.ripple.sine(time_s));
        torque_nm + (ripple.multiplicative_ripple * torque_nm + ripple.additive_ripple_nm) * sine
    }
}

impl MachineDrive {
    /// One step; a sample of the control comes first where one is due. The rotor's speed in the step is that half a
    /// step on, from the last two.
    fn advance(&mut self, on_the_way: &mut VecDeque<TimedDemand>, start_s: f64, end_s: f64, speed_rad_s: f64) -> f64 {
        if self.step_in_sample == 0 {
            while let Some(next) = on_the_way.front().filter(|next| next.time_s <= start_s + 1e-9) {
                self.held_nm = next.torque_nm;
                on_the_way.pop_front();
            }
            self.voltage_v = self.control.sample(self.state.current_a, speed_rad_s, self.held_nm);
        }
        self.step_in_sample = (self.step_in_sample + 1) % self.steps_per_sample;
        let middle_rad_s = 1.5 * speed_rad_s - 0.5 * self.last_speed_rad_s;
        self.last_speed_rad_s = speed_rad_s;
        let (frame_rad_s, step_s) = (self.control.frame_rad_s, end_s - start_s);
        self.state = self.machine.advance(&self.state, self.voltage_v, frame_rad_s, middle_rad_s, step_s);
        self.machine.braking_nm(&self.state)
    }
}
