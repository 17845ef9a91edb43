"""Faults of the clock of a terminal."""

import random
from collections.abc import Mapping
from functools import partial

from axisrig.bench.machine.faults.acts import Act
from axisrig.bench.machine.faults.beside import Beside, Make
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.rig.reading.faults import Fault


def _off(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    return Act(partial(beside.stamps.begin, fault.values["by"], 0.0), beside.stamps.end)


def _drift(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    return Act(partial(beside.stamps.begin, 0, fault.values["ppm"]), beside.stamps.end)


KINDS: Mapping[str, Make] = {"clock_off": _off, "clock_drift": _drift}
"""How each kind of the room `clock` is built in."""


def points(machine: Equipped) -> Points:
    """Return the terminal of the PLC, where it has a clock."""
    return points_of(machine, KINDS)
