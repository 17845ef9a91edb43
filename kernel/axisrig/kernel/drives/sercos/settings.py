"""The data of a SERCOS drive that the kernel needs."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.profiles.sercos.words import REAL_TIME

NO_BIT: Final = -1
"""P-AXIS-00676 and its like: not said."""


@dataclass(frozen=True)
class RealTimeBits:
    """Which real-time bits the control uses for measuring, as masks; all of P-AXIS-00060.

    enable: of S-0-0134. latched, actuated: of S-0-0135. command: of S-0-0134, for S-0-0170
    (P-AXIS-00700), 0 = none.
    """

    enable: int
    latched: int
    actuated: int
    command: int = 0


def real_time_bits(number: int, mask: int) -> RealTimeBits:
    """Return what P-AXIS-00060 says; mask: P-AXIS-00106, which counts while that is 0.

    Two manuals print the compatibility row differently: as the bit of the done measurement and as
    that of the actuated probe. The second one counts, and the other status bit is the done
    measurement (docs/ambiguities.md).
    """
    one, two = REAL_TIME
    if number == 2:
        return RealTimeBits(two, two, one)
    if number == 1 or mask == two:
        return RealTimeBits(one, one, two)
    return RealTimeBits(one, two, one)


@dataclass(frozen=True, kw_only=True)
class SercosSettings(SlaveSettings):
    """The data of one drive. outputs, inputs: its MDT and its AT, idents in the place of objects.

    lead_mm: travel per turn, for a rotary scaling. writes: start-up list, ident and value. bits:
    for measuring. measures: P-AXIS-00118 with the drive as source. starts_probing: the control sets
    S-0-0170 to 3 when the drive is in OP. period_us: for S-0-0001 and S-0-0002. proves_latches,
    proves_places: a latch, and the position from which the drive is led, counts only when the
    service channel gives it too. needs_following: P-AXIS-00411. echo_cycles: from an MDT to the AT
    that the drive has made after it.
    """

    lead_mm: float
    period_us: int
    writes: Sequence[tuple[int, int]] = ()
    bits: RealTimeBits = field(default_factory=lambda: real_time_bits(1, 0))
    measures: bool = False
    starts_probing: bool = True
    needs_following: bool = False
    proves_latches: bool = True
    proves_places: bool = True
    echo_cycles: int = 2
