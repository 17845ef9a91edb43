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
    """The start-up of one drive. expected: in the order in which they are read; wrong: an alarm
    that forbids the start whatever the drive has.
    """

    def __init__(
        self,
        axis: str,
        channel: ParameterChannel,
        expected: Sequence[Expected] = (),
        wrong: Alarm | None = None,
    ) -> None:
        self._axis, self._channel, self._wrong = axis, channel, wrong
        self._left = list(expected)

    def begin(self, ended: Ended) -> None:
        """Read and compare; it ends with the first parameter that differs or gives no answer."""
        if self._wrong is not None or not self._left:
            ended(self._wrong)
            return
        asked = self._left.pop(0)
        self._channel.read(asked.number, 0, lambda data: self._answered(asked, data, ended))

    def _answered(self, asked: Expected, data: bytes | AccessError, ended: Ended) -> None:
        name = f"P{asked.number:04d}"
        if isinstance(data, AccessError):
            ended(Alarm(900767, axis=self._axis, number=name, answer=str(data)))
            return
        is_signed = parameters()[asked.number].is_signed
        found = int.from_bytes(data, "little", signed=is_signed)
        if found == asked.value:
            self.begin(ended)
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
