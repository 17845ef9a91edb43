"""What the pages say of a tool and of failures, by pure functions: each signal and note once."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.kinematics.tool_findings import (
    KinematicStretch,
    ToolFindings,
    ToolGuide,
)
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.distance import Diagnosis
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord
from axisrig.reports.kinematics import section, signals
from axisrig.reports.kinematics.section import angle_to_normal
from axisrig.reports.run import _failures

MS = 1_000_000

TOOL = ToolFindings([], [], "head", {}, [], [], [])


@pytest.mark.parametrize("is_controlled", [True, False])
def test_the_true_gap_is_shown_where_no_distance_control_shows_it(
    is_controlled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tilt, length and distance along the tool come from the plant in any case."""
    monkeypatch.setattr(signals, "_is_controlled", lambda _: is_controlled)
    names = ("tilt_deg", "virtual_length_mm", "along_mm", "distance_true_mm")
    trace = pa.table({f"head.{name}": [float(at)] for at, name in enumerate(names)})
    found = signals._of_plant(trace, TOOL, RunFindings())
    shown = {name: float(values[0]) for name, values in found.items()}
    of_any = {"channel.tilt_true_deg": 0.0, "channel.tool_length_true_mm": 1.0,
              "channel.along_true_mm": 2.0}  # fmt: skip
    assert shown == of_any | ({} if is_controlled else {"channel.gap_true_mm": 3.0})
    short = signals._of_plant(trace.select(["head.tilt_deg"]), TOOL, RunFindings())
    assert list(short) == ["channel.tilt_true_deg"]


def test_the_angle_to_the_normal_is_that_of_the_guide_in_force() -> None:
    """ECS along a tool of 0, 30 .. 150 degrees, MCS is along the normal, off there is none."""
    angles = np.radians(30.0 * np.arange(6))
    motion: Any = SimpleNamespace(
        times_ns=np.arange(6),
        is_on=np.array([True, True, True, True, True, False]),
        direction=np.stack([np.sin(angles), 0.0 * angles, np.cos(angles)], axis=-1),
    )

    def found(*guides: tuple[int, str]) -> list[float | None]:
        listed = [ToolGuide(GuideChange(t, mode), is_used=True) for t, mode in guides]
        values = angle_to_normal(motion, replace(TOOL, guides=listed))
        return [None if np.isnan(value) else round(float(value), 6) for value in values]

    ecs, mcs = section.ECS, "MCS"
    assert found((0, ecs)) == [0.0, 30.0, 60.0, 90.0, 120.0, None]
    assert found((1, mcs)) == [None, 0.0, 0.0, 0.0, 0.0, None]
    assert found((0, ecs), (2, ""), (4, ecs)) == [0.0, 30.0, None, None, 120.0, None]
    assert found((0, mcs), (3, ecs)) == [0.0, 0.0, 0.0, 90.0, 120.0, None]


def checked(metric: str, verdict: Verdict, **cells: str) -> CheckRow:
    known = {
        **{"metric": metric, "verdict": verdict.word, "value": "", "unit": "mm", "lower": ""},
        **{"upper": "2", "uncertainty": "0.0", "check": "<= 2", "note": "", "reference": "docs"},
    }
    return CheckRow.read(known | cells)


def test_a_note_is_in_the_sentence_or_beneath_it_and_the_worst_failure_comes_first() -> None:
    """Without a value the sentence ends with the note: it is not written once more."""
    rows = [
        checked("lag_mm_max", Verdict.FAIL, value="3", note="rounding", uncertainty="0.5"),
        checked("standstill_mm", Verdict.INCONCLUSIVE, note="it never stood"),
        checked("overtravel_mm", Verdict.PASS, value="1"),
        checked("latch_mm", Verdict.MARGINAL, value="2"),
        checked("contact_mm", Verdict.ERROR, note="no plant"),
    ]
    run: Any = SimpleNamespace(checks=rows)
    found = _failures(run, {})
    notes = [(each["sentence"].split()[0], each["note"]) for each in found]
    assert notes == [("contact_mm", ""), ("lag_mm_max", "uncertainty: rounding"),
                     ("standstill_mm", "")]  # fmt: skip
    assert found[2]["sentence"].endswith(": it never stood")
    assert found[0]["sentence"].endswith(": no plant")


def used(at_ms: int, mode: str, axis: str = "", *normal: float, is_used: bool = True) -> ToolGuide:
    change = GuideChange(at_ms * MS, mode, axis, normal or (0.0, 0.0, 1.0))
    return ToolGuide(change, is_used)


def test_where_the_offset_acted_is_named_when_it_changes() -> None:
    """A normal that is not that of the machine is named too, but for a single axis."""
    tilted = (0.0, 0.6, 0.8)
    guides = [
        used(1, ""), used(2, "ACS", "Z"), used(3, "ACS", "Z"), used(4, "ACS", "X", *tilted),
        used(5, "ECS"), used(6, "MCS", "", *tilted), used(7, "ECS", "", *tilted),
        used(8, "ACS", "Y", is_used=False), used(9, "ECS", "", *tilted), used(10, "MCS"),
    ]  # fmt: skip
    found = section.modes_words(replace(TOOL, guides=guides))
    assert found == [
        ("2.0 ms", "ACS: the offset acts along the axis Z"),
        ("4.0 ms", "ACS: the offset acts along the axis X"),
        ("5.0 ms", "ECS: the offset acts along the tool"),
        ("6.0 ms", "MCS: the offset acts along the normal; normal 0, 0.6, 0.8"),
        ("7.0 ms", "ECS: the offset acts along the tool; normal 0, 0.6, 0.8"),
        ("10.0 ms", "MCS: the offset acts along the normal"),
    ]


def test_each_time_that_a_kinematic_was_on_has_its_tool_and_limits() -> None:
    def on(at_ms: int, ids: tuple[int, ...], tool_mm: float, **limits: float) -> KinematicStretch:
        record = KinematicRecord(at_ms * MS, 0, (), ids, tool_mm)
        return KinematicStretch(record, 0, limits)

    both = [on(10, (9, 98), 80.5, HD2=50.0, HD4=85.25), on(1200, (57,), 0.0)]
    assert section.kinematics_words(replace(TOOL, kinematics=both)) == [
        ("10.0 ms", "kinematic 9, 98 on, tool 80.5 mm, HD2 50°, HD4 85.25°"),
        ("1200.0 ms", "kinematic 57 on, tool 0 mm"),
    ]


def test_equal_dumps_in_a_row_are_one_and_the_last_one_is_always_shown() -> None:
    def shown(*values: str) -> Any:
        dumped = [Diagnosis(n * MS, {"zstd": value}) for n, value in enumerate(values)]
        return section.dumps(replace(TOOL, diagnosis=dumped))

    table = shown("a", "a", "b", "a", "a")
    assert (table["instants"], table["left_out"]) == (["0.0 ms", "2.0 ms", "3.0 ms"], 0)
    assert table["rows"] == [{"head": "Distance Control", "name": "zstd",
                              "values": ["a", "b", "a"], "changes": True}]  # fmt: skip
    assert shown("a", "a")["rows"][0]["changes"] is False
    for count, left_out in ((12, 0), (13, 1), (30, 18)):
        table = shown(*map(str, range(count)))
        values = table["rows"][0]["values"]
        assert (len(values), table["left_out"]) == (12, left_out)
        assert values == [*map(str, range(11)), str(count - 1)]
        assert table["instants"][-1] == f"{count - 1}.0 ms"
