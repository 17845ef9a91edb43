"""Limits by which recordings of scenarios are judged, as the parameter lists write them."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.tools.scenarios.limits import Lists, lists_of, offset_lists_of
from axisrig.kernel.parameters.table import table

OF_SLOPES = [
    parameter.path.replace("[i]", "[0]")
    for parameter in map(table("axis").row, table("axis").paths())
    if parameter is not None and parameter.topic == "dynamics.csv" and parameter.unit == "mm/s2"
]
"""Accelerations and decelerations of both slopes, of a feedhold and of an emergency stop."""


def axis_of(written: dict[str, float | str]) -> AxisRecord:
    return AxisRecord("can1", 1, 1000.0, written=written)


@pytest.mark.parametrize("name", OF_SLOPES)
def test_each_acceleration_of_the_slopes_may_be_the_largest(name: str) -> None:
    """A deceleration of P-AXIS-00280 to 00283 above the accelerations is legal as well."""
    others: dict[str, float | str] = dict.fromkeys(OF_SLOPES, 800)
    assert lists_of(axis_of(others)).a_mm_s2 == 800.0
    assert lists_of(axis_of({**others, name: 2500})).a_mm_s2 == 2500.0


@pytest.mark.parametrize(
    "name",
    ["getriebe[1].dynamik.a_max", "handbetrieb.hb.a_max", "kenngr.dist_ctrl[0].a_max",
     "getriebe[0].dynamik.vb_max"],
)  # fmt: skip
def test_what_is_no_acceleration_of_the_first_gear_does_not_count(name: str) -> None:
    assert lists_of(axis_of({"getriebe[0].dynamik.a_max": 900, name: 90_000})).a_mm_s2 == 900.0


def test_limits_of_an_axis_come_in_mm() -> None:
    """P-AXIS-00212 is in um/s, P-AXIS-00086 in 0.1 um."""
    written: dict[str, float | str] = {
        "getriebe[0].dynamik.vb_max": 81_500,
        "getriebe[0].dynamik.a_max": 1200,
        "kenngr.hub_messtaster": 50_000,
    }
    found = lists_of(axis_of(written))
    assert found == Lists(speed_mm_s=81.5, a_mm_s2=1200.0, stroke_mm=5.0)
    assert (found.rate(1), found.rate(2)) == (81.5, 1200.0)
    assert lists_of(axis_of({})) == Lists()


def test_limits_of_controls_are_those_of_each_list() -> None:
    """Of an axis and of the channel; the range of the sensor is narrower by its tolerance."""

    def written(place: str, scale: int) -> dict[str, float | str]:
        values = {"v_max": 10_000, "a_max": 200, "max_deviation": 70_000, "min_pos": -20_000,
                  "max_pos": 30_000, "tolerance": 500}  # fmt: skip
        return {f"{place}{key}": value * scale for key, value in values.items()}

    facts: Any = SimpleNamespace(
        axes={
            "Z": axis_of(written("kenngr.dist_ctrl[0].", 1)),
            "W": axis_of(written("kenngr.dist_ctrl[0].", 3)),
            "X": axis_of({}),
        },
        distance={"Z": None, "W": None},
        distance_3d=None,
        channel=written("dist_ctrl[0].", 2),
    )
    found = offset_lists_of(facts)
    of_z = Lists(speed_mm_s=10.0, a_mm_s2=200.0, deviation_mm=7.0, lowest_mm=-1.95, highest_mm=2.95)
    assert set(found) == {"Z", "W"}
    assert found["Z"] == of_z
    assert (found["W"].deviation_mm, found["W"].lowest_mm) == pytest.approx((21.0, -5.85))
    facts.distance_3d = object()
    (channel,) = [lists for name, lists in offset_lists_of(facts).items() if name not in "ZW"]
    assert (channel.speed_mm_s, channel.a_mm_s2) == (20.0, 400.0)
    assert channel.highest_mm == pytest.approx(5.9)


def test_a_sensor_may_be_anywhere_in_its_range_its_ends_included() -> None:
    values = np.array([-1.951, -1.95, 0.0, 2.95, 2.951, np.nan])
    both = Lists(lowest_mm=-1.95, highest_mm=2.95)
    assert both.allows(values).tolist() == [False, True, True, True, False, True]
    assert Lists(lowest_mm=-1.95).allows(values).tolist() == [False, *[True] * 5]
    assert Lists(highest_mm=2.95).allows(values).tolist() == [*[True] * 4, False, True]
    assert Lists().allows(values).all()
