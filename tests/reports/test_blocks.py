"""NC blocks of a run in the report: rows of the table, the lane, addresses, long programs."""

import json
import shutil
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from tests.recordings import MS, Step, block_trace
from tests.reports.pages import opened

from axisrig.kernel.errors import UserError
from axisrig.reports.blocks.section import (
    LANE_MAX,
    REDUCED_TABLE_MAX,
    TABLE_MAX,
    _joined,
    _way,
    blocks_lane,
    blocks_view,
)
from axisrig.reports.build import build_report

STEPS = (
    Step("N10 M3", "function", 10, 10, 20),
    Step("N10 M3", "feed", 20, 20, 120, feed_mm_min=600.0, path_mm=1.0, travelled_mm=1.0),
    Step(
        "N20 G100 Z0 F600", "measurement run", 120, 150, 400, "no signal", 600.0, 5.0, 2.5, line=7
    ),
    Step("X[INDP_ASYN]", "independent move", 400, 400, 900, line=9, file="sub.nc"),
    Step("N30 G60", "exact stop", 400, 400, 400, "not begun", line=8),
)


def nowhere(_path: str) -> str:
    return ""


def test_a_row_says_when_and_how_it_ended() -> None:
    view = blocks_view(block_trace(STEPS, [(160 * MS, 260 * MS)]), nowhere, is_reduced=False)
    assert view is not None
    function, feed, run, beside, stop = view["rows"]
    assert (function["lasts"], function["group"], function["feed"]) == ("10.000", "wait", "")
    assert (feed["feed"], feed["way"], feed["state"]) == ("600", "1", "done")
    assert (run["begin"], run["lasts"], run["waited"]) == ("150.000", "250.000", "30.000")
    assert (run["held"], run["way"], run["where"]) == ("100.000", "2.5 of 5", "probe.nc:7")
    assert [row["is_ordinary"] for row in view["rows"]] == [True, True, False, True, False]
    assert (beside["where"], beside["text"]) == ("sub.nc:9", "X[INDP_ASYN]")
    assert (stop["state"], stop["lasts"]) == ("not begun", "")
    # 10 ms of the function and 30 ms before the run; the axis beside the path keeps nobody waiting
    assert view["words"] == "5 commands in 0.890 s, of it 0.040 s waiting, feedhold 0.100 s"


def test_a_feedhold_counts_from_the_begin_of_its_command_on() -> None:
    """The run waits from 120 ms on and moves from 150 to 400 ms."""
    for hold_ms, held in (
        ((130, 140), ""), ((130, 160), "10.000"), ((390, 500), "10.000"), ((100, 900), "250.000"),
    ):  # fmt: skip
        holds = [(hold_ms[0] * MS, hold_ms[1] * MS)]
        view = blocks_view(block_trace(STEPS, holds), nowhere, is_reduced=False)
        assert view is not None
        assert view["rows"][2]["held"] == held, hold_ms


def test_a_block_leads_to_its_line() -> None:
    trace = block_trace([Step("N20 G1 X-1,5", "feed", 0, 0, 9, line=7)])
    view = blocks_view(trace, lambda path: f"../{path}", is_reduced=True)
    assert view is not None
    address = view["rows"][0]["address"]
    assert address == "../probe.nc#:~:text=N20%20G1%20X%2D1%2C5"


def test_axes_beside_the_path_have_a_lane_of_their_own() -> None:
    lane = blocks_lane(block_trace(STEPS), is_reduced=False)
    assert lane is not None
    assert lane["lanes"] == 2
    assert [row[5] for row in lane["rows"]] == [0, 0, 0, 1, 0]
    assert lane["rows"][2] == [
        *(2, 120 * MS, 150 * MS, 400 * MS),
        *("measuring", 0, "N20 G100 Z0 F600"),
    ]
    assert lane["rows"][3][6] == "9: X[INDP_ASYN]"


