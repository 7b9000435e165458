//! Piston, rod and crank.

/// x(θ) = r (1 − cos θ) + (r/λ)(1 − √(1 − λ² sin² θ)): how far the piston is below top dead centre.
pub(super) struct SliderCrank {
    pub(super) radius_m: f64,
    /// λ, radius over length of the rod.
    pub(super) rod_ratio: f64,
}

impl SliderCrank {
    /// x, m.
    pub(super) fn position_m(&self, angle_rad: f64) -> f64 {
        let (sine, cosine) = angle_rad.sin_cos();
        self.radius_m * (1.0 - cosine + (1.0 - self.root(sine)) / self.rod_ratio)
    }

    /// dx/dθ, m.
    pub(super) fn slope_m(&self, angle_rad: f64) -> f64 {
        let (sine, cosine) = angle_rad.sin_cos();
        self.radius_m * sine * (1.0 + self.rod_ratio * cosine / self.root(sine))
    }

    /// d²x/dθ², m.
    pub(super) fn curvature_m(&self, angle_rad: f64) -> f64 {
        let (sine, cosine) = angle_rad.sin_cos();
        let (ratio, root) = (self.rod_ratio, self.root(sine));
        let of_rod = (cosine * cosine - sine * sine) / root + (ratio * sine * cosine).powi(2) / root.powi(3);
        self.radius_m * (cosine + ratio * of_rod)
    }

    fn root(&self, sine: f64) -> f64 {
        (1.0 - (self.rod_ratio * sine).powi(2)).sqrt()
    }
}
