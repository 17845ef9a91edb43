"""Faults of distance sensors and of what carries their values."""

import random
from collections.abc import Mapping

from axisrig.bench.machine.faults.acts import Act
from axisrig.bench.machine.faults.beside import Beside, Make
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.machine.wiring.distances import DistanceFault, Drift, EndValue, Freeze, Spikes
from axisrig.bench.rig.reading.faults import Fault


def _wired(beside: Beside, fault: Fault, made: DistanceFault) -> Act:
    beside.distance(fault.target).faults.append(made)
    return Act(made.begin, made.end)


def _drift(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    return _wired(beside, fault, Drift(beside.clock, fault.values["um_s"]))


def _freeze(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    return _wired(beside, fault, Freeze(beside.clock))


def _spikes(beside: Beside, fault: Fault, numbers: random.Random) -> Act:
    um, share = fault.values["um"], fault.values["p"]
    return _wired(beside, fault, Spikes(beside.clock, um, share, numbers))


def _full(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    return _wired(beside, fault, EndValue(beside.clock, fault.values["um"]))


KINDS: Mapping[str, Make] = {
    "sensor_drift": _drift,
    "sensor_freeze": _freeze,
    "sensor_spikes": _spikes,
    "sensor_full": _full,
}
"""How each kind of the room `sensors` is built in."""


def points(machine: Equipped) -> Points:
    """Return the distance sensors that a drive or the PLC reads."""
    return points_of(machine, KINDS)
