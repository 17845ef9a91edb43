"""Commands to drives of several kinds: each goes to who knows the drive of its axis."""

from collections.abc import Mapping

from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.nc import canon


class AccessesByAxis(DriveAccesses):
    """Passes each command on; by_axis: axes without an entry have no function."""

    def __init__(self, by_axis: Mapping[str, DriveAccesses]) -> None:
        self._by_axis, self._all = by_axis, list(dict.fromkeys(by_axis.values()))

    @property
    def is_waiting(self) -> bool:
        """Whether the program may not go on before a drive has answered."""
        return any(each.is_waiting for each in self._all)

    @property
    def is_busy(self) -> bool:
        """Whether any answer is still to come."""
        return any(each.is_busy for each in self._all)

    def start(self) -> None:
        """Give parameters that are sent in every cycle the values they have from the start on."""
        for each in self._all:
            each.start()

    def reset(self) -> None:
        """Let nothing wait for an answer any more; what is on its way goes on."""
        for each in self._all:
            each.reset()

    def check(self) -> None:
        """Begin a cycle: raise what has gone wrong with a command that ran beside the program."""
        for each in self._all:
            each.check()

    def value(self, axis: str, key: str) -> float:
        """Return what the last read of a function returned."""
        return self._by_axis[axis].value(axis, key)

    def begin(self, command: canon.DriveCommand) -> None:
        """Begin one command; raises Alarm 900110 to 900112, 900255 and 900256."""
        known = self._by_axis.get(command.axis)
        if known is None:
            super().begin(command)
        else:
            known.begin(command)
