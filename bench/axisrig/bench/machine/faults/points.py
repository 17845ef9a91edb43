"""Every place of a machine where a fault can act."""

from axisrig.bench.machine.faults import (
    clock,
    drives,
    frames,
    idents,
    images,
    lines,
    plants,
    plc,
    sensors,
    wires,
)
from axisrig.bench.machine.faults.point import Equipped, FaultPoint, Points

ROOMS = (frames, drives, lines, idents, images, wires, sensors, plants, plc, clock)
"""Modules of the rooms of `faults.csv`: each has `KINDS` and `points`."""


def points(machine: Equipped) -> Points:
    """Return the fault points of a machine, by target; a target of several rooms has all kinds.

    What a plan refuses is not in it: telegrams on a carrier without faults, heartbeats that nobody
    sends, inputs of plants that something is wired to.
    """
    found: Points = {}
    for room in ROOMS:
        for target, point in room.points(machine).items():
            known = found.get(target)
            kinds = point.kinds if known is None else (*known.kinds, *point.kinds)
            found[target] = FaultPoint(target, kinds, point.axes)
    return found
