"""References of the examples, from the equations of their axes; see `axes.py` for the cascade.

    python tests/fmus/validation/examples.py [--into FOLDER]

writes one CSV for each example of `examples.csv` into the library, `AxisRig/Resources`.
"""

import argparse
import csv
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from axes import ROTOR, SLIDE, Drive, at_limit
from gantry import Course, Stop, _signals
from integration import Guard, Mode, Vector, integrate
from make_references import instants
from mechanics import hunt_crossley, stribeck
from scipy.integrate import OdeSolution, solve_ivp
from scipy.optimize import brentq

HERE = Path(__file__).parent
LIBRARY = HERE.parents[2] / "fmus" / "axisrig" / "fmus" / "AxisRig" / "Resources"
MASS = SLIDE + ROTOR
LOOP = Drive(gain=2.0 * math.pi * 60.0 * MASS, feed_forward=0.0, ta=8e-3)
VISCOUS = 800.0

State = list[float]
Error = Callable[[float, State], float]


class Stretches:
    """An axis with viscous friction only, whose demand changes at instants or places.

    States: x, v, F, I and what `more` adds, the rates of further states.
    """

    def __init__(self, state: State, more: Callable[[float, State], State] | None = None) -> None:
        self.t, self.state, self.more = 0.0, state, more
        self._parts: list[tuple[float, OdeSolution]] = []

    def run(self, error: Error, end: float, until: Callable[[float, State], float] | None) -> None:
        """Integrate with a velocity error(t, state) to the instant `end`, or to a sign change."""

        def rhs(t: float, s: Vector) -> State:
            x = [float(value) for value in s]
            rates = LOOP.rates(error(t, x), x[2], x[3], None)
            own = [x[1], (x[2] - VISCOUS * x[1]) / MASS, *rates]
            return own + (self.more(t, x) if self.more else [])

        def event(t: float, s: Vector) -> float:
            return until(t, [float(value) for value in s]) if until else 1.0

        event.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            rhs, (self.t, end), self.state, "DOP853", events=event, rtol=1e-12, atol=1e-15,
            dense_output=True, max_step=2.5e-4,
        )  # fmt: skip
        self.t, self.state = float(found.t[-1]), found.y[:, -1].tolist()
        self._parts.append((self.t, found.sol))

    def at(self, time_s: Vector) -> Vector:
        """The states at instants, as rows."""
        rows = []
        for t in time_s:
            part = next(sol for end, sol in self._parts if t <= end)
            rows.append(part(t))
        return np.array(rows)


def since(time_s: Vector, instant: float, value: float) -> Vector:
    """A value from an instant on, 0 before."""
    return np.where(time_s >= instant, value, 0.0)


def touch(time_s: Vector) -> Mapping[str, Vector]:
    """Down with 20 mm/s; the edge is 2 ms after the ball of 1 mm is 10 um in the plane at 0.1 m."""
    kv, feed, place = 40.0, 0.02, 0.1 + 1e-3 - 10e-6
    axis = Stretches([0.105, 0.0, 0.0, 0.0])

    def down(t: float, s: State) -> float:
        return kv * (0.105 - feed * t - s[0]) - s[1]

    axis.run(down, 1.0, lambda t, s: s[0] - 0.101)
    contact = axis.t
    axis.run(down, 1.0, lambda t, s: s[0] - place)
    edge = axis.t + 2e-3
    axis.run(down, edge, None)
    turned = axis.state[0]

    def up(t: float, s: State) -> float:
        return kv * (turned + feed * (t - edge) - s[0]) - s[1]

    axis.run(up, 1.0, lambda t, s: s[0] - place if t > edge + 5e-3 else -1.0)
    release = axis.t + 2e-3
    axis.run(up, float(time_s[-1]) + 1.0, None)
    return {
        "position": axis.at(time_s)[:, 0],
        "edge_position": since(time_s, edge, turned),
        "contact_time": since(time_s, contact, contact),
        "rising_time": since(time_s, edge, edge),
        "falling_time": since(time_s, release, release),
    }


