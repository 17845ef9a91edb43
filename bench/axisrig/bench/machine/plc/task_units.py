"""The control units of distance control between a PLC task and the CNC.

A command goes over once: the CNC has it in its first cycle after that of the PLC, and takes the
semaphore back; the PLC sees that in its first cycle after that of the CNC.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from axisrig.bench.machine.plc.distance_elements import DistanceControlUnit
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.plc.unit import AxisUnit, UnitCommand, UnitState


class UnitWrites(NamedTuple):
    """What the PLC has written; number: of the command, which counts them."""

    is_enabled: bool
    number: int
    command: UnitCommand | None


class UnitShown(NamedTuple):
    """What the CNC has shown, lengths in 0.1 um. taken: number of the last command that it took."""

    taken: int
    state: int
    surface: int
    distance: int
    source: int
    actual_offset: int


class TaskUnits:
    """The units of all axes; has_columns: event columns command them as well.

    note: keeps what the PLC has commanded, in words.
    """

    def __init__(
        self, units: Mapping[str, AxisUnit], note: Callable[[str], None], *, has_columns: bool
    ) -> None:
        self._units, self._note, self._has_columns = units, note, has_columns
        self._given, self._handed = dict.fromkeys(units, 0), dict.fromkeys(units, 0)
        self._pending: dict[str, UnitCommand | None] = dict.fromkeys(units)

    # At the instants of the PLC

    def read(self, name: str, unit: DistanceControlUnit, shown: UnitShown) -> None:
        """Bring a unit up to date with what the CNC has shown."""
        if shown.taken >= self._given[name]:
            unit.command_semaphor_rw, self._pending[name] = False, None
        state = unit.state_r
        state.state, state.source = shown.state, shown.source
        state.surface, state.distance = shown.surface, shown.distance
        state.actual_offset = shown.actual_offset

    def written(self, name: str, unit: DistanceControlUnit) -> UnitWrites:
        """Return what the program has written in its cycle."""
        if not unit.command_semaphor_rw:
            self._pending[name] = None
        elif self._pending[name] is None:
            self._given[name] += 1
            self._pending[name] = _command(unit)
        return UnitWrites(unit.enable_w, self._given[name], self._pending[name])

    # At the instants of the CNC

    def take(self, name: str, writes: UnitWrites) -> None:
        """Hand over what the PLC wrote, as soon as the CNC has taken the command before."""
        unit = self._units[name].distance
        unit.enable_w = writes.is_enabled or (self._has_columns and unit.enable_w)
        is_new = writes.number > self._handed[name]
        if writes.command is None or not is_new or unit.command_semaphor_rw:
            return
        self._handed[name] = writes.number
        unit.command_w, unit.command_semaphor_rw = writes.command, True
        transition = writes.command.transition
        if transition is not None:
            self._note(f"{name}.distance_control = {transition.name}")

    def shown(self, name: str) -> UnitShown:
        """Return what the PLC may read after a cycle of the CNC."""
        unit, waits = self._units[name].distance, self._units[name].distance.command_semaphor_rw
        state: UnitState = unit.state_r
        return UnitShown(
            self._handed[name] - waits,
            int(state.state),
            _units(state.surface_mm),
            _units(state.distance_mm),
            int(state.source),
            _units(state.actual_offset_mm),
        )


def _command(unit: DistanceControlUnit) -> UnitCommand:
    wanted = unit.command_w
    return UnitCommand(
        None if wanted.transition is None else DistanceCommand(wanted.transition),
        None if wanted.set_pos is None else wanted.set_pos / UNITS_PER_MM,
        None if wanted.set_dist is None else wanted.set_dist / UNITS_PER_MM,
    )


def _units(value_mm: float | None) -> int:
    return 0 if value_mm is None else round(value_mm * UNITS_PER_MM)
