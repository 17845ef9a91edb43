"""The true motion of an axis between the SYNCs: a cubic through position and speed at both ends.

What happens inside a step is in no row. Two things in the rows say how far a cubic is off there,
of each the larger one of both ends:

- the cubic through the two neighbours of a SYNC misses its position (4 x) and its speed (x half
  their distance), the larger one is what they leave unexplained. An acceleration that jumps inside
  a step puts the cubic off by 0.127 of that at the worst place and its speed by 0.75 of it in a
  step, a vibration of up to half a period in a step by 0.14 and 0.43. A third of both is the doubt:
  what is seldom beyond it is never beyond three times of it (`tests/judge/test_motion.py`);
- the acceleration jumps by J from one cubic to the next where a drive gets a new demand at every
  SYNC. Its answer within a step, which is alike in each, shows at no SYNC: exp(-t/tau) puts the
  cubic off by J h^2/384 h/tau. One that follows at once is the worst: with the speed D in a step
  and D - 1 at its begin J is 6/h, the speed of the cubic is off by 1 = J h/6, its place by
  4/27 h = J h^2/40. The doubt is J h^2/60, and a third of J h/6 of the speed.

What is odd at the end of a step may have begun there only, as braking does at the SYNC at which a
set position acts. Two things say so without what comes after it, and the doubt is no more than the
larger one of both, or than the jump at the begin leaves:

- the step before goes on into it. The motion less that is d, with d = 0 and d' = 0 at its begin, D
  and W at its end. While d'' keeps its sign, d is a sum of ramps w (t - s) with W the sum of their
  w, and none puts a cubic further off than 4/27 w h, its speed than w (both as s comes to an end
  of the step). A third of that, as above. Where d'' changes its sign W may vanish by chance, D not
  with it: 4 D/h counts in its place where it is more (inferred, from vibrations);
- the row at its begin, whose neighbours leave less of a jump unexplained the later it comes, down
  to W h: all of 4/27 and of 1 of it.

What the corners of the demand make within a step, alike in each while it gets faster evenly, shows
at no SYNC either once a loop rounds it. The set positions say how much that may be: a corner of d
lies d/8 beside a smooth demand, of which the position loop makes kv d/8 of speed and in a step
kv d/8 h/2 pi of way. Of a drive whose velocity loop has a known bandwidth b more is known, at the
frequency w = 2 pi/h of the SYNCs: position loop and feed-forward f ask for sqrt(f^2 + (kv/w)^2) of
the corner, of which b/sqrt(w^2 + b^2) is left; with g as their product that is d/8 g of way and
w d/8 g of speed. All of this counts where the largest of many steps is looked for: each of them has
its worst place. At an instant (`state_at`) a third of the larger one of both counts, where it is
more. Without a velocity loop the acceleration jumps at the SYNC, and the doubts above see it.
The set position of a row is sent in its cycle and acts from the next SYNC on: no corner yet.

An axis that follows its demand exactly goes straight from SYNC to SYNC, and its speed jumps there.
Such a step shows: its way is the speed at one of its ends times its length.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.plant_values import PlantValues
from axisrig.bench.oracles.interpolation import coefficients
from axisrig.bench.record.series import Signal, Times
from axisrig.kernel.time.clock import TimeNs

SHARE, SPEED_SHARE = 0.15 / 3, 0.75 / 3
"""Of what is unexplained, in the position and, over a step, in the speed between two SYNCs."""
OF_JUMP, SPEED_OF_JUMP = 1 / 60, 1 / 18
"""Of a jump of the acceleration at a SYNC, over the square of a step and over a step."""
OF_PAST, SPEED_OF_PAST = 4 / 27, 1.0
"""Of W, and of W h that a step and the one before leave: without what comes after the step."""
INSIDE = "what a cubic between two SYNCs does not see"
_EXACT = 1e-9
"""Of a speed, and mm/s: so far the speed of a straight step is off by rounding at most."""
_PADDING = 2
"""Rows before and behind the ones that are looked at: neighbours of their neighbours."""
_ON_THE_WAY = 5
"""Cycles before a SYNC whose set positions may be new to the drive there (inferred: three that show
a change of the acceleration, and two on the way)."""
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

    doubts_mm, doubts_mm_s: how well both are known inside each step, shape (n - 1,).
    """

    times_ns: Times
    position_mm: Signal
    speed_mm_s: Signal
    doubts_mm: Signal
    doubts_mm_s: Signal

    @cached_property
    def _steps_s(self) -> Signal:
        steps_s: Signal = np.diff(self.times_ns) * 1e-9
        return steps_s

    @cached_property
    def _pieces(self) -> npt.NDArray[np.float64]:
        """Coefficients of each cubic, shape (4, n - 1)."""
        return _pieces(self._steps_s, self.position_mm, self.speed_mm_s)

    def at(self, time_ns: TimeNs) -> State | None:
        """Return the state at an instant, None outside of the rows."""
        times = self.times_ns
        if not len(times) or not times[0] <= time_ns <= times[-1]:
            return None
        row = int(np.searchsorted(times, time_ns, side="right")) - 1
        if time_ns == times[row]:
            return State(float(self.position_mm[row]), float(self.speed_mm_s[row]), 0.0, 0.0)
        since_s = float(time_ns - times[row]) * 1e-9
        begin, rate, square, cube = (float(part) for part in self._pieces[:, row])
        return State(
            begin + since_s * (rate + since_s * (square + since_s * cube)),
            rate + since_s * (2.0 * square + since_s * 3.0 * cube),
            float(self.doubts_mm[row]),
            float(self.doubts_mm_s[row]),
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
        return largest(away_mm, self.doubts_mm[inside])

    def fastest(self, begin_ns: TimeNs, end_ns: TimeNs) -> Largest | None:
        """Return the largest speed between two instants; None: no step is there."""
        inside, begin_s, end_s = self._inside(begin_ns, end_ns)
        _, rate, square, cube = self._pieces[:, inside]
        speed_mm_s = np.zeros(len(rate))
        for at_s in (begin_s, end_s, -square / np.where(cube == 0.0, np.inf, 3.0 * cube)):
            t = np.clip(at_s, begin_s, end_s)
            speed_mm_s = np.maximum(speed_mm_s, abs(rate + t * (2.0 * square + t * 3.0 * cube)))
        return largest(speed_mm_s, self.doubts_mm_s[inside])

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
    """Return which steps an axis goes straight, shape (n - 1,).

    Both positions are known to their last digits, half a spacing of each: over a short step, far
    from 0, that is more of a speed than its own rounding. A position in mm is one in m times 1000:
    twice of that.
    """
    mean = np.diff(position_mm) / steps_s
    spacing_mm = np.spacing(np.maximum(np.abs(position_mm[:-1]), np.abs(position_mm[1:])))
    rounding = _EXACT * np.maximum(np.abs(mean), 1.0) + 2.0 * spacing_mm / steps_s
    begins, ends = (np.abs(mean - v) <= rounding for v in (speed_mm_s[:-1], speed_mm_s[1:]))
    straight: npt.NDArray[np.bool_] = begins | ends
    return straight


def _pieces(steps_s: Signal, x: Signal, v: Signal) -> npt.NDArray[np.float64]:
    """Return the coefficients of the cubic of each step, shape (4, n - 1); straight ones alike."""
    pieces = np.array(coefficients(steps_s, (x[:-1], v[:-1], x[1:], v[1:])))
    straight = is_straight(steps_s, x, v)
    pieces[1, straight] = (np.diff(x) / steps_s)[straight]
    pieces[2:, straight] = 0.0
    return pieces


def motion(times_ns: Times, position_mm: Signal, speed_mm_s: Signal) -> Motion:
    """Return the motion through rows, shape (n,), with its doubts; none in straight steps.

    The ends have one neighbour only: what the inner row beside them says counts there. Of less than
    three rows nothing can be said: the whole change of the speed over the time counts.
    """
    x, v, steps_s = position_mm, speed_mm_s, np.diff(times_ns) * 1e-9
    off_mm, jump_mm_s2 = np.zeros(len(x)), np.zeros(len(x))
    past_mm_s = np.full(len(steps_s), np.inf)
    if len(x) < 3:
        off_mm[:] = np.ptp(v) * np.sum(steps_s) / SHARE if len(x) else 0.0
    else:
        off_mm[1:-1] = _unexplained_mm(steps_s, x, v)
        pieces = _pieces(steps_s, x, v)
        jump_mm_s2[1:-1] = np.abs(_bends(steps_s, pieces)[0]) * 2.0
        past_mm_s[1:] = np.maximum(
            _beyond_past_mm_s(steps_s, x, v, pieces) / 3.0, off_mm[1:-1] / steps_s[1:]
        )
    off_mm_s = np.maximum(off_mm[:-1], off_mm[1:]) / steps_s
    begin_mm_s = jump_mm_s2[:-1] * steps_s
    jump_mm_s = np.maximum(begin_mm_s, jump_mm_s2[1:] * steps_s)
    moves = ~is_straight(steps_s, x, v)

    def doubts_mm_s(of_off: float, of_jump: float, of_past: float) -> Signal:
        ends = np.maximum(of_off * off_mm_s, of_jump * jump_mm_s)
        past = np.maximum(of_past * past_mm_s, of_jump * begin_mm_s)
        return np.where(moves, np.minimum(ends, past), 0.0)

    return Motion(
        times_ns,
        x,
        v,
        doubts_mm_s(SHARE, OF_JUMP, OF_PAST) * steps_s,
        doubts_mm_s(SPEED_SHARE, SPEED_OF_JUMP, SPEED_OF_PAST),
    )


def _bends(steps_s: Signal, pieces: npt.NDArray[np.float64]) -> tuple[Signal, Signal]:
    """Return how square and cube of each cubic differ from the one before that goes on."""
    _, _, square, cube = pieces
    return square[1:] - square[:-1] - 3.0 * cube[:-1] * steps_s[:-1], np.diff(cube)


def _beyond_past_mm_s(
    steps_s: Signal, x: Signal, v: Signal, pieces: npt.NDArray[np.float64]
) -> Signal:
    """Return what the step before each one leaves of its end, mm/s, shape (n - 2,)."""
    square, cube = _bends(steps_s, pieces)
    step_s = steps_s[1:]
    speed = step_s * (2.0 * square + step_s * 3.0 * cube)
    place = step_s**2 * (square + step_s * cube)
    # The speed jumps at the end of a straight step: it does not go on
    straight = is_straight(steps_s, x, v)[:-1]
    return np.where(straight, np.inf, np.maximum(np.abs(speed), 4.0 * np.abs(place) / step_s))


def _unexplained_mm(steps_s: Signal, x: Signal, v: Signal) -> Signal:
    """Return what the neighbours of each inner row leave unexplained, mm, shape (n - 2,)."""
    before_s, both_s = steps_s[:-1], steps_s[:-1] + steps_s[1:]
    begin, rate, square, cube = coefficients(both_s, (x[:-2], v[:-2], x[2:], v[2:]))
    place = begin + before_s * (rate + before_s * (square + before_s * cube))
    speed = rate + before_s * (2.0 * square + before_s * 3.0 * cube)
    of_speed_mm = both_s / 2.0 * abs(speed - v[1:-1])
    found: Signal = np.maximum(4.0 * abs(place - x[1:-1]), of_speed_mm)
    return found


# Of a run


def state_at(observed: Observed, axis: str, time_ns: TimeNs) -> State | None:
    """Return the true state of an axis at an instant, None outside of the recorded time."""
    row = observed.index_at(time_ns)
    there = _motion(observed, axis, row, row + 1).at(time_ns)
    if there is None or there.doubt_mm_s == 0.0:  # at a SYNC, or straight: no corner is rounded
        return there
    (rounded_mm,), (rounded_mm_s,) = _rounded(observed, axis, row, row + 1, at_instant=True)
    return there._replace(
        doubt_mm=max(there.doubt_mm, float(rounded_mm) / 3.0),
        doubt_mm_s=max(there.doubt_mm_s, float(rounded_mm_s) / 3.0),
    )


def state_ahead(observed: Observed, axis: str, time_ns: TimeNs) -> State | None:
    """Return the state at an instant if the axis goes on as it did up to the SYNC before.

    Of an instant at which something bends the motion, as a stop does. None without a step before.
    """
    row = observed.index_at(time_ns)
    if row < 1 or not len(observed):
        return None
    rows = slice(max(row - 1 - _PADDING, 0), row + 1)
    times_ns = observed.instants(rows)
    x, v = (observed.column(axis, name, rows) for name in ("truth_mm", "velocity_mm_s"))
    whole = motion(times_ns, x, v)
    step_s, on_s = (times_ns[-1] - times_ns[-2]) * 1e-9, (time_ns - int(times_ns[-1])) * 1e-9
    _, _, square, cube = coefficients(step_s, (x[-2], v[-2], x[-1], v[-1]))
    gain_mm_s2 = float(2.0 * square + 6.0 * cube * step_s)
    # Of what comes the set positions are known; else the speed may change as it did before
    bend_mm_s = float(np.max(np.abs(np.diff(v, 2)), initial=0.0))
    bend_mm_s += _answer_mm_s(observed, axis, row)
    return State(
        float(x[-1] + on_s * (v[-1] + 0.5 * on_s * gain_mm_s2)),
        float(v[-1] + on_s * gain_mm_s2),
        float(whole.doubts_mm[-1]) + bend_mm_s * on_s,
        float(whole.doubts_mm_s[-1]) + bend_mm_s,
    )


def _answer_mm_s(observed: Observed, axis: str, row: int) -> float:
    """Return how much the speed may change in the step after a row by a new slope of the demand.

    A demand that is d further at the end of the step than by the slope before makes kv d of speed
    in the position loop, and f d/T by the feed-forward; one that follows at once d/T. The new
    part of d comes from the set positions of the cycles before, within one increment (rounding).
    """
    first = max(row - _ON_THE_WAY - observed.facts.timing.buffer_cycles, 0)
    times_ns = observed.instants(slice(row - 1, row + 1))
    set_mm = observed.column(axis, "set_mm", slice(first, row + 1))
    new_mm = float(np.max(np.abs(np.diff(set_mm, 3)), initial=0.0))
    further_mm = new_mm + 1.0 / observed.axes[axis].increments_per_mm
    plant, at_once_per_s = observed.plant_of(axis), 1e9 / float(times_ns[1] - times_ns[0])
    if plant is None or not plant.kv_per_s:
        return further_mm * at_once_per_s
    share = PlantValues(plant).number("feed_forward")
    return further_mm * (plant.kv_per_s + share * at_once_per_s)


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
    """Return how well the position is known in the steps that end in some rows, mm, shape (n,)."""
    doubts_mm = np.zeros(last - first)
    known_mm = _alike(observed, axis, max(first - 1, 0), last - 1).doubts_mm
    doubts_mm[len(doubts_mm) - len(known_mm) :] = known_mm
    return doubts_mm


def together(found: Iterable[Largest | None]) -> Largest | None:
    """Return the largest of several."""
    known = [each for each in found if each is not None]
    return largest(np.array([v for v, _ in known]), np.array([doubt for _, doubt in known]))


def _parts(observed: Observed, axis: str, begin_ns: TimeNs, end_ns: TimeNs) -> Iterator[Motion]:
    """Yield the motion between two instants, so many rows at a time."""
    begin, end = observed.index_at(begin_ns), observed.index_at(end_ns) + 1
    for first in range(begin, end, _ROWS):
        yield _alike(observed, axis, first, min(first + _ROWS, end))


def _motion(observed: Observed, axis: str, first: int, last: int) -> Motion:
    """Return the motion from one row to another one; the rows around them count in its doubt."""
    around = slice(max(first - _PADDING, 0), min(last + 1 + _PADDING, len(observed)))
    times_ns = observed.instants(around)
    x, v = (observed.column(axis, name, around) for name in ("truth_mm", "velocity_mm_s"))
    whole, own = motion(times_ns, x, v), slice(first - around.start, last + 1 - around.start)
    steps = slice(own.start, own.stop - 1)
    return Motion(times_ns[own], x[own], v[own], whole.doubts_mm[steps], whole.doubts_mm_s[steps])


def _alike(observed: Observed, axis: str, first: int, last: int) -> Motion:
    """Return the same with the doubt of what is alike in many steps."""
    found = _motion(observed, axis, first, last)
    if _bandwidth_hz(observed, axis) is None:
        return found
    rounded_mm, rounded_mm_s = _rounded(observed, axis, first, last)
    moves = found.doubts_mm_s > 0.0
    return replace(
        found,
        doubts_mm=np.where(moves, np.maximum(found.doubts_mm, rounded_mm), 0.0),
        doubts_mm_s=np.where(moves, np.maximum(found.doubts_mm_s, rounded_mm_s), 0.0),
    )


def _rounded(
    observed: Observed, axis: str, first: int, last: int, *, at_instant: bool = False
) -> tuple[Signal, Signal]:
    """Return what the corners of the demand make in the steps that begin in rows first .. last - 1.

    Of way, mm, and of speed, mm/s, shape (n,) both. Of the set positions before the one of each
    row, which acts from the next SYNC on.
    """
    plant = observed.plant_of(axis)
    steps_s = np.diff(observed.instants(slice(first, last + 1))) * 1e-9
    if plant is None or not plant.kv_per_s or not observed.has(axis, "set_mm") or last <= first:
        none = np.zeros(len(steps_s))
        return none, none
    reach = _ON_THE_WAY + observed.facts.timing.buffer_cycles
    begin = max(first - reach - 2, 0)
    corners_mm = np.abs(np.diff(observed.column(axis, "set_mm", slice(begin, last - 1)), 2))
    missing = last - first + reach - 1 - len(corners_mm)
    whole_mm = np.concatenate([np.zeros(missing), corners_mm])
    largest_mm = np.lib.stride_tricks.sliding_window_view(whole_mm, reach).max(axis=1)
    per_s = 2.0 * np.pi / steps_s
    of_loop, bandwidth_hz = plant.kv_per_s / per_s, _bandwidth_hz(observed, axis)
    left = of_loop
    if bandwidth_hz is not None:
        asked = np.hypot(PlantValues(plant).number("feed_forward"), of_loop)
        left = asked / np.hypot(1.0, per_s / (2.0 * np.pi * bandwidth_hz))
    if at_instant:
        left = np.maximum(left, of_loop)
    rounded_mm = largest_mm[: len(steps_s)] / 8.0 * left
    return rounded_mm, per_s * rounded_mm


def _bandwidth_hz(observed: Observed, axis: str) -> float | None:
    """Return the bandwidth of the velocity loop of an axis, None where none is known."""
    plant = observed.plant_of(axis)
    return None if plant is None else PlantValues(plant).get("velocity_bandwidth")
