"""Faults of drives and of their controllers on CAN."""

import random
from collections.abc import Mapping

from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.frames import Make, OnCan
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.rig.reading.faults import Fault


def _power_loss(on: OnCan, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    node = on.nodes[fault.axis]
    return Act(node.power_off, node.power_on)


def _bus_off(on: OnCan, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    port = next(p for p in on.segment(fault).ports if p.port_name == fault.axis)

    def leave() -> None:
        port.force_bus_off()
        if fault.values["for"] is not None:  # else it recovers by itself, as the bus has it
            port.power_off()

    return Act(leave, port.power_on)


KINDS: Mapping[str, Make] = {"power_loss": _power_loss, "bus_off": _bus_off}
"""How each kind of the room `drives` is built in."""


def points(machine: Equipped) -> Points:
    """Return the axes whose drives can fail."""
    return points_of(machine, KINDS)
