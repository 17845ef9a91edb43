"""A circle on the machine: set positions lie on it, the axes behind it as their loops say."""

import cmath
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.text.parser import parse_program

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-xyz.toml"
RADIUS_MM, FEED_MM_MIN = 50.0, 2000.0
OMEGA = FEED_MM_MIN / 60.0 / RADIUS_MM
NM = 1e-6


def circled(kv: float, *, friction: bool) -> tuple[Machine, dict[str, Any]]:
    """Two axes of the same gain on a full circle from (50, 0), counter-clockwise around (0, 0)."""
    table, files = read_rig(RIG)
    changes = [f"plant:{axis}.kv={kv}" for axis in "xy"]
    if not friction:
        names = ("coulomb_friction", "breakaway_friction", "viscous_friction")
        changes += [f"plant:{axis}.{name}=0" for axis in "xy" for name in names]
    settings = read_settings(
        table, files, [(parse_assignment(text), as_written) for text in changes]
    )
    machine = Machine(settings, parse_program("M30", axes=tuple(table.axis)))
    block = Block(1, 10, "")
    machine.channel.load(
        iter(
            [
                canon.LinearMove(block, {"X": RADIUS_MM, "Y": 0.0}, True, None),
                canon.ExactStop(block),
                canon.ArcMove(
                    block,
                    {"X": RADIUS_MM, "Y": 0.0},
                    {"X": 0.0, "Y": 0.0},
                    {"X": 0.0, "Y": 1.0},
                    math.tau,
                    FEED_MM_MIN,
                ),
                canon.EndOfProgram(block),
            ]
        )
    )
    try:
        machine.run()
    finally:
        machine.close()
    assert machine.channel.alarms == []
    trace = machine.recorder.table()
    return machine, {name: trace.column(name).to_numpy() for name in trace.column_names}


def on_the_circle(trace: dict[str, Any]) -> Any:
    """Rows well inside the circle: 0.3 to 5.9 rad, when what the ramp left has decayed."""
    angle = np.unwrap(np.arctan2(trace["Y.set_mm"], trace["X.set_mm"]))
    begins = int(np.argmax(angle > 0.3))
    return np.arange(len(angle))[(angle > 1.0) & (angle < 5.9) & (np.arange(len(angle)) > begins)]


@pytest.mark.long
@pytest.mark.parametrize("kv", [10.0, 40.0])
def test_radius_of_the_axes_is_smaller_as_the_gain_says(kv: float) -> None:
    """A position loop of first order without feed-forward: r / sqrt(1 + (w / Kv)²).

    The velocity loop and the chords between set positions stand below 5 nm here.
    """
    _, trace = circled(kv, friction=False)
    rows = on_the_circle(trace)
    set_radius = np.hypot(trace["X.set_mm"], trace["Y.set_mm"])[rows]
    assert set_radius == pytest.approx(RADIUS_MM, abs=1e-12)
    radius = np.hypot(trace["X.truth_mm"], trace["Y.truth_mm"])[rows]
    expected = RADIUS_MM / math.sqrt(1.0 + (OMEGA / kv) ** 2)
    assert radius == pytest.approx(expected, abs=5 * NM)
    assert RADIUS_MM - expected > 1000 * NM


@pytest.mark.long
def test_axes_follow_behind_by_the_angle_that_the_gain_says() -> None:
    """arctan(w / Kv) of the loop and the way from SYNC to SYNC: set in cycle k, there at k + 2."""
    kv = 10.0
    machine, trace = circled(kv, friction=False)
    rows = on_the_circle(trace)
    demand = trace["X.set_mm"] + 1j * trace["Y.set_mm"]
    actual = trace["X.truth_mm"] + 1j * trace["Y.truth_mm"]
    behind = [-cmath.phase(actual[k] / demand[k]) for k in rows[:: len(rows) // 50]]
    period_s = machine.timing.period_ns / 1e9
    # What cycle k sets acts from SYNC k + 1 on and is reached by the demand at SYNC k + 2.
    expected = math.atan(OMEGA / kv) + 2.0 * OMEGA * period_s
    assert behind == pytest.approx([expected] * len(behind), abs=1e-6)


@pytest.mark.long
def test_set_positions_begin_and_end_at_the_programmed_point_at_constant_speed() -> None:
    """With friction the axes leave the circle at its quadrants; what is sent does not."""
    _, trace = circled(40.0, friction=True)
    x, y = trace["X.set_mm"], trace["Y.set_mm"]
    assert (x[-1], y[-1]) == (RADIUS_MM, 0.0)
    rows = on_the_circle(trace)
    steps = np.hypot(np.diff(x[rows]), np.diff(y[rows]))
    chord = 2.0 * RADIUS_MM * math.sin(OMEGA * 1e-3 / 2.0)
    assert steps == pytest.approx(chord, abs=1e-10)
    radius = np.hypot(trace["X.truth_mm"], trace["Y.truth_mm"])[rows]
    assert np.max(np.abs(radius - RADIUS_MM / math.sqrt(1.0 + (OMEGA / 40.0) ** 2))) < 0.03
