//! The equations of the masses and the shafts between them, in state space.

use std::f64::consts::TAU;

use faer::Mat;
use lti::{Complex64, StateSpace};
use rig::bench_parameters::{MechanicsParameters, RelaxingSpring, RelaxingSprings};

/// Where the air-gap torque and the bearings' friction act.
pub(super) const ROTOR: usize = 0;

/// Torques that drive the train: brake on the rotor, T_e on the engine, and what the shaft has beyond its linear part.
pub(super) const INPUTS: usize = 3;
pub(super) const BRAKE: usize = 0;
pub(super) const ENGINE: usize = 1;
pub(super) const SHAFT: usize = 2;

/// A linear connection of one mass to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Connection {
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

/// The train from the rotor to the engine. States: speeds of the masses, twists of the connections, relaxing springs of
/// the shaft, angles of rotor and engine.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Assembly {
    pub(super) inertias: Vec<f64>,
    pub(super) connections: Vec<Connection>,
    /// Which connection the shaft is.
    pub(super) shaft: usize,
    /// Relaxing springs of the shaft, their ratios those to the whole stiffness.
    springs: Vec<RelaxingSpring>,
    /// K as stated, zero without a shaft.
    stated_stiffness: f64,
    pub(super) viscous: f64,
}

impl Assembly {
    /// The train, its shaft bolted on or not.
    pub(super) fn new(parameters: &MechanicsParameters, is_connected: bool) -> Self {
        let on = if is_connected { 1.0 } else { 0.0 };
        let relaxing = RelaxingSprings::new(parameters.shaft_loss.filter(|_| is_connected));
        let stiffness = on * parameters.shaft_stiffness_nm_per_rad;
        let shaft = Connection {
            stiffness: stiffness * relaxing.static_ratio,
            damping: on * parameters.shaft_damping_nm_s_per_rad,
        };
        let (mut inertias, mut connections) = (vec![parameters.dyno_inertia_kg_m2], Vec::new());
        if let Some(twist) = parameters.dyno_twist {
            inertias = vec![parameters.dyno_inertia_kg_m2 - twist.coupling_inertia_kg_m2, twist.coupling_inertia_kg_m2];
            connections.push(Connection { stiffness: twist.stiffness_nm_per_rad, damping: twist.damping_nm_s_per_rad });
        }
        connections.push(shaft);
        let mut engine = parameters.engine_inertia_kg_m2;
        if let Some(flywheel) = parameters.flywheel {
            inertias.push(flywheel.secondary_inertia_kg_m2);
            engine -= flywheel.secondary_inertia_kg_m2;
            connections
                .push(Connection { stiffness: flywheel.stiffness_nm_per_rad, damping: flywheel.damping_nm_s_per_rad });
        }
        inertias.push(engine);
        Self {
            shaft: usize::from(parameters.dyno_twist.is_some()),
            stated_stiffness: stiffness,
            viscous: parameters.viscous_friction_nm_s_per_rad,
            inertias,
            connections,
            springs: relaxing.springs,
        }
    }

    pub(super) fn engine(&self) -> usize {
        self.inertias.len() - 1
    }

    pub(super) fn twist(&self, connection: usize) -> usize {
        self.inertias.len() + connection
    }

    pub(super) fn spring(&self, spring: usize) -> usize {
        self.inertias.len() + self.connections.len() + spring
    }

    pub(super) fn rotor_angle(&self) -> usize {
        self.spring(self.springs.len())
    }

    pub(super) fn engine_angle(&self) -> usize {
        self.rotor_angle() + 1
    }

    pub(super) fn states(&self) -> usize {
        self.engine_angle() + 1
    }

    /// T of a connection as a row on the states: K φ + B (ω_next − ω), and for the shaft the relaxing springs.
    pub(super) fn torque_row(&self, connection: usize) -> Vec<f64> {
        let mut row = vec![0.0; self.states()];
        let Connection { stiffness, damping } = self.connections[connection];
        row[connection] -= damping;
        row[connection + 1] += damping;
        row[self.twist(connection)] = stiffness;
        if connection == self.shaft {
            for (index, spring) in self.springs.iter().enumerate() {
                row[self.spring(index)] = self.stated_stiffness * spring.ratio;
            }
        }
        row
    }

    /// ẋ = A x + B u with u = (brake, engine, shaft beyond linear).
    pub(super) fn matrices(&self) -> (Mat<f64>, Mat<f64>) {
        let n = self.states();
        let (mut a, mut b) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, INPUTS));
        for connection in 0..self.connections.len() {
            let row = self.torque_row(connection);
            for (j, torque) in row.iter().enumerate() {
                a[(connection, j)] += torque / self.inertias[connection];
                a[(connection + 1, j)] -= torque / self.inertias[connection + 1];
            }
            a[(self.twist(connection), connection)] = -1.0;
            a[(self.twist(connection), connection + 1)] = 1.0;
        }
        for (index, spring) in self.springs.iter().enumerate() {
            let state = self.spring(index);
            a[(state, self.shaft)] = -1.0;
            a[(state, self.shaft + 1)] = 1.0;
            a[(state, state)] = -spring.rate;
        }
        a[(ROTOR, ROTOR)] -= self.viscous / self.inertias[ROTOR];
        a[(self.rotor_angle(), ROTOR)] = 1.0;
        a[(self.engine_angle(), self.engine())] = 1.0;
        b[(ROTOR, BRAKE)] = -1.0 / self.inertias[ROTOR];
        b[(self.engine(), ENGINE)] = 1.0 / self.inertias[self.engine()];
        b[(self.shaft, SHAFT)] = 1.0 / self.inertias[self.shaft];
        b[(self.shaft + 1, SHAFT)] = -1.0 / self.inertias[self.shaft + 1];
        (a, b)
    }

    /// Gain of T_d → T_shaft with play and stiffening left out.
    ///
    /// From the engine's end inwards: what lies beyond mass i takes I_i ω_i, with I_i = Z/(1 + Z/(J_{i+1} s + I_{i+1}))
    /// and Z = T/Δω of the connection.
    pub(super) fn shaft_gain(&self, frequency_hz: f64) -> f64 {
        let s = Complex64::new(0.0, TAU * frequency_hz);
        let mut gain = Complex64::new(1.0, 0.0);
        let mut beyond = Complex64::new(0.0, 0.0);
        for (connection, linear) in self.connections.iter().enumerate().rev() {
            let mut stiffness = Complex64::new(linear.stiffness, 0.0);
            if connection == self.shaft {
                let relaxing = |spring: &RelaxingSpring| s * (self.stated_stiffness * spring.ratio) / (s + spring.rate);
                stiffness += self.springs.iter().map(relaxing).sum::<Complex64>();
            }
            let impedance = stiffness / s + linear.damping;
            beyond = impedance / (impedance / (s * self.inertias[connection + 1] + beyond) + 1.0);
            if connection <= self.shaft {
                let bearing = if connection == ROTOR { self.viscous } else { 0.0 };
                gain *= beyond / (s * self.inertias[connection] + beyond + bearing);
            }
        }
        gain.norm()
    }

    /// The equations as a system with its states as outputs.
    pub(super) fn state_space(&self) -> Result<StateSpace, lti::LtiError> {
        let (a, b) = self.matrices();
        let n = self.states();
        StateSpace::new(a, b, Mat::identity(n, n), Mat::zeros(n, INPUTS), None)
    }
}
