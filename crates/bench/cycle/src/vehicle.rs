//! A vehicle that follows a speed, and what that asks of the engine: the model of 40 CFR 1036.545.

use serde::{Deserialize, Serialize};

use crate::error::CycleError;
use crate::reference::Reference;

/// Standard acceleration of free fall, m/s².
const GRAVITY: f64 = 9.806_65;
/// Density of air, kg/m³.
const AIR: f64 = 1.1845;
/// Steps of the model in a second: at least 100.
const STEPS: usize = 100;

/// Mass and road load of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vehicle {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Mass that turning parts add to it, kg.
    #[serde(default)]
    pub rotating_mass_kg: f64,
    /// Rolling resistance, N/N.
    pub rolling_resistance: f64,
    /// Drag area C_d A, m².
    pub drag_area_m2: f64,
    /// Radius of the tyres, m.
    pub tyre_radius_m: f64,
    /// Ratio of the axle.
    pub axle_ratio: f64,
    /// Efficiency of the driveline.
    #[serde(default = "usual_efficiency")]
    pub efficiency: f64,
}

fn usual_efficiency() -> f64 {
    0.955
}

/// Gears, and the speeds at which they change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gearbox {
    /// Ratios, first gear first.
    pub ratios: Vec<f64>,
    /// The next higher gear is taken above this engine speed, rpm.
    pub up_rpm: f64,
    /// The next lower gear is taken below this engine speed, rpm.
    pub down_rpm: f64,
    /// The clutch holds the engine at this speed at least, rpm.
    pub idle_rpm: f64,
}

/// A driver who looks at the speed: T at the wheel = K_p e + K_i ∫e, beside what the road load asks for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Driver {
    /// N for each m/s.
    pub proportional_n_s_m: f64,
    /// N/s for each m/s.
    pub integral_n_m: f64,
}

impl Driver {
    /// A driver for a vehicle: a time constant of half a second.
    pub fn of(vehicle: &Vehicle) -> Self {
        let mass = vehicle.mass_kg + vehicle.rotating_mass_kg;
        Driver { proportional_n_s_m: 2.0 * mass, integral_n_m: mass }
    }
}

/// Result of a vehicle's run through a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct VehicleRun {
    /// Speed and torque of the engine each second.
    pub reference: Reference,
    /// Speed of the vehicle each second, m/s.
    pub speed_m_s: Vec<f64>,
    /// Gear each second, from 1 on.
    pub gear: Vec<usize>,
}

impl Vehicle {
    /// Force against the motion at a speed on a road of this grade (rise over run), N.
    pub fn road_load_n(&self, speed_m_s: f64, grade: f64) -> f64 {
        let angle = grade.atan();
        let rolling =
            if speed_m_s > 0.0 { self.mass_kg * GRAVITY * self.rolling_resistance * angle.cos() } else { 0.0 };
        rolling + 0.5 * AIR * self.drag_area_m2 * speed_m_s * speed_m_s + self.mass_kg * GRAVITY * angle.sin()
    }

    /// The speed after a step, m/s: v + Δt (F − F_road)/(M + M_rot); the vehicle does not roll back.
    pub fn next_speed_m_s(&self, speed_m_s: f64, force_n: f64, grade: f64, step_s: f64) -> f64 {
        let net_n = force_n - self.road_load_n(speed_m_s, grade);
        (speed_m_s + step_s * net_n / (self.mass_kg + self.rotating_mass_kg)).max(0.0)
    }

    /// Angular speed of the axle's input at a vehicle speed, rad/s: k_a v/r.
    pub fn input_speed_rad_s(&self, speed_m_s: f64) -> f64 {
        self.axle_ratio * speed_m_s / self.tyre_radius_m
    }

