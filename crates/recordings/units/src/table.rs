//! Every unit known, as benches spell it.

use std::f64::consts::{PI, TAU};

use crate::Quantity::{
    self, Angle, AngularAcceleration, AngularSpeed, Current, Damping, Force, Inertia, Length, MassFlow, Power,
    Pressure, Ratio, Speed, Stiffness, Temperature, Time, Torque, TorqueRate, Voltage,
};
use crate::unit::{RPM_RAD_S, Unit};

/// One degree in rad.
const DEGREE_RAD: f64 = PI / 180.0;
/// One pound-force in N: 0.453 592 37 kg · 9.806 65 m/s².
const POUND_FORCE_N: f64 = 4.448_221_615_260_5;
/// One foot in m.
const FOOT_M: f64 = 0.3048;
/// One inch in m.
const INCH_M: f64 = 0.0254;
/// One pound-force foot in Nm: 0.453 592 37 kg · 9.806 65 m/s² · 0.3048 m.
const POUND_FORCE_FOOT_NM: f64 = 1.355_817_948_331_400_4;
/// One pound foot squared in kg m²: 0.453 592 37 kg · (0.3048 m)².
const POUND_FOOT_SQUARED_KG_M2: f64 = 0.453_592_37 * FOOT_M * FOOT_M;
/// One kilogram-force in N, and one kilogram-force metre in Nm.
const KILOPOND_N: f64 = 9.806_65;
/// One metric horsepower in W: 75 kgf m/s.
const METRIC_HORSEPOWER_W: f64 = 75.0 * KILOPOND_N;
/// One mechanical horsepower in W: 550 lbf ft/s.
const HORSEPOWER_W: f64 = 550.0 * POUND_FORCE_FOOT_NM;
/// 0 °C in K.
const CELSIUS_ZERO_K: f64 = 273.15;
/// One degree Fahrenheit in K.
const FAHRENHEIT_K: f64 = 5.0 / 9.0;

/// A unit, and every other spelling of it; letter case, spaces and the like are of no matter, see
/// [`normalised`](crate::normalised).
pub(super) struct Row {
    pub(super) unit: Unit,
    others: &'static [&'static str],
}

impl Row {
    pub(super) fn spellings(&self) -> impl Iterator<Item = &'static str> + use<> {
        std::iter::once(self.unit.spelling).chain(self.others.iter().copied())
    }

    const fn with_zero_at(mut self, offset: f64) -> Self {
        self.unit.offset = offset;
        self
    }
}

