"""The true motion of an axis between the SYNCs: a cubic through position and speed at both ends.

What happens inside a step is in no row, so a cubic is off where the acceleration jumps there. How
far is read from the rows themselves: the cubic through the two neighbours of a SYNC misses its
position (4 x) and its speed (x half their distance); the larger one is what they leave unexplained.
At the worst place an acceleration that jumps inside a step puts the cubic off by 0.127 of that and
its speed by 0.75 of it in a step, a vibration of up to half a period in a step by 0.14 and 0.43. A
third of both is the doubt: what is seldom beyond it is never beyond three times of it
(`tests/judge/test_motion.py`; on machines `tests/study`).

An axis that follows its demand exactly goes straight from SYNC to SYNC, and its speed jumps there.
Such a step shows: its way is the speed at one of its ends times its length.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.interpolation import coefficients
from axisrig.bench.record.series import Signal, Times
from axisrig.kernel.time.clock import TimeNs

SHARE, SPEED_SHARE = 0.15 / 3, 0.75 / 3
"""Of what is unexplained, in the position and, over a step, in the speed between two SYNCs."""
INSIDE = "what a cubic between two SYNCs does not see"
_EXACT = 1e-9
"""Of a speed, and mm/s: so far the speed of a straight step is off by rounding at most."""
_PADDING = 2
"""Rows before and behind the ones that are looked at: neighbours of their neighbours."""
_ROWS = 4096
"""So many are looked at together."""


class State(NamedTuple):
    """Where an axis was at an instant, and how fast; doubts: how well both are known."""

    position_mm: float
    speed_mm_s: float
    doubt_mm: float
    doubt_mm_s: float


class Largest(NamedTuple):
    """The largest of a magnitude, and how well it is known, both in its unit."""

    value: float
    doubt: float


@dataclass(frozen=True)
class Motion:
    """Motion of an axis at SYNCs. times_ns, position_mm, speed_mm_s: shape (n,).

    unexplained_mm: what the neighbours of each step leave unexplained, shape (n - 1,).
    """

    times_ns: Times
    position_mm: Signal
    speed_mm_s: Signal
    unexplained_mm: Signal

    @cached_property
    def _steps_s(self) -> Signal:
        steps_s: Signal = np.diff(self.times_ns) * 1e-9
        return steps_s

    @cached_property
    def _pieces(self) -> npt.NDArray[np.float64]:
        """Coefficients of each cubic, shape (4, n - 1)."""
        x, v, steps_s = self.position_mm, self.speed_mm_s, self._steps_s
        pieces = np.array(coefficients(steps_s, (x[:-1], v[:-1], x[1:], v[1:])))
        straight = is_straight(steps_s, x, v)
        pieces[1, straight] = (np.diff(x) / steps_s)[straight]
        pieces[2:, straight] = 0.0
        return pieces

    def at(self, time_ns: TimeNs) -> State | None:
        """Return the state at an instant, None outside of the rows."""
        times = self.times_ns
        if not len(times) or not times[0] <= time_ns <= times[-1]:
            return None
        row = int(np.searchsorted(times, time_ns, side="right")) - 1
        if time_ns == times[row]:
            return State(float(self.position_mm[row]), float(self.speed_mm_s[row]), 0.0, 0.0)
        since_s, off_mm = float(time_ns - times[row]) * 1e-9, float(self.unexplained_mm[row])
        begin, rate, square, cube = (float(part) for part in self._pieces[:, row])
        return State(
            begin + since_s * (rate + since_s * (square + since_s * cube)),
            rate + since_s * (2.0 * square + since_s * 3.0 * cube),
            SHARE * off_mm,
            SPEED_SHARE * off_mm / float(self._steps_s[row]),
        )

    def farthest(self, from_mm: float, begin_ns: TimeNs, end_ns: TimeNs) -> Largest | None:
        """Return the largest distance from a place between two instants; None: no step is there."""
        inside, begin_s, end_s = self._inside(begin_ns, end_ns)
        first, rate, square, cube = self._pieces[:, inside]
        away_mm = np.zeros(len(first))
        for at_s in (begin_s, end_s, *_turns_s(rate, square, cube)):
            t = np.clip(at_s, begin_s, end_s)
            away_mm = np.maximum(
                away_mm, abs(first + t * (rate + t * (square + t * cube)) - from_mm)
            )
        return largest(away_mm, SHARE * self.unexplained_mm[inside])

    def fastest(self, begin_ns: TimeNs, end_ns: TimeNs) -> Largest | None:
        """Return the largest speed between two instants; None: no step is there."""
        inside, begin_s, end_s = self._inside(begin_ns, end_ns)
        _, rate, square, cube = self._pieces[:, inside]
        speed_mm_s = np.zeros(len(rate))
        for at_s in (begin_s, end_s, -square / np.where(cube == 0.0, np.inf, 3.0 * cube)):
            t = np.clip(at_s, begin_s, end_s)
            speed_mm_s = np.maximum(speed_mm_s, abs(rate + t * (2.0 * square + t * 3.0 * cube)))
        doubt_mm_s = SPEED_SHARE * self.unexplained_mm[inside] / self._steps_s[inside]
        return largest(speed_mm_s, doubt_mm_s)

    def _inside(self, begin_ns: TimeNs, end_ns: TimeNs) -> tuple[slice, Signal, Signal]:
        """Return the steps that are between two instants, and from where to where each is, s."""
        times = self.times_ns
        first = max(int(np.searchsorted(times, begin_ns, side="right")) - 1, 0)
        last = min(int(np.searchsorted(times, end_ns, side="left")), len(times) - 1)
        inside = slice(first, max(first, last))
        begins, ends = times[inside], times[1:][inside]
        begin_s, end_s = (
            (np.clip(at_ns, begins, ends) - begins) * 1e-9 for at_ns in (begin_ns, end_ns)
        )
        return inside, begin_s, end_s


def _turns_s(rate: Signal, square: Signal, cube: Signal) -> tuple[Signal, Signal]:
    """Return where rate + 2 square t + 3 cube t^2 is 0, and some instant where it never is."""
    root = np.sqrt(np.maximum(square * square - 3.0 * cube * rate, 0.0))
    whole = -(square + np.copysign(root, square))
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = whole / (3.0 * cube), rate / whole
    return np.nan_to_num(first), np.nan_to_num(second)


def largest(values: Signal, doubts: Signal) -> Largest | None:
    """Return the largest; a smaller value with more doubt may be it as well."""
    if not len(values):
        return None
    place = int(np.argmax(values))
    most = float(values[place])
    return Largest(most, max(float(np.max(values + doubts)) - most, float(doubts[place])))


def is_straight(steps_s: Signal, position_mm: Signal, speed_mm_s: Signal) -> npt.NDArray[np.bool_]:
    """Return which steps an axis goes straight, shape (n - 1,)."""
    mean = np.diff(position_mm) / steps_s
    rounding = _EXACT * np.maximum(np.abs(mean), 1.0)
    begins, ends = (np.abs(mean - v) <= rounding for v in (speed_mm_s[:-1], speed_mm_s[1:]))
    straight: npt.NDArray[np.bool_] = begins | ends
    return straight


def unexplained_mm(times_ns: Times, position_mm: Signal, speed_mm_s: Signal) -> Signal:
    """Return what the neighbours of each step leave unexplained, mm, shape (n - 1,).

    The ends have one neighbour only: what the inner row beside them says counts there. Of less than
    three rows nothing can be said: the whole change of the speed over the time counts.
    """
    x, v, steps_s = position_mm, speed_mm_s, np.diff(times_ns) * 1e-9
    if len(x) < 3:
        return np.abs(np.diff(v)) * steps_s
    off_mm = np.zeros(len(x))
    before_s, both_s = steps_s[:-1], steps_s[:-1] + steps_s[1:]
    begin, rate, square, cube = coefficients(both_s, (x[:-2], v[:-2], x[2:], v[2:]))
    place = begin + before_s * (rate + before_s * (square + before_s * cube))
    speed = rate + before_s * (2.0 * square + before_s * 3.0 * cube)
    of_speed_mm = both_s / 2.0 * abs(speed - v[1:-1])
    off_mm[1:-1] = np.maximum(4.0 * abs(place - x[1:-1]), of_speed_mm)
    return np.where(is_straight(steps_s, x, v), 0.0, np.maximum(off_mm[:-1], off_mm[1:]))


# Of a run


def state_at(observed: Observed, axis: str, time_ns: TimeNs) -> State | None:
    """Return the true state of an axis at an instant, None outside of the recorded time."""
    row = observed.index_at(time_ns)
    return _motion(observed, axis, row, row + 1).at(time_ns)


def farthest(
    observed: Observed, axis: str, from_mm: float, begin_ns: TimeNs, end_ns: TimeNs
) -> Largest | None:
    """Return how far an axis was from a place at most, mm; None: no SYNC is behind the begin."""
    parts = _parts(observed, axis, begin_ns, end_ns)
    return together(part.farthest(from_mm, begin_ns, end_ns) for part in parts)


def fastest(observed: Observed, axis: str, begin_ns: TimeNs, end_ns: TimeNs) -> Largest | None:
    """Return how fast an axis was at most, mm/s; None: no SYNC is behind the begin."""
    parts = _parts(observed, axis, begin_ns, end_ns)
    return together(part.fastest(begin_ns, end_ns) for part in parts)


def doubts_before(observed: Observed, axis: str, first: int, last: int) -> Signal:
    """Return how well the position is known in the steps that end in some rows, shape (n,)."""
    doubts_mm = np.zeros(last - first)
    begin = max(first - 1, 0)
    unknown_mm = _motion(observed, axis, begin, last - 1).unexplained_mm
    doubts_mm[len(doubts_mm) - len(unknown_mm) :] = SHARE * unknown_mm
    return doubts_mm


def together(found: Iterable[Largest | None]) -> Largest | None:
    """Return the largest of several."""
    known = [each for each in found if each is not None]
    return largest(np.array([v for v, _ in known]), np.array([doubt for _, doubt in known]))


def _parts(observed: Observed, axis: str, begin_ns: TimeNs, end_ns: TimeNs) -> Iterator[Motion]:
    """Yield the motion between two instants, so many rows at a time."""
    begin, end = observed.index_at(begin_ns), observed.index_at(end_ns) + 1
    for first in range(begin, end, _ROWS):
        yield _motion(observed, axis, first, min(first + _ROWS, end))


def _motion(observed: Observed, axis: str, first: int, last: int) -> Motion:
    """Return the motion from one row to another one; the rows around them count in its doubt."""
    around = slice(max(first - _PADDING, 0), min(last + 1 + _PADDING, len(observed)))
    times_ns = observed.instants(around)
    x, v = (observed.column(axis, name, around) for name in ("truth_mm", "velocity_mm_s"))
    own = slice(first - around.start, last + 1 - around.start)
    steps = slice(own.start, own.stop - 1)
    return Motion(times_ns[own], x[own], v[own], unexplained_mm(times_ns, x, v)[steps])
