"""Inputs of plants that nothing of the bench is wired to, held at a value for a time."""

from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.slave import Exchange
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import SUPPLY
from axisrig.kernel.time.clock import TimeNs


def parts_of(plant: Plant) -> dict[str, Roles]:
    """Return the roles of every FMU of a plant, by its instance."""
    found = {name: axis.roles for name, axis in plant.axes.items()}
    found |= {name: probe.roles for name, probe in plant.probes.items()}
    return found | {name: sensor.roles for name, sensor in plant.distances.items()}


class HeldInput:
    """An input of an FMU that gets another value for a time, and then the one that it had.

    instance, name: of the plant and of its variable. The supply of a probe is switched as the PLC
    orders it again, also where the order came meanwhile.
    """

    def __init__(self, plant: Plant, instance: str, name: str) -> None:
        self._plant, self._probe = plant, plant.probes.get(instance)
        self._is_supply = self._probe is not None and name == SUPPLY
        self._input = Exchange(parts_of(plant)[instance].slave, [name])
        self._before: float = 0.0

    def begin(self, value: float, now_ns: TimeNs) -> None:
        """Hold the input at a value in the unit of the FMU; a Boolean one takes 0 and others."""
        self._wake(now_ns)
        self._input.read()
        self._before = self._input.values[0]
        if self._is_supply and self._probe is not None:
            self._probe.is_supply_held = True
        self._write(value)

    def end(self, now_ns: TimeNs) -> None:
        """Give the input back what it had."""
        self._wake(now_ns)
        before = self._before
        if self._is_supply and self._probe is not None:
            self._probe.is_supply_held, before = False, self._probe.is_switched_on
        self._write(before)

    def _wake(self, now_ns: TimeNs) -> None:
        self._plant.advance_to(now_ns)
        if self._probe is not None:
            self._probe.wake(now_ns)

    def _write(self, value: float) -> None:
        self._input.values[0] = type(self._input.values[0])(value)
        self._input.write()
