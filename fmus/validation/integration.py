"""Integration of equations with kinks: stopped and started anew at each of them.

The right-hand side gets a mode, one truth value for each guard. Within a stretch the mode rests, so
that the right-hand side is smooth; the stretch ends where a guard changes its sign.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853, solve_ivp

Vector = NDArray[np.float64]
Mode = tuple[bool, ...]
# Time in s, state, mode: derivatives of the state, or the value of a guard.
RightHandSide = Callable[[float, list[float], Mode], Sequence[float]]
Guard = Callable[[float, list[float], Mode], float]

MAX_STRETCHES = 100_000


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
        found = solve_ivp(
            lambda t, x, mode: rhs(t, x.tolist(), mode),
            (t, end),
            x,
            method="DOP853",
            rtol=rtol,
            atol=atol,
            max_step=max_step_s,
            dense_output=True,
            args=(mode,),
            events=[_event(guard, memory) for guard, memory in zip(guards, mode, strict=True)],
        )
        if found.status < 0:
            raise RuntimeError(f"no solution past {found.t[-1]} s: {found.message}")
        last = float(found.t[-1])
        inside = (time_s > t) & (time_s <= last)
        if inside.any():
            rows[inside] = found.sol(time_s[inside]).T
        t, x = last, found.y[:, -1]
        if found.status == 0:
            return rows
        crossed = {k for k, instants in enumerate(found.t_events) if len(instants)}
        flipped = tuple(old ^ (k in crossed) for k, old in enumerate(mode))
        mode = settled(guards, t, x.tolist(), flipped, crossed)
    raise RuntimeError(f"events without end at {t} s")


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


def _event(guard: Guard, memory: bool) -> Callable[..., float]:
    """A guard as an event of solve_ivp: only the change that contradicts its memory counts."""

    def event(t: float, x: Vector, mode: Mode) -> float:
        return guard(t, x.tolist(), mode)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1.0 if memory else 1.0  # type: ignore[attr-defined]
    return event
