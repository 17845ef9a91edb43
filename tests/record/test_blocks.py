"""The block trace in a recording: packed and read back equal, old recordings without, damage."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.recordings import facts

from axisrig.bench.record.blocks import (
    REAL,
    STATES,
    WHOLE,
    BlockTrace,
    ProgramLine,
    block_kinds,
    held_ns,
    pack_rows,
)
from axisrig.bench.record.facts import Facts, read_run, run_text
from axisrig.kernel.errors import UserError

MS = 1_000_000
LINES = (ProgramLine("p.nc", 3, 10, "N10 G1 Z5 F600"), ProgramLine("sub.nc", 1, None, "G4 X0.1"))


def trace(columns: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> BlockTrace:
    return BlockTrace(LINES, ("feed", "dwell"), columns.shape[1], pack_rows(columns))


def loop(turns: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """A loop with a move and a dwell time."""
    count = 2 * turns
    place = np.arange(count) % 2
    begin = np.arange(count) * 110.0 * MS + 14_620_000
    whole = [place, place, begin, begin, begin + 110.0 * MS, np.zeros(count)]
    feed, path = np.where(place == 0, 600.0, np.nan), np.where(place == 0, 0.1 + 0.2, np.nan)
    return np.array([*whole, feed, path, path])


def test_rows_come_back_bit_for_bit() -> None:
    columns = loop(50)
    columns[2:5] += 2.0**52  # 52 days of simulated time
    rows = trace(columns).rows()
    for name, column in zip((*WHOLE, *REAL), columns, strict=True):
        found = getattr(rows, name)
        assert found.dtype == (np.int64 if name in WHOLE else np.float64)
        assert found.astype(np.float64).tobytes() == column.tobytes()


def test_ten_thousand_rows_of_a_loop_take_less_than_40_kb() -> None:
    assert len(trace(loop(5000)).packed) < 40_000


def test_no_rows() -> None:
    rows = BlockTrace().rows()
    assert {len(column) for column in rows} == {0}


def test_a_recording_of_version_1_has_no_blocks(tmp_path: Path) -> None:
    content = json.loads(run_text(facts()))
    del content["facts"]["blocks"]
    content["version"] = 1
    (tmp_path / "run.json").write_text(json.dumps(content), encoding="utf-8")
    left = read_run(tmp_path / "run.json").facts
    assert left == facts()
    assert isinstance(left, Facts)
    assert left.blocks is None


def test_blocks_are_written_and_read(tmp_path: Path) -> None:
    left = facts(blocks=replace(trace(loop(3)), holds=((5, 9),)))
    (tmp_path / "run.json").write_text(run_text(left), encoding="utf-8")
    assert read_run(tmp_path / "run.json").facts == left


@pytest.mark.parametrize(
    "changes",
    [
        {"packed": "no base64!"},
        {"packed": "AAAA"},
        {"count": 7},
        {"lines": LINES[:1]},
        {"kinds": ("feed",)},
        {"packed": ""},
        {"count": 0},
    ],
)
def test_damaged_rows_are_refused(changes: dict[str, object]) -> None:
    with pytest.raises(UserError, match="the recording is damaged: blocks"):
        replace(trace(loop(2)), **changes).rows()  # type: ignore[arg-type]


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize(("column", "size"), [(0, len(LINES)), (1, 2), (5, len(STATES))])
def test_a_row_names_a_line_a_kind_and_a_state_that_are_there(
    column: int, size: int, row: int
) -> None:
    """From 0 to the last one; neither before nor after them."""
    for place, is_there in ((0, True), (size - 1, True), (size, False), (-1, False)):
        columns = loop(1)
        columns[column, row] = place
        if is_there:
            assert trace(columns).rows()[column][row] == place
            continue
        with pytest.raises(UserError, match="a row names what is not there") as caught:
            trace(columns).rows()
        assert caught.value.hint == "run the case again with this version"


def test_whole_numbers_are_the_nearest_ones_on_either_side_of_0() -> None:
    """A time of 0.1 ms as a float is not always whole; before 0 it is as near as after."""
    columns = loop(2)
    columns[2] = [-2.0000001, -1.9999999, 2.0000001, 2.9999999]
    rows = trace(columns).rows()
    assert rows.due_ns.tolist() == [-2, -2, 2, 3]


def test_every_kind_has_a_group_and_a_meaning() -> None:
    for kind, row in block_kinds().items():
        assert row["group"] in {"motion", "measuring", "wait", "other"}, kind
        assert row["meaning"], kind


def test_states_are_words_of_their_own() -> None:
    assert len(set(STATES)) == len(STATES)


def test_feedholds_within_an_interval_are_summed() -> None:
    assert held_ns(((0, 10), (20, 30)), 5, 25) == 10
    assert held_ns((), 5, 25) == 0


@pytest.mark.parametrize(
    ("begin_ns", "end_ns", "held"),
    [
        (0, 40, 20), (10, 20, 0), (12, 18, 0), (0, 5, 5), (25, 26, 1), (30, 40, 0), (31, 90, 0),
        (9, 21, 2), (10, 10, 0), (5, 5, 0),
    ],
)  # fmt: skip
def test_a_feedhold_counts_with_its_part_in_the_interval(
    begin_ns: int, end_ns: int, held: int
) -> None:
    """Of two, 0 to 10 and 20 to 30; one that is before or after takes nothing off."""
    assert held_ns(((0, 10), (20, 30)), begin_ns, end_ns) == held
    assert held_ns(((20, 30), (0, 10)), begin_ns, end_ns) == held
