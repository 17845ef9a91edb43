"""Error of the edge of a probe against the communication step, for three masters.

One SYNC period of 10 ms and one motion; only the longest step of the co-simulation changes. The
reference is an integration of the same physics with scipy (rtol 1e-12, event), written here from
the equations. `python docs/plots/edge_error.py` draws docs/images/edge-error.svg.
"""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1]))

from axisrig.fmus import ensure_built  # noqa: E402
from axisrig.fmus.build import build  # noqa: E402
from axisrig.kernel.cosim.fmi.fmu import load_fmu  # noqa: E402
from axisrig.kernel.cosim.plant.axis import PlantAxis  # noqa: E402
from axisrig.kernel.cosim.plant.plant import Plant  # noqa: E402

SYNC_NS, OFFSET_NS = 10_000_000, 48_000
STEPS_US = (100, 200, 500, 1000, 2000, 5000, 10_000)
SPEED, ACCELERATION = -0.02, 1.0  # of the demand: m/s, m/s2
END_NS = 30 * SYNC_NS
INTERNAL_STEP_S = 10e-6
# Defaults of ScrewAxis: 159 Hz with the motor held; the slope of the demand is added in full
MASS, MOTOR_MASS = 120.0, 1.8e-4 * (2 * pi / 0.01) ** 2
STIFFNESS, DAMPING, MOTOR_FRICTION = 120e6, 6e3, 100.0
KV, INTEGRAL_TIME, CURRENT_RATE = 40.0, 8e-3, 2 * pi * 800
GAIN = 2 * pi * 60 * (MASS + MOTOR_MASS)
WITHOUT_FRICTION = {f"friction.{name}": 0.0 for name in ("coulomb", "breakaway", "viscous")}
BEND_S, BENT_ACCELERATION = 0.0234567, 1.0


def demand_at(time_ns: int) -> float:
    """The position that is commanded for a SYNC: 1 m/s2 up to 20 mm/s, then straight on."""
    time_s = max(time_ns - OFFSET_NS, 0) * 1e-9
    ramp_s = SPEED / -ACCELERATION
    fast_s = max(time_s - ramp_s, 0.0)
    return -ACCELERATION / 2 * min(time_s, ramp_s) ** 2 + SPEED * fast_s


def syncs_ns() -> Iterator[int]:
    """Instants of SYNC."""
    return iter(range(OFFSET_NS, END_NS, SYNC_NS))


# The physics, written for scipy


def elastic(time_s: float, state: Any, start: float, rate: float, begin_s: float) -> list[float]:
    """Cascade of a drive, motor and load on a spring."""
    x, v, s, w, force, integral = state
    error = KV * (start + rate * (time_s - begin_s) - s) + rate - w
    screw = STIFFNESS * (s - x) + DAMPING * (w - v)
    return [
        v,
        screw / MASS,
        w,
        (force - screw - MOTOR_FRICTION * w) / MOTOR_MASS,
        CURRENT_RATE * (GAIN * error + integral - force),
        GAIN * error / INTEGRAL_TIME,
    ]


def bent(_time_s: float, state: Any, acceleration: float) -> list[float]:
    """Mass under a given acceleration."""
    return [state[1], acceleration]


def elastic_pieces() -> Iterator[tuple[float, float, tuple[float, ...]]]:
    """Begin, end and arguments of each smooth piece of the elastic axis."""
    first_s = OFFSET_NS * 1e-9
    yield 0.0, first_s, (0.0, 0.0, 0.0)
    for sync_ns in syncs_ns():
        start, end = demand_at(sync_ns), demand_at(sync_ns + SYNC_NS)
        begin_s = sync_ns * 1e-9
        yield begin_s, begin_s + SYNC_NS * 1e-9, (start, (end - start) / SYNC_NS * 1e9, begin_s)


def bent_pieces() -> Iterator[tuple[float, float, tuple[float, ...]]]:
    """The two smooth pieces of the bent motion."""
    yield 0.0, BEND_S, (0.0,)
    yield BEND_S, END_NS * 1e-9, (BENT_ACCELERATION,)


@dataclass(frozen=True)
class Case:
    """One motion. places: of the surface, m; each gives one edge."""

    model: str
    equations: Callable[..., list[float]]
    pieces: Callable[[], Iterator[tuple[float, float, tuple[float, ...]]]]
    state: tuple[float, ...]
    places: tuple[float, ...]
    start: dict[str, float] = field(default_factory=dict)


