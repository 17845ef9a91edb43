"""The variables of the PLC side (V.E.), as the channel and the program see them."""

from kernel.clock import Clock, TimeNs
from kernel.nc import canon


class ExternalVariables:
    """Values of the moment, by the name behind `V.E.`, and what the program gave out when.

    A program reads `values` at the block that uses one, when everything before it is executed.
    passed: takes each write, in the order in which everything for the PLC side was carried out.
    """

    def __init__(self, clock: Clock, passed: list[canon.Command]) -> None:
        self._clock, self._passed = clock, passed
        self.values: dict[str, float] = {}
        self.writes: list[tuple[TimeNs, canon.ExternalWrite]] = []

    def write(self, command: canon.ExternalWrite) -> None:
        """Give out a value: the PLC side has it from now on."""
        self.values[command.name] = command.value
        self.writes.append((self._clock.now_ns, command))
        self._passed.append(command)