def test_a_long_loop_is_shortened_and_says_so() -> None:
    count = 5000
    steps = [Step("N10 G1 Z1", "feed", 10 * n, 10 * n, 10 * n + 10) for n in range(count)]
    steps[2500] = Step("N20 G4 X9", "dwell", 25_000, 25_000, 25_010.5, line=2)
    trace = block_trace(steps)
    for is_reduced, most in ((False, TABLE_MAX), (True, REDUCED_TABLE_MAX)):
        view = blocks_view(trace, nowhere, is_reduced=is_reduced)
        assert view is not None
        assert [row["at"] for row in view["rows"]] == [
            *range(most // 2),
            *range(count - most // 2, count),
        ]
        assert view["left_out"] == count - most
        (again,) = view["again"]
        assert (again["text"], again["count"], again["lasts"]) == ("N10 G1 Z1", 4999, "49990.000")


def test_the_lane_of_a_long_loop_is_without_gaps() -> None:
    """Short neighbours are one stretch, a long command stays by itself."""
    steps = [Step("N10 G1 Z1", "feed", 10 * n, 10 * n, 10 * n + 10) for n in range(5000)]
    steps.insert(2500, Step("N20 G4 X9", "dwell", 25_000, 25_000, 34_000, line=2))
    steps[2501:] = [replace(s, due_ms=s.due_ms + 9000, begin_ms=s.begin_ms + 9000,
                            end_ms=s.end_ms + 9000) for s in steps[2501:]]  # fmt: skip
    lane = blocks_lane(block_trace(steps), is_reduced=False)
    assert lane is not None
    assert len(lane["rows"]) < LANE_MAX
    ends = [(row[1], row[3]) for row in lane["rows"]]
    assert ends[0][0] == 0
    assert ends[-1][1] == 59_000 * MS
    assert all(one[1] == other[0] for one, other in pairwise(ends))
    (dwell,) = [row for row in lane["rows"] if row[4] == "wait"]
    assert (dwell[0], dwell[6]) == (2500, "N20 G4 X9")
    # 59 s in 2000 parts, of which a stretch takes two: 59 ms are six commands
    assert lane["rows"][0][6] == "6 from N10 G1 Z1"


def test_a_stretch_of_short_commands_ends_with_the_one_that_ends_last() -> None:
    """Moves of single axes overlap: before a long one, the first of two short ones ends last."""
    lasts_ms = {1002: 4.5, 1004: 9.0}  # a stretch has six of the others, one begins with 1002
    steps = [
        Step("X[INDP_ASYN]", "independent move", n, n, n + lasts_ms.get(n, 0.5), line=9)
        for n in range(5000)
    ]
    lane = blocks_lane(block_trace(steps), is_reduced=False)
    assert lane is not None
    assert len(lane["rows"]) < LANE_MAX
    for row, after in pairwise([*lane["rows"], (5000,)]):
        own = steps[row[0] : after[0]]
        assert row[1] == own[0].due_ms * MS
        assert row[3] == max(step.end_ms for step in own) * MS


def test_what_has_no_blocks_has_no_table() -> None:
    for trace in (None, block_trace([])):
        assert blocks_view(trace, nowhere, is_reduced=False) is None
        assert blocks_lane(trace, is_reduced=False) is None


def test_a_kind_of_a_later_version_is_shown_by_its_word() -> None:
    trace = block_trace([Step("N10", "teleport", 0, 0, 5)])
    view, lane = blocks_view(trace, nowhere, is_reduced=False), blocks_lane(trace, is_reduced=True)
    assert view is not None
    assert lane is not None
    assert (view["rows"][0]["kind"], lane["rows"][0][4]) == ("teleport", "other")


@pytest.mark.long
def test_the_page_has_table_and_lane(campaign: Path, tmp_path: Path) -> None:
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    manifest = json.loads((part / "manifest.json").read_text(encoding="utf-8"))
    manifest["plans"][0]["path"] = "probing.csv"
    (part / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    run = opened(build_report(part))["probing-feed_1_a"]
    assert run.html.count('class="pick"') == 4
    assert "4 commands in" in run.html
    assert len(run.chart["blocks"]["rows"]) == 4
    assert run.chart["plots"][0]["plot"] == "block"
    # The files of the blocks are named from the folder of the program that the row names
    assert 'href="../../probe.nc#:~:text=N20%20G100%20Z0%20F1000"' in run.html


@pytest.mark.long
def test_a_damaged_block_trace_names_its_run(campaign: Path, tmp_path: Path) -> None:

    shutil.copytree(campaign, tmp_path / "out")
    path = tmp_path / "out" / "runs" / "probing-feed_1_a.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    content["facts"]["blocks"]["packed"] = "AAAA"
    path.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(UserError, match="the recording is damaged: blocks") as raised:
        build_report(tmp_path / "out")
    assert raised.value.file == str(path)


@pytest.mark.parametrize(
    ("path", "travelled", "words"),
    [
        (5.0, 5.0, "5"), (5.0, 5.0 + 5e-7, "5"), (5.0, 2.5, "2.5 of 5"), (5.0, 0.0, "0 of 5"),
        (5.0, float("nan"), "5"), (float("nan"), 3.0, ""), (0.0, 0.0, "0"),
        (5.0, 4.9999, "4.9999 of 5"),
    ],
)  # fmt: skip
def test_the_way_of_a_block(path: float, travelled: float, words: str) -> None:
    assert _way(path, travelled) == words


def lane(*rows: tuple[int, int, str]) -> list[list[Any]]:
    """Rows of due and end, waiting for a half of it, with their group."""
    return [
        [at, due, due + 1, end, group, 0, f"N{at}"] for at, (due, end, group) in enumerate(rows)
    ]


@pytest.mark.parametrize(
    ("rows", "found"),
    [
        (lane((0, 100, "a")), lane((0, 100, "a"))),
        (lane((0, 3, "a")), lane((0, 3, "a"))),  # alone, though short
        (lane((0, 3, "a"), (3, 8, "b")), [[0, 0, 0, 8, "b", 0, "2 from N0"]]),  # 5 of 8 are b
        (lane((0, 6, "a"), (6, 11, "b"), (11, 15, "a")),
         [[0, 0, 0, 11, "a", 0, "2 from N0"], [2, 11, 12, 15, "a", 0, "N2"]]),
        (lane((0, 3, "a"), (3, 50, "b"), (50, 53, "a"), (53, 56, "a")),
         [[0, 0, 1, 3, "a", 0, "N0"], [1, 3, 4, 50, "b", 0, "N1"],
          [2, 50, 50, 56, "a", 0, "2 from N2"]]),
    ],
)  # fmt: skip
def test_short_commands_are_joined_until_they_are_10_long(
    rows: list[list[Any]], found: list[list[Any]]
) -> None:
    assert _joined(rows, 10) == found


def test_lines_that_come_again_are_counted_by_what_they_took() -> None:
    """From due to end; a line that is carried out once is not among them."""
    steps = [
        Step("N10 G1", "feed", 0, 5, 10, line=1), Step("N20 G1", "feed", 10, 10, 40, line=2),
        Step("N10 G1", "feed", 40, 40, 45, line=1), Step("N20 G1", "feed", 45, 45, 50, line=2),
        Step("N30 G1", "feed", 50, 50, 99, line=3),
    ]  # fmt: skip
    view = blocks_view(block_trace(steps), nowhere, is_reduced=False)
    assert view is not None
    again = [(each["text"], each["count"], each["lasts"]) for each in view["again"]]
    assert again == [("N20 G1", 2, "35.000"), ("N10 G1", 2, "15.000")]
    assert view["file"] == "probe.nc"
    assert (view["has_waits"], view["has_feed"], view["has_way"]) == (True, False, False)
    alone = blocks_view(block_trace(steps[:1]), nowhere, is_reduced=False)
    assert alone is not None
    assert alone["words"] == "1 command in 0.010 s, of it 0.005 s waiting"
    assert (alone["left_out"], alone["half"]) == (0, -1)
