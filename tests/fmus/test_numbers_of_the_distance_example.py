"""The example of a distance loop: its numbers are those of its documentation."""

import csv
import math
import re

from axisrig.fmus.build import LIBRARY

TEXT = (LIBRARY / "Examples" / "DistanceLoop.mo").read_text(encoding="utf-8")
REFERENCE = LIBRARY / "Resources" / "ReferenceResults" / "DistanceLoop.csv"


def number(name: str) -> float:
    (found,) = re.findall(rf"\b{name} = ([-+\d.e]+)", TEXT)
    return float(found)


def test_the_sheet_rises_by_2_mm_with_5_mm_s_from_0_1_to_0_5_s() -> None:
    begin, end = number("lift_begin"), number("lift_end")
    assert (begin, end, number("lift")) == (0.1, 0.5, 2e-3)
    speed_m_s = number("lift") / (end - begin)
    assert math.isclose(speed_m_s, 5e-3)
    # A loop that is proportional stays behind by v/K
    assert math.isclose(speed_m_s / number("gain"), 0.25e-3)


def test_the_axis_begins_at_rest_above_the_sheet() -> None:
    """At the distance to keep, so that only the sheet moves it."""
    assert math.isclose(number("position_start"), number("level") + number("set_distance"))


def test_the_loop_does_not_overshoot() -> None:
    """s (1 + s T) + K has real roots where 4 K T is at most 1: none of its signals swings."""
    assert number("order") == 1
    delay_s = 1.0 / (2.0 * math.pi * number("bandwidth"))
    assert 4.0 * number("gain") * delay_s < 1.0
    with REFERENCE.open(encoding="utf-8", newline="") as file:
        rows = [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]
    settled_m = 0.25e-3 * math.exp(-8.0)  # what is left of a deviation after 8 time constants
    (last,) = [row for row in rows if row["time"] == 0.5]
    assert math.isclose(last["distance"], 2e-3 - 0.25e-3, abs_tol=2.0 * settled_m)
    resting = [row for row in rows if row["time"] >= 0.5 + 8.0 / number("gain")]
    assert resting
    for row in resting:
        assert math.isclose(row["distance"], 2e-3, abs_tol=2.0 * settled_m)
    highest_m = number("level") + number("lift") + number("set_distance")
    assert max(row["position"] for row in rows) <= highest_m + 1e-9