CASES = {
    # 10 ms of the approach, then an acceleration step of 1 m/s2 = 1000 mm/s2 inside a step
    "acceleration step": Case(
        "EdgeProof.Bent",
        bent,
        bent_pieces,
        (0.0, SPEED),
        tuple(SPEED * (BEND_S + since_s) for since_s in (-3e-3, -2e-5, 1e-5, 4e-4, 2e-3, 5e-3)),
    ),
    # In the ringing after the demand began to move, and after it went straight on
    "160 Hz mode": Case(
        "AxisRig.Drives.ScrewAxis",
        elastic,
        elastic_pieces,
        (0.0,) * 6,
        (-2e-5, -5.3e-5, -1.01e-4, -2.2e-4, -3.4e-4, -5.1e-4),
        {"kv": KV, "feed_forward": 1.0, **WITHOUT_FRICTION},
    ),
}


def reference_s(case: Case, place: float) -> float:
    """The instant at which the load reaches a place, by scipy."""
    state: Any = case.state

    def reached(_time_s: float, now: Any, *_arguments: float) -> float:
        return float(now[0] - place)

    reached.terminal = True  # type: ignore[attr-defined]
    for begin_s, end_s, arguments in case.pieces():
        solution = solve_ivp(
            case.equations,
            (begin_s, end_s),
            state,
            method="DOP853",
            args=arguments,
            events=reached,
            rtol=1e-12,
            atol=1e-17,
        )
        if solution.t_events[0].size:
            return float(solution.t_events[0][0])
        state = solution.y[:, -1]
    raise ValueError(f"{place} m is not reached")


def state_at(case: Case, time_s: float) -> Any:
    """The state at an instant, by scipy."""
    state: Any = case.state
    for begin_s, end_s, arguments in case.pieces():
        span = (begin_s, min(end_s, time_s))
        solution = solve_ivp(
            case.equations, span, state, method="DOP853", args=arguments, rtol=1e-12, atol=1e-17
        )
        state = solution.y[:, -1]
        if end_s >= time_s:
            break
    return state


# The masters


@cache
def axis_fmu(model: str, folder: Path) -> Path:
    """Build the FMU of a case."""
    if model.startswith("AxisRig."):
        return ensure_built(model)
    return build(model, folder / f"{model}.fmu", HERE / "EdgeProof", INTERNAL_STEP_S)


@contextmanager
def plant_of(
    case: Case, folder: Path, step_us: int, place: float, hold_ns: int = 0
) -> Iterator[Plant]:
    """A plant of one axis and a probe above a surface at `place`."""
    plant = Plant(exchange_ns=step_us * 1000, hold_ns=hold_ns)
    try:
        axis = load_fmu(axis_fmu(case.model, folder), "axis")
        for variable, value in case.start.items():
            axis.set_start(variable, value)
        plant.add_axis(axis)
        probe = load_fmu(ensure_built("AxisRig.Sensors.TouchProbe"), "probe")
        probe.set_start("surface", place)
        plant.add_probe(probe, {"z": "axis"})
        plant.initialize(0)
        yield plant
    finally:
        plant.close()


def drive(axis: PlantAxis, is_done: Callable[[], bool]) -> None:
    """Command the axis SYNC by SYNC until the edge is found."""
    for sync_ns in syncs_ns():
        axis.advance_to(sync_ns)
        if is_done():
            return
        start, end = demand_at(sync_ns), demand_at(sync_ns + SYNC_NS)
        axis.command(sync_ns, start, (end - start) / SYNC_NS * 1e9, sync_ns + SYNC_NS, True)


def ours_ns(case: Case, folder: Path, step_us: int, place: float) -> int:
    """The edge as the bench finds it."""
    with plant_of(case, folder, step_us, place) as plant:
        edges = plant.probes["probe"].signal.edges
        drive(plant.axes["axis"], lambda: bool(edges))
        return edges[0][0]


