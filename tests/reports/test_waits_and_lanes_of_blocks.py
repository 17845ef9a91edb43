"""Blocks of a page that wait, take no time, or share a box of their lane."""

from dataclasses import replace
from typing import Any

import pytest
from tests.recordings import MS, Step, block_trace

from axisrig.bench.record.blocks import BlockTrace
from axisrig.reports.blocks import section as blocks
from axisrig.reports.blocks.section import blocks_lane, blocks_view


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


@pytest.mark.parametrize(
    ("holds_ms", "words"),
    [
        ((), "1 command in 0.090 s"),
        (((20, 25),), "1 command in 0.090 s, feedhold 0.005 s"),
        (((20, 25), (40, 52), (60, 63)), "1 command in 0.090 s, feedhold 0.020 s"),
    ],
)
def test_feedholds_of_a_run_add_up(holds_ms: tuple[tuple[int, int], ...], words: str) -> None:
    trace = block_trace([Step("N10 G1 Z5", "feed", 0, 0, 90)])
    trace = replace(trace, holds=tuple((begin * MS, end * MS) for begin, end in holds_ms))
    view = shown(trace)
    assert view["words"] == words
    held_ms = sum(end - begin for begin, end in holds_ms)
    assert view["rows"][0]["held"] == (f"{held_ms}.000" if held_ms else "")


def test_a_command_that_has_waited_long_is_a_box_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is due at 10 ms and begins at 140 ms: of the whole, 190 ms, that is more than half."""
    monkeypatch.setattr(blocks, "LANE_MAX", 4)
    spans = [(0, 0, 10), (10, 140, 150), *((at, at, at + 10) for at in (150, 160, 170, 180))]
    trace = block_trace([
        Step(f"N{n} G1", "feed", *span, line=n) for n, span in enumerate(spans, start=1)
    ])  # fmt: skip
    lane = blocks_lane(trace, is_reduced=False)
    assert lane is not None
    assert [row[6] for row in lane["rows"]] == ["N1 G1", "N2 G1", "4 from N3 G1"]
    assert [row[1] // MS for row in lane["rows"]] == [0, 10, 150]
