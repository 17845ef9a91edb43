"""Faults of drives that are none of what carries them: their supply."""

import random
from collections.abc import Callable, Mapping
from typing import Protocol

from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.point import Equipped, Points, points_of
from axisrig.bench.rig.reading.faults import Fault


class WithDrives(Protocol):
    """What a fault of a drive acts on: the virtual drives of a carrier by axis."""

    @property
    def nodes(self) -> Mapping[str, Cia402Node]:
        """The drives, with their supplies."""
        ...


Make = Callable[[WithDrives, Fault, random.Random, Injected], Act]


def _power_loss(on: WithDrives, fault: Fault, _numbers: random.Random, _record: Injected) -> Act:
    node = on.nodes[fault.axis]
    return Act(node.power_off, node.power_on)


KINDS: Mapping[str, Make] = {"power_loss": _power_loss}
"""How each kind of the room `drives` is built in."""


def points(machine: Equipped) -> Points:
    """Return the axes whose drives can lose their supply."""
    return points_of(machine, KINDS)
