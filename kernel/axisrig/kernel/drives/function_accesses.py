"""Drive functions in a running program, whatever the family: values that are read and written.

Without WAIT a write runs in parallel to the program; an error of it comes up in the cycle in which
the drive's answer is there. Source: TF5200 programming manual 207630987.
"""

from collections.abc import Callable
from typing import Protocol

from axisrig.kernel.drives.accesses import AnsweredAccesses
from axisrig.kernel.drives.functions import AccessError, DriveFunction, Functions
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

Answered = Callable[[bytes | AccessError], None]
"""Takes the data of a value (empty after a write) or the reason why there are none."""


class ValueAccess(Protocol):
    """Reads and writes values of one drive; never waits, requests run in turn."""

    def read(self, index: int, sub: int, done: Answered) -> None:
        """Read a value; `done` gets its bytes, the lowest first."""
        ...

    def write(self, index: int, sub: int, data: bytes, done: Answered) -> None:
        """Write a value; `done` gets b"" when the drive has taken it."""
        ...


class FunctionAccesses(AnsweredAccesses):
    """Carries out the #DRIVE commands of a channel."""

    def _functions(self, axis: str) -> Functions:
        """Return the functions of an axis by key; empty where it has none."""
        raise NotImplementedError

    def _way(self, axis: str) -> ValueAccess:
        """Return the way to the values of its drive."""
        raise NotImplementedError

    def _find(self, axis: str, key: str) -> DriveFunction:
        functions = self._functions(axis)
        function = functions.get(key.upper())
        if function is None:
            known = ", ".join(f.key for f in functions.values()) or "none"
            raise Alarm(900110, axis=axis, key=key, known=known)
        return function

    def _write_beside(self, command: canon.DriveWrite, function: DriveFunction) -> None:
        """Write beside the cycle; where a mask is set, the other bits are read before."""
        raw = function.raw(command.value, command.axis)
        self._open[command.axis] += 1
        if function.mask is None:
            self._send(command, function, raw)
            return

        def merge(present: bytes | AccessError) -> None:
            if isinstance(present, AccessError):
                self._close(command, function, present)
            else:
                self._send(command, function, function.merged(raw, present))

        self._way(command.axis).read(function.index, function.sub, merge)

    def _send(self, command: canon.DriveWrite, function: DriveFunction, raw: int) -> None:
        self._way(command.axis).write(
            function.index,
            function.sub,
            function.encode(raw),
            lambda answer: self._close(command, function, answer),
        )

    def _read(self, command: canon.DriveRead, function: DriveFunction) -> None:
        self._open[command.axis] += 1

        def done(answer: bytes | AccessError) -> None:
            if not isinstance(answer, AccessError):
                self._take(command, function, answer)
            self._close(command, function, answer)

        self._way(command.axis).read(function.read_index, function.read_sub, done)

    def _take(self, command: canon.DriveRead, function: DriveFunction, data: bytes) -> None:
        """Take what was read."""
        self._values[command.axis, command.key.upper()] = function.value(data)

    def _close(
        self,
        command: canon.DriveWrite | canon.DriveRead,
        function: DriveFunction,
        answer: bytes | AccessError,
    ) -> None:
        """Note that a command is over; a failure comes up in the next cycle."""
        self._open[command.axis] -= 1
        if isinstance(answer, AccessError) and self._failed is None:
            self._failed = Alarm(
                900032,
                place=command.block.place,
                axis=command.axis,
                key=function.key,
                object=answer.target,
                answer=str(answer),
            )