    /// Lets a driver follow a schedule, m/s at each second from 0 on, on a level road.
    ///
    /// # Errors
    /// A value of vehicle or gears that cannot be, a schedule without values.
    pub fn follow(&self, schedule_m_s: &[f64], gears: &Gearbox, driver: &Driver) -> Result<VehicleRun, CycleError> {
        self.check()?;
        gears.check()?;
        if schedule_m_s.is_empty() {
            return Err(CycleError::Length { what: "schedule", expected: 1, found: 0 });
        }
        let step_s = 1.0 / STEPS as f64;
        let (mut speed, mut integral_n, mut gear) = (schedule_m_s[0].max(0.0), 0.0, 0);
        let (mut engine_rad_s, mut engine_nm) = (Vec::new(), Vec::new());
        let (mut speeds, mut gears_used) = (Vec::new(), Vec::new());
        for k in 0..=(schedule_m_s.len() - 1) * STEPS {
            let place = k as f64 * step_s;
            let low = place.floor() as usize;
            let next = schedule_m_s[(low + 1).min(schedule_m_s.len() - 1)];
            let target = schedule_m_s[low] + place.fract() * (next - schedule_m_s[low]);
            let error = target - speed;
            integral_n += driver.integral_n_m * error * step_s;
            if target <= 0.0 {
                integral_n = 0.0;
            }
            let mass = self.mass_kg + self.rotating_mass_kg;
            let ahead_n = self.road_load_n(target, 0.0) + mass * (next - schedule_m_s[low]);
            let force_n = if target <= 0.0 {
                0.0_f64.min(-mass)
            } else {
                ahead_n + driver.proportional_n_s_m * error + integral_n
            };
            let input = self.input_speed_rad_s(speed) / units::RPM_RAD_S;
            gear = gears.choose(gear, input);
            if k % STEPS == 0 {
                let ratio = gears.ratios[gear];
                let turning = (input * ratio).max(gears.idle_rpm) * units::RPM_RAD_S;
                let efficiency = if force_n >= 0.0 { 1.0 / self.efficiency } else { self.efficiency };
                let wheel_nm = if target > 0.0 { force_n * self.tyre_radius_m } else { 0.0 };
                engine_rad_s.push(turning);
                engine_nm.push(efficiency * wheel_nm / (self.axle_ratio * ratio));
                speeds.push(speed);
                gears_used.push(gear + 1);
            }
            speed = self.next_speed_m_s(speed, force_n, 0.0, step_s);
        }
        let reference = Reference::of_itself(0.0, engine_rad_s, engine_nm);
        Ok(VehicleRun { reference, speed_m_s: speeds, gear: gears_used })
    }

    fn check(&self) -> Result<(), CycleError> {
        let positive = [
            ("mass_kg", self.mass_kg),
            ("tyre_radius_m", self.tyre_radius_m),
            ("axle_ratio", self.axle_ratio),
            ("efficiency", self.efficiency),
        ];
        let not_negative = [
            ("rotating_mass_kg", self.rotating_mass_kg),
            ("rolling_resistance", self.rolling_resistance),
            ("drag_area_m2", self.drag_area_m2),
        ];
        let fault = |name, value, possible| CycleError::Vehicle { name, value, possible };
        let bad = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        let negative = not_negative.into_iter().find(|(_, value)| !(*value >= 0.0 && value.is_finite()));
        match (bad, negative) {
            (Some((name, value)), _) => Err(fault(name, value, "above 0")),
            (_, Some((name, value))) => Err(fault(name, value, "0 or above")),
            _ => Ok(()),
        }
    }
}

impl Gearbox {
    fn check(&self) -> Result<(), CycleError> {
        let fault = |name, value, possible| Err(CycleError::Vehicle { name, value, possible });
        if self.ratios.is_empty() {
            return fault("gears", 0.0, "one ratio or more");
        }
        if let Some(ratio) = self.ratios.iter().find(|ratio| !(**ratio > 0.0 && ratio.is_finite())) {
            return fault("a ratio", *ratio, "above 0");
        }
        if !(self.up_rpm > self.down_rpm && self.down_rpm >= self.idle_rpm && self.idle_rpm > 0.0) {
            return fault("up_rpm", self.up_rpm, "above down_rpm, and that at idle_rpm or above");
        }
        Ok(())
    }

    /// The gear for a speed of the gearbox's output, rpm; one step at a time.
    fn choose(&self, gear: usize, output_rpm: f64) -> usize {
        let engine_rpm = output_rpm * self.ratios[gear];
        if engine_rpm > self.up_rpm && gear + 1 < self.ratios.len() {
            gear + 1
        } else if engine_rpm < self.down_rpm && gear > 0 {
            gear - 1
        } else {
            gear
        }
    }
}