const fn row(spelling: &'static str, quantity: Quantity, factor: f64, others: &'static [&'static str]) -> Row {
    Row { unit: Unit { quantity, factor, offset: 0.0, spelling }, others }
}

pub(super) const TABLE: &[Row] = &[
    row("rad/s", AngularSpeed, 1.0, &["rad/sec", "rads-1", "radian/s", "radians/s", "radps"]),
    row(
        "rpm",
        AngularSpeed,
        RPM_RAD_S,
        &[
            "1/min", "/min", "u/min", "r/min", "rev/min", "rot/min", "tr/min", "umdr/min", "min-1", "1min-1", "umin-1",
            "rmin-1", "revmin-1", "upm", "revs/min", "1/minute",
        ],
    ),
    row("krpm", AngularSpeed, 1000.0 * RPM_RAD_S, &["1000rpm", "1000/min", "x1000rpm"]),
    row("rev/s", AngularSpeed, TAU, &["rps", "u/s", "r/s", "tr/s", "revs-1", "us-1", "revs/s"]),
    row("deg/s", AngularSpeed, DEGREE_RAD, &["°/s", "grad/s", "degs-1", "°s-1", "degree/s", "degrees/s"]),
    row("Nm", Torque, 1.0, &["n-m", "newtonmeter", "newtonmetre", "newton-meter", "newton-metre", "newtonmeters"]),
    row("kNm", Torque, 1e3, &["kn-m"]),
    row("mNm", Torque, 1e-3, &["mn-m"]),
    row("Ncm", Torque, 1e-2, &["n-cm"]),
    row(
        "lbf ft",
        Torque,
        POUND_FORCE_FOOT_NM,
        &["lbft", "ftlb", "ftlbf", "lbf-ft", "lb-ft", "ft-lb", "ft-lbf", "ftlbs", "ft-lbs", "footpound", "poundfoot"],
    ),
    row(
        "lbf in",
        Torque,
        POUND_FORCE_FOOT_NM / 12.0,
        &["lbin", "inlb", "inlbf", "lbf-in", "lb-in", "in-lb", "in-lbf", "inlbs", "in-lbs"],
    ),
    row("kgf m", Torque, KILOPOND_N, &["kpm", "mkgf", "mkp", "kgf-m"]),
    row("1", Ratio, 1.0, &["-", "ratio", "frac", "fraction"]),
    row("%", Ratio, 1e-2, &["percent", "pct", "prozent", "perc", "percentage"]),
    row("‰", Ratio, 1e-3, &["promille", "permille"]),
    row("ppm", Ratio, 1e-6, &[]),
    row("kg m²", Inertia, 1.0, &["kg-m2", "kgm2/rad", "nms2", "nms2/rad"]),
    row("g m²", Inertia, 1e-3, &["g-m2"]),
    row("kg cm²", Inertia, 1e-4, &["kg-cm2"]),
    row("g cm²", Inertia, 1e-7, &["g-cm2"]),
    row("kg mm²", Inertia, 1e-6, &["kg-mm2"]),
    row("lb ft²", Inertia, POUND_FOOT_SQUARED_KG_M2, &["lbmft2", "lb-ft2", "lbm-ft2"]),
    row("Nm/rad", Stiffness, 1.0, &["n-m/rad", "nmrad-1"]),
    row("kNm/rad", Stiffness, 1e3, &["knmrad-1"]),
    row("Nm/deg", Stiffness, 1.0 / DEGREE_RAD, &["nm/°", "nm/grad"]),
    row("Nm s/rad", Damping, 1.0, &["nm/rad/s", "nmsrad-1", "nm-s/rad"]),
    row("Nm/rpm", Damping, 1.0 / RPM_RAD_S, &["nm/1/min", "nmmin"]),
    row("rad", Angle, 1.0, &["radian", "radians"]),
    row(
        "deg",
        Angle,
        DEGREE_RAD,
        &["°", "degree", "degrees", "grad", "°ca", "degca", "°crk", "degcrk", "°cra", "°kw", "gradkw", "degkw"],
    ),
    row("rev", Angle, TAU, &["revs", "umdr", "turn", "turns"]),
    row("rad/s²", AngularAcceleration, 1.0, &["rad/s/s", "rads-2", "rad/sec2"]),
    row(
        "rpm/s",
        AngularAcceleration,
        RPM_RAD_S,
        &["1/min/s", "u/min/s", "r/min/s", "rev/min/s", "min-1/s", "min-1s-1", "1/mins", "rpm/sec", "upm/s"],
    ),
    row("Nm/s", TorqueRate, 1.0, &["n-m/s", "nms-1", "nm/sec"]),
    row("kNm/s", TorqueRate, 1e3, &["kn-m/s", "knms-1"]),
    row("Nm/ms", TorqueRate, 1e3, &["n-m/ms"]),
    row("s", Time, 1.0, &["sec", "second", "seconds", "sek", "sekunde", "sekunden"]),
    row("ms", Time, 1e-3, &["msec", "millisecond", "milliseconds"]),
    row("µs", Time, 1e-6, &["us", "μs", "usec", "µsec"]),
    row("ns", Time, 1e-9, &["nsec"]),
    row("min", Time, 60.0, &["minute", "minutes", "minuten"]),
    row("h", Time, 3600.0, &["hr", "hour", "hours", "std", "stunde", "stunden"]),
    row("W", Power, 1.0, &["watt", "va"]),
    row("kW", Power, 1e3, &["kilowatt", "kva"]),
    row("PS", Power, METRIC_HORSEPOWER_W, &["cv", "pk", "hp(m)", "hpmetric"]),
    row("hp", Power, HORSEPOWER_W, &["bhp", "horsepower", "hp(i)"]),
    row("K", Temperature, 1.0, &["kelvin", "degk", "°k"]),
    row("°C", Temperature, 1.0, &["degc", "celsius", "deg.celsius", "gradc", "gradcelsius", "degreec", "℃"])
        .with_zero_at(CELSIUS_ZERO_K),
    row("°F", Temperature, FAHRENHEIT_K, &["degf", "fahrenheit", "℉"])
        .with_zero_at(CELSIUS_ZERO_K - 32.0 * FAHRENHEIT_K),
    row("Pa", Pressure, 1.0, &["pascal", "n/m2"]),
    row("hPa", Pressure, 1e2, &["mbar", "mbara"]),
    row("kPa", Pressure, 1e3, &["kpaa", "kpaabs"]),
    row("MPa", Pressure, 1e6, &["n/mm2"]),
    row("bar", Pressure, 1e5, &["bara", "barabs"]),
    row("psi", Pressure, POUND_FORCE_N / (INCH_M * INCH_M), &["lbf/in2", "psia"]),
    row("N", Force, 1.0, &["newton"]),
    row("kN", Force, 1e3, &[]),
    row("lbf", Force, POUND_FORCE_N, &[]),
    row("kgf", Force, KILOPOND_N, &["kp"]),
    row("A", Current, 1.0, &["amp", "ampere", "amps", "arms", "aeff"]),
    row("mA", Current, 1e-3, &[]),
    row("kA", Current, 1e3, &[]),
    row("V", Voltage, 1.0, &["volt", "volts", "vrms", "veff"]),
    row("mV", Voltage, 1e-3, &[]),
    row("kV", Voltage, 1e3, &[]),
    row("kg/s", MassFlow, 1.0, &["kgs-1"]),
    row("g/s", MassFlow, 1e-3, &["gs-1"]),
    row("kg/h", MassFlow, 1.0 / 3600.0, &["kg/hr", "kgh-1"]),
    row("m", Length, 1.0, &["meter", "metre"]),
    row("mm", Length, 1e-3, &[]),
    row("km", Length, 1e3, &[]),
    row("m/s", Speed, 1.0, &["ms-1", "mps"]),
    row("km/h", Speed, 1.0 / 3.6, &["kmh", "kph", "kmh-1"]),
    row("mph", Speed, 5280.0 * FOOT_M / 3600.0, &["mi/h", "mile/h", "miles/h"]),
];

/// Units with more than one meaning, and what to write instead.
pub(super) const AMBIGUOUS: &[(&str, &[&str])] =
    &[("hz", &["rev/s", "rad/s"]), ("1/s", &["rev/s", "rad/s"]), ("s-1", &["rev/s", "rad/s"])];
