"""What a sensor at an inclined tool says besides its distance, and at which instant."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import Fmu

from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.cosim.plant.distance import TOOL, PlantDistance
from axisrig.kernel.time.clock import MS


def tool_value(number: int) -> Any:
    """Each value is its number and the time in ms."""
    return lambda ns: number + ns / MS


def test_the_place_of_the_tool_is_that_of_its_instant() -> None:
    fmu = Fmu("z_position", distance=0.5, **{name: tool_value(n) for n, name in enumerate(TOOL)})
    moved: Any = SimpleNamespace(motion=[0.0, 0.0])
    sensor = PlantDistance(fmu.roles, {"z": moved})
    sensor.start(2 * MS)
    for end in (3, 5):
        sensor.step(fmu.time_ns, end * MS)
        sensor.look()
    assert sensor.has_tool
    for at_ns, looked_ms in (
        (2 * MS, 2), (3 * MS - 1, 2), (3 * MS, 3), (5 * MS - 1, 3), (5 * MS, 5), (9 * MS, 5),
    ):  # fmt: skip
        assert sensor.tool_at(at_ns) == [n + looked_ms for n in range(len(TOOL))]
    for ask in (sensor.tool_at, sensor.reported_at):
        with pytest.raises(PlantError, match=r"axis_x at t = 1\.999999 ms: no .* is kept"):
            ask(2 * MS - 1)


def test_a_sensor_without_a_tool_says_nothing_of_it() -> None:
    fmu = Fmu("z_position", distance=0.5)
    sensor = PlantDistance(fmu.roles, {"z": SimpleNamespace(motion=[0.0, 0.0])})  # type: ignore[dict-item]
    sensor.start(0)
    assert not sensor.has_tool
    with pytest.raises(PlantError, match="no place of the tool is kept"):
        sensor.tool_at(0)
