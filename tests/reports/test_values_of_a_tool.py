"""Smallest and largest values of an inclined tool: which rows count, and how they are written."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.recordings import MS
from tests.reports import tilted

from axisrig.bench.judge.kinematics.tool_findings import ToolGuide
from axisrig.bench.record.kinematics import GuideChange
from axisrig.reports.kinematics.motion import Motion, motion_of
from axisrig.reports.kinematics.section import rows

TRACE = tilted.trace()
TOOL = tilted.tool(TRACE, tilted.left())
A, C = math.radians(tilted.A_DEG), math.radians(tilted.C_DEG)
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


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_without_a_control_the_beam_counts_where_it_works(side: float) -> None:
    """10 um and 20 um beside the surface; 4 mm above it, while it comes, is an approach."""
    depth = np.select([AT < 100, AT < 300, AT < 500], [-400.0, -4.0, 0.01 * side], 0.02 * side)
    base = motion()
    found = values(motion(is_on=AT < 0, along_mm=base.length_mm - depth))
    ends = ("10.00", "20.00") if side > 0 else ("-20.00", "-10.00")
    assert found[DEPTH] == (*ends, "µm")


def test_a_control_that_was_on_leaves_out_the_rows_after_it() -> None:
    """The beam is as near after the control as while it is on."""
    depth = np.where(AT < 400, 0.01, 0.02)
    base = motion()
    along = base.length_mm - depth
    assert values(motion(is_on=AT < 400, along_mm=along))[DEPTH] == ("10.00", "10.00", "µm")
    assert values(motion(is_on=AT >= 400, along_mm=along))[DEPTH] == ("20.00", "20.00", "µm")


@pytest.mark.parametrize(
    ("normal", "cosine"),
    [
        ((0.0, 0.0, 1.0), math.cos(A)),
        ((0.0, 0.0, -1.0), -math.cos(A)),
        ((1.0, 0.0, 0.0), math.sin(C) * math.sin(A)),
        ((0.0, 1.0, 0.0), -math.cos(C) * math.sin(A)),
    ],
)
def test_along_the_tool_b_is_the_angle_between_tool_and_normal(
    normal: tuple[float, float, float], cosine: float
) -> None:
    """u = (sin C sin A, -cos C sin A, cos A), which stands while the control is on."""
    change = GuideChange(tilted.ON * MS, "ECS", normal=normal)
    guided = replace(TOOL, guides=[ToolGuide(change, is_used=True)])
    b = f"{math.degrees(math.acos(cosine)):.4f}"
    assert ("b, direction to normal", b, b, "°") in rows(motion(), guided)
