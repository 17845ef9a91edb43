"""Faults of the task of the PLC."""

import random
from collections.abc import Mapping
from functools import partial

from axisrig.bench.machine.faults.acts import Act
from axisrig.bench.machine.faults.beside import Beside, Make
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.rig.reading.faults import Fault


def _lost(beside: Beside, _fault: Fault, _numbers: random.Random) -> Act:
    return Act(beside.task.begin_lost, beside.task.end_lost)


def _late(beside: Beside, fault: Fault, numbers: random.Random) -> Act:
    by_ns, jitter_ns = fault.values["by"], fault.values["jitter"]
    begin = partial(beside.task.begin_late, by_ns, jitter_ns, numbers)
    return Act(begin, beside.task.end_late)


KINDS: Mapping[str, Make] = {"plc_lost": _lost, "plc_late": _late}
"""How each kind of the room `plc` is built in."""


def points(machine: Equipped) -> Points:
    """Return the task of the PLC, where there is one."""
    return points_of(machine, KINDS)
