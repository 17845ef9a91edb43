"""Curves through a few points of a motion."""

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Sequence
from typing import Final

from axisrig.kernel.time.clock import TimeNs

SEARCHES: Final = 4
"""Steps of Newton's method from a row to a summit beside it; each doubles the digits."""


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


def _summit(places: Sequence[float], values: Sequence[float], near: float) -> tuple[float, float]:
    """Return place and value of the summit of the polynomial through some points (Newton's form).

    near: one of the places, from which it is searched by Newton's method, through the parabola of
    value, slope and bend there. `near` itself where there is none.
    """
    count, shares = len(places), list(values)
    for order in range(1, count):
        for last in range(count - 1, order - 1, -1):
            span = places[last] - places[last - order]
            shares[last] = (shares[last] - shares[last - 1]) / span
    x = near
    for _ in range(SEARCHES):
        _, slope, bend = _on_polynomial(places, shares, x)
        if bend >= 0.0:
            break
        x -= slope / bend
    return x, _on_polynomial(places, shares, x)[0]


def _on_polynomial(
    places: Sequence[float], shares: Sequence[float], x: float
) -> tuple[float, float, float]:
    """Return value, slope and second derivative of a polynomial in Newton's form (Horner)."""
    value, slope, half_bend = shares[-1], 0.0, 0.0
    for number in range(len(places) - 2, -1, -1):
        away = x - places[number]
        half_bend = half_bend * away + slope
        slope = slope * away + value
        value = value * away + shares[number]
    return value, slope, 2.0 * half_bend


def peak(
    times_ns: deque[TimeNs],
    rows: deque[list[float]],
    place: int,
    since_ns: TimeNs,
    until_ns: TimeNs,
) -> float:
    """Return the largest value at `place` of rows with their instants, from one instant to another.

    It is the summit of the polynomial through the largest value and up to two on both sides of it,
    none beyond a 0: there a contact begins or ends. Of five rows that are h apart it is off by at
    most 0.03 h^5 times the fifth derivative (interpolation of degree 4, any text on it; half way
    between the last two). 0 without rows.
    """
    first, end = bisect_left(times_ns, since_ns), bisect_right(times_ns, until_ns)
    # By places, since these are the last rows: a deque is walked from its nearer end
    kept = [rows[number][place] for number in range(first, end)]
    largest = max(kept, default=0.0)
    middle = min(first + kept.index(largest), end - 2) if largest > 0.0 else 0
    if middle < 1:
        return largest
    begin, after = middle - 1, middle + 2
    while begin > max(middle - 2, 0) and rows[begin][place] > 0.0 and rows[begin - 1][place] > 0.0:
        begin -= 1
    while after < min(middle + 3, end) and rows[after - 1][place] > 0.0 < rows[after][place]:
        after += 1
    numbers = range(begin, after)
    instants = [(times_ns[number] - until_ns) * 1e-9 for number in numbers]
    top_s, top = _summit(
        instants, [rows[number][place] for number in numbers], instants[middle - begin]
    )
    since_s = max(since_ns, times_ns[middle - 1]) - until_ns
    return max(largest, top) if since_s * 1e-9 <= top_s <= 0.0 else largest
