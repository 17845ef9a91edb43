"""Parameters of a PROFIdrive drive beside the cycle: one request at a time, and #DRIVE.

Source: SINAMICS 6SL3097-4AB10 p. 613; which parameters #DRIVE writes to the axis list says
(P-AXIS-00398; docs/profidrive.md).
"""

from collections import deque
from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from axisrig.kernel.drives.function_accesses import Answered, FunctionAccesses
from axisrig.kernel.drives.functions import AccessError, Functions, Idents
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.profiles.profidrive import parameters as words

NUMBERS: Final = Idents(
    r"[Pp]?(?P<index>\d{1,5})(?:_(?P<sub>\d{1,5}))?",
    (10, 10),
    "parameter of a PROFIdrive drive",
    "its number, with a subindex where it has one, as in 1230 or 1230_0",
)
Send = Callable[[bytes, Callable[[bytes], None]], None]
"""Sends a request; gets the response, empty where the drive is silent."""


class ParameterError(AccessError):
    """A parameter could not be read or written. code: error value, None without an answer."""

    def __init__(self, number: int, code: int | None) -> None:
        self.code = code
        self.target = f"P{number:04d}"
        super().__init__("no answer" if code is None else words.parameter_error_text(code))


class _Open(NamedTuple):
    request: words.Request
    done: Answered


class ParameterChannel:
    """Reads and writes parameters of one drive; requests run in turn. send: of the segment."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self._waiting: deque[_Open] = deque()
        self._reference = 0

    def read(self, index: int, sub: int, done: Answered) -> None:
        """Read a parameter; `done` gets its bytes, the lowest first."""
        self._ask(index, sub, b"", done)

    def write(self, index: int, sub: int, data: bytes, done: Answered) -> None:
        """Write a parameter. data: the lowest byte first."""
        self._ask(index, sub, data[::-1], done)

    def _ask(self, index: int, sub: int, data: bytes, done: Answered) -> None:
        self._reference = self._reference % words.REFERENCES + 1
        self._waiting.append(_Open(words.Request(self._reference, index, sub, data), done))
        if len(self._waiting) == 1:
            self._begin()

    def _begin(self) -> None:
        self._send(self._waiting[0].request.pack(), self._answered)

    def _answered(self, response: bytes) -> None:
        request, done = self._waiting.popleft()
        if self._waiting:
            self._begin()
        done(_result(request, response))


def _result(request: words.Request, response: bytes) -> bytes | ParameterError:
    """Return what a response says; one with another reference or identifier is none."""
    if len(response) < words.HEAD.size:
        return ParameterError(request.number, None)
    reference, kind, _axis, _count = words.HEAD.unpack_from(response)
    asked = words.WRITE if request.data else words.READ
    if reference != request.reference or kind & ~words.NEGATIVE != asked:
        return ParameterError(request.number, None)
    if kind & words.NEGATIVE:
        return ParameterError(request.number, words.ERROR.unpack_from(response, words.HEAD.size)[2])
    if asked == words.WRITE:
        return b""
    kind, _count = words.VALUES.unpack_from(response, words.HEAD.size)
    begin = words.HEAD.size + words.VALUES.size
    return response[begin : begin + words.FORMATS[kind]][::-1]


class ParameterWay(NamedTuple):
    """The way to the parameters of one drive, and the functions of its list."""

    channel: ParameterChannel
    functions: Functions


class ProfidriveAccesses(FunctionAccesses):
    """Carries out the #DRIVE commands of a channel for PROFIdrive drives; ways: by axis."""

    def __init__(self, ways: Mapping[str, ParameterWay]) -> None:
        super().__init__()
        self._ways = ways

    def _functions(self, axis: str) -> Functions:
        return self._ways[axis].functions

    def _way(self, axis: str) -> ParameterChannel:
        return self._ways[axis].channel

    def _carry_out(self, command: canon.DriveRead | canon.DriveWrite) -> None:
        if command.length_bytes is not None:
            known = "parameters, which #DRIVE reads and writes"
            raise Alarm(900255, axis=command.axis, ident=command.key, known=known)
        function = self._find(command.axis, command.key)
        if isinstance(command, canon.DriveRead):
            self._read(command, function)
        elif function.communication == "ACYCLIC":
            self._write_beside(command, function)
        else:
            function.raw(command.value, command.axis)  # what it cannot be is an alarm all the same
