"""The criteria of a run walked along the plant's own motion, SYNC by SYNC.

Where the closed forms do not hold (the stop moves, the axis still rings, friction holds it back)
this computes what the criteria must give: from the demand that the plant follows and where its
encoder is, without any word of the kernel.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.bench.oracles.fixed_stop.timing import Cycles

Signal = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Course:
    """One axis in the trace: demand and encoder of its drive at each SYNC, shape (n,), mm."""

    demand_mm: Signal
    encoder_mm: Signal

    def read(self, later: int) -> "Course":
        """Return what a control has whose actual positions come so many cycles later."""
        first_mm = float(self.encoder_mm[0]) if len(self.encoder_mm) else 0.0
        return Course(self.demand_mm, shifted(self.encoder_mm, -later, fill=first_mm))

    def lag_mm(self, cycles: Cycles) -> Signal:
        """Return e(k) = s(k - d) - x(k); the demand reaches s(k) way_cycles SYNCs later.

        NaN at the end, where the trace does not show the demand any more.
        """
        ahead = cycles.way_cycles - cycles.delay_cycles
        return shifted(self.demand_mm, ahead) - self.encoder_mm

    def change_mm(self, rows: int) -> Signal:
        """Return |x(k) - x(k - rows)|; before the trace the axis was where it begins."""
        return np.abs(self.encoder_mm - shifted(self.encoder_mm, -rows, fill=self.encoder_mm[0]))


@dataclass(frozen=True)
class Followed:
    """Rows in which the criteria of an axis came true, None = never.

    beyond: first of the last unbroken rows with the lag above its limit. window: first of the last
    unbroken rows in which the window holds. found: all active criteria hold.
    """

    beyond: int | None
    window: int | None
    found: int | None


def shifted(values: Signal, ahead: int, fill: float = np.nan) -> Signal:
    """Return values[k + ahead]; what is outside is `fill`."""
    out = np.full(len(values), fill)
    if ahead >= len(values) or -ahead >= len(values):
        return out
    if ahead >= 0:
        out[: len(values) - ahead] = values[ahead:]
    else:
        out[-ahead:] = values[:ahead]
    return out


def follow(
    course: Course, limits: Limits, cycles: Cycles, armed: Flags, moving: Flags | None = None
) -> Followed:
    """Walk the criteria of one axis over a part of the trace.

    armed: rows in which they count, shape (n,). moving: those of them in which the window does,
    None = all.
    """
    rows = cycles.up(limits.min_time_ns)
    all_hold = armed.copy() if limits.detects else np.zeros(len(armed), dtype=bool)
    beyond = window = np.zeros(len(armed), dtype=bool)
    if limits.lag_limit_mm is not None:
        beyond = armed & (np.abs(course.lag_mm(cycles)) > limits.lag_limit_mm)
        all_hold &= lasting(beyond, rows)
    if limits.window_mm is not None:
        window = (armed if moving is None else armed & moving) & (
            course.change_mm(rows) <= limits.window_mm
        )
        all_hold &= window
    found = np.flatnonzero(all_hold)
    end = int(found[0]) if len(found) else len(armed) - 1
    return Followed(
        begin_of_last(beyond, end),
        begin_of_last(window, end),
        int(found[0]) if len(found) else None,
    )


def lasting(flags: Flags, rows: int) -> Flags:
    """Return where a flag has been up for so many rows before this one, and still is."""
    since = np.zeros(len(flags), dtype=np.int64)
    count = -1
    for row, is_up in enumerate(flags):
        count = count + 1 if is_up else -1
        since[row] = count
    held: Flags = since >= rows
    return held


def begin_of_last(flags: Flags, row: int) -> int | None:
    """Return where the unbroken time began in which a flag is up at a row, None when it is not."""
    if not len(flags) or not flags[row]:
        return None
    down = np.flatnonzero(~flags[: row + 1])
    return int(down[-1]) + 1 if len(down) else 0
