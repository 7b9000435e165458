//! The sampled speed controller.

use super::plant::Streams;
use crate::model::{BenchModel, FeedForwardGains, PiController};
use crate::simulate::error::SimulationError;
use crate::simulate::inputs::InitialState;

/// Clocks that differ by less than this part count as equal.
const SAME_CLOCK: f64 = 1e-6;

/// PI and feed-forward. While the demand exceeds the limit, the integrator rests if the error would drive it further
/// (conditional integration).
pub(super) struct Pi {
    gains: PiController,
    feed_forward: Option<FeedForwardGains>,
    limit_nm: f64,
    integral_nm: f64,
    last_demand_rad_s: Option<f64>,
}

impl Pi {
    pub(super) fn new(model: &BenchModel, start: &InitialState, sample_time_s: f64) -> Result<Self, SimulationError> {
        let gains = model.speed_controller.ok_or(SimulationError::MissingPart { part: "speed controller" })?;
        if (gains.sample_time_s - sample_time_s).abs() > SAME_CLOCK * sample_time_s {
            return Err(SimulationError::Clock { inputs_s: sample_time_s, controller_s: gains.sample_time_s });
        }
        Ok(Pi {
            gains,
            feed_forward: model.feed_forward,
            limit_nm: model.torque_limit_nm.unwrap_or(f64::INFINITY),
            integral_nm: start.integrator_nm,
            last_demand_rad_s: None,
        })
    }

    /// One update; returns T_d* at this sample.
    pub(super) fn update(&mut self, reading_rad_s: f64, demand_rad_s: f64, streams: &mut Streams) -> Option<f64> {
        let feed_forward = self.feed_forward_nm(demand_rad_s);
        let output = self.pi_nm(reading_rad_s - demand_rad_s, feed_forward);
        let updates = self.gains.delay_s / self.gains.sample_time_s;
        streams.push_controller(output, feed_forward, updates)
    }

    fn pi_nm(&mut self, error: f64, feed_forward_nm: f64) -> f64 {
        let output = self.gains.proportional_nm_s_per_rad * error + self.integral_nm;
        let change = self.gains.integral_nm_per_rad * self.gains.sample_time_s * error;
        let demand = output + feed_forward_nm;
        let winds_up = demand.abs() > self.limit_nm && change * demand > 0.0;
        if !winds_up {
            self.integral_nm += change;
        }
        output
    }

    fn feed_forward_nm(&mut self, demand: f64) -> f64 {
        let last = self.last_demand_rad_s.replace(demand).unwrap_or(demand);
        let acceleration = (demand - last) / self.gains.sample_time_s;
        self.feed_forward.map_or(0.0, |f| f.speed_nm_s_per_rad * demand + f.acceleration_nm_s2_per_rad * acceleration)
    }
}