def tilting_touch(time_s: Vector) -> Mapping[str, Vector]:
    """The tip of a lever of 180 mm that straightens with 0.4 rad/s, going down with 20 mm/s."""
    lever, radius = 0.18, 1e-3

    def height(t: Any) -> Any:
        return 0.187 - 0.02 * t - lever * np.cos(-0.3 + 0.4 * t)

    touch = float(brentq(lambda t: height(t) - radius, 0.0, 0.49, xtol=1e-15, rtol=1e-15))
    return {
        "tcp_y": lever * np.sin(-0.3 + 0.4 * time_s),
        "tcp_z": height(time_s),
        "contact_time": since(time_s, touch, touch),
        "contact_a": since(time_s, touch, -0.3 + 0.4 * touch),
        "rising_time": since(time_s, touch + 2e-3, touch + 2e-3),
    }


def fixed_stop(time_s: Vector) -> Mapping[str, Vector]:
    """Demand to 18 mm at 30 mm/s, stop at 10 mm, 600 N at most; back from 0.9 to 1.2 s."""
    stop_at, limit = 0.01, 600.0

    def demand(t: float, mode: Mode) -> tuple[float, float]:
        rest, back, done = mode[:3]
        if back:
            return (0.01 - 0.03 * 0.3, 0.0) if done else (0.01 - 0.03 * (t - 0.9), -0.03)
        return (0.018, 0.0) if rest else (0.03 * t, 0.03)

    def asked(t: float, s: State, mode: Mode) -> float:
        return float(LOOP.gain) * LOOP.error(demand(t, mode), s[0], s[1]) + s[3]

    def rhs(t: float, s: State, mode: Mode) -> tuple[float, ...]:
        x, v, force, integral = s
        error = LOOP.error(demand(t, mode), x, v)
        rates = LOOP.rates(error, force, integral, at_limit(mode[3], mode[4], limit))
        friction = stribeck(v, 60.0, 90.0, 5e-3) * math.tanh(v / 1e-4) + VISCOUS * v
        stop = 20e6 * (x - stop_at) * (1.0 + 20.0 * v) if mode[5] and mode[6] else 0.0
        return v, (force - friction - stop) / MASS, *rates

    guards: list[Guard] = [
        *(lambda t, s, m, at=at: t - at for at in (0.6, 0.9, 1.2)),
        lambda t, s, m: asked(t, s, m) - limit,
        lambda t, s, m: -limit - asked(t, s, m),
        lambda t, s, m: s[0] - stop_at,
        lambda t, s, m: 1.0 + 20.0 * s[1],
    ]
    rows = integrate(rhs, [0.0, 0.0, 0.0, 0.0], time_s, guards, rtol=1e-12)
    stops = [max(0.0, hunt_crossley(x - stop_at, v, 20e6, 1.0, 20.0)) for x, v, *_ in rows]
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "force": rows[:, 2],
        "stop_force": np.array(stops),
    }


def distance_loop(time_s: Vector) -> Mapping[str, Vector]:
    """v = 20/s (2 mm - y), dy/dt = 2 pi 100 Hz (d - y); the sheet rises 2 mm from 0.1 to 0.5 s."""

    def height(t: float) -> float:
        return 0.01 + 2e-3 * min(max((t - 0.1) / 0.4, 0.0), 1.0)

    def sensor(t: float, s: State) -> State:
        return [2.0 * math.pi * 100.0 * (s[0] - height(t) - s[4])]

    axis = Stretches([0.012, 0.0, 0.0, 0.0, 2e-3], sensor)
    for end in (0.1, 0.5, float(time_s[-1]) + 0.1):
        axis.run(lambda t, s: 20.0 * (2e-3 - s[4]) - s[1], end, None)
    rows = axis.at(time_s)
    heights = np.array([height(t) for t in time_s])
    return {
        "position": rows[:, 0],
        "distance": rows[:, 4],
        "distance_true": rows[:, 0] - heights,
    }


