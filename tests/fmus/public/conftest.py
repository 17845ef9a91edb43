"""Models in the style of textbooks, built and run; the mathematics that they are compared with."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.small_fmus import small_fmu

from axisrig.fmus import BuildError

FOLDER = Path(__file__).parent


@pytest.fixture(scope="session")
def built() -> Callable[..., Path]:
    """The FMU of a public model; each is built once."""
    done: dict[tuple[str, float | None], Path | BuildError] = {}

    def build(model: str, step_s: float | None = None) -> Path:
        key = (model, step_s)
        library = FOLDER / model.partition(".")[0]
        if key not in done:
            try:
                done[key] = small_fmu(model, library, step_s)
            except BuildError as error:
                done[key] = error
        result = done[key]
        if isinstance(result, BuildError):
            raise result
        return result

    return build


@pytest.fixture
def run(built, load) -> Callable[..., dict[str, np.ndarray]]:
    """Runs a public model and gives the named outputs at the instants of communication."""

    def runner(
        model: str,
        times: Sequence[float],
        names: Sequence[str],
        step_s: float | None = None,
        inputs: Callable[[float], Mapping[str, Any]] | None = None,
        **start: Any,
    ) -> dict[str, np.ndarray]:
        plant = load(built(model, step_s), **start)
        found = {name: [plant.get(name)] for name in names}
        for before, after in itertools.pairwise(times):
            if inputs is not None:
                plant.set(**inputs(before))
            plant.slave.doStep(before, after - before)
            for name in names:
                found[name].append(plant.get(name))
        return {name: np.array(values, dtype=float) for name, values in found.items()}

    return runner


def smooth(f: Callable[..., Any], x0: Sequence[float], t: np.ndarray, **more: Any) -> np.ndarray:
    """Solution of x' = f(t, x) at the instants t, shape (len(x0), len(t))."""
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14, "max_step": t[1] - t[0]}
    result = solve_ivp(f, (t[0], t[-1]), x0, t_eval=t, **{**options, **more})
    assert result.success
    return np.asarray(result.y)


def hybrid(
    rates: Mapping[Any, Callable[..., Any]],
    guards: Mapping[Any, Sequence[tuple[Callable[..., float], Callable[..., Any]]]],
    mode: Any,
    x0: Sequence[float],
    t: np.ndarray,
) -> tuple[np.ndarray, list[Any], list[float]]:
    """A system with modes: rates[mode](t, x); a guard that rises through zero ends a mode.

    guards[mode]: pairs (g(t, x), jump(t, x) -> (mode, x)).
    Returns states at t, shape (len(x0), len(t)), modes at t, and the instants of the jumps.
    """
    states, modes, jumps = np.full((len(x0), len(t)), np.nan), [mode] * len(t), []
    begin, x = float(t[0]), np.array(x0, dtype=float)
    states[:, 0] = x
    while True:
        pairs = guards[mode]
        events = []
        for guard, _ in pairs:
            event = lambda t, x, guard=guard: guard(t, x)  # noqa: E731
            event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
            events.append(event)
        result = solve_ivp(
            rates[mode],
            (begin, t[-1]),
            x,
            events=events,
            dense_output=True,
            method="DOP853",
            rtol=1e-13,
            atol=1e-14,
            max_step=2e-3,
        )
        inside = (t > begin) & (t <= result.t[-1])
        if inside.any():
            states[:, inside] = result.sol(t[inside])
            for i in np.flatnonzero(inside):
                modes[i] = mode
        if result.status == 0:
            return states, modes, jumps
        which = next(i for i, found in enumerate(result.t_events) if len(found))
        begin, x = result.t[-1], result.y[:, -1]
        jumps.append(float(begin))
        mode, x = pairs[which][1](begin, x)
        x = np.array(x, dtype=float)


@pytest.fixture(scope="session")
def solve() -> SimpleNamespace:
    """Solvers of the references: `smooth` and `hybrid`."""
    return SimpleNamespace(smooth=smooth, hybrid=hybrid)