def points(case: Case, folder: Path, step_us: int) -> tuple[Any, Any, Any]:
    """Times, positions and velocities at the ends of fixed communication steps."""
    rows = []
    with plant_of(case, folder, 20_000, -1.0) as plant:
        axis = plant.axes["axis"]
        for sync_ns in (0, *syncs_ns()):
            axis.advance_to(sync_ns)
            if sync_ns:
                start, end = demand_at(sync_ns), demand_at(sync_ns + SYNC_NS)
                axis.command(sync_ns, start, (end - start) / SYNC_NS * 1e9, sync_ns + SYNC_NS, True)
            first_ns = sync_ns + step_us * 1000 if sync_ns else OFFSET_NS
            last_ns = sync_ns + SYNC_NS if sync_ns else OFFSET_NS
            rows.append((sync_ns * 1e-9, *axis.motion[:2]))
            for time_ns in range(first_ns, last_ns, step_us * 1000):
                axis.advance_to(time_ns)
                rows.append((time_ns * 1e-9, *axis.motion[:2]))
    times, positions, velocities = np.array(rows).T
    return times, positions, velocities


def at_end_s(case: Case, folder: Path, step_us: int, places: Sequence[float]) -> list[float]:
    """A plain master: the edge is seen at the end of the step."""
    times, positions, _ = points(case, folder, step_us)
    return [float(times[np.argmax(positions <= place)]) for place in places]


def end_points_s(case: Case, folder: Path, step_us: int, places: Sequence[float]) -> list[float]:
    """A master that interpolates between the two ends of the step (cubic Hermite)."""
    times, positions, velocities = points(case, folder, step_us)
    path = CubicHermiteSpline(times, positions, velocities)
    found = []
    for place in places:
        after = int(np.argmax(positions <= place))
        found.append(
            brentq(lambda t, p=place: path(t) - p, *times[after - 1 : after + 1], xtol=1e-16)
        )
    return found


def errors_ns(name: str, folder: Path, steps_us: Sequence[int] = STEPS_US) -> dict[str, Any]:
    """Largest error of the edge for each step and master, ns.

    Returns: master -> array of shape (len(steps_us),); `bench` also holds the edges themselves
    under `edges`, shape (len(steps_us), number of places), ns.
    """
    case = CASES[name]
    truth_s = np.array([reference_s(case, place) for place in case.places])
    rows: dict[str, list[Any]] = {"step end": [], "end points": [], "axisrig": [], "edges": []}
    for step_us in steps_us:
        edges = [ours_ns(case, folder, step_us, place) for place in case.places]
        rows["edges"].append(edges)
        rows["axisrig"].append(np.abs(np.array(edges) - truth_s * 1e9).max())
        for master, find in (("step end", at_end_s), ("end points", end_points_s)):
            seen_s = np.array(find(case, folder, step_us, case.places))
            rows[master].append(np.abs(seen_s - truth_s).max() * 1e9)
    return {master: np.array(values) for master, values in rows.items()}


def draw(folder: Path, target: Path) -> None:
    """Draw every case into one picture."""
    import matplotlib as mpl  # noqa: PLC0415
    from matplotlib import pyplot as plt  # noqa: PLC0415

    mpl.use("svg")
    mpl.rcParams.update({"svg.hashsalt": "axisrig", "svg.fonttype": "none", "font.size": 9})
    figure, axes = plt.subplots(1, len(CASES), figsize=(8, 3.7), sharey=True, layout="constrained")
    labels = {
        "step end": "edge seen at the end of the step",
        "end points": "cubic through the end points",
        "axisrig": "axisrig",
    }
    for place, name in zip(axes, CASES, strict=True):
        errors = errors_ns(name, folder)
        for (master, label), marker in zip(labels.items(), "s^o", strict=True):
            place.loglog(np.array(STEPS_US) / 1000, errors[master], marker=marker, label=label)
        place.axhline(1.0, color="grey", linewidth=0.8, linestyle=":")
        place.set_title(name)
        place.set_xlabel("communication step, ms")
        place.minorticks_off()
        place.set_xticks(
            [step_us / 1000 for step_us in STEPS_US], [f"{s / 1000:g}" for s in STEPS_US]
        )
        place.grid(alpha=0.3)
    axes[0].set_ylabel("largest error of the edge, ns")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    import tempfile

    with tempfile.TemporaryDirectory() as name:
        draw(Path(name), HERE.parent / "images" / "edge-error.svg")
