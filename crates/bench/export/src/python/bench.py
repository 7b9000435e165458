"""@TITLE@

The model simulates the bench in speed control (NT) and in torque control (TN), with a controller tick of 1 ms, delays, torque limit,
anti-windup and encoder gate. It needs numpy alone. All numbers are in SI: rad/s, Nm, kg m², s.

    import numpy as np
    from @MODULE@ import Bench, Start

    bench = Bench()
    start = Start.steady(bench, speed=@SPEED@, torque=@TORQUE@)
    engine = np.full(2000, @TORQUE@)
    engine[1000:] = @MORE@
    response = bench.simulate(engine, start, @EXAMPLE@)
    response["T_shaft"]

The torque T_d is positive when it brakes the dynamometer:
    J_d dw_d/dt = T_shaft - T_d,  J_e dw_e/dt = T_e - T_shaft,  T_shaft = K twist + B (w_e - w_d)
"""

from dataclasses import dataclass
import math

import numpy as np

# begin of the model
# end of the model

INSTANT = 1e-9  # part of a tick below which two instants count as one


@dataclass(frozen=True)
class Start:
    """State of the bench at the first sample."""

    w_d: float  # speed of the dynamometer, rad/s
    w_e: float  # speed of the engine, rad/s
    twist: float  # of the shaft, rad
    T_d: float  # air-gap torque, Nm
    integrator: float = 0.0  # of the speed controller, Nm

    @staticmethod
    def steady(bench, speed, torque):
        """Everything turns at one speed (rad/s) under one torque (Nm)."""
        feed_forward = (bench["k"] or 0.0) * speed
        return Start(speed, speed, torque / bench["K"], torque, torque - feed_forward)


@dataclass(frozen=True)
class EngineSpeedControl:
    """Speed control of the engine in TN: T_e = P e + I, dI/dt = K e, with e = w_e* - w_e. The torque is there a tick later."""

    speed: np.ndarray  # w_e*, rad/s, one value a tick
    proportional: float  # Nm s/rad
    integral: float  # Nm/rad
    start: float = 0.0  # Nm


