"""Which telegrams of a node with digital inputs count, from what a wire carried.

A node answers each SYNC once: on a bus that carries one frame after the other its telegram ends
after the SYNC and itself, and before the control works on that SYNC. Two that differ in that time
are one too many, and nothing says which; two alike say the same.
"""

from collections.abc import Iterable, Sequence
from itertools import groupby

from axisrig.kernel.time.clock import TimeNs

Telegram = tuple[TimeNs, bytes]
"""End on the wire and data."""


def counting(
    telegrams: Iterable[Telegram], period_ns: TimeNs, first_ns: TimeNs, last_ns: TimeNs
) -> Sequence[Telegram]:
    """Return the telegrams that answer a SYNC without a contradiction, in their order.

    SYNCs are requested every period_ns; first_ns, last_ns: after one an answer may end.
    """
    inside = (t for t in telegrams if first_ns <= t[0] % period_ns <= last_ns)
    found: list[Telegram] = []
    for _, group in groupby(inside, key=lambda telegram: telegram[0] // period_ns):
        answers = list(group)
        if len({data for _, data in answers}) == 1:
            found += answers
    return found
