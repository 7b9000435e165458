//! Tests that are asked for, drawn at random within the range of a bench's recordings.

use capability::{CycleDemand, Demand, shapes};
use cycle::{Own, Reference, RequirementSet, requirement};
use foreign_bench::{Mode, Random};
use rig::ControlMode;
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};

use crate::support::RPM;

/// Length of the part of a cycle, s.
const CYCLE_S: usize = 30;

/// A test.
pub(crate) struct Asked {
    pub(crate) name: &'static str,
    what: What,
    pub(crate) own: Vec<Own>,
    pub(crate) sets: Vec<RequirementSet>,
}

enum What {
    Plan(Box<ExperimentPlan>, Demands),
    Cycle(Reference),
}

impl Asked {
    /// One test of each kind, from a speed on.
    pub(crate) fn drawn(lowest_rad_s: f64, seed: u64) -> Vec<Asked> {
        let mut random = Random::new(seed ^ 0xa5ced);
        let lowest_rpm = lowest_rad_s / RPM;
        let speed = |random: &mut Random| lowest_rpm + random.between(0.0, 800.0).round();
        let tip_in = [
            ("speed", speed(&mut random)),
            ("torque", random.between(20.0, 50.0)),
            ("to", random.between(80.0, 160.0)),
            ("ramp", random.between(0.05, 0.3)),
        ];
        let height = random.between(20.0, 120.0) * random.one_of([-1.0, 1.0]);
        let step = [("speed", speed(&mut random) + 120.0), ("torque", 60.0), ("height", height)];
        let amplitude = ("amplitude", random.between(5.0, 20.0));
        let sweep = [("speed", speed(&mut random)), amplitude, ("to", 30.0), ("duration", 6.0)];
        let held_rpm = speed(&mut random);
        let in_torque_control = random.one_of([
            ("WhiteNoise_T_TN", ExperimentPlan::white_noise_t_tn as fn(f64, f64) -> ExperimentPlan),
            ("Step_T_TN", ExperimentPlan::step_t_tn),
            ("Sine_T_TN", ExperimentPlan::sine_t_tn),
        ]);
        vec![
            shaped("tip-in", &tip_in, &["speed within 10 rpm for 95 %"]),
            shaped("speed-step", &step, &["speed settling within 20 % below 1 s", "speed overshoot below 50 %"]),
            shaped("sine-sweep", &sweep, &[]),
            planned(in_torque_control.0, in_torque_control.1(held_rpm, 6.0), seed, &[]),
            Asked {
                name: "cycle",
                what: What::Cycle(part_of_a_cycle(lowest_rad_s, &mut random)),
                own: Vec::new(),
                sets: vec![requirement("1065.514").unwrap()],
            },
        ]
    }

    /// As the program is asked.
    pub(crate) fn demand(&self) -> Demand<'_> {
        match &self.what {
            What::Plan(plan, demands) => Demand::Plan(plan, demands),
            What::Cycle(reference) => Demand::Cycle(CycleDemand { reference, map: None }),
        }
    }

    pub(crate) fn plan(&self) -> Option<(&ExperimentPlan, &Demands)> {
        match &self.what {
            What::Plan(plan, demands) => Some((plan, demands)),
            What::Cycle(_) => None,
        }
    }

    pub(crate) fn reference(&self) -> Option<&Reference> {
        match &self.what {
            What::Plan(..) => None,
            What::Cycle(reference) => Some(reference),
        }
    }

    /// Tells whether T_d* is demanded, and so no prediction.
    pub(crate) fn is_in_torque_control(&self) -> bool {
        self.plan().is_some_and(|(plan, _)| plan.label.mode == ControlMode::Tn)
    }

    /// As the bench is asked: in a cycle the engine gives what its own inertia needs, too.
    pub(crate) fn foreign(&self, engine_inertia_kg_m2: f64) -> foreign_bench::Demand {
        match &self.what {
            What::Plan(plan, demands) => {
                let is_torque = plan.label.mode == ControlMode::Tn;
                foreign_bench::Demand {
                    mode: if is_torque { Mode::Torque } else { Mode::Speed },
                    speed_rad_s: demands.speed_rad_s.clone(),
                    torque_nm: if is_torque { &demands.dyno_torque_nm } else { &demands.engine_torque_nm }.clone(),
                }
            }
            What::Cycle(reference) => {
                let updates = 0..=1000 * (reference.speed_rad_s.len() - 1);
                let speed = |k: usize| reference.speed_at(1e-3 * k as f64);
                let torque = |k: usize| {
                    let acceleration = (speed(k + 1) - speed(k)) / 1e-3;
                    reference.torque_at(1e-3 * k as f64) + engine_inertia_kg_m2 * acceleration
                };
                foreign_bench::Demand {
                    mode: Mode::Speed,
                    speed_rad_s: updates.clone().map(speed).collect(),
                    torque_nm: updates.map(torque).collect(),
                }
            }
        }
    }
}

fn shaped(name: &'static str, numbers: &[(&str, f64)], own: &[&str]) -> Asked {
    let shape = shapes::find(name).unwrap();
    let given: Vec<(&str, String)> = numbers.iter().map(|(name, value)| (*name, format!("{value:.3}"))).collect();
    let given: Vec<(&str, &str)> = given.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let plan = shape.plan(&Settings::parse(shape.parameters, &given).unwrap()).unwrap();
    planned(name, plan, 1, own)
}

fn planned(name: &'static str, plan: ExperimentPlan, seed: u64, own: &[&str]) -> Asked {
    let demands = Demands::of(&plan, seed, DEMAND_HOLD_S);
    let own = own.iter().map(|text| text.parse().unwrap()).collect();
    Asked { name, what: What::Plan(Box::new(plan), demands), own, sets: Vec::new() }
}

/// Speeds within 1500 rpm and torques from 10 to 120 Nm, which go on at random from second to second.
fn part_of_a_cycle(lowest_rad_s: f64, random: &mut Random) -> Reference {
    let (mut speed, mut torque) = (lowest_rad_s + 300.0 * RPM, 50.0);
    let (mut speeds, mut torques) = (vec![speed], vec![torque]);
    for _ in 0..CYCLE_S {
        speed = (speed + 150.0 * RPM * random.normal()).clamp(lowest_rad_s, lowest_rad_s + 1500.0 * RPM);
        torque = (torque + 30.0 * random.normal()).clamp(10.0, 120.0);
        speeds.push(speed);
        torques.push(torque);
    }
    Reference::of_itself(0.0, speeds, torques)
}