class Bench:
    """The bench with the estimated parameters; keyword arguments change some, as in Bench(K=2500.0)."""

    def __init__(self, **changes):
        unknown = set(changes) - set(PARAMETERS)
        if unknown:
            raise ValueError(f"unknown parameters: {', '.join(sorted(unknown))}; there are {', '.join(PARAMETERS)}")
        self.parameters = {**PARAMETERS, **changes}

    def __getitem__(self, name):
        return self.parameters[name]

    def changed(self, **changes):
        """The same bench with some parameters changed."""
        return Bench(**{**self.parameters, **changes})

    def draw(self, random):
        """A bench drawn from the covariance of the estimates; `random` is a numpy.random.Generator."""
        changes = {}
        for names, covariance, degrees_of_freedom in COVARIANCE:
            centre = np.array([self[name] for name in names])
            for _ in range(1000):
                step = random.multivariate_normal(np.zeros(len(names)), np.array(covariance), method="eigh")
                if math.isfinite(degrees_of_freedom):
                    step *= math.sqrt(degrees_of_freedom / random.chisquare(degrees_of_freedom))
                drawn = dict(zip(names, (centre + step).tolist()))
                if all(_can_be(name, value) for name, value in drawn.items()):
                    break
            else:
                raise ValueError(f"hardly any draw of {', '.join(names)} is a bench that can be")
            changes.update(drawn)
        return self.changed(**changes)

    def is_valid(self, response):
        """Whether each sample of a response is within the range of the recordings that the model was estimated from."""
        inside = np.ones(len(response["w_d"]), dtype=bool)
        for name in ("w_d", "T_d"):
            if VALIDITY[name] is not None:
                low, high = VALIDITY[name]
                inside &= (response[name] >= low) & (response[name] <= high)
        return inside

    def simulate(
        self,
        engine_torque,
        start,
        *,
        speed_demand=None,
        torque_demand=None,
        air_gap_torque=None,
        engine_speed_control=None,
        sample_time=None,
    ):
        """Simulates the bench. Give one demand, with one value a tick as the engine torque has.

        engine_torque: T_e, Nm, linear between the samples. speed_demand: w_d*, rad/s (NT), as the controller has it: advance a
        recorded one by DEMAND_LEAD ticks. torque_demand: T_d*, Nm, held (TN).
        air_gap_torque: T_d itself, Nm, linear between the samples. engine_speed_control: an EngineSpeedControl, whose torque is added
        to engine_torque. sample_time: of the inputs in TN, s; in NT it is that of the controller.
        Returns a dict of arrays: w_d and w_e as the encoders read them, T_d, T_shaft, T_e, and T_d_demand (none with air_gap_torque).
        """
        drives = [d for d in (speed_demand, torque_demand, air_gap_torque) if d is not None]
        if len(drives) != 1:
            raise ValueError("give one of speed_demand, torque_demand and air_gap_torque")
        engine = np.array(engine_torque, dtype=float)
        drive = np.asarray(drives[0], dtype=float)
        if engine.ndim != 1 or engine.shape != drive.shape or len(engine) == 0:
            raise ValueError(f"engine torque and demand need one value a tick each, not {engine.shape} and {drive.shape}")
        step = self._tick(speed_demand is not None, sample_time)
        plant = _Plant(self, step, air_gap_torque is not None, start)
        controller = None if speed_demand is None else _Controller(self, start)
        streams = _Streams(start.integrator if controller else 0.0, self["T_limit"])
        governor = None
        if engine_speed_control is not None:
            governor = _Governor(engine_speed_control, step, engine)
        encoders = _Encoder(self["T_gate"] / step, step), _Encoder(self["T_gate"] / step, step)
        out = {name: np.empty(len(engine)) for name in ("w_d", "w_e", "T_d", "T_shaft")}
        demands = []
        for k in range(len(engine)):
            reading = encoders[0].read(plant.x[4], plant.x[0])
            out["w_d"][k] = reading
            out["w_e"][k] = encoders[1].read(plant.x[5], plant.x[1])
            if governor:
                governor.update(k, out["w_e"][k])
            if controller:
                demands.append(controller.update(reading, drive, k, streams))
            elif torque_demand is not None:
                demands.append(streams.push_demand(drive[k]))
            out["T_d"][k] = plant.air_gap_torque(drive, streams, k)
            out["T_shaft"][k] = self["K"] * plant.x[2] + self["B"] * (plant.x[1] - plant.x[0])
            plant.advance(engine, drive, streams, k)
        out["T_e"] = engine
        if air_gap_torque is None:
            out["T_d_demand"] = np.array(demands)
        return out

    def state_space(self):
        """A, B, C, D of the mechanics with the lag of the torque control, continuous.

        Inputs T_d* and T_e, outputs w_d, w_e, T_d, T_shaft, states w_d, w_e, twist and, with a lag, T_d. The delay tau_t of T_d* is left out.
        """
        full_a, full_b = _continuous(self, self["a"])
        lag = self["a"] is not None
        n = 4 if lag else 3
        a, b = full_a[:n, :n], full_b[:n, :2]
        c, d = np.zeros((4, n)), np.zeros((4, 2))
        c[0, 0] = c[1, 1] = 1.0
        if lag:
            c[2, 3] = 1.0
        else:
            d[2, 0] = 1.0
        c[3, :3] = [-self["B"], self["B"], self["K"]]
        return a, b, c, d

    def control_state_space(self, pade=0):
        """The same as a control.StateSpace of the package `control`; `pade` is the order of the approximation of the delay, 0 for none."""
        import control

        system = control.ss(*self.state_space())
        if pade and self["tau_t"]:
            delay = control.ss(control.tf(*control.pade(self["tau_t"], pade)))
            system = system * control.append(delay, control.ss([], [], [], [[1.0]]))
        return control.ss(
            system.A, system.B, system.C, system.D, inputs=["T_d_demand", "T_e"], outputs=["w_d", "w_e", "T_d", "T_shaft"]
        )

    def _tick(self, is_speed_control, sample_time):
        own = self["T_s"]
        if is_speed_control and (own is None or self["a"] is None and self["tau_t"] is None):
            raise ValueError("the model has no speed controller, or no torque control")
        if is_speed_control and sample_time is not None and abs(sample_time - own) > 1e-6 * own:
            raise ValueError(f"inputs every {sample_time} s, but the controller runs every {own} s")
        return sample_time or own or 1e-3


