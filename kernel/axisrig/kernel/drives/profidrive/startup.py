"""The start-up of a PROFIdrive drive: its parameters are held against what the control counts with.

Each is read beside the cycle, one after the other, before images are swapped. Fine bits and speed
base that differ are factors, another telegram has other words in its places, and another function
of the fast input latches nothing (FCT-C4 6.5).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from axisrig.kernel.drives.functions import AccessError
from axisrig.kernel.drives.profidrive.parameter_channel import ParameterChannel
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive.parameters import parameters


class Expected(NamedTuple):
    """A parameter of the drive as the control counts with it. source: what says so."""

    number: int
    value: int
    source: str


Ended = Callable[[Alarm | None], None]


class ProfidriveStart:
    """The start-up of one drive.

    expected: in the order in which they are read. wrong: an alarm that forbids the start whatever
    the drive has.
    """

    def __init__(
        self,
        axis: str,
        channel: ParameterChannel,
        expected: Sequence[Expected] = (),
        wrong: Alarm | None = None,
    ) -> None:
        self._axis, self._channel, self._wrong = axis, channel, wrong
        self._expected = tuple(expected)

    def begin(self, ended: Ended) -> None:
        """Read and compare; it ends with the first parameter that differs or gives no answer."""
        if self._wrong is not None:
            ended(self._wrong)
            return
        self._ask(0, ended)

    def _ask(self, place: int, ended: Ended) -> None:
        """Read the parameter at this place of those that are expected, if there is one."""
        if place == len(self._expected):
            ended(None)
            return
        number = self._expected[place].number
        self._channel.read(number, 0, lambda data: self._answered(place, data, ended))

    def _answered(self, place: int, data: bytes | AccessError, ended: Ended) -> None:
        asked = self._expected[place]
        name = f"P{asked.number:04d}"
        if isinstance(data, AccessError):
            ended(Alarm(900767, axis=self._axis, number=name, answer=str(data)))
            return
        is_signed = parameters()[asked.number].is_signed
        found = int.from_bytes(data, "little", signed=is_signed)
        if found == asked.value:
            self._ask(place + 1, ended)
            return
        ended(
            Alarm(
                900766,
                axis=self._axis,
                number=name,
                value=found,
                expected=asked.value,
                source=asked.source,
            )
        )
