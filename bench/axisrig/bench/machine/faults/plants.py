"""Faults of plants: inputs of their FMUs that nothing is wired to, as the supply of a probe."""

import random
from collections.abc import Mapping

from axisrig.bench.machine.faults.acts import Act
from axisrig.bench.machine.faults.beside import Beside, Make
from axisrig.bench.machine.faults.point import Equipped, FaultPoint, Points
from axisrig.bench.rig.reading.fault_targets import INPUT, axes_of
from axisrig.bench.rig.reading.faults import Fault
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.refused_setting import blamed
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.inputs import HeldInput, parts_of
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError


def _inputs(plant: Plant) -> list[str]:
    """Return PLANT.INPUT of every input that nothing is wired to."""
    parts = parts_of(plant).items()
    return [f"{instance}.{name}" for instance, roles in parts for name in roles.spare_inputs()]


def _check(settings: Settings, plant: Plant) -> None:
    for fault in settings.faults:
        if fault.kind in KINDS and fault.target not in _inputs(plant):
            raise rig_error(
                settings.files,
                ("plant", fault.target.partition(".")[0]),
                f"fault {fault.kind}: the FMU has no such input, or it is wired",
                value=fault.target,
                allowed=_inputs(plant) or "none in this rig",
            )


def _hold(beside: Beside, fault: Fault, _numbers: random.Random) -> Act:
    """Raise UserError with the place of the cell for an input that is not there."""
    plant, clock = beside.plant, beside.clock
    try:
        _check(beside.settings, plant)
    except UserError as error:
        raise blamed(error, beside.settings, lambda again: _check(again, plant)) from error
    instance, _, name = fault.target.partition(".")
    held = HeldInput(plant, instance, name)
    value = fault.values["value"]
    return Act(lambda: held.begin(value, clock.now_ns), lambda: held.end(clock.now_ns))


KINDS: Mapping[str, Make] = {"plant_input": _hold}
"""How each kind of the room `plants` is built in."""


def points(machine: Equipped) -> Points:
    """Return the inputs that FMUs offer and nothing is wired to."""
    rig = machine.settings.rig
    return {
        target: FaultPoint(target, tuple(KINDS), axes_of(target, (INPUT,), rig))
        for target in _inputs(machine.plant)
    }
