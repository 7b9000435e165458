//! The sampled speed controller.

use rig::results::Part;

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
    /// Samples by which N_d* is later in the speed error than N_d, and late in the feed-forward.
    lags: (isize, isize),
}

impl Pi {
    pub(super) fn new(model: &BenchModel, start: &InitialState, sample_time_s: f64) -> Result<Self, SimulationError> {
        let gains = model.speed_controller.ok_or(SimulationError::MissingPart { part: Part::SpeedController })?;
        if (gains.sample_time_s - sample_time_s).abs() > SAME_CLOCK * sample_time_s {
            return Err(SimulationError::Clock { inputs_s: sample_time_s, controller_s: gains.sample_time_s });
        }
        Ok(Pi {
            gains,
            feed_forward: model.feed_forward,
            limit_nm: model.torque_limit_nm.unwrap_or(f64::INFINITY),
            integral_nm: start.integrator_nm,
            lags: model.recorded_demand_lags(),
        })
    }

    /// The update at sample `k` of the demand; returns T_d* at this sample.
    pub(super) fn update(
        &mut self,
        reading_rad_s: f64,
        demand: &[f64],
        k: usize,
        streams: &mut Streams,
    ) -> Option<f64> {
        let late = |lag: isize| demand[k.saturating_add_signed(-lag).min(demand.len() - 1)];
        let (in_error, in_feed) = self.lags;
        let feed_forward = self.feed_forward_nm(late(in_feed), late(in_feed + 1));
        let output = self.pi_nm(reading_rad_s - late(in_error), feed_forward);
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

    fn feed_forward_nm(&self, demand: f64, before: f64) -> f64 {
        let acceleration = (demand - before) / self.gains.sample_time_s;
        self.feed_forward.map_or(0.0, |f| f.speed_nm_s_per_rad * demand + f.acceleration_nm_s2_per_rad * acceleration)
    }
}
