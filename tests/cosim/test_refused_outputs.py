"""What an FMU reports that is no number is named with its variable and its role."""

from math import inf, nan
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.roles import Bound
from axisrig.kernel.cosim.plant.refused_outputs import refusal

NAMES = ("position", "velocity", "force")
POSITION, FORCE = "table.s (position)", "motor.F (force)"


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((nan, 0.0, 1.0), f"{POSITION} is nan"),
        ((0.0, 0.0, -inf), f"{FORCE} is -inf"),
        ((inf, nan, nan), f"{POSITION} is inf, {FORCE} is nan"),  # the speed comes of the position
        ((0.0, inf, 1.0), "velocity is inf"),
    ],
)
def test_the_error_names_what_the_fmu_reports(values: tuple[float, ...], message: str) -> None:
    """The speed is no output of this one: it is named only where nothing else is wrong."""
    bound = {"position": Bound("table.s"), "force": Bound("motor.F")}
    roles: Any = SimpleNamespace(
        bound=bound, has=bound.__contains__, slave=SimpleNamespace(name="table", time_ns=2_500_000)
    )
    error = refusal(roles, NAMES, values)
    assert str(error) == f"plant table at t = 2.500000 ms: {message}"
    assert (error.instance, error.time_ns) == ("table", 2_500_000)


def test_where_no_output_is_wrong_each_value_that_was_computed_is_named() -> None:
    roles: Any = SimpleNamespace(
        bound={}, has=lambda _: False, slave=SimpleNamespace(name="table", time_ns=0)
    )
    error = refusal(roles, NAMES, (nan, 0.0, -inf))
    assert error.reason == "position is nan, force is -inf"
