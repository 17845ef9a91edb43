"""Integration of equations with kinks: stopped and started anew at each of them.

The right-hand side gets a mode, one truth value for each guard. Within a stretch the mode rests, so
that the right-hand side is smooth; the stretch ends where a guard changes its sign.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Vector = NDArray[np.float64]
Mode = tuple[bool, ...]
RightHandSide = Callable[[float, Vector, Mode], Sequence[float]]
Guard = Callable[[float, Vector], float]

MAX_STRETCHES = 100_000


def integrate(
    rhs: RightHandSide,
    state: Sequence[float],
    time_s: Vector,
    guards: Sequence[Guard] = (),
    breaks_s: Sequence[float] = (),
    rtol: float = 1e-11,
    atol: float | Sequence[float] = 1e-14,
) -> Vector:
    """States at every instant of `time_s` as rows: len(time_s) x len(state).

    A guard is true where its function is positive. breaks_s: instants at which the right-hand side
    jumps in time; it is evaluated on (or inside) one side of a break only.
    Method: DOP853 (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I).
    Raises RuntimeError when the integration fails or finds no end of events.
    """
    rows = np.empty((len(time_s), len(state)))
    rows[0] = x = np.asarray(state, dtype=float)
    mode = [guard(time_s[0], x) > 0 for guard in guards]
    edges = sorted({time_s[0], time_s[-1], *(b for b in breaks_s if time_s[0] < b < time_s[-1])})
    for begin, end in pairwise(edges):
        x = _between(rhs, x, (begin, end), guards, mode, (time_s, rows), (rtol, atol))
    return rows


def _between(
    rhs: RightHandSide,
    x: Vector,
    span: tuple[float, float],
    guards: Sequence[Guard],
    mode: list[bool],
    wanted: tuple[Vector, Vector],
    tolerance: tuple[float, float | Sequence[float]],
) -> Vector:
    """Integrate over one span of smooth inputs; fills the wanted rows and changes the mode."""
    t, end = span
    time_s, rows = wanted
    for _ in range(MAX_STRETCHES):
        found = solve_ivp(
            rhs,
            (t, end),
            x,
            method="DOP853",
            rtol=tolerance[0],
            atol=tolerance[1],
            dense_output=True,
            args=(tuple(mode),),
            events=[_event(guard, memory) for guard, memory in zip(guards, mode, strict=True)],
        )
        if found.status < 0:
            raise RuntimeError(f"no solution past {found.t[-1]} s: {found.message}")
        last = float(found.t[-1])
        inside = (time_s > t) & (time_s <= last)
        rows[inside] = found.sol(time_s[inside]).T
        t, x = last, found.y[:, -1]
        if found.status == 0:
            return x
        for k, instants in enumerate(found.t_events):
            mode[k] ^= len(instants) > 0
    raise RuntimeError(f"events without end at {t} s")


def _event(guard: Guard, memory: bool) -> Callable[..., float]:
    """A guard as an event of solve_ivp: only the change that contradicts its memory counts."""

    def event(t: float, x: Vector, mode: Mode) -> float:
        return guard(t, x)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1.0 if memory else 1.0  # type: ignore[attr-defined]
    return event
