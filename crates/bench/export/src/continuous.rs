//! The mechanics with the lag of the torque control, as a continuous linear system.

use bench_model::model::BenchModel;

use crate::numbers::Unit;

/// A continuous system with names; rows of matrices.
#[derive(Debug, Clone, PartialEq)]
pub struct Continuous {
    /// A.
    pub a: Vec<Vec<f64>>,
    /// B.
    pub b: Vec<Vec<f64>>,
    /// C.
    pub c: Vec<Vec<f64>>,
    /// D.
    pub d: Vec<Vec<f64>>,
    /// Delay of each input, s.
    pub input_delays_s: Vec<f64>,
    /// States with their units.
    pub states: Vec<(&'static str, Unit)>,
    /// Inputs with their units.
    pub inputs: Vec<(&'static str, Unit)>,
    /// Outputs with their units.
    pub outputs: Vec<(&'static str, Unit)>,
}

/// T_d* (or, without torque control, T_d) and T_e to the speeds, T_d and T_shaft.
///
/// J_d dω_d/dt = T_shaft − T_d, J_e dω_e/dt = T_e − T_shaft, T_shaft = K Δθ + B (ω_e − ω_d), dT_d/dt = a (T_d* − T_d).
#[must_use]
pub fn of(model: &BenchModel) -> Continuous {
    let mechanics = &model.mechanics;
    let (jd, je) = (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2);
    let (k, b) = (mechanics.stiffness_nm_per_rad, mechanics.damping_nm_s_per_rad);
    let shaft = vec![-b, b, k];
    let mut system = Continuous {
        a: vec![vec![-b / jd, b / jd, k / jd], vec![b / je, -b / je, -k / je], vec![-1.0, 1.0, 0.0]],
        b: vec![vec![-1.0 / jd, 0.0], vec![0.0, 1.0 / je], vec![0.0, 0.0]],
        c: vec![vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 0.0], shaft],
        d: vec![vec![0.0, 0.0], vec![0.0, 0.0], vec![1.0, 0.0], vec![0.0, 0.0]],
        input_delays_s: vec![model.torque_control.map_or(0.0, |control| control.delay_s), 0.0],
        states: vec![("w_d", Unit::Speed), ("w_e", Unit::Speed), ("twist", Unit::Angle)],
        inputs: vec![("T_d_demand", Unit::Torque), ("T_e", Unit::Torque)],
        outputs: vec![("w_d", Unit::Speed), ("w_e", Unit::Speed), ("T_d", Unit::Torque), ("T_shaft", Unit::Torque)],
    };
    if let Some(bandwidth) = model.torque_control.and_then(|control| control.bandwidth_rad_s) {
        system.add_lag(bandwidth, 1.0 / jd);
    }
    system
}

impl Continuous {
    /// Puts a/(s + a) before the torque, which becomes a state.
    fn add_lag(&mut self, bandwidth_rad_s: f64, per_inertia: f64) {
        let of_torque = [-per_inertia, 0.0, 0.0];
        self.a.iter_mut().zip(of_torque).for_each(|(row, entry)| row.push(entry));
        self.a.push(vec![0.0, 0.0, 0.0, -bandwidth_rad_s]);
        self.b[0][0] = 0.0;
        self.b.push(vec![bandwidth_rad_s, 0.0]);
        self.c.iter_mut().zip([0.0, 0.0, 1.0, 0.0]).for_each(|(row, entry)| row.push(entry));
        self.d[2][0] = 0.0;
        self.states.push(("T_d", Unit::Torque));
    }
}
