//! Reading a speed as the mean over a gate.

/// An encoder that reads (θ(t) − θ(t − gate))/gate, with the angles it has seen. Between samples the angle is the cubic
/// through both ends with the speeds there; before the first sample the speed was constant.
#[derive(Debug, Clone)]
pub(super) struct Encoder {
    gate_samples: f64,
    sample_time_s: f64,
    angles_rad: Vec<f64>,
    speeds_rad_s: Vec<f64>,
}

impl Encoder {
    pub(super) fn new(gate_samples: f64, sample_time_s: f64, samples: usize) -> Self {
        let series = || Vec::with_capacity(samples);
        Encoder { gate_samples, sample_time_s, angles_rad: series(), speeds_rad_s: series() }
    }

    /// The reading at the next sample, at which angle and speed are these.
    pub(super) fn read(&mut self, angle_rad: f64, speed_rad_s: f64) -> f64 {
        self.angles_rad.push(angle_rad);
        self.speeds_rad_s.push(speed_rad_s);
        if self.gate_samples <= 0.0 {
            return speed_rad_s;
        }
        let position = (self.angles_rad.len() - 1) as f64 - self.gate_samples;
        (angle_rad - self.angle_at(position)) / (self.gate_samples * self.sample_time_s)
    }

    fn angle_at(&self, position: f64) -> f64 {
        let below = position.floor();
        if below < 0.0 {
            return self.angles_rad[0] + position * self.sample_time_s * self.speeds_rad_s[0];
        }
        let (i, x) = (below as usize, position - below);
        if x == 0.0 {
            return self.angles_rad[i];
        }
        let (a, b) = (self.angles_rad[i], self.angles_rad[i + 1]);
        let (da, db) = (self.speeds_rad_s[i] * self.sample_time_s, self.speeds_rad_s[i + 1] * self.sample_time_s);
        let (y, xx) = (1.0 - x, x * x);
        a + (b - a) * xx * (3.0 - 2.0 * x) + x * y * (da * y - db * x)
    }
}
