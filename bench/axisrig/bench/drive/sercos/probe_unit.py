"""The probing cycle of a drive: S-0-0169, 170, 405, 406 in, S-0-0401, 402, 409 to 412 out.

It says the touch probe unit of the servo what to do, in the bits of 60B8, and reads 60B9. An enable
bit at 1 arms; what was latched stays until it is 0. Source: AX5000 and AX2000 ident descriptions
(docs/sercos.md).
"""

from collections.abc import Callable
from typing import Final

from axisrig.bench.drive.cia402.functions.touch_probe import TouchProbe
from axisrig.bench.drive.sercos.profiles import SercosProfile
from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction, ProbeStatus

POSITIVE_1, NEGATIVE_1, POSITIVE_2, NEGATIVE_2 = 1, 2, 4, 8
CONTINUOUS: Final = 1 << 5
AUTOMATIC: Final = 1 << 8
"""Bits of S-0-0169: the last one begins the probing cycle with OP."""
SELECTED: Final = POSITIVE_1 | NEGATIVE_1 | POSITIVE_2 | NEGATIVE_2
_SECOND_ENCODER: Final = 1 << 14
_ENABLE: Final = (int(ProbeFunction.ENABLE_1), int(ProbeFunction.ENABLE_1) << 8)
_EDGES: Final = (
    (POSITIVE_1, int(ProbeFunction.POSITIVE_1)),
    (NEGATIVE_1, int(ProbeFunction.NEGATIVE_1)),
    (POSITIVE_2, int(ProbeFunction.POSITIVE_1) << 8),
    (NEGATIVE_2, int(ProbeFunction.NEGATIVE_1) << 8),
)
_STORED: Final = (
    int(ProbeStatus.POSITIVE_STORED_1),
    int(ProbeStatus.NEGATIVE_STORED_1),
    int(ProbeStatus.POSITIVE_STORED_1) << 8,
    int(ProbeStatus.NEGATIVE_STORED_1) << 8,
)


class ProbeUnit:
    """The probing cycle. select(): S-0-0169. enabled(n): S-0-0405 and S-0-0406.

    is_running: S-0-0170 has begun it and nobody has ended it.
    """

    def __init__(
        self,
        profile: SercosProfile,
        probe: TouchProbe,
        select: Callable[[], int],
        enabled: Callable[[int], bool],
    ) -> None:
        self._profile, self._probe = profile, probe
        self._select, self._enabled = select, enabled
        self.is_running = False

    def begin(self) -> bool:
        """Begin the cycle; return whether it can."""
        self.is_running = bool(self._select() & SELECTED) or not self._profile.needs_input
        return self.is_running

    def end(self) -> None:
        """End it: nothing is latched any more."""
        self.is_running = False

    def function(self) -> int:
        """Return what the touch probe unit has to do, as 60B8 says it."""
        if not self.is_running:
            return 0
        select, word = self._select(), 0
        for selected, bits in _EDGES:
            if select & selected and self._enabled(1 if selected > NEGATIVE_1 else 0):
                word |= bits
        for number, enable in enumerate(_ENABLE):
            if word >> 8 * number & 0xFF:
                word |= enable
                if select & CONTINUOUS:
                    word |= int(ProbeFunction.CONTINUOUS_1) << 8 * number
        if word & _ENABLE[1]:
            word |= _SECOND_ENCODER
        return word

    def latched(self, number: int) -> int:
        """Return S-0-0409 to S-0-0412, by their order."""
        return int(bool(self._probe.status & _STORED[number]))

    def latches(self) -> int:
        """Return S-0-0179: the same, as bits."""
        return sum(self.latched(number) << number for number in range(len(_STORED)))

    def level(self, number: int) -> int:
        """Return S-0-0401 and S-0-0402: the levels of the inputs."""
        return self._probe.inputs >> number & 1
