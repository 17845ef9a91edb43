"""The block about an inclined tool in words: when it was on, where the offset acted, its dumps."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.recordings import MS
from tests.reports import tilted

from axisrig.bench.judge.kinematics.tool_findings import KinematicStretch, ToolGuide
from axisrig.bench.record.distance import Diagnosis
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord
from axisrig.reports.kinematics.motion import motion_of
from axisrig.reports.kinematics.section import (
    DUMPS,
    angle_to_normal,
    dumps,
    kinematics_words,
    modes_words,
    source_words,
)

TRACE = tilted.trace()
TOOL = tilted.tool(TRACE, tilted.left())
ALONG_X = (1.0, 0.0, 0.0)


def guide(at_ms: int, mode: str, *, is_used: bool = True, **more: Any) -> ToolGuide:
    return ToolGuide(GuideChange(at_ms * MS, mode, **more), is_used)


def modes(*guides: ToolGuide) -> list[tuple[str, str]]:
    return modes_words(replace(TOOL, guides=guides))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (guide(1, "ACS", axis="Z"), "ACS: the offset acts along the axis Z"),
        (guide(1, "ECS"), "ECS: the offset acts along the tool"),
        (guide(1, "MCS"), "MCS: the offset acts along the normal"),
        # A normal is that of MCS and ECS; an axis needs none
        (guide(1, "MCS", normal=ALONG_X), "MCS: the offset acts along the normal; normal 1, 0, 0"),
        (guide(1, "ECS", normal=(0.0, 0.6, 0.8)),
         "ECS: the offset acts along the tool; normal 0, 0.6, 0.8"),
        (guide(1, "ACS", axis="X", normal=ALONG_X), "ACS: the offset acts along the axis X"),
        (guide(1, "MCS", normal=(1 / 3, 0.0, -(8**0.5) / 3)),
         "MCS: the offset acts along the normal; normal 0.3333, 0, -0.9428"),
    ],
)  # fmt: skip
def test_where_an_offset_acts_is_said_with_a_normal_that_is_not_upright(
    given: ToolGuide, words: str
) -> None:
    assert modes(given) == [("1.0 ms", words)]


def test_a_mode_has_a_line_where_it_changes_and_was_used() -> None:
    """The same again is no change, other ones between it are."""
    mcs, ecs = "MCS: the offset acts along the normal", "ECS: the offset acts along the tool"
    assert modes(
        guide(1, ""), guide(2, "MCS"), guide(3, "MCS"), guide(4, "ECS", is_used=False),
        guide(5, "MCS"), guide(6, "ECS"), guide(7, ""), guide(8, "ECS"), guide(9, "MCS"),
    ) == [("2.0 ms", mcs), ("6.0 ms", ecs), ("9.0 ms", mcs)]  # fmt: skip
    assert modes(guide(2, "MCS"), guide(3, "MCS", normal=ALONG_X)) == [
        ("2.0 ms", mcs), ("3.0 ms", f"{mcs}; normal 1, 0, 0"),
    ]  # fmt: skip


def dumped(*values: str) -> dict[str, Any]:
    diagnosis = [
        Diagnosis(n * MS, {"zstd": value, "kp": "0.3", "cmd_offset": "0"})
        for n, value in enumerate(values)
    ]
    table = dumps(replace(TOOL, diagnosis=diagnosis))
    assert table is not None
    return table


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ("a", "a"), ("aaa", "a"), ("aab", "ab"), ("abb", "ab"),
        ("aba", "aba"),  # equal ones that do not follow each other are two
        ("abab", "abab"), ("abbaab", "abab"),
    ],
)  # fmt: skip
def test_equal_dumps_one_after_the_other_are_one_column(values: str, shown: str) -> None:
    """Each at the instant of its first one."""
    table = dumped(*values)
    first, *others = table["rows"]
    assert "".join(first["values"]) == shown
    firsts = [n for n, value in enumerate(values) if not n or values[n - 1] != value]
    assert table["instants"] == [f"{n}.0 ms" for n in firsts]
    assert first["changes"] is (len({*values}) > 1)
    assert [row["changes"] for row in others] == [False, False]
    assert table["left_out"] == 0


@pytest.mark.parametrize("count", [DUMPS - 1, DUMPS, DUMPS + 1, DUMPS + 5])
def test_of_many_dumps_the_first_ones_and_the_last_one_are_shown(count: int) -> None:
    table = dumped(*map(str, range(count)))
    last = count - 1
    shown = [*range(DUMPS - 1), last] if count > DUMPS else [*range(count)]
    assert table["rows"][0]["values"] == [str(n) for n in shown]
    assert table["left_out"] == max(count - DUMPS, 0)


def test_each_time_that_a_kinematic_was_on_has_a_line_with_what_it_was() -> None:
    """Steps in their order, the length with six digits, limits in degrees where they act."""
    stretches = [
        KinematicStretch(
            KinematicRecord(at_ms * MS, None, ("X",), ids, tool_mm), 900 * MS, limits
        )
        for at_ms, ids, tool_mm, limits in (
            (10, (98,), 123.4567891, {}),
            (20, (98, 9), 50.0, {"HD2": 50.0, "HD4": 12.3456789}),
        )
    ]  # fmt: skip
    assert kinematics_words(replace(TOOL, kinematics=stretches)) == [
        ("10.0 ms", "kinematic 98 on, tool 123.457 mm"),
        ("20.0 ms", "kinematic 98, 9 on, tool 50 mm, HD2 50°, HD4 12.3457°"),
    ]


def test_it_is_said_where_tool_and_surface_come_from() -> None:
    motion = motion_of(TRACE, TOOL)
    assert "left no signals" in source_words(TOOL, None)
    assert f"those of the plant {TOOL.sensor}." in source_words(TOOL, motion)
    alone = source_words(replace(TOOL, sensor=None), motion)
    assert "without a surface" in alone
    assert "plant {" not in alone


def test_the_angle_to_the_normal_is_that_of_the_last_mode_while_the_control_is_on() -> None:
    """0 but for ECS; no value while no mode is given, or while the control is off."""
    motion = motion_of(TRACE, TOOL)
    assert motion is not None
    times_ms = motion.times_ns // MS
    motion = replace(motion, is_on=(times_ms >= 300) & (times_ms < 600))
    guides = [guide(0, ""), guide(350, "MCS"), guide(400, "ECS"), guide(500, "ACS")]
    found = angle_to_normal(motion, replace(TOOL, guides=guides))
    assert np.isnan(found[(times_ms < 350) | (times_ms >= 600)]).all()
    for begin, end, wanted in ((350, 400, 0.0), (400, 500, abs(tilted.A_DEG)), (500, 600, 0.0)):
        rows = (times_ms >= begin) & (times_ms < end)
        assert rows.any()
        assert found[rows] == pytest.approx(wanted, abs=1e-6)
