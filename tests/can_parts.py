"""What a machine of a test has on its CAN buses."""

from axisrig.bench.machine.canopen.family import CanBuses
from axisrig.bench.machine.machine import Machine


def can_of(machine: Machine) -> CanBuses:
    """Return the CAN buses of a machine with all that is on them."""
    (part,) = (part for part in machine.installed if isinstance(part, CanBuses))
    return part
