"""In which cycle an alarm of distance control is due, from the sensor values alone.

Sources: FCT-M3 11; P-AXIS-00414, 00417, 00419 to 00421. Raised in the cycle that receives it.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.lists import Limits
from axisrig.kernel.time.clock import S, TimeNs

Signal = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
JUMP, ABOVE, BELOW, OFFSET = 70329, 70330, 70576, 70331
NEWER_TWIN = {JUMP: 310018, ABOVE: 310019, BELOW: 310020, OFFSET: 310017}
_ROUNDING_MM = 1e-9


@dataclass(frozen=True)
class Due:
    """An alarm of the older family and the row (cycle) in which it is due."""

    alarm: int
    row: int


def changes_mm(sensor_mm: Signal) -> Signal:
    """Return the change of each value against the one before it; 0 for the first."""
    return np.diff(sensor_mm, prepend=sensor_mm[:1])


def first_due(
    sensor_mm: Signal,
    change_mm: Signal,
    offset_mm: Signal,
    is_watched: Flags,
    limits: Limits,
    period_ns: TimeNs,
) -> Due | None:
    """Return the first alarm that is due, None where none is.

    sensor_mm: as each cycle receives it. change_mm: against the value before, where there is one to
    compare with. offset_mm: what the law asks for, before the clamp of
    max_deviation. is_watched: rows in which the control follows. All of shape (n,).
    """
    change_mm_s = np.abs(change_mm) * S / period_ns
    causes = (
        (JUMP, change_mm_s > limits.change_mm_s + _ROUNDING_MM * S / period_ns),
        (ABOVE, sensor_mm > limits.high_mm + _ROUNDING_MM),
        (BELOW, sensor_mm < limits.low_mm - _ROUNDING_MM),
        (OFFSET, np.abs(offset_mm) > limits.deviation_mm + _ROUNDING_MM),
    )
    found = []
    for alarm, is_beyond in causes:
        rows = np.flatnonzero(is_beyond & is_watched)
        if len(rows):
            found.append(Due(alarm, int(rows[0])))
    return min(found, key=lambda due: due.row, default=None)
