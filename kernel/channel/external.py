"""The variables of the PLC side (V.E.), as the channel and the program see them."""

from typing import NamedTuple

from kernel.clock import Clock, TimeNs
from kernel.nc import canon


class PlcEvent(NamedTuple):
    """Something that passed between the program and the PLC side.

    starts_again: the operator's start after a programmed stop, not the stop itself.
    """

    time_ns: TimeNs
    command: canon.ProgramStop | canon.TechnologyFunction | canon.ExternalWrite
    starts_again: bool = False


class ExternalVariables:
    """Values of the moment, by the name behind `V.E.`.

    A program reads `values` at the block that uses one, when everything before it is executed.
    events: takes each write.
    """

    def __init__(self, clock: Clock, events: list[PlcEvent]) -> None:
        self._clock, self._events = clock, events
        self.values: dict[str, float] = {}

    def write(self, command: canon.ExternalWrite) -> None:
        """Give out a value: the PLC side has it from now on."""
        self.values[command.name] = command.value
        self._events.append(PlcEvent(self._clock.now_ns, command))
