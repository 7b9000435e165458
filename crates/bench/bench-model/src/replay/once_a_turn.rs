//! The once-a-turn error of an encoder, ω (a cos φ + b sin φ), φ being the angle turned since the replay's start.

/// Its two waves on the clock of the replay.
pub(super) struct OnceATurn {
    speed: Vec<f64>,
    angle: Vec<f64>,
    step_s: f64,
    gate_s: f64,
}

impl OnceATurn {
    pub(super) fn new(speed: &[f64], step_s: f64, gate_s: f64) -> Self {
        let mut turned = 0.0;
        let angle = speed.iter().map(|w| {
            turned += w * step_s;
            turned
        });
        OnceATurn { angle: angle.collect(), speed: speed.to_vec(), step_s, gate_s }
    }

    /// Addition to a reading that is the mean over the gate before it.
    pub(super) fn reading(&self, amplitudes: [f64; 2]) -> Vec<f64> {
        self.wave(amplitudes, 0.5 * self.gate_s)
    }

    /// The acceleration the error pretends.
    pub(super) fn slope(&self, amplitudes: [f64; 2]) -> Vec<f64> {
        let wave = self.wave(amplitudes, 0.0);
        let last = wave.len().saturating_sub(1);
        let difference = |i: usize| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
            (wave[after] - wave[before]) / (self.step_s * (after - before).max(1) as f64)
        };
        (0..wave.len()).map(difference).collect()
    }

    fn wave(&self, [cosine, sine]: [f64; 2], late_s: f64) -> Vec<f64> {
        let at = |(speed, angle): (&f64, &f64)| {
            let (sin, cos) = (angle - speed * late_s).sin_cos();
            speed * (cosine * cos + sine * sin)
        };
        self.speed.iter().zip(&self.angle).map(at).collect()
    }
}
