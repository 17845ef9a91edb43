"""The criteria of a run to a fixed stop, read from what the parameter lists say.

Source: FCT-C4 8.2.2, P-AXIS-00774 to 00778 with their fall-backs P-AXIS-00769 to 00773, 00331 and
00332.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from axisrig.kernel.time.clock import US, TimeNs

_MEASURING = "kenngr.measure.fixed_stop_detect."
_DRIVE = "antr.fixed_stop.detect."
_OLD_LAG, _OLD_CYCLES = "kenngr.fixed_stop_pos_lag_limit", "kenngr.fixed_stop_nbr_cycles"
PER_MM = 10_000.0  # the lists count in 0.1 um
PER_MILLE = 1000.0

Written = Mapping[str, object]
"""Parameter -> value, only of those that a list or a plan has written."""


@dataclass(frozen=True)
class Limits:
    """Criteria of one axis.

    lag_limit_mm, window_mm: None = the criterion is off. start_distance_mm, per_mille: how far the
    block must have gone before the criteria count, None = not specified.
    """

    lag_limit_mm: float | None = None
    window_mm: float | None = None
    min_time_ns: TimeNs = 0
    start_distance_mm: float | None = None
    per_mille: float | None = None

    @property
    def detects(self) -> bool:
        """Whether any criterion is on."""
        return self.lag_limit_mm is not None or self.window_mm is not None

    def arming_mm(self, block_mm: float | None) -> float | None:
        """Return how far a block must have gone: the smaller one of what is specified, else 0.

        block_mm: its length, None = not known. None: the length would be needed.
        """
        ways_mm = [] if self.start_distance_mm is None else [self.start_distance_mm]
        if self.per_mille is not None:
            if block_mm is None:
                return 0.0 if 0.0 in ways_mm else None
            ways_mm.append(self.per_mille * block_mm / PER_MILLE)
        return min(ways_mm, default=0.0)


def limits_as_written(written: Written, period_ns: TimeNs) -> Limits:
    """Follow the chains of one axis; period_ns: cycle of the position control.

    A limit of 0 is off for the lag, also from P-AXIS-00331; without a time the window is no
    criterion, since nothing moves in no time.
    """
    time_ns = _min_time_ns(written, period_ns)
    window = _first(written, (_MEASURING, _DRIVE), "max_delta_position_window")
    lag = _first(written, (_MEASURING, _DRIVE), "pos_lag_limit")
    if lag is None:
        lag = _number(written, _OLD_LAG, 0)
    start = _start_distance(written)
    return Limits(
        lag_limit_mm=lag / PER_MM if lag > 0 else None,
        window_mm=window / PER_MM if window is not None and time_ns else None,
        min_time_ns=time_ns,
        start_distance_mm=None if start is None else start / PER_MM,
        per_mille=_first(written, (_MEASURING, _DRIVE), "start_distance_per_mille"),
    )


def delay_cycles(written: Written) -> int:
    """Return d of one axis, P-AXIS-00191, 4 when not set. For lags that are judged 0 counts as 1
    (`Cycles.judged`); the lag that is shown has it as it is written.

    Source: docs/ambiguities.md, "Two position lags".
    """
    return int(_number(written, "antr.nbr_delay_cycles", 4))


def arming_mm(limits: Sequence[Limits], block_mm: float | None) -> float | None:
    """Return the arming path of a run: the smallest of all its axes; None = not known."""
    ways_mm = [one.arming_mm(block_mm) for one in limits]
    if 0.0 in ways_mm:
        return 0.0
    known_mm = [way for way in ways_mm if way is not None]
    return min(known_mm, default=0.0) if len(known_mm) == len(ways_mm) else None


def _number(written: Written, name: str, otherwise: float) -> float:
    value = written.get(name, otherwise)
    assert isinstance(value, int | float)
    return float(value)


def _first(written: Written, stems: Sequence[str], name: str) -> float | None:
    """Return the first value of a chain that is not negative, None without one; unset is -1."""
    values = [_number(written, stem + name, -1) for stem in stems]
    return next((value for value in values if value >= 0), None)


def _min_time_ns(written: Written, period_ns: TimeNs) -> TimeNs:
    for stem in (_MEASURING, _DRIVE):
        time_us = int(_number(written, stem + "min_time", 0))
        if time_us:
            return time_us * US
    return int(_number(written, _OLD_CYCLES, 0)) * period_ns


def _start_distance(written: Written) -> float | None:
    """Return the written path; the default 0 of P-AXIS-00776 is no specification."""
    own = _MEASURING + "start_distance"
    if own not in written:
        return None
    return _first(written, (_MEASURING, _DRIVE), "start_distance")
