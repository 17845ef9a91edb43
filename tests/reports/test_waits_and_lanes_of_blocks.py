"""Blocks that wait, take no time or are joined; zero of a tornado; signals that fall; coverage."""

import re
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, Step, block_trace
from tests.reports.test_picture import points
from tests.reports.test_shares_of_a_sweep import RECT, effect, picture

from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.blocks import BlockTrace
from axisrig.reports.blocks import section as blocks
from axisrig.reports.blocks.section import blocks_lane, blocks_view
from axisrig.reports.coverage.section import ANY, _transitions
from axisrig.reports.parts import picture as drawing
from axisrig.reports.signals import chart


def shown(trace: BlockTrace, *, is_reduced: bool = False) -> dict[str, Any]:
    found = blocks_view(trace, lambda _: "", is_reduced=is_reduced)
    assert found is not None
    return found


def test_the_program_waits_for_its_path_and_not_for_what_moves_beside_it() -> None:
    """2 ms before the feed and 3 ms of dwell; the axis beside the path began 40 ms after its block.

    A measurement run beside the path is none of the path either.
    """
    trace = block_trace([
        Step("N10 G1 Z5", "feed", 0, 2, 10),
        Step("X[INDP_ASYN]", "independent move", 10, 50, 90, line=2),
        Step("Y[MEAS]", "independent run", 10, 60, 80, line=3),
        Step("N40 G4 0.003", "dwell", 10, 10, 13, line=4),
    ])  # fmt: skip
    view = shown(trace)
    assert view["words"] == "4 commands in 0.090 s, of it 0.005 s waiting"
    assert [row["waited"] for row in view["rows"]] == ["2.000", "40.000", "50.000", ""]
    lane = blocks_lane(trace, is_reduced=False)
    assert lane is not None
    assert [row[5] for row in lane["rows"]] == [0, 1, 1, 0]
    assert lane["lanes"] == 2


def test_a_command_that_takes_no_time_is_where_it_was_due() -> None:
    """So that it has a width in the plots; one that lasts is where it acts."""
    trace = block_trace([
        Step("N10 G1 Z5", "feed", 0, 2, 10), Step("N20 #WORD", "distance control", 10, 14, 14,
                                                  line=2),
    ])  # fmt: skip
    first, second = shown(trace)["rows"]
    assert (first["begin_ns"], first["end_ns"]) == (2 * MS, 10 * MS)
    assert (second["begin_ns"], second["end_ns"]) == (10 * MS, 14 * MS)
    assert (first["lasts"], second["lasts"], second["waited"]) == ("8.000", "", "4.000")


@pytest.mark.parametrize(
    ("count", "labels"),
    [
        (4, ["N1 G1", "N2 G1", "N3 G1", "N4 G1"]),
        (5, ["3 from N1 G1", "2 from N4 G1"]),
        (7, ["4 from N1 G1", "3 from N5 G1"]),
    ],
)
def test_a_lane_of_too_many_commands_joins_them_to_twice_its_share(
    count: int, labels: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """30 ms each, four at most: joined until they are half of the whole (75 ms, 105 ms)."""
    monkeypatch.setattr(blocks, "LANE_MAX", 4)
    trace = block_trace([
        Step(f"N{n} G1", "feed", 30 * (n - 1), 30 * (n - 1), 30 * n, line=n)
        for n in range(1, count + 1)
    ])  # fmt: skip
    lane = blocks_lane(trace, is_reduced=False)
    assert lane is not None
    assert [row[6] for row in lane["rows"]] == labels
    assert lane["rows"][0][1] == 0
    assert lane["rows"][-1][3] == 30 * count * MS


@pytest.mark.parametrize(("values", "sides"), [((2.0, 3.0), "right"), ((-2.0, -3.0), "left")])
def test_bars_of_one_sign_begin_at_no_change(values: tuple[float, ...], sides: str) -> None:
    """It is at one edge of the picture, and the longest bar comes first."""
    svg = picture(*(effect(value, value - 0.5, value + 0.5) for value in values))
    bars = [tuple(map(float, bar)) for bar in re.findall(RECT, svg)]
    zeros = {float(x) for x in re.findall(r'class="sw-zero" x1="([\d.]+)"', svg)}
    (zero,) = zeros
    (x, _, width), (other, _, less) = bars
    assert width / less == pytest.approx(1.5, rel=2e-3)
    if sides == "right":
        assert x == other == zero
    else:
        assert (x + width, other + less) == pytest.approx((zero, zero), abs=0.11)
    assert 0.0 < zero < 420.0


def test_a_transition_of_the_table_counts_for_itself_and_another_one_for_any_state() -> None:
    """The table has A to FAULT by name, and FAULT from any other state."""
    known = [("A", "B"), ("A", "FAULT"), (ANY, "FAULT")]
    found = {("A", "FAULT"): 2, ("B", "FAULT"): 3, ("C", "FAULT"): 4, ("B", "A"): 1}
    text = re.sub("<[^>]*>", "|", _transitions("T", known, found))
    assert "T: 3 of 3" not in text
    assert "T: 2 of 3" in text
    for words in ("A → FAULT: 2", "* → FAULT: 7", "B → A: 1, not in the table"):
        assert words in text
    assert "A → B|" in text


@pytest.mark.parametrize(("first", "last"), [(19.0, 0.0), (0.0, 19.0)])
def test_a_signal_that_falls_in_each_column_is_drawn_falling(first: float, last: float) -> None:
    """20 values in each of 210 columns of pixels, a saw: its two ends are in their order."""
    rows = 210 * 20
    saw = np.tile(np.linspace(first, last, 20), 210)
    table = pa.table({"time_ns": np.arange(rows, dtype=np.int64) * MS, "Z.actual_mm": saw})
    description, _ = chart(table, RunFindings())
    ends = points(drawing.picture(table, description, "m"))[:, 1]
    assert len(ends) == 2 * 210
    falls = ends[::2] < ends[1::2]  # a smaller y is higher up
    assert falls.all() if first > last else not falls.any()
