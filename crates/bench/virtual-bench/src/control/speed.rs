//! The dynamometer's speed controller: PI with transport delay and anti-windup, feed-forward, torque limit.

use std::collections::VecDeque;

use rig::bench_parameters::ControllerParameters;
use rig::results::DelayPlace;

use crate::drive::TimedDemand;

/// Part of an update below which a delay counts as a whole number of updates.
const WHOLE: f64 = 1e-9;

/// T_d* = e^{−sτ} (K_p + K_i/s)(N_d − N_d*) + k N_d* + m + k_a dN_d*/dt in discrete form (thesis 6.2, 6.6, 6.7); see
/// [`ControllerParameters`].
#[derive(Debug, Clone)]
pub(crate) struct SpeedController {
    parameters: ControllerParameters,
    limit_nm: f64,
    update_s: f64,
    integral_nm: f64,
    last_demand_rad_s: f64,
    /// Late values, from the oldest still needed to the newest: PI outputs, whole outputs or measured speeds.
    late: VecDeque<f64>,
    /// Whole updates in τ, and the rest as a time.
    whole_updates: usize,
    rest_s: f64,
}

/// Demand of one update of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Update {
    /// From the update on.
    pub now: TimedDemand,
    /// From a time before the next update on, where τ is no whole number of updates.
    pub later: Option<TimedDemand>,
}

impl SpeedController {
    /// The controller at rest: holding a speed with a torque.
    pub(crate) fn new(
        parameters: &ControllerParameters,
        limit_nm: f64,
        update_s: f64,
        speed_rad_s: f64,
        torque_nm: f64,
    ) -> Self {
        let updates = parameters.delay_s / update_s;
        let whole = (updates + WHOLE).floor();
        let rest = updates - whole;
        let mut controller = Self {
            parameters: parameters.clone(),
            limit_nm,
            update_s,
            integral_nm: 0.0,
            last_demand_rad_s: speed_rad_s,
            late: VecDeque::new(),
            whole_updates: whole as usize,
            rest_s: if rest > WHOLE { rest * update_s } else { 0.0 },
        };
        controller.integral_nm = torque_nm - controller.feed_forward_nm(speed_rad_s);
        let at_rest = match parameters.delay_place {
            DelayPlace::SpeedError => controller.integral_nm,
            DelayPlace::WholeOutput => torque_nm,
            DelayPlace::MeasuredSpeed => speed_rad_s,
        };
        controller.late.resize(controller.whole_updates + 1, at_rest);
        controller
    }

    /// One update with the measured speed and the demand.
    pub(crate) fn update(&mut self, time_s: f64, speed_rad_s: f64, demand_rad_s: f64) -> Update {
        let feed_forward_nm = self.feed_forward_nm(demand_rad_s);
        self.last_demand_rad_s = demand_rad_s;
        let ((previous, current), at_once_nm) = match self.parameters.delay_place {
            DelayPlace::SpeedError => {
                let output_nm = self.pi_nm(speed_rad_s - demand_rad_s, feed_forward_nm);
                (self.late(output_nm), feed_forward_nm)
            }
            DelayPlace::WholeOutput => {
                let output_nm = self.pi_nm(speed_rad_s - demand_rad_s, feed_forward_nm) + feed_forward_nm;
                (self.late(output_nm), 0.0)
            }
            DelayPlace::MeasuredSpeed => {
                let (_, late_rad_s) = self.late(speed_rad_s);
                let output_nm = self.pi_nm(late_rad_s - demand_rad_s, feed_forward_nm);
                ((output_nm, output_nm), feed_forward_nm)
            }
        };
        let demand = |time_s, late_nm: f64| TimedDemand {
            time_s,
            torque_nm: (late_nm + at_once_nm).clamp(-self.limit_nm, self.limit_nm),
        };
        if self.rest_s > 0.0 {
            Update { now: demand(time_s, previous), later: Some(demand(time_s + self.rest_s, current)) }
        } else {
            Update { now: demand(time_s, current), later: None }
        }
    }

    /// Value that came in τ ago, in whole updates: before and from this update on.
    fn late(&mut self, value: f64) -> (f64, f64) {
        self.late.push_back(value);
        let previous = self.late.pop_front().unwrap_or(value);
        (previous, self.late.front().copied().unwrap_or(value))
    }

    /// v_j = K_p e_j + I_j; then I_{j+1} = I_j + K_i T e_j unless that drives an exceeded limit further.
    fn pi_nm(&mut self, error_rad_s: f64, feed_forward_nm: f64) -> f64 {
        let output_nm = self.parameters.proportional_nm_s_per_rad * error_rad_s + self.integral_nm;
        let change_nm = self.parameters.integral_nm_per_rad * self.update_s * error_rad_s;
        let demand_nm = output_nm + feed_forward_nm;
        let winds_up = demand_nm.abs() > self.limit_nm && change_nm * demand_nm > 0.0;
        if !winds_up {
            self.integral_nm += change_nm;
        }
        output_nm
    }

    fn feed_forward_nm(&self, demand_rad_s: f64) -> f64 {
        let acceleration_rad_s2 = (demand_rad_s - self.last_demand_rad_s) / self.update_s;
        self.parameters.speed_feed_forward_nm_s_per_rad * demand_rad_s
            + self.parameters.offset_feed_forward_nm
            + self.parameters.acceleration_feed_forward_nm_s2_per_rad * acceleration_rad_s2
    }
}
