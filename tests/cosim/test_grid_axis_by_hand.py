"""An axis on an FMU that takes steps of one length: what it reports at its points and between."""

from typing import Any

import pytest
from tests.cosim.test_plant_by_hand import Fmu

from axisrig.kernel.cosim.plant.grid import GridAxis
from axisrig.kernel.cosim.plant.outputs import DEMAND_POSITION, FORCE, POSITION
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("tells_demand", [True, False])
def test_demand_and_force_are_those_of_the_instant_also_at_a_point_of_the_grid(
    tells_demand: bool,
) -> None:
    """Points every 4 ms, 0.5 mm/ms; the demand is an output of the FMU or the last command."""
    more: dict[str, Any] = {"demand_position": lambda ns: 1e-3 * ns / MS} if tells_demand else {}
    fmu = Fmu(
        "demand", grid_ns=4 * MS, position=lambda ns: 0.01 * ns / MS, velocity=10.0,
        force=lambda ns: 3.0 * ns / MS, **more,
    )  # fmt: skip
    axis = GridAxis(fmu.roles, lambda _ns: None)
    axis.start(0)
    axis.command(0, 0.0, 0.5, 100 * MS, True)
    per_ms = 1e-3 if tells_demand else 0.5e-3
    for end_ms in (1, 3, 4, 6, 8, 12, 13):
        axis.step_to(end_ms * MS)
        assert axis.motion[POSITION] == pytest.approx(0.01 * end_ms)
        assert axis.motion[DEMAND_POSITION] == pytest.approx(per_ms * end_ms), end_ms
        assert axis.motion[FORCE] == pytest.approx(3.0 * end_ms)
        assert axis.motion_at(end_ms * MS) == axis.motion
