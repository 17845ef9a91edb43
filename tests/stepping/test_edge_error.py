"""The edge is exact at any communication step; the numbers of the picture in the docs."""

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

NAMES = ("acceleration step", "160 Hz mode")


@pytest.fixture(scope="module")
def errors(edge_error: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Case -> errors of the masters from 0.1 to 10 ms at one SYNC of 10 ms."""
    folder = tmp_path_factory.mktemp("proof")
    return {name: edge_error.errors_ns(name, folder) for name in NAMES}


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_edge_is_within_half_a_nanosecond_of_scipy_at_any_step(errors: Any, name: str) -> None:
    """Rounding to whole nanoseconds, and 0.01 ns with which the FMU locates the crossing."""
    assert errors[name]["axisrig"].max() <= 0.5 + 0.01


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.long
def test_edge_does_not_depend_on_the_step(errors: Any, name: str) -> None:
    edges = errors[name]["edges"]
    assert (edges == edges[0]).all()


@pytest.mark.long
@pytest.mark.parametrize("name", NAMES)
def test_plain_masters_miss_it_by_far(errors: Any, name: str) -> None:
    """So the comparison can tell: a step that ends late, a cubic across the bend or the mode."""
    assert (errors[name]["step end"] > 5e4).all()
    assert errors[name]["end points"][-1] > 5e4
    assert (np.diff(errors[name]["end points"]) > 0).all()


def test_reference_of_the_bent_motion_is_the_closed_form(edge_error: ModuleType) -> None:
    """x = v t until the bend, then v t + a (t - b)^2/2; solved as the smaller root."""
    case = edge_error.CASES["acceleration step"]
    speed, bend, a = edge_error.SPEED, edge_error.BEND_S, edge_error.BENT_ACCELERATION
    for place in case.places:
        rest = place - speed * bend
        since = (-speed - np.sqrt(speed**2 + 2 * a * rest)) / a if rest < 0 else rest / speed
        assert edge_error.reference_s(case, place) == pytest.approx(bend + since, abs=1e-13)


@pytest.mark.long
def test_latched_position_is_as_exact(edge_error: ModuleType, tmp_path: Path) -> None:
    """The encoder 333 us after the edge, in the ringing, against scipy: below 0.01 nm."""
    case = edge_error.CASES["160 Hz mode"]
    hold_ns, found = 333_000, []
    for step_us in (100, 1000, 10_000):
        with edge_error.plant_of(case, tmp_path, step_us, case.places[2], hold_ns) as plant:
            axis, edges = plant.axes["axis"], plant.probes["probe"].signal.edges
            edge_error.drive(axis, lambda edges=edges: bool(edges))
            latch_ns = edges[0][0] + hold_ns
            found.append(axis.motor_position_m_at(latch_ns))
    assert found == [found[0]] * 3
    motor = edge_error.state_at(case, latch_ns * 1e-9)[2]
    assert found[0] == pytest.approx(motor, abs=1e-11)
