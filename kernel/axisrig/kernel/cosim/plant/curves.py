"""Curves through a few points of a motion."""

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Sequence

from axisrig.kernel.time.clock import TimeNs


def hermite(time_s: float, step_s: float, ends: tuple[float, float, float, float]) -> float:
    """Evaluate the cubic Hermite polynomial at `time_s` of a step of `step_s`.

    ends: value and slope at the begin, value and slope at the end (unit, unit/s).
    Source: any text on interpolation; error |x''''| h^4 / 384 for a smooth motion.
    """
    x0, v0, x1, v1 = ends
    u = time_s / step_s
    w = 1.0 - u
    return (
        w * w * (1.0 + 2.0 * u) * x0
        + u * u * (3.0 - 2.0 * u) * x1
        + step_s * u * w * (w * v0 - u * v1)
    )


def end_slope(points: Sequence[tuple[TimeNs, float]]) -> float:
    """Return the slope at the first of three points, the latest one, of the parabola through them.

    Two points: that of the line, one: 0. Error for a smooth motion: x''' h^2 / 3 (backward
    difference of second order).
    """
    (now_ns, now), *past = points
    if not past:
        return 0.0
    (last_ns, last), *older = past
    h1 = (now_ns - last_ns) * 1e-9
    slope = (now - last) / h1
    if not older:
        return slope
    h0 = (last_ns - older[0][0]) * 1e-9
    before = (last - older[0][1]) / h0
    return slope + (slope - before) * h1 / (h0 + h1)


def two_before(
    times_ns: deque[TimeNs], rows: deque[list[float]], now_ns: TimeNs, apart_ns: TimeNs
) -> list[tuple[TimeNs, list[float]]]:
    """Return up to two rows with their instants, the latest first, so far apart or more.

    The first of them is as far from `now_ns`.
    """
    found: list[tuple[TimeNs, list[float]]] = []
    latest_ns = now_ns - apart_ns
    for time_ns, row in zip(reversed(times_ns), reversed(rows), strict=True):
        if time_ns <= latest_ns:
            found.append((time_ns, row))
            if len(found) > 1:
                break
            latest_ns = time_ns - apart_ns
    return found


def drop_before(times_ns: deque[TimeNs], rows: deque[list[float]], oldest_ns: TimeNs) -> None:
    """Drop the rows before an instant; one at least is not. What comes next takes their memory."""
    while times_ns[0] < oldest_ns:
        times_ns.popleft()
        rows.popleft()


def _vertex(places: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """Return place and value of the vertex of the parabola through three points (Newton's form).

    The middle point where they are on a straight line or in a valley.
    """
    (x0, x1, x2), (y0, y1, y2) = places, values
    first = (y1 - y0) / (x1 - x0)
    bend = ((y2 - y1) / (x2 - x1) - first) / (x2 - x0)
    if bend >= 0.0:
        return x1, y1
    x = (x0 + x1) / 2 - first / (2 * bend)
    return x, y0 + (x - x0) * (first + bend * (x - x1))


def peak(
    times_ns: deque[TimeNs],
    rows: deque[list[float]],
    place: int,
    since_ns: TimeNs,
    until_ns: TimeNs,
) -> float:
    """Return the largest value at `place` of rows with their instants, from one instant to another.

    It is the top of the parabola through the largest value and those beside it, off by at most
    0.064 h^3 times the third derivative for rows that are h apart (interpolation of degree 2, any
    text on it): 0.02 % for the force of a stop of 500 N/um in steps of 50 us. 0 without rows.
    """
    first, end = bisect_left(times_ns, since_ns), bisect_right(times_ns, until_ns)
    # By places, since these are the last rows: a deque is walked from its nearer end
    kept = [rows[number][place] for number in range(first, end)]
    largest = max(kept, default=0.0)
    middle = min(first + kept.index(largest), end - 2) if largest > 0.0 else 0
    if middle < 1:
        return largest
    numbers = range(middle - 1, middle + 2)
    instants = [(times_ns[number] - until_ns) * 1e-9 for number in numbers]
    top_s, top = _vertex(instants, [rows[number][place] for number in numbers])
    inside = max(since_ns - until_ns, times_ns[middle - 1] - until_ns) * 1e-9 <= top_s <= 0.0
    return max(largest, top) if inside else largest
