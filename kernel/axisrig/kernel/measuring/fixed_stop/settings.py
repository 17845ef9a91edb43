"""What the parameter list of an axis says about runs to a fixed stop (FCT-C4 7.3 and 8.2.2)."""

from dataclasses import dataclass
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.record import Criteria
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import TimeNs

PER_MILLE: Final = 1000
_DETECT = "kenngr.measure.fixed_stop_detect."
LAG_LIMIT, MIN_TIME = _DETECT + "pos_lag_limit", _DETECT + "min_time"
START, START_SHARE = _DETECT + "start_distance", _DETECT + "start_distance_per_mille"
WINDOW = _DETECT + "max_delta_position_window"
WATCHES_SLAVES = _DETECT + "use_gantry_slave"


@dataclass(frozen=True)
class FixedStopSettings:
    """One axis; None = not set, or no criterion.

    lag_limit_mm: P-AXIS-00774, 00769, 00331. window_mm: 00778, 00773. min_time_ns: 00775, 00770;
    min_cycles: 00332, when neither of them is set. start_distance_mm: 00776, 00771 where a list
    sets one. start_per_mille: 00777, 00772. watches_slaves: 00835, of the master of a gantry.
    """

    lag_limit_mm: float | None = None
    window_mm: float | None = None
    min_time_ns: TimeNs = 0
    min_cycles: int = 0
    start_distance_mm: float | None = None
    start_per_mille: int | None = None
    watches_slaves: bool = False

    @classmethod
    def read(cls, axis: ParameterSet) -> "FixedStopSettings":
        """Take them from the parameters of an axis."""
        window_mm, share = axis.mm(WINDOW), axis.integer(START_SHARE)
        counts_cycles = axis.resolve(MIN_TIME).parameter.unit == "cycles"
        is_start_set = axis.resolve(START).origin is not None
        return cls(
            lag_limit_mm=axis.mm(LAG_LIMIT) or None,
            window_mm=window_mm if window_mm >= 0 else None,
            min_time_ns=0 if counts_cycles else axis.ns(MIN_TIME),
            min_cycles=axis.integer(MIN_TIME) if counts_cycles else 0,
            start_distance_mm=axis.mm(START) if is_start_set else None,
            start_per_mille=share if share >= 0 else None,
            watches_slaves=axis.flag(WATCHES_SLAVES),
        )

    def criteria(self, period_ns: TimeNs) -> Criteria:
        """Return what is judged; without a time there is no way within it to judge."""
        min_time_ns = self.min_time_ns or self.min_cycles * period_ns
        return Criteria(self.lag_limit_mm, self.window_mm if min_time_ns else None, min_time_ns)

    def start_mm(self, block_mm: float) -> float:
        """Return the path of a block of this length before the stop is looked for.

        The smaller of what is set; nothing set is 0. Source: P-AXIS-00776 and 00777.
        """
        ways = []
        if self.start_distance_mm is not None:
            ways.append(self.start_distance_mm)
        if self.start_per_mille is not None:
            ways.append(self.start_per_mille * block_mm / PER_MILLE)
        return min(ways, default=0.0)

    def check(self, axis: str) -> None:
        """Raise Alarm 51026 for a share above the whole block."""
        if self.start_per_mille is not None and self.start_per_mille > PER_MILLE:
            raise Alarm(
                51026, axis=axis, value_permille=self.start_per_mille, limit_permille=PER_MILLE
            )
