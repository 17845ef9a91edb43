"""Smallest and largest values of an inclined tool: which rows count, and how they are written."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.reports import tilted

from axisrig.reports.kinematics.motion import Motion, motion_of
from axisrig.reports.kinematics.section import rows

TRACE = tilted.trace()
TOOL = tilted.tool(TRACE, tilted.left())
DEPTH = "beam below the surface while it works"
OFFSET, MOVED = "o, offset along the normal", "o/cos b, along the direction"


def motion(**changes: Any) -> Motion:
    found = motion_of(TRACE, TOOL)
    assert found is not None
    return replace(found, **changes)


def values(of: Motion) -> dict[str, tuple[str, str, str]]:
    return {name: (least, most, unit) for name, least, most, unit in rows(of, TOOL)}


AT = np.arange(len(motion().times_ns))


@pytest.mark.parametrize(
    ("is_on", "least", "most"),
    [
        ((AT >= 300) & (AT < 310), "-3000.00", "5000.00"),
        (AT == 305, "5000.00", "5000.00"),
        (AT >= 200, "-400000.00", "5000.00"),
    ],
)
def test_the_beam_counts_while_the_control_is_on(is_on: Any, least: str, most: str) -> None:
    """5 mm below the surface and 3 mm above it in a row each; 400 mm above it while it comes."""
    depth = np.where(AT < 290, -400.0, 0.0)
    depth[305], depth[307] = 5.0, -3.0
    base = motion()
    found = values(motion(is_on=is_on, along_mm=base.length_mm - depth))
    assert found[DEPTH] == (least, most, "µm")


@pytest.mark.parametrize(
    ("tilt_deg", "least", "most"),
    [
        ((-0.00001, 35.0), "0.0000", "35.0000"),  # rounded to 0, it has no sign
        ((12.34564, 12.34566), "12.3456", "12.3457"),
        ((-35.0, -0.00004), "-35.0000", "0.0000"),
        ((np.nan, 7.0), "7.0000", "7.0000"),
        ((np.inf, 7.0), "7.0000", "7.0000"),
    ],
)
def test_a_value_has_four_digits_and_what_is_not_known_is_none(
    tilt_deg: tuple[float, float], least: str, most: str
) -> None:
    whole = np.where(AT % 2 == 0, *tilt_deg)
    assert values(motion(tilt_deg=whole))["tilt"] == (least, most, "°")


def test_a_signal_that_nothing_gives_has_no_row() -> None:
    unknown = np.full(len(AT), np.nan)
    found = values(motion(length_mm=unknown, distance_mm=unknown))
    assert not {"tool length, true", "h, clamping point to surface, true", DEPTH} & set(found)
    assert "tilt" in found


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_offset_has_its_rows_where_there_is_one(side: float) -> None:
    """One row of 1.5 mm, and others without a value, are enough; all of 0 are none."""
    some = np.where(AT < 100, np.nan, 0.0)
    assert not {OFFSET, MOVED} & set(values(motion(offset_mm=some, moved_mm=some)))
    some[400] = 1.5 * side
    found = values(motion(offset_mm=some, moved_mm=2.0 * some))
    ends = ("0.0000", "1.5000") if side > 0 else ("-1.5000", "0.0000")
    twice = ("0.0000", "3.0000") if side > 0 else ("-3.0000", "0.0000")
    assert found[OFFSET] == (*ends, "mm")
    assert found[MOVED] == (*twice, "mm")
