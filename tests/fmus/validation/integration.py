"""Integration of equations with kinks: stopped and started anew at each of them.

The right-hand side gets a mode, one truth value for each guard. Within a stretch the mode rests, so
that the right-hand side is smooth; the stretch ends where a guard changes its sign.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

Vector = NDArray[np.float64]
Mode = tuple[bool, ...]
# Time in s, state, mode: derivatives of the state, or the value of a guard.
RightHandSide = Callable[[float, list[float], Mode], Sequence[float]]
Guard = Callable[[float, list[float], Mode], float]

MAX_STRETCHES = 100_000
EPS = float(np.finfo(float).eps)


def integrate(
    rhs: RightHandSide,
    state: Sequence[float],
    time_s: Vector,
    guards: Sequence[Guard] = (),
    rtol: float = 1e-11,
    atol: float | Sequence[float] = 1e-14,
    max_step_s: float = 2.5e-4,
) -> Vector:
    """States at every instant of `time_s` as rows: len(time_s) x len(state).

    A guard is true where its function is positive; it may depend on the mode of the others. It is
    looked at every max_step_s.
    Method: DOP853 (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I).
    Raises RuntimeError when the integration fails or finds no end of events.
    """
    rows = np.empty((len(time_s), len(state)))
    rows[0] = x = np.asarray(state, dtype=float)
    t, end = float(time_s[0]), float(time_s[-1])
    mode = settled(guards, t, x.tolist(), (False,) * len(guards), set())
    for _ in range(MAX_STRETCHES):
        solver = DOP853(
            lambda t, x, mode=mode: rhs(t, x.tolist(), mode),
            t,
            x,
            end,
            rtol=rtol,
            atol=atol,
            max_step=max_step_s,
        )
        t, x, crossed = _stretch(solver, mode, guards, time_s, rows)
        if t >= end:
            return rows
        flipped = tuple(old ^ (k == crossed) for k, old in enumerate(mode))
        mode = settled(guards, t, x.tolist(), flipped, {crossed})
    raise RuntimeError(f"events without end at {t} s")


def _stretch(
    solver: DOP853, mode: Mode, guards: Sequence[Guard], time_s: Vector, rows: Vector
) -> tuple[float, Vector, int]:
    """Integrate until a guard contradicts its memory or to the end, and fill the rows.

    Gives instant and state there, and which guard; -1 at the end. The polynomial within a step is
    made only where an instant or an event lies in it.
    Raises RuntimeError when the integration fails.
    """
    t, state = solver.t, solver.y.tolist()
    before = [guard(t, state, mode) for guard in guards]
    while solver.status == "running":
        message = solver.step()
        if solver.status == "failed":
            raise RuntimeError(f"no solution past {solver.t} s: {message}")
        t_old, t, state = t, solver.t, solver.y.tolist()
        after = [guard(t, state, mode) for guard in guards]
        # Only the change that contradicts the memory counts.
        changed = [
            k
            for k, old in enumerate(mode)
            if (before[k] >= 0 >= after[k] if old else before[k] <= 0 <= after[k])
        ]
        instants = np.flatnonzero((time_s > t_old) & (time_s <= t))
        if changed or len(instants):
            path = solver.dense_output()
            roots = [
                brentq(
                    lambda t, k=k, path=path: guards[k](t, path(t).tolist(), mode),
                    t_old,
                    t,
                    xtol=4 * EPS,
                    rtol=4 * EPS,
                )
                for k in changed
            ]
            last = min(roots, default=t)
            inside = instants[time_s[instants] <= last]
            if len(inside):
                rows[inside] = path(time_s[inside]).T
            if roots:
                return last, path(last), changed[roots.index(last)]
        before = after
    return t, solver.y, -1


def advance(
    rhs: RightHandSide,
    state: list[float],
    span: tuple[float, float],
    guards: Sequence[Guard] = (),
    rtol: float = 1e-11,
    atol: float = 1e-14,
) -> list[float]:
    """The state at the end of a short span, as `integrate` but without its overhead.

    Only where a guard changes from one end to the other is the span integrated with events.
    """
    mode = settled(guards, span[0], state, (False,) * len(guards), set())
    solver = DOP853(
        lambda t, x: rhs(t, x.tolist(), mode),
        span[0],
        np.array(state),
        span[1],
        first_step=span[1] - span[0],
        rtol=rtol,
        atol=atol,
    )
    while solver.status == "running":
        solver.step()
    end: list[float] = solver.y.tolist()
    if all((guard(span[1], end, mode) > 0) == old for guard, old in zip(guards, mode, strict=True)):
        return end
    last: list[float] = integrate(rhs, state, np.array(span), guards, rtol, atol)[-1].tolist()
    return last


def settled(
    guards: Sequence[Guard], t: float, x: list[float], mode: Mode, crossed: set[int]
) -> Mode:
    """The mode in which every guard agrees with its function, but for those just `crossed`.

    Raises RuntimeError when there is none.
    """
    for _ in range(2 * len(guards) + 1):
        found = tuple(
            old if k in crossed else guard(t, x, mode) > 0
            for k, (guard, old) in enumerate(zip(guards, mode, strict=True))
        )
        if found == mode:
            return mode
        mode = found
    raise RuntimeError(f"no mode fits at {t} s")
