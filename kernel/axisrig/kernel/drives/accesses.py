"""#DRIVE and #IDENT whatever the family: what waits for an answer, and who knows the drive."""

from collections import Counter
from collections.abc import Mapping

from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon


class AnsweredAccesses(DriveAccesses):
    """Commands whose answers come later. A family carries them out (`_carry_out`).

    _open: answers still to come, by axis; _failed: what has gone wrong beside the program.
    """

    def __init__(self) -> None:
        self._open: Counter[str] = Counter()
        self._awaited: str | None = None
        self._values: dict[tuple[str, str], float] = {}
        self._failed: Alarm | None = None

    @property
    def is_waiting(self) -> bool:
        """Whether the program may not go on before a drive has answered."""
        if self._awaited is not None and not self._open[self._awaited]:
            self._awaited = None
        return self._awaited is not None

    @property
    def is_busy(self) -> bool:
        """Whether any answer is still to come."""
        return any(self._open.values())

    def reset(self) -> None:
        """Let nothing wait for an answer any more; what is on its way goes on."""
        self._awaited = None

    def check(self) -> None:
        """Begin a cycle: raise what has gone wrong with a command that ran beside the program."""
        failed, self._failed = self._failed, None
        if failed is not None:
            raise failed

    def value(self, axis: str, key: str) -> float:
        """Return what the last read of a function or an ident returned."""
        return self._values[axis, key.upper()]

    def begin(self, command: canon.DriveCommand) -> None:
        """Begin one command; raises Alarm 900110 to 900112, 900255 and 900256."""
        if isinstance(command, canon.DriveWait):
            self._awaited = command.axis
            return
        self._carry_out(command)
        if isinstance(command, canon.DriveRead) or command.waits:
            self._awaited = command.axis

    def _carry_out(self, command: canon.DriveRead | canon.DriveWrite) -> None:
        """Send it to the drive."""
        raise NotImplementedError


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
