"""Columns of distance sensors in the trace, and lags of an axis whose SYNC comes later."""

import math
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.test_recorder_rows import MOTION, Plant, Recording

from axisrig.bench.drive.axis.drive import NO_TICK
from axisrig.bench.machine.recording.recorder import (
    DISTANCE_COLUMNS,
    TOOL_COLUMNS,
    RecordedAxis,
    Recorder,
)
from axisrig.bench.record.series import SeriesWriter
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class Sensor:
    """Reports its distance at an instant, 1 um more in each millisecond; roles: that it fills."""

    def __init__(self, roles: str, *, has_tool: bool = False) -> None:
        self.roles: Any = SimpleNamespace(has=roles.split().__contains__)
        self.has_tool = has_tool
        self._true = "distance_true" in roles

    def reported_at(self, time_ns: int) -> tuple[float, float | None, bool, bool]:
        at = time_ns / MS
        true_m = 0.002 + at * 1e-6 if self._true else None
        return 0.001 + at * 1e-6, true_m, at % 2 == 1, at % 2 == 0

    def tool_at(self, time_ns: int) -> list[float]:
        at = time_ns / MS
        return [*(1e-3 * (number + at) for number in range(8)), math.pi / 6]


def rows(**sensors: Sensor) -> Any:
    """Two rows of an axis X, at 1 and 2 ms."""
    made = Recording({})
    servo: Any = SimpleNamespace(tick_ns=250 * US, sync_ns=0, lag_peak_m=NO_TICK)
    made.servos["X"], made.whole.distances = servo, sensors
    axis = RecordedAxis("X", Plant("X", ""), servo)  # type: ignore[arg-type]
    made.recorder = Recorder(made.whole, [axis], {}, (), SeriesWriter(None))
    for number in (1, 2):
        made.cycle(number, number * MS + 1, X=number * MS)
    return made.table()


def test_a_sensor_has_a_column_for_each_role_and_flags_are_whole_numbers() -> None:
    table = rows(near=Sensor("distance distance_true valid touching"), far=Sensor("distance valid"))
    found = {name: table[name] for name in table.column_names if name[:4] in ("near", "far.")}
    assert set(found) == {*(f"near.{name}" for name in DISTANCE_COLUMNS), "far.distance_mm",
                          "far.valid"}  # fmt: skip
    for name, column in found.items():
        assert str(column.type) == ("double" if name.endswith("_mm") else "int8"), name
    assert found["near.distance_mm"].to_pylist() == pytest.approx([1.001, 1.002])
    assert found["near.distance_true_mm"].to_pylist() == pytest.approx([2.001, 2.002])
    assert found["near.valid"].to_pylist() == found["far.valid"].to_pylist() == [1, 0]
    assert found["near.touching"].to_pylist() == [0, 1]


def test_a_sensor_at_a_tool_says_where_that_is() -> None:
    """Lengths in mm in their order, the tilt in degrees; beside a sensor without a tool."""
    table = rows(plain=Sensor("distance"), tilted=Sensor("distance", has_tool=True))
    assert [name for name in table.column_names if name.startswith("plain")] == [
        "plain.distance_mm"
    ]
    for place, name in enumerate(TOOL_COLUMNS):
        found = table[f"tilted.{name}"].to_pylist()
        expected = [30.0] * 2 if name == "tilt_deg" else [place + 1.0, place + 2.0]
        assert found == pytest.approx(expected), name
    assert table["tilted.distance_mm"].to_pylist() == pytest.approx([1.001, 1.002])


class Led(Plant):
    """Its motor and its load move by 1 mm/s, its demand stands."""

    def motion_at(self, time_ns: int) -> list[float]:
        moved = time_ns / MS * 1e-6
        return [value + moved * (place in (0, 2)) for place, value in enumerate(self._start)]


@pytest.mark.parametrize("late_us", [0, 1, 300, 900])
def test_the_lag_of_a_drive_is_that_of_its_own_sync(late_us: int) -> None:
    """0.3 ms later the motor is 0.3 um nearer to where it is led; the truth is of the row."""
    made = Recording({"X": Led("X", ""), "C": Led("C", "")}, segments=2)
    for number in (1, 2):
        at_ns = number * MS
        made.cycle(number, at_ns + (late_us + 1) * US, X=at_ns, C=at_ns + late_us * US)
    table = made.table()
    for name, after_ms in (("X", 0.0), ("C", late_us / 1000)):
        start = MOTION[name]
        lag_mm = [(start[4] - start[2]) * 1e3 - 1e-3 * (at + after_ms) for at in (1, 2)]
        assert table[f"{name}.drive_lag_mm"].to_pylist() == pytest.approx(lag_mm, abs=1e-9)
        truth_mm = [start[0] * 1e3 + 1e-3 * at for at in (1, 2)]
        assert table[f"{name}.truth_mm"].to_pylist() == pytest.approx(truth_mm, abs=1e-9)