def homing(time_s: Vector) -> Mapping[str, Vector]:
    """Velocity control: -30 mm/s until x = 0, 10 mm/s until x = 50 um, then to rest."""
    axis = Stretches([0.01, 0.0, 0.0, 0.0])
    axis.run(lambda t, s: -0.03 - s[1], 1.0, lambda t, s: s[0])
    closing = axis.t
    axis.run(lambda t, s: 0.01 - s[1], 1.0, lambda t, s: s[0] - 50e-6)
    opening, home = axis.t, axis.state[0]
    axis.run(lambda t, s: -s[1], float(time_s[-1]) + 0.1, None)
    return {
        "position": axis.at(time_s)[:, 0],
        "home": since(time_s, opening, home),
        "closing_time": since(time_s, closing, closing),
        "opening_time": since(time_s, opening, opening),
    }


def gantry(time_s: Vector) -> Mapping[str, Vector]:
    """Both sides 20 mm forward in 0.4 s, without stops; the limits of the motors are not met."""

    def demand(t: float, side: int, mode: Mode) -> tuple[float, float]:
        return (0.02, 0.0) if mode[0] else (0.05 * t, 0.05)

    far = Stop(1e3)
    signals = _signals(Course(demand, (0.4,), (4000.0, 4000.0), (far, far), 0.0), time_s)
    signals["skew"] = signals["position_1"] - signals["position_2"]
    return {k: signals[k] for k in ("position_1", "position_2", "skew", "force_1", "force_2")}


def inclined_tool(time_s: Vector) -> Mapping[str, Vector]:
    """The height of the clamping point over the tilt: falls, rests, falls."""
    tilt = 1.4 * (3 * time_s**2 - 2 * time_s**3)
    begin, end = np.radians([50.0, 70.0])
    rest = 80e-3 * np.cos(begin)
    height = np.where(tilt < begin, 80e-3 * np.cos(tilt), rest)
    height = np.where(tilt > end, rest * np.cos(tilt) / np.cos(end), height)
    nothing = np.zeros_like(time_s)
    return {
        "distance": height / np.cos(tilt),
        "distance_true": height,
        "tcp_x": nothing,
        "tcp_z": nothing,
        "clamping_z": height,
        "tilt": tilt,
    }


REFERENCES: Mapping[str, Callable[[Vector], Mapping[str, Vector]]] = {
    "Touch": touch,
    "TiltingTouch": tilting_touch,
    "FixedStop": fixed_stop,
    "DistanceLoop": distance_loop,
    "Homing": homing,
    "Gantry": gantry,
    "InclinedTool": inclined_tool,
}


def read_examples() -> dict[str, list[dict[str, str]]]:
    """The rows of examples.csv by example."""
    with (HERE / "examples.csv").open(encoding="utf-8", newline="") as file:
        found: dict[str, list[dict[str, str]]] = {}
        for row in csv.DictReader(file):
            found.setdefault(row["model"], []).append(row)
    return found


def main() -> None:
    """Write the references of all examples."""
    parser = argparse.ArgumentParser(description="Make the references of the examples.")
    parser.add_argument("--into", type=Path, default=LIBRARY / "ReferenceResults", help="folder")
    folder = parser.parse_args().into
    folder.mkdir(parents=True, exist_ok=True)
    for model, rows in read_examples().items():
        time_s = instants(rows)
        signals = REFERENCES[model](time_s)
        names = [row["signal"] for row in rows]
        columns = [time_s, *(np.asarray(signals[name], dtype=float) for name in names)]
        with (folder / f"{model}.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["time", *names])
            writer.writerows([repr(float(v)) for v in row] for row in zip(*columns, strict=True))


if __name__ == "__main__":
    main()