def _can_be(name, value):
    if name in ("K_p", "K_i", "k", "k_a"):
        return math.isfinite(value)
    if name in ("B", "tau_c", "tau_t"):
        return math.isfinite(value) and value >= 0.0
    return math.isfinite(value) and value > 0.0


def _samples_back(delay, position):
    """Which sample is in force `position` ticks after the present one if each takes effect `delay` ticks after its own."""
    return int(max(math.ceil(delay - position - INSTANT), 0.0))


def _round(value):
    """To the nearest whole number, halves away from zero."""
    return int(math.copysign(math.floor(abs(value) + 0.5), value))


class _Streams:
    """What the controller has demanded: PI before its delay, and the feed-forward, or T_d* as the latter."""

    def __init__(self, before, limit):
        self.delayed, self.immediate, self.before = [], [], before
        self.limit = math.inf if limit is None else limit

    def push_controller(self, pi, feed_forward, updates):
        self.delayed.append(pi)
        self.immediate.append(feed_forward)
        return self.demand(len(self.delayed) - 1, _samples_back(updates, 0.0), 0)

    def push_demand(self, demand):
        self.delayed.append(0.0)
        self.immediate.append(demand)
        return min(max(demand, -self.limit), self.limit)

    def demand(self, k, delayed_back, immediate_back):
        delayed = self.delayed[k - delayed_back] if k >= delayed_back else self.before
        total = delayed + self.immediate[max(k - immediate_back, 0)]
        return min(max(total, -self.limit), self.limit)


class _Controller:
    """PI and feed-forward. At the limit the integrator rests if the error would drive it further."""

    def __init__(self, bench, start):
        self.bench = bench
        self.integral = start.integrator
        self.limit = math.inf if bench["T_limit"] is None else bench["T_limit"]
        self.lag = _round((bench["tau_n"] - bench["tau_c"]) / bench["T_s"])
        self.feed_lag = _round((bench["tau_f"] or 0.0) / bench["T_s"])

    def update(self, reading, demand, k, streams):
        bench = self.bench

        def late(lag):
            return demand[min(max(k - lag, 0), len(demand) - 1)]

        feed_forward = 0.0
        if bench["k"] is not None:
            now, before = late(self.feed_lag), late(self.feed_lag + 1)
            feed_forward = bench["k"] * now + bench["k_a"] * ((now - before) / bench["T_s"])
        error = reading - late(self.lag)
        output = bench["K_p"] * error + self.integral
        change = bench["K_i"] * bench["T_s"] * error
        total = output + feed_forward
        if not (abs(total) > self.limit and change * total > 0.0):
            self.integral += change
        return streams.push_controller(output, feed_forward, bench["tau_c"] / bench["T_s"])


class _Governor:
    def __init__(self, control, step, engine):
        if len(control.speed) != len(engine):
            raise ValueError("the speed demand of the engine needs one value a tick")
        self.control, self.step, self.engine = control, step, engine
        self.integral = control.start
        engine[0] += self.integral

    def update(self, k, reading):
        error = self.control.speed[k] - reading
        torque = self.control.proportional * error + self.integral
        self.integral += self.control.integral * self.step * error
        if k + 1 < len(self.engine):
            self.engine[k + 1] += torque


class _Encoder:
    """Reads the mean speed over its gate. Between samples the angle is a cubic."""

    def __init__(self, gate, step):
        self.gate, self.step = gate, step
        self.angles, self.speeds = [], []

    def read(self, angle, speed):
        self.angles.append(angle)
        self.speeds.append(speed)
        if self.gate <= 0.0:
            return speed
        return (angle - self._at(len(self.angles) - 1 - self.gate)) / (self.gate * self.step)

    def _at(self, position):
        below = math.floor(position)
        if below < 0:
            return self.angles[0] + position * self.step * self.speeds[0]
        x = position - below
        if x == 0.0:
            return self.angles[below]
        a, b = self.angles[below], self.angles[below + 1]
        da, db = self.speeds[below] * self.step, self.speeds[below + 1] * self.step
        y, xx = 1.0 - x, x * x
        return a + (b - a) * xx * (3.0 - 2.0 * x) + x * y * (da * y - db * x)


