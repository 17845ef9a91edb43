"""When a telegram can answer a SYNC at all: a bus carries one frame after the other."""

from axisrig.bench.bus.can.frame import IFS_BITS
from axisrig.bench.rig.canopen.members import segment_of
from axisrig.bench.rig.real_axes import is_real
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import S, TimeNs

_BARE_BITS = 44
"""Of a standard data frame without data, stuff bits and intermission (Bosch CAN 2.0)."""


def first_answer_ns(settings: Settings, segment: str, data_bytes: int) -> TimeNs:
    """Return how long after the request of a SYNC an answer to it ends at the earliest.

    SYNC, intermission and answer, both frames at their shortest. 0 on a real bus, where the control
    does not see when a frame ended.
    """
    if is_real(settings, segment):
        return 0
    counter = bool(settings.rig.cycle.sync_counter)
    bits = 2 * _BARE_BITS + IFS_BITS + 8 * (counter + data_bytes)
    return bits * S // segment_of(settings, segment).bitrate