class _Plant:
    """Torque control and mechanics between two ticks, exact. States w_d, w_e, twist, T_d, angles of both."""

    def __init__(self, bench, step, is_torque_given, start):
        bandwidth = None if is_torque_given else bench["a"]
        delay = 0.0 if is_torque_given else max(bench["tau_t"], 0.0)
        immediate = delay / step
        delayed = (delay + max(bench["tau_c"] or 0.0, 0.0)) / step
        self.has_lag, self.is_torque_given = bandwidth is not None, is_torque_given
        self.x = np.array([start.w_d, start.w_e, start.twist, start.T_d, 0.0, 0.0])
        a, b = _continuous(bench, bandwidth)
        instants = [0.0, 1.0]
        for value in (delayed, immediate):
            instant = value - math.floor(value)
            if all(abs(other - instant) > INSTANT for other in instants):
                instants.append(instant)
        instants.sort()
        self.substeps = [
            (x0, x1, _samples_back(delayed, x0), _samples_back(immediate, x0), *_held(a, b, (x1 - x0) * step))
            for x0, x1 in zip(instants, instants[1:])
        ]

    def air_gap_torque(self, drive, streams, k):
        if self.is_torque_given:
            return drive[k]
        if self.has_lag:
            return self.x[3]
        return streams.demand(k, self.substeps[0][2], self.substeps[0][3])

    def advance(self, engine, drive, streams, k):
        after = min(k + 1, len(engine) - 1)
        for x0, x1, delayed_back, immediate_back, phi, first, last in self.substeps:
            if self.is_torque_given:
                braking = [drive[k] + (drive[after] - drive[k]) * x for x in (x0, x1)]
            else:
                braking = [streams.demand(k, delayed_back, immediate_back)] * 2
            torque = [engine[k] + (engine[after] - engine[k]) * x for x in (x0, x1)]
            self.x = phi @ self.x + first @ [braking[0], torque[0]] + last @ [braking[1], torque[1]]


def _continuous(bench, bandwidth):
    """A and B of the six states; the inputs are the demand at the lag, or T_d itself, and T_e."""
    a, b = np.zeros((6, 6)), np.zeros((6, 2))
    stiffness, damping = bench["K"], bench["B"]
    for row, sign, inertia in ((0, 1.0, bench["J_d"]), (1, -1.0, bench["J_e"])):
        a[row, :3] = [-sign * damping / inertia, sign * damping / inertia, sign * stiffness / inertia]
    a[2, :2] = [-1.0, 1.0]
    a[4, 0] = a[5, 1] = 1.0
    b[1, 1] = 1.0 / bench["J_e"]
    if bandwidth is None:
        b[0, 0] = -1.0 / bench["J_d"]
    else:
        a[0, 3] = -1.0 / bench["J_d"]
        a[3, 3] = -bandwidth
        b[3, 0] = bandwidth
    return a, b


def _held(a, b, step):
    """Transition over a step, and what inputs that are linear over it do by their first and their last value."""
    n, m = b.shape
    whole = np.zeros((n + 2 * m, n + 2 * m))
    whole[:n, :n], whole[:n, n : n + m], whole[n : n + m, n + m :] = a * step, b * step, np.eye(m)
    whole = _exponential(whole)
    last = whole[:n, n + m :]
    return whole[:n, :n], whole[:n, n : n + m] - last, last


def _exponential(matrix):
    """The exponential of a matrix, by a power series of the matrix scaled down."""
    doublings = max(0, math.ceil(math.log2(max(np.abs(matrix).sum(axis=1).max(), 1e-300))) + 2)
    scaled = matrix / 2.0**doublings
    term = total = np.eye(len(matrix))
    for order in range(1, 22):
        term = term @ scaled / order
        total = total + term
    for _ in range(doublings):
        total = total @ total
    return total
